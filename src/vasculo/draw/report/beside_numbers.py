"""Tables of a few runs beside each other, with their differences from the first."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

import numpy as np

from vasculo.draw.page import Markup, as_text, folded, html, paragraph, table
from vasculo.draw.report.events import KINDS
from vasculo.draw.report.numbers import GROWTH, REMODELLING
from vasculo.draw.report.words import change, label, number
from vasculo.store.table import UNIT_OF

if TYPE_CHECKING:
    from collections.abc import Sequence

    from vasculo.store.read import Run
    from vasculo.store.units import Units


def numbers_table(runs: Sequence[Run], names: Sequence[str], rows: Sequence[int], stage: str, units: Units) -> str:
    """Numbers of one step of each run; small below, what is different from the first run.

    Parameters
    ----------
    runs, names, rows : sequence
        Runs, their names, and the row of the table of each that is told.
    stage : {"vasculogenesis", "angiogenesis"}
        Whose numbers.
    units : Units
        In which they are told.
    """
    listing = []
    for column in GROWTH if stage == "vasculogenesis" else REMODELLING:
        values = [
            float(run.metrics[column][row]) if column in run.metrics else float("nan")
            for run, row in zip(runs, rows, strict=True)
        ]
        if np.isfinite(values).any():
            factor = units.factor(UNIT_OF.get(column, ""))
            cells = [number(values[0] * factor)]
            cells += [_with(number(value * factor), change(values[0], value, column, units)) for value in values[1:]]
            listing.append((label(column, stage, units), *cells))
    return table(("number", *names), listing, ("", *("value" for _ in runs)))


def events_table(runs: Sequence[Run], names: Sequence[str]) -> str:
    """Count the events of each run by kind."""
    counts = [Counter(event.kind for event in run.events) for run in runs]
    rows = [
        (words, *(str(count[kind]) for count in counts))
        for kind, words in KINDS.items()
        if any(count[kind] for count in counts)
    ]
    if not rows:
        return paragraph("Events: none in any of the runs.")
    return table(("event", *names), rows, ("", *("value" for _ in runs)))


def facts_table(runs: Sequence[Run], names: Sequence[str]) -> list[str]:
    """Numbers of the plexuses and of the extractions, folded, where all runs have them."""
    parts = []
    for name, title in (("plexus", "All numbers of the plexuses"), ("extraction", "All counts of the extractions")):
        facts = [{entry["name"]: entry for entry in run.facts(name) or []} for run in runs]
        if all(facts):
            rows = [
                (
                    Markup(f'{html(key.replace("_", " "))}<span class="define">{html(entry["meaning"])}</span>'),
                    *(as_text(each[key]["value"]) if key in each else "" for each in facts),
                )
                for key, entry in facts[0].items()
            ]
            parts.append(folded(title, table(("number", *names), rows, ("", *("value" for _ in runs)))))
    return parts


def _with(value: str, difference: str) -> str:
    return Markup(f"{html(value)}<small>{html(difference)}</small>") if value and difference else value
