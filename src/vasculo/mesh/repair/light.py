"""Whether a mesh that was carried along needs nothing but smoothing: its edges still have the lengths they should."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.geometry.arrays import Flags, Floats, Ints

SHORT, LONG = 0.5, 2.2
"""Edges of a mesh that is let be are between these many of their wanted lengths; in a fresh mesh 0.63 to 2."""

AT_WALL = 0.62
"""Edges that end on a wall may not be shorter than this many: they tell that a passage has become narrow."""

SLACK = 1.25
"""What was too short or too long before the move is let be until it is so by this much more."""

ACROSS_SHORT, ACROSS_LONG = 0.85, 2.4
"""The same for edges from wall to wall: in a fresh mesh they are 1.1 to 2.2, and wall edges must follow the width."""


@njit(cache=True, error_model="numpy")
def has_come_out(square: float, before: float, short: float, long: float) -> bool:
    """Whether a squared length has left the range between two lengths, or was outside `before` and is now far so."""
    if square < short * short:
        return before >= short * short or square * SLACK * SLACK < short * short
    if square > long * long:
        return before <= long * long or square > long * long * SLACK * SLACK
    return False


@njit(cache=True, error_model="numpy")
def is_misfit(
    points: Floats,
    old: Floats,
    triangles: Ints,
    neighbours: Ints,
    on_wall: Flags,
    touched: Flags,
    sizes: Floats,
    least: float,
) -> bool:
    """Whether a triangle with a touched node is too flat, or has an edge of the wrong length.

    Too flat: a mean ratio below `least`, unless two of its edges are walls. Walls may be shorter than `sizes` (n,) say.
    `old` are the places before the move.
    """
    for t in range(len(triangles)):
        if not (touched[triangles[t, 0]] or touched[triangles[t, 1]] or touched[triangles[t, 2]]):
            continue
        squares = 0.0
        walls = 0
        for k in range(3):
            a = triangles[t, k]
            b = triangles[t, k + 1 if k < 2 else 0]
            square = (points[b, 0] - points[a, 0]) ** 2 + (points[b, 1] - points[a, 1]) ** 2
            squares += square
            wanted = 0.5 * (sizes[a] + sizes[b])
            at_wall = neighbours[t, k - 1 if k > 0 else 2] < 0
            walls += at_wall
            short = AT_WALL if on_wall[a] or on_wall[b] else SHORT
            long = LONG
            if at_wall:
                short = 0.0
            elif on_wall[a] and on_wall[b]:
                short = ACROSS_SHORT
                long = ACROSS_LONG
            before = (old[b, 0] - old[a, 0]) ** 2 + (old[b, 1] - old[a, 1]) ** 2
            if has_come_out(square, before, short * wanted, long * wanted):
                return True
        a = triangles[t, 0]
        b = triangles[t, 1]
        c = triangles[t, 2]
        twice = (points[b, 0] - points[a, 0]) * (points[c, 1] - points[a, 1]) - (points[b, 1] - points[a, 1]) * (
            points[c, 0] - points[a, 0]
        )
        if not 3.4641016151377544 * twice >= (least if walls < 2 else 0.0) * squares:
            return True
    return False


def is_misfit_plain(
    points: NDArray[np.float64],
    old: NDArray[np.float64],
    triangles: NDArray[np.int32],
    neighbours: NDArray[np.int32],
    on_wall: NDArray[np.bool_],
    touched: NDArray[np.bool_],
    sizes: NDArray[np.float64],
    least: float,
) -> bool:
    """Plain twin of `is_misfit`."""
    rows = touched[triangles].any(axis=1)
    a, b = triangles[rows], triangles[rows][:, (1, 2, 0)]
    length, before = (np.linalg.norm(places[b] - places[a], axis=2) for places in (points, old))
    wanted = 0.5 * (sizes[a] + sizes[b])
    at_wall = neighbours[rows][:, (2, 0, 1)] < 0
    p, q, r = (points[a[:, k]] for k in range(3))
    twice = (q - p)[:, 0] * (r - p)[:, 1] - (q - p)[:, 1] * (r - p)[:, 0]
    ratio = 2.0 * np.sqrt(3.0) * twice / (length**2).sum(axis=1)
    flat = ratio < np.where(at_wall.sum(axis=1) < 2, least, 0.0)
    across = on_wall[a] & on_wall[b] & ~at_wall
    inner = np.where(on_wall[a] | on_wall[b], AT_WALL, SHORT)
    short = np.where(at_wall, 0.0, np.where(across, ACROSS_SHORT, inner)) * wanted
    long = np.where(across, ACROSS_LONG, LONG) * wanted
    wrong = (length < np.where(before < short, short / SLACK, short)) | (
        length > np.where(before > long, long * SLACK, long)
    )
    return bool(flat.any() or wrong.any())
