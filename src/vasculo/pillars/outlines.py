"""What is done to outlines between two steps: kept off the border, evenly spaced, simple."""

from __future__ import annotations

from typing import TYPE_CHECKING

import shapely

from vasculo.errors import InputError
from vasculo.geometry.outline import as_outline, is_simple, perimeter, resample, segment_lengths
from vasculo.pillars.merge import close_up
from vasculo.pillars.parameters import MINIMUM_NODES

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    from numpy.typing import NDArray

MARGIN = 0.25  # smallest distance of a membrane node from the outer boundary, membrane spacings
UNEVEN = 1.6  # longest over shortest side at which a membrane gets new nodes
MISCOUNT = 0.05  # relative difference to the wanted number of nodes at which it does


def keep_inside(points: NDArray[np.float64], outer: NDArray[np.float64], margin: float) -> NDArray[np.float64]:
    """Move nodes that come too close to the outer boundary straight back.

    Parameters
    ----------
    points : (n, 2) float64
        Model length; not changed.
    outer : (k, 2) float64
        Outer boundary, counter-clockwise.
    margin : float
        Distance to keep, model length.

    Returns
    -------
    (n, 2) float64

    Raises
    ------
    InputError
        If the domain is narrower than twice the margin.
    """
    inner = shapely.Polygon(outer).buffer(-margin, join_style="mitre")
    if not isinstance(inner, shapely.Polygon) or inner.is_empty:
        raise InputError(f"the domain is too narrow to keep pillars {margin:.3g} off its boundary")
    shapely.prepare(inner)
    out = ~shapely.contains_xy(inner, points[:, 0], points[:, 1])
    if not out.any():
        return points
    border = inner.exterior
    nearest = shapely.line_interpolate_point(border, shapely.line_locate_point(border, shapely.points(points[out])))
    moved = points.copy()
    moved[out] = shapely.get_coordinates(nearest)
    return moved


def tidy(outlines: Sequence[NDArray[np.float64]], spacing: float, radius: float) -> list[NDArray[np.float64]]:
    """Make outlines simple and their nodes evenly spaced, where they are not.

    Parameters
    ----------
    outlines : sequence of (k, 2) float64
        Model length.
    spacing, radius : float
        Wanted node spacing; closing that takes crossings away, model length.

    Returns
    -------
    list of (k, 2) float64
        Simple; new nodes lie on a periodic cubic spline.
    """
    result = []
    for given in outlines:
        outline = as_outline(given)
        if not is_simple(outline):
            outline = resample(close_up([outline], radius), spacing, minimum=MINIMUM_NODES)
        elif needs_nodes(outline, spacing):
            smooth = resample(outline, spacing, minimum=MINIMUM_NODES, smooth=True)
            outline = smooth if is_simple(smooth) else resample(outline, spacing, minimum=MINIMUM_NODES)
        result.append(outline)
    return result


def needs_nodes(outline: NDArray[np.float64], spacing: float) -> bool:
    """Whether the sides of an outline have become uneven or too few."""
    sides = segment_lengths(outline)
    wanted = max(MINIMUM_NODES, round(perimeter(outline) / spacing))
    return bool(sides.max() > UNEVEN * sides.min() or abs(len(outline) - wanted) > MISCOUNT * wanted)
