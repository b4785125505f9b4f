"""Springs with width and grey by force, as in the paper's Figs 1 and 2."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from vasculo.draw.canvas import panel

if TYPE_CHECKING:
    from vasculo.draw.canvas import Box
    from vasculo.store.read import Springs

CLIP = 98.0  # percentile of the tensions that is drawn full black and full width
WIDTHS = (0.15, 1.2)  # points, whole mesh
GREYS = (0.82, 0.04)


def force_scale(springs: Springs) -> float:
    """Tension that is drawn full black: the 98th percentile."""
    pulls = np.maximum(springs.forces, 0.0)
    return float(np.percentile(pulls, CLIP)) if pulls.size else 0.0


def whole_tissue() -> Box:
    """Region of the whole tissue, the unit square, with a hair of margin for the springs of the frame."""
    return -0.005, -0.005, 1.005, 1.005


def zoom(springs: int) -> float:
    """Factor on the line widths for a coarse mesh; 35,000 springs are drawn as thin as they print."""
    return min(2.5, max(1.0, (35_000 / max(springs, 1)) ** 0.4))


def draw_springs(axes: Any, springs: Springs, box: Box, title: str = "", widen: float = 1.0) -> None:
    """Draw the springs inside `box`.

    Parameters
    ----------
    axes : matplotlib Axes
        Where.
    springs : Springs
        The tissue at one step.
    box : tuple of float
        Region xmin, ymin, xmax, ymax; model length.
    title : str
        Caption.
    widen : float
        Factor on the line widths, for fragments.
    """
    from matplotlib.collections import LineCollection  # noqa: PLC0415  # heavy, and only here

    ends = springs.points[springs.springs]
    low, high = ends.min(axis=1), ends.max(axis=1)
    seen = (low[:, 0] < box[2]) & (high[:, 0] > box[0]) & (low[:, 1] < box[3]) & (high[:, 1] > box[1])
    scale = force_scale(springs)
    pull = np.clip(springs.forces[seen] / scale, 0.0, 1.0) if scale > 0.0 else np.zeros(np.count_nonzero(seen))
    order = np.argsort(pull, kind="stable")
    pull = pull[order]
    grey = GREYS[0] + (GREYS[1] - GREYS[0]) * pull**0.7
    lines = LineCollection(
        ends[seen][order],
        linewidths=widen * (WIDTHS[0] + (WIDTHS[1] - WIDTHS[0]) * pull),
        colors=np.repeat(grey[:, None], 3, axis=1),
        capstyle="round",
        rasterized=True,
    )
    axes.add_collection(lines)
    panel(axes, box, title)
