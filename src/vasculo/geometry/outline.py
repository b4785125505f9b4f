"""One closed polygon: area, centroid, second moments, simplicity, resampling."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import shapely
from scipy.interpolate import CubicSpline

from vasculo.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

COINCIDENT = 1e-12
"""Neighbouring nodes closer than this fraction of the outline's extent are one node."""


def is_number(value: object) -> bool:
    """Whether a value is a real number (truth values are not)."""
    return isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool | np.bool_)


def as_outline(points: ArrayLike) -> NDArray[np.float64]:
    """Clean a closed polygon: float64, counter-clockwise, no repeated nodes; node 0 stays first.

    Parameters
    ----------
    points : (k, 2) array of numbers, model length
        Nodes in order, either way round; a closing copy of the first node is allowed.

    Returns
    -------
    (k', 2) float64, model length
        Counter-clockwise nodes; the closing copy and coincident neighbours are dropped.

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
    if len(outline):
        step = np.abs(outline - np.roll(outline, 1, axis=0)).max(axis=1)
        keep = step > COINCIDENT * extent
        keep[0] = True
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
    return np.ascontiguousarray(outline)


def signed_area(outline: NDArray[np.float64]) -> float:
    """Area of a closed polygon, positive when counter-clockwise; (k, 2) float64 in, model length squared out."""
    x, y = (outline - outline[0]).T
    return 0.5 * float(np.dot(x, np.roll(y, -1)) - np.dot(np.roll(x, -1), y))


def perimeter(outline: NDArray[np.float64]) -> float:
    """Length of a closed polygon; (k, 2) float64 in, model length out."""
    return float(segment_lengths(outline).sum())


def segment_lengths(outline: NDArray[np.float64]) -> NDArray[np.float64]:
    """Length of each segment, node i to node i + 1, the last one back to node 0; (k,) float64, model length."""
    step = np.roll(outline, -1, axis=0) - outline
    return np.hypot(step[:, 0], step[:, 1])


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
    outline: NDArray[np.float64], spacing: float, *, minimum: int = 16, smooth: bool = False
) -> NDArray[np.float64]:
    """Nodes at equal arc length, starting at node 0.

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

    Returns
    -------
    (n, 2) float64, model length
        n = max(minimum, round(length / spacing)).

    Raises
    ------
    InputError
        Spacing not positive, or fewer than three nodes asked for.
    """
    if not spacing > 0.0 or minimum < 3:
        raise InputError(f"resampling needs a positive spacing and at least 3 nodes, not {spacing} and {minimum}")
    closed = np.concatenate((outline, outline[:1]))
    arc = np.concatenate(([0.0], np.cumsum(segment_lengths(outline))))
    if smooth:
        spline = CubicSpline(arc, closed, bc_type="periodic", axis=0)
        fine = np.unique(np.concatenate([np.linspace(arc[:-1], arc[1:], 9).ravel(), arc]))
        closed = spline(fine)
        closed[-1] = closed[0]
        arc = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(closed, axis=0).T))))
    nodes = max(minimum, round(arc[-1] / spacing))
    wanted = arc[-1] * np.arange(nodes) / nodes
    if smooth:
        return np.ascontiguousarray(spline(np.interp(wanted, arc, fine)))
    return np.column_stack((np.interp(wanted, arc, closed[:, 0]), np.interp(wanted, arc, closed[:, 1])))
