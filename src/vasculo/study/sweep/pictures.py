"""The pictures and the page of a sweep, from its tables."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

import vasculo
from vasculo.draw.canvas import save
from vasculo.draw.end_states import draw_end_states, end_state
from vasculo.draw.page import as_text
from vasculo.draw.phase import Axis, Field, draw_cells, draw_curves_over, draw_points, is_grid, levels
from vasculo.draw.sweep_page import Listing, Shown, SweepContent, link, sweep_page
from vasculo.errors import InputError
from vasculo.store.read import REPORT
from vasculo.store.table import write_whole
from vasculo.study.sweep.file import in_words
from vasculo.study.sweep.home import DIAGRAM, GALLERY, PAGE, PARQUET, RUNS
from vasculo.study.sweep.labels import setting_meaning
from vasculo.study.sweep.points import Span
from vasculo.study.sweep.table import NOT_YET

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from vasculo.study.sweep.numbers import Number
    from vasculo.study.sweep.results import Sweep

    Table = dict[str, NDArray[Any]]

MOST_PICTURES = 64
"""Points up to which the ends of the runs are drawn."""
MOST_PANELS = 6
"""Values of a third setting up to which each has a panel of its own."""


def illustrate(found: Sweep) -> Path:
    """Draw the diagrams and the ends of the runs, and write the page; return its file."""
    table, points = found.table, found.summary
    shown: list[Shown] = []
    if (table["status"] == "complete").any():
        shown += _diagrams(found, table)
        if found.file.diagram.gallery and len(points["point"]) <= MOST_PICTURES:
            shown.append(_kept(found, GALLERY, *_gallery(found, table, points)))
    write_whole(found.folder / PAGE, sweep_page(_content(found, table, points, shown)))
    return found.folder / PAGE


def _axes(found: Sweep) -> list[str]:
    """Order the settings: those of the two axes first, then the others."""
    asked = [key for key in (found.file.diagram.x, found.file.diagram.y) if key is not None]
    return list(dict.fromkeys([*asked, *found.varied]))


def _axis(found: Sweep, values: NDArray[Any], key: str) -> Axis:
    span = found.file.axes.get(key)
    positive = values.dtype.kind in "if" and len(values) and values.min() > 0.0
    wide = bool(positive) and values.max() > 30.0 * values.min()
    log = span.scale == "log" if isinstance(span, Span) else wide
    return Axis(found.label(key), values, log)


def _diagrams(found: Sweep, table: Table) -> list[Shown]:
    """Draw the numbers over the settings, averaged over the seeds and over settings that have no axis."""
    keys, seeds = _axes(found), len(np.unique(table["seed"]))
    used, rest = keys[:2], keys[2:]
    gridded = len(used) == 2 and _gridded(found, [table[key] for key in used], used)
    if gridded and rest and len(levels(table[rest[0]])) <= MOST_PANELS:
        used, rest = keys[:3], keys[3:]
    members = np.unique(np.stack([_codes(table[key]) for key in used], axis=1), axis=0, return_inverse=True)[1].ravel()
    first = [int(np.flatnonzero(members == group)[0]) for group in range(members.max() + 1)]
    axes = [_axis(found, table[key][first], key) for key in used]
    complete = table["status"] == "complete"
    values = [np.where(complete, _factor(found, number) * table[number.name], np.nan) for number in found.shown]
    fields = [
        _field(number.label(found.settings.units), each, members)
        for number, each in zip(found.shown, values, strict=True)
    ]
    words = f"Mean{' and standard deviation' if seeds > 1 else ''} over {seeds} seed{'s' * (seeds > 1)}"
    if rest:
        others = ", ".join(found.words(key) for key in rest)
        words += f" and over {others}" if gridded else f"; {others} differ from point to point"
    title = f"{', '.join(found.words(key) for key in used)}"
    if len(axes) == 1:
        figure = draw_curves_over(axes[0], fields, _axis(found, table[used[0]], used[0]), values)
        return [_kept(found, DIAGRAM, figure, f"Numbers over {title}", f"{words}; a dot is a run.")]
    if len(axes) == 3:
        return [
            _kept(
                found,
                f"diagram-{number.name}.png",
                draw_cells(axes[0], axes[1], [field], axes[2]),
                field.label,
                f"{number.meaning}. {words}.",
            )
            for number, field in zip(found.shown, fields, strict=True)
        ]
    if gridded or not (axes[0].numeric and axes[1].numeric):
        return [_kept(found, DIAGRAM, draw_cells(axes[0], axes[1], fields), f"Numbers over {title}", f"{words}.")]
    words += "; a dot is a point of the sweep, the colour between them linear interpolation."
    return [_kept(found, DIAGRAM, draw_points(axes[0], axes[1], fields), f"Numbers over {title}", words)]


def _kept(found: Sweep, name: str, figure: Figure, title: str, caption: str) -> Shown:
    """Save a picture in the folder of the sweep, and show it on the page."""
    save(figure, found.folder / name)
    return Shown((found.folder / name).read_bytes(), title, caption)


def _factor(found: Sweep, number: Number) -> float:
    return found.settings.units.factor(number.dimension)


def _gridded(found: Sweep, columns: Sequence[NDArray[Any]], keys: Sequence[str]) -> bool:
    x, y = (_axis(found, values, key) for values, key in zip(columns, keys, strict=True))
    return is_grid(x, y)


def _field(label: str, values: NDArray[np.float64], members: NDArray[np.int64]) -> Field:
    """Mean and spread of a number in each group of runs."""
    groups = [values[(members == group) & np.isfinite(values)] for group in range(members.max() + 1)]
    return Field(
        label,
        np.array([each.mean() if len(each) else np.nan for each in groups]),
        np.array([each.std(ddof=1) if len(each) > 1 else np.nan for each in groups]),
    )


def _codes(values: NDArray[Any]) -> NDArray[np.int64]:
    """Give each row of a column the place of its value among the distinct ones."""
    return np.unique(values, return_inverse=True)[1].ravel()


def _gallery(found: Sweep, table: Table, points: Table) -> tuple[Figure, str, str]:
    """Draw the end of the first complete run of each point."""
    states = []
    for point in points["point"]:
        rows = np.flatnonzero((table["point"] == point) & (table["status"] == "complete"))
        state = None
        if len(rows):
            run = found.planned[str(table["run"][rows[0]])]
            words = ", ".join(as_text(value) for value in run.settings.values())
            try:
                state = end_state(found.run(run.name), f"{point}: {words}")
            except InputError:  # it was taken away, or cannot be read any more
                state = None
        states.append(state)
    keys, title, caption = _axes(found), "How the runs ended", "First complete run of each point"
    if len(keys) == 2 and _gridded(found, [points[key] for key in keys], keys):
        return draw_end_states(states, *(_axis(found, points[key], key) for key in keys)), title, f"{caption}."
    names = ", ".join(found.words(key) for key in found.varied)
    return draw_end_states(states), title, f"{caption}, with its number and its {names}."


def _content(found: Sweep, table: Table, points: Table, diagrams: Sequence[Shown]) -> SweepContent:
    """Gather what stands on the page."""
    plan, failures = found.plan, found.failures
    waiting = int((table["status"] == NOT_YET).sum())
    parts = [f"{waiting} of {len(plan.runs)} runs are not done yet"] if waiting else []
    parts += [f"{len(failures)} of {len(plan.runs)} runs failed, see below"] if failures else []
    seeds = len(np.unique(table["seed"]))
    seconds = float(np.nansum(table["seconds"]))
    numbers = [
        ("points", f"{len(points['point']):,}"),
        ("seeds a point", f"{seeds}"),
        ("runs complete", f"{int((table['status'] == 'complete').sum()):,} of {len(plan.runs):,}"),
        ("time of the runs together", f"{seconds / 60.0:.1f} min" if seconds > 90.0 else f"{seconds:.0f} s"),
    ]
    varied = [
        (found.label(key), key, _values_text(found, table[key], key), setting_meaning(key, found.settings.kind))
        for key in found.varied
    ]
    fixed = [(found.label(key), in_words({key: value})) for key, value in plan.fixed.items()]
    resume = f"vasculo sweep --resume --out {found.folder}"
    more = f"vasculo sweep SWEEP --resume --out {found.folder}"
    commands = [("go on, and try again what failed", resume)] if waiting or failures else []
    commands += [
        ("add points or seeds, once they are in the sweep file", more),
        ("write the report of a run", f"vasculo report {found.folder / RUNS / plan.runs[0].name}"),
        ("load the table in Python", f"pandas.read_parquet('{found.folder / PARQUET}')"),
    ]
    meanings = [(number.name, number.unit_name(found.settings.units), number.meaning) for number in found.numbers]
    return SweepContent(
        plan.title,
        f"Study {plan.study}, {found.file.sweep.method}, vasculo {vasculo.__version__}.",
        "; ".join(parts) + "." if parts else "",
        numbers,
        diagrams,
        Listing(("setting", "key", "values", "meaning"), varied, (False, False, False, False)),
        Listing(("setting", "value"), fixed, (False, False)),
        _points(found, points),
        _runs(found, table),
        _failures(found),
        commands,
        Listing(("number", "unit", "meaning"), meanings, (False, False, False)),
    )


def _failures(found: Sweep) -> Listing:
    """List the runs that failed, each with its line."""
    rows = [
        (each.run, *(as_text(each.settings.get(key)) for key in found.varied), str(each.seed), each.line)
        for each in found.failures
    ]
    head = ("run", *(found.label(key) for key in found.varied), "seed", "what went wrong")
    return Listing(head, rows, (False, *(True for _ in head[1:-1]), False))


def _values_text(found: Sweep, values: NDArray[Any], key: str) -> str:
    """Values of a setting in one line."""
    span, distinct = found.file.axes.get(key), levels(values)
    if isinstance(span, Span) and (span.steps is None or len(distinct) > 8):
        return f"{as_text(span.low)} to {as_text(span.high)}" + (", logarithmic" if span.scale == "log" else "")
    if len(distinct) > 8 and values.dtype.kind in "if":
        return f"{len(distinct)} values from {as_text(distinct[0])} to {as_text(distinct[-1])}"
    return ", ".join(as_text(value) for value in distinct)


def _points(found: Sweep, points: Table) -> Listing:
    """List the points, ordered by the first number that is shown, the largest first; those without a run last."""
    units = found.settings.units
    lead = points[f"{found.shown[0].name} mean"]
    order = sorted(range(len(lead)), key=lambda row: -lead[row] if np.isfinite(lead[row]) else np.inf)
    rows = []
    for row in order:
        cells = [
            str(points["point"][row]),
            *(as_text(points[key][row].item()) for key in found.varied),
            str(points["n"][row]),
        ]
        for number in found.shown:
            factor = units.factor(number.dimension)
            mean, spread = (factor * float(points[f"{number.name} {what}"][row]) for what in ("mean", "sd"))
            cells.append(as_text(mean) + (f" ± {spread:.2g}" if np.isfinite(spread) else ""))
        rows.append(cells)
    head = (
        "point",
        *(found.label(key) for key in found.varied),
        "runs",
        *(number.label(units) for number in found.shown),
    )
    return Listing(head, rows, (False, *(True for _ in head[1:])))


def _runs(found: Sweep, table: Table) -> Listing:
    """List the runs in the order of the plan, with a link to its report, or to its folder."""
    units = found.settings.units
    rows = []
    for row, name in enumerate(table["run"].tolist()):
        folder = found.folder / RUNS / name
        target = f"{RUNS}/{name}/{REPORT}" if (folder / REPORT).is_file() else f"{RUNS}/{name}/"
        cells = [link(name, target) if folder.is_dir() else name]
        cells += [as_text(table[key][row].item()) for key in found.varied] + [str(table["seed"][row])]
        cells += [as_text(units.factor(number.dimension) * float(table[number.name][row])) for number in found.shown]
        rows.append(
            [
                *cells,
                f"{table['seconds'][row]:.1f}" if np.isfinite(table["seconds"][row]) else "",
                str(table["status"][row]),
            ]
        )
    labels = [found.label(key) for key in found.varied]
    head = ("run", *labels, "seed", *(number.label(units) for number in found.shown), "seconds", "status")
    return Listing(head, rows, (False, *(True for _ in head[1:-1]), False))
