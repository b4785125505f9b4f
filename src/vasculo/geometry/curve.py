"""Nodes in the order of Hilbert's curve: what is near in the plane is near in memory."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from vasculo.geometry.predicates import SMALLEST

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.geometry.arrays import Floats, Ints

LEVELS = 24
"""The curve visits 2^24 by 2^24 squares."""

AT_ONCE = 4
"""Levels that one look at the table goes down."""

DIGIT = 12
"""Bits that one pass of the sort looks at; the 48 bits of a place on the curve are four of them."""


def _one_level(square: int, turn: int, x: int, y: int) -> tuple[int, int]:
    """Go down to the quarter (x, y) of a square: its place on the curve, after that of the square, and the turn there.

    The curve in a square is the basic one (from the lower left to the lower right corner), perhaps mirrored at the
    diagonal (turn & 1) and then at the other diagonal (turn & 2).
    """
    if turn & 1:
        x, y = y, x
    if turn & 2:
        x, y = 1 - y, 1 - x
    place = 3 * x ^ y
    return 4 * square + place, turn ^ (1, 0, 0, 2)[place]


def _table() -> NDArray[np.uint16]:
    """For each turn and each of 16 by 16 squares: the place on the curve in it, times 4, plus the turn there."""
    table = np.empty((4, 16, 16), dtype=np.uint16)
    for turn, column, row in np.ndindex(4, 16, 16):
        place, now = 0, turn
        for level in range(AT_ONCE - 1, -1, -1):
            place, now = _one_level(place, now, column >> level & 1, row >> level & 1)
        table[turn, column, row] = 4 * place + now
    return table


TABLE = _table()


def curve_order(points: Floats) -> Ints:
    """Sort points along Hilbert's curve through the square around them.

    Parameters
    ----------
    points : (n, 2) float64, model length
        Finite. Points in the same of 2^24 by 2^24 squares keep their order.

    Returns
    -------
    (n,) int32
        Numbers of the points in the order of the curve.

    Notes
    -----
    Hilbert 1891. The places are sorted by their digits, in linear time.
    """
    return sort_keys(curve_places(points))


@njit(cache=True, error_model="numpy")
def curve_places(points: Floats) -> NDArray[np.int64]:
    """Place (n,) of each point's square on the curve."""
    low_x, low_y, high_x, high_y = np.inf, np.inf, -np.inf, -np.inf
    for i in range(len(points)):
        x, y = points[i, 0], points[i, 1]
        low_x, low_y, high_x, high_y = min(low_x, x), min(low_y, y), max(high_x, x), max(high_y, y)
    scale = (2.0**LEVELS - 1.0) / max(high_x - low_x, high_y - low_y, SMALLEST)
    places = np.empty(len(points), dtype=np.int64)
    for i in range(len(points)):
        column, row = int((points[i, 0] - low_x) * scale), int((points[i, 1] - low_y) * scale)
        place, turn = np.int64(0), np.int64(0)
        for level in range(LEVELS - AT_ONCE, -1, -AT_ONCE):
            found = np.int64(TABLE[turn, column >> level & 15, row >> level & 15])
            place = place << 2 * AT_ONCE | found >> 2
            turn = found & 3
        places[i] = place
    return places


def curve_places_plain(points: Floats) -> NDArray[np.int64]:
    """Twin of `curve_places`, level by level."""
    scale = (2.0**LEVELS - 1.0) / max(float(np.ptp(points, axis=0).max()), SMALLEST)
    places = []
    for column, row in ((points - points.min(axis=0)) * scale).astype(np.int64).tolist():
        place, turn = 0, 0
        for level in range(LEVELS - 1, -1, -1):
            place, turn = _one_level(place, turn, column >> level & 1, row >> level & 1)
        places.append(place)
    return np.array(places, dtype=np.int64)


@njit(cache=True, error_model="numpy")
def sort_keys(keys: NDArray[np.int64]) -> Ints:
    """Order (n,) that sorts keys of 48 bits, equal ones as they come (`numpy.argsort` with kind "stable")."""
    n = len(keys)
    order, other = np.arange(n).astype(np.int32), np.empty(n, dtype=np.int32)
    first = np.empty(2**DIGIT + 1, dtype=np.int64)
    for shift in range(0, 2 * LEVELS, DIGIT):
        first[:] = 0
        for i in range(n):
            first[(keys[i] >> shift & 2**DIGIT - 1) + 1] += 1
        for digit in range(2**DIGIT):
            first[digit + 1] += first[digit]
        for i in range(n):
            digit = keys[order[i]] >> shift & 2**DIGIT - 1
            other[first[digit]] = order[i]
            first[digit] += 1
        order, other = other, order
    return order
