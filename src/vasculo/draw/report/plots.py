"""Plots of the numbers of runs over their steps: each an image of its own, so that a phone shows a column."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.ticker import MaxNLocator

from vasculo.draw.canvas import ACCENT, INK, MUTED, PILLAR_EDGE, new_figure, render
from vasculo.draw.curves import plain
from vasculo.draw.page import encoded, html
from vasculo.draw.report.words import name_of, number
from vasculo.store.table import COUNTS, UNIT_OF

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from vasculo.store.read import Run
    from vasculo.store.units import Units

GROWTH = ("springs", "void_fraction", "pillars")
REMODELLING = (
    "pillars",
    "alignment",
    "order",
    "aspect_ratio",
    "local_angle",
    "permeability",
    "mean_wall_shear",
    "shear_ratio",
    "shear_variation",
    "mean_gap",
    "corridors",
    "corridor_width",
    "chain_fraction",
    "straightness",
)
STYLES = (("solid", ACCENT, "-"), ("dashed", PILLAR_EDGE, "--"), ("dotted", INK, ":"), ("solid", "#b8860b", "-"))
"""Line of each run: its name in a page, its colour, and its name in a plot."""
_SIZE = (3.2, 1.7)  # inches
_INSIDE = (
    0.17,
    0.24,
    0.81,
    0.71,
)  # left, bottom, width, height; shares. A layout engine would take four times as long.


@dataclass(frozen=True)
class Curve:
    """A number over steps or time: (n,) float64 each."""

    across: NDArray[np.float64]
    values: NDArray[np.float64]


def plots(runs: Sequence[Run], stage: str, across: str, units: Units) -> str:
    """Plot every number of a stage that one of the runs has, all runs in each plot.

    Parameters
    ----------
    runs : sequence of Run
        At most four.
    stage : {"vasculogenesis", "angiogenesis"}
        Whose steps.
    across : {"step", "time"}
        What goes to the right.
    units : Units
        In which the numbers are told.
    """
    names = GROWTH if stage == "vasculogenesis" else REMODELLING
    found = [_plot(runs, stage, name, across, units) for name in names]
    return '<div class="plots">\n' + "\n".join(filter(None, found)) + "\n</div>"


def legend(names: Sequence[str]) -> str:
    """Say which line is whose run."""
    keys = (
        f'<span style="--tone: {colour}; --stroke: {stroke}">{html(name)}</span>'
        for name, (stroke, colour, _) in zip(names, STYLES, strict=False)
    )
    return f'<p class="legend">{"".join(keys)}</p>'


def curve(run: Run, stage: str, column: str, across: str) -> Curve | None:
    """Take a column of a stage where it has values; None when there are none."""
    if column not in run.metrics:
        return None
    rows = (run.metrics["stage"] == stage) & np.isfinite(run.metrics[column])
    return Curve(run.metrics[across][rows], run.metrics[column][rows]) if rows.any() else None


def _plot(runs: Sequence[Run], stage: str, column: str, across: str, units: Units) -> str:
    curves = [curve(run, stage, column, across) for run in runs]
    if all(found is None or (len(runs) == 1 and np.ptp(found.values) == 0.0) for found in curves):
        return ""
    dimension = UNIT_OF.get(column, "")
    figure = new_figure(*_SIZE, layout=None)
    axes = figure.add_axes(_INSIDE)
    for found, (_, colour, style) in zip(curves, STYLES, strict=False):
        if found is not None:
            marker = "o" if len(found.values) < 3 else None
            values = found.values * units.factor(dimension)
            axes.plot(found.across, values, style, color=colour, linewidth=1.6, marker=marker)
    plain(axes, "", "")
    axes.set_xlabel(across if stage == "vasculogenesis" or across == "step" else "strain", fontsize=8, color=MUTED)
    axes.tick_params(labelsize=8)
    axes.yaxis.set_major_locator(MaxNLocator(5, integer=column in COUNTS))
    unit, title = units.name(dimension), name_of(column, stage)
    head = title + (f", {unit}" if unit else "")
    ends = "; ".join(_ends(found, dimension, units) for found in curves if found is not None)
    source = f"data:image/svg+xml;base64,{encoded(render(figure, 'svg'))}"
    return (
        f'<figure><figcaption>{html(head)}</figcaption><div class="wide">'
        f'<img alt="{html(f"{title} over the {across}: {ends}")}" src="{source}"></div></figure>'
    )


def _ends(found: Curve, dimension: str, units: Units) -> str:
    first, last = (number(value * units.factor(dimension)) for value in found.values[[0, -1]])
    return f"from {first} to {last} {units.name(dimension)}".rstrip()
