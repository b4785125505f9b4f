"""What happened: the film, the pictures, the plots, the events."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vasculo.draw.canvas import png
from vasculo.draw.figures import pictures
from vasculo.draw.page import paragraph, section
from vasculo.draw.report.events import events_parts
from vasculo.draw.report.media import moving, shown
from vasculo.draw.report.plots import plots
from vasculo.store.read import FIGURES

if TYPE_CHECKING:
    from vasculo.store.read import Run

_FILM = {
    ("vasculogenesis",): "The tissue tears into a plexus. Width and grey of a spring follow its pull.",
    ("angiogenesis",): "Pillars in the flow: dark where the blood rests, bright where it is fast.",
    ("angiogenesis", "vasculogenesis"): (
        "First the tissue tears (width and grey of a spring follow its pull), then the pillars remodel in the flow: "
        "dark where the blood rests, bright where it is fast."
    ),
}
_PLOTTED = ("curves-vasculogenesis", "curves-angiogenesis")
"""Figures that the report draws as plots of their own."""


def happened(run: Run) -> str:
    """Put the part together."""
    stages = tuple(sorted({frame.stage for frame in run.frames}))
    if not stages:
        return section("happened", "2 · What happened", [paragraph("No step was recorded.")])
    parts = [moving(run, "story", "The film", _FILM[stages]), *figures(run)]
    for stage, across in (("vasculogenesis", "time"), ("angiogenesis", "step")):
        if stage in stages:
            parts += [f"<h3>{stage.capitalize()} in numbers</h3>", plots([run], stage, across, run.units)]
    if "angiogenesis" in stages:
        parts += events_parts(run)
    return section("happened", "2 · What happened", parts)


def figures(run: Run) -> list[str]:
    """Every figure, from its file if it is there."""
    found = []
    for entry in pictures(run):
        if entry.name not in _PLOTTED:
            file = run.folder / FIGURES / f"{entry.name}.png"
            image = file.read_bytes() if file.is_file() else png(entry.draw(run))
            found.append(shown(image, entry.title, entry.caption))
    return found
