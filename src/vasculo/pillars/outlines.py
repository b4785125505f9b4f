"""What is done to outlines between two steps: kept off the border, evenly spaced, simple."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import shapely

from vasculo.errors import InputError
from vasculo.geometry.neighbours import as_polygons
from vasculo.geometry.outline import as_outline, is_simple, perimeter, resample, segment_lengths
from vasculo.pillars.closing import joined
from vasculo.pillars.parameters import MINIMUM_NODES

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

MARGIN = 0.25  # smallest distance of a membrane node from the outer boundary, membrane spacings
UNEVEN = 1.6  # longest over shortest side at which a membrane gets new nodes
MISCOUNT = 0.05  # relative difference to the wanted number of nodes at which it does


def inner_polygon(outer: NDArray[np.float64], margin: float) -> shapely.Polygon:
    """Return the region that is at least `margin` away from the outer boundary, prepared for queries.

    Raises
    ------
    InputError
        If the domain is narrower than twice the margin.
    """
    inner = shapely.Polygon(outer).buffer(-margin, join_style="mitre")
    if not isinstance(inner, shapely.Polygon) or inner.is_empty:
        raise InputError(f"the domain is too narrow to keep pillars {margin:.3g} off its boundary")
    shapely.prepare(inner)
    return inner


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
    inner = inner_polygon(outer, margin)
    out = ~shapely.contains_xy(inner, points[:, 0], points[:, 1])
    if not out.any():
        return points
    border = inner.exterior
    nearest = shapely.line_interpolate_point(border, shapely.line_locate_point(border, shapely.points(points[out])))
    moved = points.copy()
    moved[out] = shapely.get_coordinates(nearest)
    return moved


def uncrossed(
    before: NDArray[np.float64], after: NDArray[np.float64], starts: NDArray[np.int32], times: int = 4
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Cut the moves of pillars that would cross themselves or each other.

    Parameters
    ----------
    before, after : (n, 2) float64, model length
        Membranes before and after a step; those before are simple, disjoint and counter-clockwise.
    starts : (p + 1,) int32
    times : int
        The move of a pillar that is concerned is halved so often, then the pillar stays.

    Returns
    -------
    points : (n, 2) float64, model length
        Simple, disjoint and counter-clockwise.
    shares : (p,) float64
        Part of its move that each pillar makes; 1 where nothing crosses.
    """
    shares = np.ones(len(starts) - 1)
    points = after
    while len(wrong := crossing(points, starts)):
        moving = wrong[shares[wrong] > 0.0]
        if not len(moving):
            break
        shares[moving] *= 0.5
        shares[shares < 0.5**times] = 0.0
        whole = np.repeat(shares, np.diff(starts))[:, None]
        points = np.where(whole == 1.0, after, before + whole * (after - before))
    return points, shares


def crossing(points: NDArray[np.float64], starts: NDArray[np.int32]) -> NDArray[np.int64]:
    """Pillars that cross or touch themselves or another, or are turned over; (m,) int64, sorted."""
    nodes = np.arange(len(points))
    after = nodes + 1
    after[starts[1:] - 1] = starts[:-1]
    origin = np.repeat(points[starts[:-1]], np.diff(starts), axis=0)
    x, y = (points - origin).T
    areas = np.add.reduceat(x * y[after] - x[after] * y, starts[:-1])
    polygons = as_polygons(np.split(points, starts[1:-1]))
    wrong = ~(areas > 0.0) | ~shapely.is_valid(polygons)
    one, two = shapely.STRtree(polygons).query(polygons, predicate="intersects")
    wrong[one[one != two]] = True
    return np.flatnonzero(wrong)


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
            outline = joined([outline], radius, spacing)
        elif needs_nodes(outline, spacing):
            smooth = resample(outline, spacing, minimum=MINIMUM_NODES, smooth=True)
            straight = smooth if is_simple(smooth) else resample(outline, spacing, minimum=MINIMUM_NODES)
            outline = straight if is_simple(straight) else joined([outline], radius, spacing)
        result.append(outline)
    return result


def needs_nodes(outline: NDArray[np.float64], spacing: float) -> bool:
    """Whether the sides of an outline have become uneven or too few."""
    sides = segment_lengths(outline)
    wanted = max(MINIMUM_NODES, round(perimeter(outline) / spacing))
    return bool(sides.max() > UNEVEN * sides.min() or abs(len(outline) - wanted) > MISCOUNT * wanted)
