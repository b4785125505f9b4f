"""The report of a sweep: one HTML page with its plan, its diagrams and its table, which links to the runs."""

from __future__ import annotations

from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING
from urllib.parse import quote

from vasculo.draw.page import Markup, cards, folded, page, paragraph, picture, section, table

if TYPE_CHECKING:
    from collections.abc import Sequence

    Rows = Sequence[Sequence[str]]

MOST_ROWS = 1_000
"""Rows of a table on the page; the files have all."""


@dataclass(frozen=True)
class Shown:
    """A picture of the page: PNG, headline, caption."""

    image: bytes
    title: str
    caption: str


@dataclass(frozen=True)
class Listing:
    """A table of the page: names of the columns, rows of cells, and which columns are numbers."""

    head: Sequence[str]
    rows: Rows
    numbers: Sequence[bool]

    def html(self, file: str) -> str:
        """Make it; of a long one the first rows, and the file that has all."""
        kinds = ["value" if each else "" for each in self.numbers]
        shown = table(self.head, self.rows[:MOST_ROWS], kinds)
        if len(self.rows) <= MOST_ROWS:
            return shown
        return shown + paragraph(f"The first {MOST_ROWS:,} of {len(self.rows):,} rows; {file} has all.", "muted")


@dataclass(frozen=True)
class SweepContent:
    """What stands on the page.

    Attributes
    ----------
    title, about : str
        Headline, and a line below it.
    state : str
        What is missing or failed, empty when all is there.
    numbers : sequence of (name, value)
        The cards.
    diagrams : sequence of Shown
        Phase diagrams, and how the runs ended.
    plan : Listing
        What is varied.
    fixed : Listing
        What all runs have.
    points, runs, failures : Listing
        A row a point, a run, a failed run.
    commands : sequence of (what, command)
        How to go on.
    definitions : Listing
        Names, units and meanings of the numbers.
    """

    title: str
    about: str
    state: str
    numbers: Sequence[tuple[str, str]]
    diagrams: Sequence[Shown]
    plan: Listing
    fixed: Listing
    points: Listing
    runs: Listing
    failures: Listing
    commands: Sequence[tuple[str, str]]
    definitions: Listing


def sweep_page(content: SweepContent) -> str:
    """Write the page."""
    parts = [f"<h1>{escape(content.title)}</h1>", paragraph(content.about, "muted")]
    if content.state:
        parts.append(paragraph(content.state, "warning"))
    parts.append(cards(content.numbers))
    if content.diagrams:
        shown = [picture(each.image, each.title, each.caption) for each in content.diagrams]
        parts.append(section("diagram", "What the settings do", shown))
    plan = [content.plan.html("plan.json")]
    if content.fixed.rows:
        plan.append(folded("Settings that all runs share", content.fixed.html("sweep.toml")))
    parts.append(section("plan", "What was varied", plan))
    points = [paragraph("Mean ± standard deviation over the seeds of each point.", "muted")]
    parts.append(section("points", "Points", [*points, content.points.html("summary.csv")]))
    if content.failures.rows:
        parts.append(section("failures", "Runs that failed", [content.failures.html("failures.csv")]))
    runs = content.runs.html("table.csv")
    parts.append(section("runs", "Runs", [folded(f"All {len(content.runs.rows):,} runs", runs)]))
    rows = [(what, Markup(f"<code>{escape(command)}</code>")) for what, command in content.commands]
    parts.append(section("next", "How to go on", [table(("to", "command"), rows)]))
    words = folded("Numbers of the table", content.definitions.html("table.parquet"))
    parts.append(section("definitions", "Definitions", [words]))
    return page(content.title, parts)


def link(words: str, target: str) -> Markup:
    """Link to a file beside the page."""
    return Markup(f'<a href="{escape(quote(target))}">{escape(words)}</a>')
