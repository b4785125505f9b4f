"""Phase diagrams: a number over two settings, as cells with their values, as a field through points, or as a curve."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from vasculo.draw.canvas import ACCENT, INK, MUTED, SMALL, TEXT, WIDTH, caption, new_figure
from vasculo.draw.curves import plain
from vasculo.draw.page import as_text

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

COLOURS = "cividis"
"""Colour map: its lightness rises steadily, so it survives grey print, and it looks the same to the colour-blind."""
MOST_TEXTS = 12
"""Columns up to which the cells carry their numbers."""
_EMPTY = "#eceae6"
_FINE = 400  # samples of a field along an axis
_NARROWEST = 0.01  # of the largest value: less is not worth a colour


@dataclass(frozen=True)
class Axis:
    """One axis of a diagram.

    Attributes
    ----------
    label : str
        Name and unit of the setting.
    values : ndarray, shape (points,)
        Its value at each point: numbers or texts.
    log : bool
        Whether it is shown on a logarithmic scale.
    """

    label: str
    values: NDArray[Any]
    log: bool = False

    @property
    def numeric(self) -> bool:
        """Whether the values are numbers."""
        return self.values.dtype.kind in "if"


@dataclass(frozen=True)
class Field:
    """The number that is shown.

    Attributes
    ----------
    label : str
        Name and unit.
    mean, spread : (points,) float64
        Mean and standard deviation over the runs of each point; NaN where there is none.
    """

    label: str
    mean: Floats
    spread: Floats

    @property
    def ends(self) -> tuple[float, float]:
        """Ends of the colour scale: smallest and largest mean, some way apart even when all are nearly the same."""
        known = self.mean[np.isfinite(self.mean)]
        low, high = (float(known.min()), float(known.max())) if len(known) else (0.0, 1.0)
        least = 0.5 * _NARROWEST * max(abs(low), abs(high)) or 0.5
        middle, half = 0.5 * (low + high), max(0.5 * (high - low), least)
        return middle - half, middle + half


def draw_cells(x: Axis, y: Axis, fields: Sequence[Field], third: Axis | None = None) -> Figure:
    """Draw a cell for each pair of values, with mean and spread in it.

    Parameters
    ----------
    x, y : Axis
        Settings to the right and upwards.
    fields : sequence of Field
        The numbers, a panel each.
    third : Axis, optional
        A third setting, which has a panel for each of its values; goes with one number.
    """
    columns, rows = levels(x.values), levels(y.values)
    groups: list[Any] = [None] if third is None else levels(third.values)
    panels = [(field, group) for field in fields for group in groups]
    across = min(len(panels), 2 if len(columns) <= 5 else 1)
    wide = min(across * (0.85 * len(columns) + 1.4), WIDTH)
    high = min(0.55, max(0.24, 0.6 * (wide / across - 1.4) / len(columns)))
    figure, grid = _sheet(len(panels), across, wide, high * len(rows) + 0.75)
    for axes, (field, group) in zip(grid, panels, strict=True):
        inside = np.ones(len(field.mean), dtype=bool) if third is None else third.values == group
        mean, spread = (_table(x, y, values, inside) for values in (field.mean, field.spread))
        axes.set_facecolor(_EMPTY)
        shown = axes.imshow(mean, cmap=COLOURS, vmin=field.ends[0], vmax=field.ends[1], origin="lower", aspect="auto")
        if len(columns) <= MOST_TEXTS:
            _write(axes, mean, spread, field.ends)
        _cell_frame(axes, columns, rows)
        caption(axes, field.label if third is None else f"{third.label.partition(',')[0]} {as_text(group)}")
        _names(axes, x.label, y.label)
        _bar(axes, shown, field.label if third is not None else "")
    return figure


def draw_points(x: Axis, y: Axis, fields: Sequence[Field]) -> Figure:
    """Draw a field through scattered points by linear interpolation, and the points over it; a panel a number."""
    across = min(len(fields), 2)
    figure, grid = _sheet(len(fields), across, across * WIDTH / 2.0, 2.6)
    for axes, field in zip(grid, fields, strict=True):
        known = np.isfinite(field.mean)
        at, (low, high) = (x.values[known], y.values[known]), field.ends
        if surface := _surface(x, y, at, field.mean[known]):
            steps = np.linspace(low, high, 11)
            axes.contourf(*surface, levels=steps, cmap=COLOURS, vmin=low, vmax=high, alpha=0.55)
        style = {"cmap": COLOURS, "vmin": low, "vmax": high, "s": 26, "edgecolors": "white", "linewidths": 0.8}
        shown = axes.scatter(*at, c=field.mean[known], zorder=3, **style)
        axes.scatter(x.values[~known], y.values[~known], marker="x", color=MUTED, s=20, zorder=3)
        plain(axes, field.label, "")
        _names(axes, x.label, y.label)
        axes.use_sticky_edges = False  # room for the dots at the border
        _scale(axes, "x", x)
        _scale(axes, "y", y)
        _bar(axes, shown, "")
    return figure


def draw_curves_over(x: Axis, fields: Sequence[Field], runs: Axis, values: Sequence[Floats]) -> Figure:
    """Draw numbers over one setting: the mean with its standard deviation, and every run as a dot; a panel a number.

    Parameters
    ----------
    x : Axis
        The setting at each point.
    fields : sequence of Field
        The numbers.
    runs : Axis
        The setting of each run.
    values : sequence of ndarray, shape (runs,)
        Each of the numbers of each run; NaN where there is none.
    """
    across = min(len(fields), 2)
    figure, grid = _sheet(len(fields), across, across * WIDTH / 2.0, 2.3)
    names = levels(x.values)
    for axes, field, dots in zip(grid, fields, values, strict=True):
        at = [axis.values if axis.numeric else np.array([names.index(v) for v in axis.values]) for axis in (x, runs)]
        order = np.argsort(at[0], kind="stable")
        axes.scatter(at[1], dots, s=9, color=MUTED, alpha=0.6, linewidths=0, zorder=2)
        bars = np.where(np.isfinite(field.spread), field.spread, 0.0)[order]
        style = {"fmt": "o-" if x.numeric else "o", "color": ACCENT, "markersize": 4.0, "capsize": 2.5}
        axes.errorbar(at[0][order], field.mean[order], bars, linewidth=1.3, zorder=3, **style)
        plain(axes, field.label, "")
        axes.set_xlabel(x.label, fontsize=TEXT, color=INK)
        if x.numeric:
            _scale(axes, "x", x)
        if not x.numeric or len(names) <= 8:
            axes.set_xticks(names if x.numeric else range(len(names)), [as_text(name) for name in names])
            axes.minorticks_off()
    return figure


def levels(values: NDArray[Any]) -> list[Any]:
    """Distinct values: numbers by size, texts in the order in which they come."""
    if values.dtype.kind in "if":
        return [each.item() for each in np.unique(values)]
    return list(dict.fromkeys(values.tolist()))


def is_grid(x: Axis, y: Axis, most: int = 400) -> bool:
    """Whether the points lie on a grid that most of its cells have a point in."""
    cells = len(levels(x.values)) * len(levels(y.values))
    points = len(set(zip(x.values.tolist(), y.values.tolist(), strict=True)))
    return cells <= most and 2 * points > cells


def _table(x: Axis, y: Axis, values: Floats, inside: NDArray[np.bool_]) -> Floats:
    """Values of the points in their cells, (rows, columns); NaN where there is none."""
    columns, rows = levels(x.values), levels(y.values)
    found = np.full((len(rows), len(columns)), np.nan)
    for point in np.flatnonzero(inside):
        found[rows.index(y.values[point].item()), columns.index(x.values[point].item())] = values[point]
    return found


def _write(axes: Any, mean: Floats, spread: Floats, ends: tuple[float, float]) -> None:
    """Write the mean, and the spread where there is one, into each cell."""
    for (row, column), value in np.ndenumerate(mean):
        if not np.isfinite(value):
            axes.text(column, row, "none", ha="center", va="center", fontsize=SMALL, color=MUTED)
            continue
        dark = (value - ends[0]) / (ends[1] - ends[0]) < 0.55
        text = f"{value:.3g}"
        if np.isfinite(spread[row, column]):
            text += f"\n± {spread[row, column]:.2g}"
        colour = "white" if dark else INK
        axes.text(column, row, text, ha="center", va="center", fontsize=SMALL, color=colour, linespacing=1.25)


def _surface(x: Axis, y: Axis, at: tuple[NDArray[Any], NDArray[Any]], values: Floats) -> tuple[Any, ...] | None:
    """Interpolate between points, on the scales of the axes; None for fewer than four points, or a line of them."""
    from matplotlib.tri import LinearTriInterpolator, Triangulation  # noqa: PLC0415  # heavy, and only here

    flat = [np.log(each) if axis.log else each.astype(np.float64) for axis, each in zip((x, y), at, strict=True)]
    if len(values) < 4 or any(np.ptp(each) == 0.0 for each in flat):
        return None
    apart = [(each - each.min()) / np.ptp(each) for each in flat]
    if np.linalg.svd(np.stack(apart) - np.mean(apart, axis=1, keepdims=True), compute_uv=False)[-1] < 1e-6:
        return None
    side = np.linspace(0.0, 1.0, _FINE)
    surface = LinearTriInterpolator(Triangulation(*apart), values)(*np.meshgrid(side, side))
    ends = [each.min() + side * np.ptp(each) for each in flat]
    return *(np.exp(each) if axis.log else each for axis, each in zip((x, y), ends, strict=True)), surface


def _sheet(panels: int, across: int, wide: float, high: float) -> tuple[Figure, list[Any]]:
    """Make a figure of so many panels, each so high, inches; return it with their axes."""
    down = -(-panels // across)
    figure = new_figure(wide, down * high + 0.1)
    grid = list(figure.subplots(down, across, squeeze=False).ravel())
    for axes in grid[panels:]:
        axes.set_visible(False)
    return figure, grid[:panels]


def _cell_frame(axes: Any, columns: Sequence[Any], rows: Sequence[Any]) -> None:
    """Name the columns and rows of cells, at most about twenty of each, and draw white lines between them."""
    for names, put in ((columns, axes.set_xticks), (rows, axes.set_yticks)):
        every = -(-len(names) // 20)
        put(range(0, len(names), every), [as_text(name) for name in names[::every]])
        put(np.arange(len(names) - 1) + 0.5, minor=True)
    axes.grid(which="minor", color="white", linewidth=1.2)
    axes.tick_params(which="both", labelsize=SMALL, length=0, colors=INK)
    for spine in axes.spines.values():
        spine.set_visible(False)


def _names(axes: Any, x: str, y: str) -> None:
    axes.set_xlabel(x, fontsize=TEXT, color=INK)
    axes.set_ylabel(y, fontsize=TEXT, color=INK)


def _scale(axes: Any, along: Literal["x", "y"], setting: Axis) -> None:
    """Give an axis the scale of its setting, with plain numbers."""
    from matplotlib.ticker import LogLocator, NullLocator  # noqa: PLC0415  # heavy, and only here

    if setting.log:
        axes.set(**{f"{along}scale": "log"})
        axis = getattr(axes, f"{along}axis")
        wide = setting.values.max() > 100.0 * setting.values.min()
        axis.set_major_locator(LogLocator(subs=(1.0,) if wide else (1.0, 2.0, 5.0)))
        axis.set_major_formatter(lambda value, _: as_text(float(value)))
        axis.set_minor_locator(NullLocator())


def _bar(axes: Any, shown: Any, label: str) -> None:
    """Put a colour bar beside the axes."""
    bar = axes.figure.colorbar(shown, ax=axes, pad=0.02, aspect=24)
    bar.set_label(label, fontsize=TEXT, color=INK)
    bar.ax.tick_params(labelsize=SMALL, length=2.5)
    bar.formatter.set_useOffset(False)
    bar.outline.set_visible(False)
