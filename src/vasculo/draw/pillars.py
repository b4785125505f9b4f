"""Pillars as filled outlines, and the wall shear along them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from vasculo.draw.canvas import INK, PILLAR, PILLAR_EDGE, SHEAR, panel

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from vasculo.draw.canvas import Box
    from vasculo.store.read import FlowFields


THIN, WIDE = 0.6, 1.5
"""Factors on the width of the lines where the shear is nothing and where it is at the top of its scale."""


def pen(count: int) -> float:
    """Factor on the width of outlines: thinner where there are more pillars than print well."""
    return max(0.25, min(1.0, (100.0 / max(count, 1)) ** 0.5))


def add(axes: Any, collection: Any) -> Any:
    """Add many shapes inside the frame of the axes: the layout need not look for the box of each; return them."""
    collection.set_in_layout(False)
    return axes.add_collection(collection, autolim=False)


def draw_pillars(axes: Any, outlines: Sequence[NDArray[np.float64]], *, face: str = PILLAR) -> None:
    """Fill the outlines, (k, 2) each, in the tone of tissue."""
    from matplotlib.collections import PolyCollection  # noqa: PLC0415  # heavy, and only here

    width = 0.6 * pen(len(outlines))
    add(axes, PolyCollection(outlines, facecolors=face, edgecolors=PILLAR_EDGE, linewidths=width, zorder=3))


def draw_pillars_over(
    axes: Any,
    outlines: Sequence[NDArray[np.float64]],
    earlier: Sequence[NDArray[np.float64]],
    box: Box,
    title: str = "",
) -> None:
    """Draw pillars with the outlines of an earlier step as thin lines over them."""
    from matplotlib.collections import PolyCollection  # noqa: PLC0415

    draw_pillars(axes, outlines)
    width = 0.5 * pen(len(earlier))
    add(axes, PolyCollection(earlier, facecolors="none", edgecolors=INK, linewidths=width, zorder=4))
    panel(axes, box, title)


def shear_scale(flow: FlowFields) -> float:
    """Largest shear of the colour scale: twice the mean magnitude on the pillars (length-weighted)."""
    edges = flow.mesh.points[flow.wall_edges]
    lengths = np.hypot(*(edges[:, 1] - edges[:, 0]).T) * (flow.wall_pillar >= 0)
    total = float(lengths.sum())
    return 2.0 * float(np.abs(flow.wall_shear) @ lengths) / total if total > 0.0 else 0.0


def draw_shear(
    axes: Any,
    flow: FlowFields,
    outlines: Sequence[NDArray[np.float64]],
    box: Box,
    title: str = "",
    scale: float | None = None,
) -> Any:
    """Draw the magnitude of the wall shear along the pillars, wider and darker; return the lines, for a colour bar."""
    from matplotlib.collections import LineCollection, PolyCollection  # noqa: PLC0415

    add(axes, PolyCollection(outlines, facecolors="#f6f2ee", edgecolors="none", zorder=1))
    on_pillars = flow.wall_pillar >= 0
    top = (shear_scale(flow) if scale is None else scale) or 1.0
    shear = np.minimum(np.abs(flow.wall_shear[on_pillars]), top)
    lines = LineCollection(
        list(flow.mesh.points[flow.wall_edges[on_pillars]]),
        cmap=SHEAR,
        linewidths=1.8 * max(0.4, pen(len(outlines))) * (THIN + (WIDE - THIN) * shear / top),
        capstyle="round",
        zorder=2,
        rasterized=True,
    )
    lines.set_array(np.abs(flow.wall_shear[on_pillars]))
    lines.set_clim(0.0, top)
    add(axes, lines)
    panel(axes, box, title)
    return lines
