"""One closed polygon: area, centroid, second moments, simplicity, resampling."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import shapely
from scipy.interpolate import CubicSpline

from vasculo.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

COINCIDENT = 1e-12
"""Neighbouring nodes closer than this fraction of the outline's extent are one node."""
EVENNESS = 1.25
"""Longest over shortest distance between resampled nodes, where corners allow it."""
CORNER_GAP = 0.6
"""Of two corners closer than this many spacings the sharper stays."""
HALVINGS = 6
"""How often the spacing is halved to make a resampled outline simple."""
TRIALS = np.concatenate(
    ([1.0], np.ravel([1.03 ** -np.arange(1, 8), 1.03 ** np.arange(1, 8)], order="F"), 1.03 ** -np.arange(8, 24))
)
"""Spacings that are tried, over the wanted one: from 1.23 down to 0.51, the nearest first."""
AREA_KEPT = 1e-3
"""Relative change of area that counts as kept."""
EQUALISATIONS = 2
"""Rounds that make the distances between resampled nodes alike."""


def is_number(value: object) -> bool:
    """Whether a value is a real number (truth values are not)."""
    return isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool | np.bool_)


def as_outline(points: ArrayLike) -> NDArray[np.float64]:
    """Clean a closed polygon as `mended_outline` does, without saying what was mended; (k, 2) float64."""
    return mended_outline(points)[0]


def mended_outline(points: ArrayLike) -> tuple[NDArray[np.float64], tuple[str, ...]]:
    """Clean a closed polygon, and say what was mended.

    Parameters
    ----------
    points : (k, 2) array of numbers, model length
        Nodes in order, either way round; a closing copy of the first node is allowed.

    Returns
    -------
    outline : (k', 2) float64, model length
        Counter-clockwise nodes, node 0 first; the closing copy and coincident neighbours are dropped.
    repairs : tuple of str
        "turned counter-clockwise", "3 repeated nodes dropped"; a closing copy is no repair.

    Raises
    ------
    InputError
        Wrong shape, not finite, fewer than three distinct nodes, or zero area.
    """
    try:
        outline = np.array(points, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(f"an outline must be an array of numbers of shape (k, 2): {error}") from None
    if outline.ndim != 2 or outline.shape[1] != 2:
        raise InputError(f"an outline must have shape (k, 2), not {outline.shape}")
    bad = np.flatnonzero(~np.isfinite(outline).all(axis=1))
    if bad.size:
        x, y = outline[bad[0]]
        raise InputError(f"node {bad[0]} of the outline is not finite: ({x}, {y})")
    extent = float(np.ptp(outline, axis=0).max()) if len(outline) else 0.0
    repairs: list[str] = []
    if len(outline) > 1 and np.abs(outline[0] - outline[-1]).max() <= COINCIDENT * extent:
        outline = outline[:-1]
    if len(outline):
        step = np.abs(outline - np.roll(outline, 1, axis=0)).max(axis=1)
        keep = step > COINCIDENT * extent
        keep[0] = True
        if not keep.all():
            repairs.append(f"{np.count_nonzero(~keep)} repeated nodes dropped")
        outline = outline[keep]
        if len(outline) > 1 and np.abs(outline[0] - outline[-1]).max() <= COINCIDENT * extent:
            outline = outline[:-1]
    if len(outline) < 3:
        raise InputError(f"an outline needs at least 3 distinct nodes, not {len(outline)}")
    area = signed_area(outline)
    if abs(area) <= COINCIDENT * extent**2:
        raise InputError(f"the outline encloses no area ({area:.3g} at an extent of {extent:.3g})")
    if area < 0.0:
        outline = np.concatenate((outline[:1], outline[:0:-1]))
        repairs.append("turned counter-clockwise")
    return np.ascontiguousarray(outline), tuple(repairs)


def signed_area(outline: NDArray[np.float64]) -> float:
    """Area of a closed polygon, positive when counter-clockwise; (k, 2) float64 in, model length squared out."""
    x, y = (outline - outline[0]).T
    return 0.5 * float(np.dot(x, np.roll(y, -1)) - np.dot(np.roll(x, -1), y))


def outline_areas(outlines: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Signed area of each of some closed polygons; (p,) float64, model length squared."""
    return np.array([signed_area(outline) for outline in outlines])


def perimeter(outline: NDArray[np.float64]) -> float:
    """Length of a closed polygon; (k, 2) float64 in, model length out."""
    return float(segment_lengths(outline).sum())


def segment_lengths(outline: NDArray[np.float64]) -> NDArray[np.float64]:
    """Length of each segment, node i to node i + 1, the last one back to node 0; (k,) float64, model length."""
    step = np.roll(outline, -1, axis=0) - outline
    return np.hypot(step[:, 0], step[:, 1])


def following(counts: NDArray[np.int64]) -> NDArray[np.int64]:
    """Next node of each node on closed rings of so many nodes that stand one after the other."""
    last = np.cumsum(counts) - 1
    after = np.arange(1, int(last[-1]) + 2)
    after[last] = last - counts + 1
    return after


def centroid(outline: NDArray[np.float64]) -> NDArray[np.float64]:
    """Centroid of the enclosed area; (k, 2) float64 in, (2,) float64 out, model length."""
    origin = outline[0]
    p = outline - origin
    q = np.roll(p, -1, axis=0)
    cross = p[:, 0] * q[:, 1] - q[:, 0] * p[:, 1]
    return np.asarray(origin + ((p + q) * cross[:, None]).sum(axis=0) / (3.0 * cross.sum()))


def second_moments(outline: NDArray[np.float64]) -> NDArray[np.float64]:
    """Mean of x x^T over the enclosed area, about the centroid.

    Parameters
    ----------
    outline : (k, 2) float64, model length
        Closed polygon, either way round.

    Returns
    -------
    (2, 2) float64, model length squared
        Symmetric; a disk of radius R gives R^2/4 times the identity.
    """
    p = outline - centroid(outline)
    q = np.roll(p, -1, axis=0)
    cross = p[:, 0] * q[:, 1] - q[:, 0] * p[:, 1]
    both = p + q
    total = np.einsum("k,ki,kj->ij", cross, p, p) + np.einsum("k,ki,kj->ij", cross, q, q)
    total += np.einsum("k,ki,kj->ij", cross, both, both)
    return np.asarray(total / (12.0 * cross.sum()))


def is_simple(outline: NDArray[np.float64]) -> bool:
    """Whether the closed polygon neither crosses nor touches itself."""
    return bool(shapely.is_valid(shapely.Polygon(outline)))


def resample(
    outline: NDArray[np.float64],
    spacing: float,
    *,
    minimum: int = 16,
    smooth: bool = False,
    corners: float | None = None,
    keep_area: bool = False,
) -> NDArray[np.float64]:
    """Nodes evenly spaced along an outline, on request with its corners and its area kept.

    Parameters
    ----------
    outline : (k, 2) float64, model length
        Closed polygon.
    spacing : float, model length
        Wanted distance between nodes along the outline; rounded so that a whole number fits.
    minimum : int, default 16
        Smallest number of nodes.
    smooth : bool, default False
        False: nodes on the polygon itself (never outside its hull, corners are cut).
        True: nodes on the periodic cubic spline through the polygon's nodes (keeps the area of a round outline).
    corners : float, degrees, optional
        Nodes that turn by more than this stay nodes. The turn is the angle between the two chords that reach half a
        spacing backwards and forwards along the outline, so an arc of radius r turns by spacing / (2 r) radians and
        teeth much shorter than the spacing do not count. Of two corners closer than 0.6 spacings the sharper stays.
    keep_area : bool, default False
        Whether all nodes, corners too, move along their normals by one common distance, so that the area stays that of
        the given outline (with `smooth`, of the spline). Where corners alone shape the outline nothing moves.

    Returns
    -------
    (n, 2) float64, model length
        Neither corners nor area: at equal arc length from node 0 on, n = max(minimum, round(length / spacing)).

        Else from the first corner on (from node 0 where there is none), at equal distances from node to node between
        two corners; n >= minimum. The spacing is the nearest to the wanted one, from 1.23 down to 0.51 of it, with
        which these distances differ by less than 1.25 from piece to piece, or by as little above that as the corners
        allow. The area is exact to rounding. The result is simple where the outline is: if need be the spacing is
        halved, up to six times, and after that the outline itself is returned.

    Raises
    ------
    InputError
        Spacing not positive, fewer than three nodes asked for, a corner angle outside 0 to 180, or corners of a spline.
    """
    if not spacing > 0.0 or minimum < 3:
        raise InputError(f"resampling needs a positive spacing and at least 3 nodes, not {spacing} and {minimum}")
    if corners is not None and (smooth or not 0.0 < corners < 180.0):
        raise InputError(f"corners need an angle between 0 and 180 degrees and no spline, not {corners} and {smooth}")
    closed = np.concatenate((outline, outline[:1]))
    arc = np.concatenate(([0.0], np.cumsum(segment_lengths(outline))))
    if smooth:
        spline = CubicSpline(arc, closed, bc_type="periodic", axis=0)
        fine = np.unique(np.concatenate([np.linspace(arc[:-1], arc[1:], 9).ravel(), arc]))
        closed = spline(fine)
        closed[-1] = closed[0]
        arc = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(closed, axis=0).T))))
    nodes = max(minimum, round(arc[-1] / spacing))
    if corners is not None or keep_area:
        return _resample_kept(closed, arc, arc[-1] / nodes, minimum, 180.0 if corners is None else corners, keep_area)
    wanted = arc[-1] * np.arange(nodes) / nodes
    if smooth:
        return np.ascontiguousarray(spline(np.interp(wanted, arc, fine)))
    return np.column_stack((np.interp(wanted, arc, closed[:, 0]), np.interp(wanted, arc, closed[:, 1])))


def _resample_kept(
    closed: NDArray[np.float64], arc: NDArray[np.float64], spacing: float, minimum: int, corners: float, keep_area: bool
) -> NDArray[np.float64]:
    """Resample a closed curve with its corners and perhaps its area kept; finer where it would cross itself."""
    area = signed_area(closed[:-1])
    for _ in range(HALVINGS + 1):
        stops = arc[_corners(closed, arc, spacing, corners)]
        fresh = _even_nodes(closed, arc, stops, spacing, minimum)
        if keep_area:
            fresh = _with_area(fresh, area)
        if is_simple(fresh) and (not keep_area or abs(signed_area(fresh) - area) <= AREA_KEPT * abs(area)):
            return fresh
        spacing *= 0.5
    return closed[:-1].copy()


def _point_at(closed: NDArray[np.float64], arc: NDArray[np.float64], place: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points (m, 2) at places (m,) along a closed curve, which may lie outside of one turn."""
    inside = np.mod(place, arc[-1])
    return np.column_stack((np.interp(inside, arc, closed[:, 0]), np.interp(inside, arc, closed[:, 1])))


def _corners(closed: NDArray[np.float64], arc: NDArray[np.float64], spacing: float, angle: float) -> NDArray[np.int64]:
    """Nodes that turn by more than an angle (degrees), in order, the sharper of two close ones; node 0 if none does."""
    here, place, length = closed[:-1], arc[:-1], arc[-1]
    one = here - _point_at(closed, arc, place - 0.5 * spacing)
    two = _point_at(closed, arc, place + 0.5 * spacing) - here
    turn = np.abs(np.arctan2(one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0], (one * two).sum(axis=1)))
    sharpest_first = np.argsort(-turn, kind="stable")
    kept: list[int] = []
    for node in sharpest_first[: np.count_nonzero(turn > np.radians(angle))].tolist():
        away = np.abs(place[kept] - place[node])
        if np.all(np.minimum(away, length - away) >= CORNER_GAP * spacing):
            kept.append(node)
    return np.array(sorted(kept) or [0])


def _even_nodes(
    closed: NDArray[np.float64], arc: NDArray[np.float64], stops: NDArray[np.float64], spacing: float, minimum: int
) -> NDArray[np.float64]:
    """Nodes at the stops (places along the curve) and at equal distances between them."""
    ends = np.append(stops, stops[0] + arc[-1])
    pieces = np.diff(ends)
    # Strategy: share out nodes by arc length, move them between the stops until chords, not arcs, are alike, and do
    # both once more with the lengths that the chords then have.
    for _ in range(2):
        count = _shares(pieces, spacing * pieces.sum() / arc[-1], minimum)
        bounds = np.concatenate(([0], np.cumsum(count)))
        number = np.arange(bounds[-1] + 1)
        place = np.interp(number, bounds, ends)
        for _ in range(EQUALISATIONS):
            chords = np.hypot(*np.diff(_point_at(closed, arc, place), axis=0).T)
            passed = np.concatenate(([0.0], np.cumsum(chords)))
            place = np.interp(np.interp(number, bounds, passed[bounds]), passed, place)
        pieces = np.diff(passed[bounds])
    return _point_at(closed, arc, place[:-1])


def _shares(pieces: NDArray[np.float64], spacing: float, minimum: int) -> NDArray[np.int64]:
    """How many segments each piece (p,) of an outline gets: the spacing nearest to the wanted one that is even."""
    trials = spacing * TRIALS
    counts = np.maximum(np.rint(pieces / trials[:, None]), 1.0)
    sides = pieces / counts
    ratio = np.where(counts.sum(axis=1) >= minimum, sides.max(axis=1) / sides.min(axis=1), np.inf)
    fits = np.flatnonzero(ratio <= EVENNESS)
    return np.asarray(counts[fits[0] if fits.size else np.argmin(ratio)], dtype=np.int64)


def _with_area(outline: NDArray[np.float64], area: float) -> NDArray[np.float64]:
    """Move all nodes by one distance along their normals so that the signed area becomes the given one."""
    across = np.roll(outline, -1, axis=0) - np.roll(outline, 1, axis=0)
    size = np.maximum(np.hypot(across[:, 0], across[:, 1]), 1e-300)
    normal = np.column_stack((across[:, 1], -across[:, 0])) / size[:, None]
    # Strategy: the area is a quadratic of the distance; take the root nearest to zero, nothing where there is none.
    linear, square, missing = 0.5 * float(size.sum()), signed_area(normal), signed_area(outline) - area
    root = linear * linear - 4.0 * square * missing
    if root <= 0.0:
        return outline
    return np.asarray(outline - 2.0 * missing / (linear + np.sqrt(root)) * normal)
