"""What the command line prints of a sweep: its plan, and its points at the end."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import numpy as np
from rich.console import Console
from rich.table import Table

from vasculo.draw.page import as_text
from vasculo.study.costs import SPREAD
from vasculo.study.sweep.cost import expected, told_time
from vasculo.study.sweep.home import FAILURES, PAGE, PARQUET, TABLE

if TYPE_CHECKING:
    from vasculo.study.sweep.results import Sweep

_MOST_ROWS = 24


def show_plan(found: Sweep, workers: int | None = None) -> None:
    """Print what a sweep leads to on so many workers, one a processor when left out."""
    console, plan, processors = _console(), found.plan, len(os.sched_getaffinity(0))
    count = workers or processors
    cost = expected(found.samples, len(plan.runs), count, max(1, processors // count))
    points = plan.points
    lines = [
        ("sweep", plan.title),
        ("study", plan.study),
        ("method", found.file.sweep.method),
        ("points", f"{len(points):,}"),
        ("runs", f"{len(plan.runs):,}, {len(found.file.sweep.all_seeds)} of each point"),
        ("numbers", f"{len(found.numbers)} a run; diagrams of {', '.join(number.name for number in found.shown)}"),
        ("time", f"{told_time(cost.seconds / SPREAD)} to {told_time(cost.seconds * SPREAD)} on {count} workers"),
        ("memory", f"about {cost.memory:.0f} MB a worker"),
        ("disk", f"about {max(cost.record, 1.0):.0f} MB of records"),
    ]
    for name, value in lines:
        console.print(f"{name:<8}  {value}", soft_wrap=True)
    table = _table("point", *(found.label(key) for key in found.varied))
    shown = list(points.items())[:_MOST_ROWS]
    for number, settings in shown:
        table.add_row(str(number), *(as_text(settings.get(key)) for key in found.varied))
    console.print(table)
    if len(points) > len(shown):
        console.print(f"and {len(points) - len(shown):,} more")


def show_sweep(found: Sweep) -> None:
    """Print the points with their means, and where everything lies."""
    console, points, units = _console(), found.summary, found.settings.units
    table = _table("point", *(found.label(key) for key in found.varied), "runs", *(n.label(units) for n in found.shown))
    for row in range(min(len(points["point"]), _MOST_ROWS)):
        cells = [str(points["point"][row]), *(as_text(points[key][row].item()) for key in found.varied)]
        cells.append(str(points["n"][row]))
        for number in found.shown:
            factor = units.factor(number.dimension)
            mean, spread = (factor * float(points[f"{number.name} {what}"][row]) for what in ("mean", "sd"))
            cells.append(as_text(mean) + (f" ± {spread:.2g}" if np.isfinite(spread) else ""))
        table.add_row(*cells)
    console.print(table)
    if len(points["point"]) > _MOST_ROWS:
        console.print(f"and {len(points['point']) - _MOST_ROWS:,} more points")
    for name in (PAGE, TABLE, PARQUET, *((FAILURES,) if found.failures else ())):
        if (found.folder / name).exists():
            console.print(f"{found.folder / name}", soft_wrap=True)


def _console() -> Console:
    """Make a console as wide as the terminal, or wide enough for the tables where there is none."""
    console = Console(highlight=False, markup=False)
    if not console.is_terminal:
        console.width = 160
    return console


def _table(*columns: str) -> Table:
    table = Table(box=None, pad_edge=False, header_style="bold")
    for name in columns:
        table.add_column(name, justify="right", overflow="fold")
    return table
