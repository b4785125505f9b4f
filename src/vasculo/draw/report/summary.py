"""The answer in short: a sentence made from the numbers, and the numbers that matter most."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.draw.page import MINUS, TIMES
from vasculo.draw.report.words import has, number, plural, rows_of

if TYPE_CHECKING:
    from vasculo.store.read import Run

_STEADY = 0.02
"""A relative change below this counts as none in a sentence."""


def sentence(run: Run) -> str:
    """Say in words what the run did, from its numbers."""
    said = []
    if run.steps("vasculogenesis"):
        said.append(_growth(run))
    if run.steps("angiogenesis"):
        said.append(_remodelling(run))
    return " ".join(said) or "Nothing was recorded."


def _growth(run: Run) -> str:
    first, last = rows_of(run, "vasculogenesis")
    springs, voids = run.metrics["springs"], int(run.metrics["pillars"][last])
    return (
        f"A tissue of {len(run.network().points):,} nodes was stretched until {1 - springs[last] / springs[first]:.0%} "
        f"of its {int(springs[first]):,} springs were gone: {plural(voids, 'void')} cover "
        f"{run.metrics['void_fraction'][last]:.0%} of it."
    )


def _remodelling(run: Run) -> str:
    first, last = rows_of(run, "angiogenesis")
    table = run.metrics
    pillars, merges = (table["pillars"][[first, last]]).astype(int), int(table["merges"][last])
    steps = plural(int(table["step"][last]), "remodelling step")
    if pillars[0] == 1 and pillars[1] == 1:
        text = f"In {steps} one pillar in the flow went from aspect ratio {_pair(run, 'aspect_ratio', first, last)}"
    elif pillars[0] == pillars[1]:
        text = f"In {steps} {plural(int(pillars[0]), 'pillar')} stayed {pillars[1]}"
    else:
        text = f"In {steps} {plural(int(pillars[0]), 'pillar')} became {pillars[1]} ({plural(merges, 'merger')})"
    parts = [text]
    if pillars[0] > 1 and has(run, "alignment", (first,)) and has(run, "alignment", (last,)):
        parts.append(f"alignment with the local flow went from {_pair(run, 'alignment', first, last)}")
    if has(run, "permeability", (first,)) and has(run, "permeability", (last,)):
        parts.append(f"permeability {_trend(table['permeability'][first], table['permeability'][last])}")
    return f"{_joined(parts)}."


def _pair(run: Run, column: str, first: int, last: int) -> str:
    return " to ".join(f"{run.metrics[column][row]:.2f}" for row in (first, last)).replace("-", MINUS)


def _trend(first: float, last: float) -> str:
    """Say how a number rose or fell."""
    if first <= 0.0:
        return f"ended at {number(last)}"
    ratio = last / first
    if abs(ratio - 1.0) < _STEADY:
        return "stayed as it was"
    if ratio >= 2.0:
        return f"rose {ratio:.1f}-fold"
    return f"{'rose' if ratio > 1.0 else 'fell'} by {abs(ratio - 1.0):.0%}"


def _joined(parts: list[str]) -> str:
    return parts[0] if len(parts) == 1 else f"{', '.join(parts[:-1])} and {parts[-1]}"


def key_numbers(run: Run) -> list[tuple[str, str]]:
    """Pick the numbers of the first screen: name and value."""
    found: list[tuple[str, str]] = []
    table = run.metrics
    if run.steps("vasculogenesis"):
        first, last = rows_of(run, "vasculogenesis")
        springs = table["springs"]
        found += [
            ("nodes of the tissue", f"{len(run.network().points):,}"),
            (f"of {int(springs[first]):,} springs left", f"{int(springs[last]):,}"),
        ]
        if not run.steps("angiogenesis"):
            found.append(("voids", f"{int(table['pillars'][last])}"))
            found.append(("of the area in voids", f"{table['void_fraction'][last]:.0%}"))
    if run.steps("angiogenesis"):
        first, last = rows_of(run, "angiogenesis")
        pillars = [int(table["pillars"][row]) for row in (first, last)]
        if pillars != [1, 1]:
            found.append(("pillars, start and end", f"{pillars[0]} → {pillars[1]}"))
            found.append(("mergers", f"{int(table['merges'][last])}"))
        if has(run, "permeability", (first,)) and table["permeability"][first] > 0.0:
            ratio = table["permeability"][last] / table["permeability"][first]
            if np.isfinite(ratio):
                found.append(("permeability over its start", f"{TIMES} {ratio:.2f}"))
        for column, words in (("alignment", "alignment with the local flow"), ("aspect_ratio", "aspect ratio")):
            if has(run, column, (first,)) and has(run, column, (last,)):
                found.append((words, f"{table[column][first]:.2f} → {table[column][last]:.2f}"))
        found.append(("triangles of the flow mesh", f"{int(table['triangles'][last]):,}"))
    return found
