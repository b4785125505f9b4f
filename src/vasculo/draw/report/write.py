"""The report of a run: a summary, and five parts below it, in one HTML page."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from vasculo.draw.page import cards, html, page, paragraph
from vasculo.draw.report.asked import asked
from vasculo.draw.report.flows import draw_ends
from vasculo.draw.report.happened import happened
from vasculo.draw.report.media import shown
from vasculo.draw.report.numbers import numbers
from vasculo.draw.report.repeat import repeat
from vasculo.draw.report.summary import key_numbers, sentence
from vasculo.draw.report.sure import sure
from vasculo.store.read import REPORT
from vasculo.store.table import write_whole

if TYPE_CHECKING:
    from vasculo.store.read import Run

PARTS = {
    "asked": "What was asked",
    "happened": "What happened",
    "numbers": "Numbers",
    "sure": "How sure",
    "repeat": "How to repeat",
}
"""Parts of the page: their anchors and titles."""


def write_report(run: Run, out: str | Path | None = None) -> Path:
    """Write the report of a run, whole or not at all.

    Parameters
    ----------
    run : Run
        An opened run; figures that lie in its folder are taken as they are, the others are drawn.
    out : str or Path, optional
        The file; `report.html` in the folder of the run when left out.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        When matplotlib is missing.
    OSError
        When the file cannot be written.
    """
    path = run.folder / REPORT if out is None else Path(out)
    parts = [summary_of(run), asked(run), happened(run), numbers(run), sure(run), repeat(run)]
    write_whole(path, page(str(run.settings["study"]["title"]), parts))
    return path


def links() -> str:
    """Lead to the parts of the page."""
    inside = " ".join(f'<a href="#{name}">{title}</a>' for name, title in PARTS.items())
    return f"<nav>{inside}</nav>"


def summary_of(run: Run) -> str:
    """Give the answer on one screen."""
    study = run.settings["study"]
    head = [
        f"<h1>{html(str(study['title']))}</h1>",
        paragraph(f"Run {run.folder.resolve().name}, seed {study['seed']}, vasculo {run.version}", "muted"),
        links(),
    ]
    if not run.complete:
        head.append(paragraph("This run did not come to its end; what follows is what was recorded.", "warning"))
    left = [paragraph(sentence(run), "lead"), cards(key_numbers(run))]
    right = []
    if run.frames:
        figure, words = draw_ends(run)
        right = [shown(figure, "", words)]
    return (
        "<header>\n"
        + "\n".join(head)
        + '\n<div class="summary">\n<div>'
        + "\n".join(left)
        + "</div>\n<div>"
        + "\n".join(right)
        + "</div>\n</div>\n</header>"
    )
