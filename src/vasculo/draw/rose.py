"""Mergers: in which directions pillars met, and when."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.ticker import MaxNLocator

from vasculo.draw.canvas import ACCENT, INK, MUTED, PILLAR, PILLAR_EDGE, SMALL, WIDTH, caption, new_figure
from vasculo.draw.curves import plain

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from vasculo.store.read import Run

_PETALS = 24
"""Petals of the rose, 15 degrees each; every merger counts on both sides, for a direction has no sense."""


def merge_angles(run: Run) -> NDArray[np.float64]:
    """Directions between the two pillars of every merger, degrees against x; (m,) float64."""
    return np.array([event.angle for event in run.events if event.kind == "merge"], dtype=np.float64)


def draw_mergers(run: Run, width: float = WIDTH) -> Figure:
    """Draw the rose of the directions, and the mergers of every recorded step."""
    angles = merge_angles(run)
    figure = new_figure(width, max(1.8, 0.36 * width))
    grid = figure.add_gridspec(1, 2, width_ratios=(1.0, 1.9))
    rose = figure.add_subplot(grid[0], projection="polar")
    petal = 2.0 * np.pi / _PETALS
    both = np.radians(np.concatenate((angles, angles + 180.0)))
    petals = np.rint(both / petal).astype(int) % _PETALS
    counts = np.bincount(petals, minlength=_PETALS)
    rose.bar(petal * np.arange(_PETALS), counts, petal, color=PILLAR, edgecolor=PILLAR_EDGE, linewidth=0.7, zorder=2)
    rose.set_xticks(np.radians([0, 45, 90, 135, 180, 225, 270, 315]), ["x", "", "y", "", "", "", "", ""])
    rose.tick_params(labelsize=SMALL, colors=MUTED, pad=0)
    rose.set_yticks([])
    rose.grid(color="#e5e7eb", linewidth=0.6)
    rose.spines["polar"].set_color("#e5e7eb")
    caption(rose, "directions")
    over = figure.add_subplot(grid[1])
    steps = np.array([event.step for event in run.events if event.kind == "merge"])
    last = run.steps()[-1]
    over.bar(np.arange(last + 1), np.bincount(steps, minlength=last + 1), 0.85, color=ACCENT)
    over.set_xlim(-0.6, last + 0.6)
    plain(over, "mergers a step", "")
    over.set_xlabel("step", fontsize=SMALL, color=MUTED)
    for axis in (over.xaxis, over.yaxis):
        axis.set_major_locator(MaxNLocator(integer=True))
    over.tick_params(colors=INK)
    return figure
