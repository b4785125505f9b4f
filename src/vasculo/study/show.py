"""What the command line prints of a run: its stages at the end, and its numbers."""

from __future__ import annotations

import csv
import io
from collections import Counter
from typing import TYPE_CHECKING

import numpy as np
from rich.console import Console
from rich.table import Table

from vasculo import measure
from vasculo.errors import InputError
from vasculo.store.events import events_text
from vasculo.store.read import FIGURES, RECORD, REPORT, TABLE
from vasculo.store.table import COLUMNS, COUNTS, STAGES, UNIT_OF, to_csv
from vasculo.store.units import Units
from vasculo.study.changes import told
from vasculo.study.watch_table import WATCH_TABLE

if TYPE_CHECKING:
    from vasculo.store.read import Run
    from vasculo.study.picture import Written

_MOST_ROWS = 9
_SHOWN = {
    "vasculogenesis": ("step", "time", "springs", "void_fraction", "pillars", "residual"),
    "angiogenesis": (
        "step",
        "pillars",
        "merges",
        "order",
        "alignment",
        "local_angle",
        "aspect_ratio",
        "mean_gap",
        "permeability",
        "chains",
        "corridors",
        "shear_ratio",
    ),
}


def show_end(run: Run) -> None:
    """Print the table of stages and where everything lies."""
    console = _console()
    _show_origin(run, console)
    table = _table("stage", "seconds", "peak MB", "result")
    stages = run.facts("stages")
    for stage in stages:
        table.add_row(stage["name"], f"{stage['seconds']:.1f}", str(stage["peak_mb"]), stage["result"])
    if stages:
        total = sum(stage["seconds"] for stage in stages)
        table.add_row("all", f"{total:.1f}", str(max(stage["peak_mb"] for stage in stages)), "")
    console.print(table)
    for name in (REPORT, FIGURES, RECORD, TABLE, WATCH_TABLE):
        if (run.folder / name).exists():
            console.print(f"{run.folder / name}", soft_wrap=True)


def show_numbers(run: Run) -> None:
    """Print rows of the table, thinned, and the pillars of the last step."""
    console = _console()
    if run.caveat:
        console.print(run.caveat, soft_wrap=True)
    _show_origin(run, console)
    for stage in STAGES:
        rows = np.flatnonzero(run.metrics["stage"] == stage)
        if not len(rows):
            continue
        shown = [name for name in _SHOWN[stage] if name in run.metrics]
        table = _table(*(_heading(name, UNIT_OF.get(name, ""), run.units) for name in shown), title=stage)
        picked = rows[np.unique(np.linspace(0, len(rows) - 1, _MOST_ROWS).round().astype(int))]
        for row in picked:
            table.add_row(*(_cell(name, float(run.metrics[name][row]), run.units) for name in shown))
        console.print(table)
    if plexus := run.facts("plexus"):
        table = _table("plexus at the end", "value")
        for entry in plexus:
            table.add_row(entry["name"], f"{entry['value']:.4g}")
        console.print(table)
        console.print(
            "lengths in mean initial springs, areas in mean initial triangles; docs/morphometry.md defines each"
        )
    if run.steps("angiogenesis"):
        _show_pillars(run, console)


def show_picture(written: Written) -> None:
    """Print what was found in a picture, and what was written."""
    console = _console()
    width = max(len(name) for name, _ in written.rows)
    for name, value in written.rows:
        console.print(f"{name:<{width}}  {value}", soft_wrap=True)
    for note in written.notes:
        console.print(f"note: {note}", soft_wrap=True)
    for file in (written.overlay, written.outlines):
        if file is not None:
            console.print(str(file), soft_wrap=True)
    console.print(f"{written.study} written; try: vasculo run {written.study}", soft_wrap=True)


def table_text(run: Run, *, physical: bool = False) -> str:
    """Return the whole table of a run as CSV.

    Parameters
    ----------
    run : Run
        The run.
    physical : bool
        Whether numbers are in the physical units of the study, where it names them, and headers have the unit behind
        the name; else all is as in `metrics.csv`.

    Raises
    ------
    InputError
        When physical units are wanted and the study names none.
    """
    stages = [str(stage) for stage in run.metrics["stage"]]
    columns = {name: values for name, values in run.metrics.items() if name != "stage"}
    if not physical:
        return to_csv(stages, columns)
    units = run.units
    if units == Units():
        raise InputError(f"{run.folder} has no physical units: give the study a section [units] with length and shear")
    factors = {name: units.factor(UNIT_OF.get(name, "")) for name in columns}
    text = to_csv(stages, {name: values * factors[name] for name, values in columns.items()})
    _, end, body = text.partition("\n")
    return (
        ",".join(f"{name} [{units.name(UNIT_OF[name])}]" if name in UNIT_OF else name for name in COLUMNS) + end + body
    )


def passages_text(run: Run) -> str:
    """Return the passages between the pillars of the last step as CSV."""
    columns = measure.passages(run.domain()).columns()
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*(column.tolist() for column in columns.values()), strict=True))
    return text.getvalue()


def all_events(run: Run) -> str:
    """Return everything that happened to the pillars as CSV."""
    return events_text(run.events)


def _show_origin(run: Run, console: Console) -> None:
    """Print where a branch comes from, the latest last."""
    for origin in run.facts("branch"):
        changes = told([(path, old, new) for path, old, new in origin["changes"]])
        console.print(f"branch of {origin['folder']} behind step {origin['step']}: {changes}", soft_wrap=True)


def _show_pillars(run: Run, console: Console) -> None:
    domain = run.domain()
    found, chains = measure.pillars(domain), measure.chains(domain, run.pillars().lineage)
    passages = measure.passages(domain)
    inner = passages.between_pillars
    table = _table("pillars of the last step", "smallest", "median", "largest", "unit")
    values = {
        "area": ("area", found.area),
        "aspect ratio": ("", found.aspect_ratio),
        "nearest gap": ("length", found.nearest_gap),
        "length": ("length", chains.lengths),
        "original pillars": ("", chains.sizes),
    }
    if inner.any():
        values |= {
            "width of passages": ("length", passages.width[inner]),
            "length of passages": ("length", passages.length[inner]),
        }
    for name, (dimension, column) in values.items():
        picked = run.units.factor(dimension) * np.array([column.min(), np.median(column), column.max()])
        table.add_row(name, *(f"{value:.4g}" for value in picked), run.units.name(dimension))
    console.print(table)
    events = run.events
    angles = np.array([event.angle for event in events if event.kind == "merge"])
    text = f"pillars {len(found)}, {chains.fraction:.0%} of the original ones in chains"
    if len(angles):
        text += f"; mergers {len(angles)}, mean cos 2 phi {np.mean(np.cos(2.0 * np.radians(angles))):.2f} against x"
    others = Counter(event.kind for event in events if event.kind != "merge")
    if others:
        text += "; " + ", ".join(f"{kind} {count}" for kind, count in sorted(others.items()))
    console.print(text, soft_wrap=True)


def _console() -> Console:
    """Make a console as wide as the terminal, or wide enough for every table where there is none."""
    console = Console(highlight=False, markup=False)
    if not console.is_terminal:
        console.width = 160
    return console


def _table(*columns: str, title: str | None = None) -> Table:
    table = Table(title=title, title_justify="left", box=None, pad_edge=False, header_style="bold")
    for number, name in enumerate(columns):
        text = name in {"stage", "result", "unit"} or (number == 0 and " " in name)
        table.add_column(name, justify="left" if text else "right", no_wrap=name != "result", overflow="fold")
    return table


def _heading(name: str, dimension: str, units: Units) -> str:
    """Name of a column, with its unit below where that is a physical one."""
    return f"{name}\n{units.name(dimension)}" if dimension and units.known(dimension) else name


def _cell(name: str, value: float, units: Units) -> str:
    if np.isnan(value):
        return ""
    return str(int(value)) if name in COUNTS else f"{value * units.factor(UNIT_OF.get(name, '')):.4g}"
