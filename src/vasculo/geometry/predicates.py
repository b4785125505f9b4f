"""Orientation and in-circle tests whose sign is always exact (Shewchuk 1997).

A filter comes first: the determinant in floating-point arithmetic, with a bound of its rounding error. Where that does
not decide, the in-circle test tries twofold precision, and at last the determinant is summed exactly, as an expansion:
a list of numbers that do not overlap, smallest first.
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np
from numba import njit

if TYPE_CHECKING:
    from vasculo.geometry.arrays import Floats

SMALLEST, LARGEST = 1e-60, 1e70
"""Coordinates that are zero or between these in size have exact signs: nothing overflows or loses bits to underflow."""

EPSILON = 2.0**-53
"""Largest relative error of one rounding."""

ORIENT_BOUND = (3.0 + 16.0 * EPSILON) * EPSILON
INCIRCLE_BOUND = 11.0 * EPSILON
"""Rounding errors of the filters over the size of what is summed: Shewchuk's bounds A. The second size is a quick one:
u^2 v^2 + v^2 w^2 + w^2 u^2, at least that of all terms. It is rounded itself, or 10 EPSILON would do."""

TWOFOLD_BOUND = 2.0**-97
"""The same for the in-circle test in twofold precision: a product there is off by at most 7 EPSILON^2, a sum by 3
(Joldes, Muller & Popescu 2017), which adds up to 33 EPSILON^2; this is 512."""

SPLITTER = 2.0**27 + 1.0
"""Parts 53 bits into two halves (Veltkamp)."""


@njit(cache=True, error_model="numpy")
def orient2d(ax: float, ay: float, bx: float, by: float, cx: float, cy: float) -> float:
    """On which side of the way from a to b the point c lies.

    Parameters
    ----------
    ax, ay, bx, by, cx, cy : float, model length
        Zero, or between `SMALLEST` and `LARGEST` in size.

    Returns
    -------
    float, model length squared
        Positive to the left, negative to the right, zero exactly on the line: twice the area of the triangle a, b, c,
        with an exact sign.

    Notes
    -----
    Shewchuk 1997, Adaptive precision floating-point arithmetic and fast robust geometric predicates.
    """
    left = (ax - cx) * (by - cy)
    right = (ay - cy) * (bx - cx)
    twice = left - right
    if abs(twice) > ORIENT_BOUND * (abs(left) + abs(right)):
        return twice
    return _orient2d_exact(ax, ay, bx, by, cx, cy)


@njit(cache=True, error_model="numpy")
def incircle(ax: float, ay: float, bx: float, by: float, cx: float, cy: float, dx: float, dy: float) -> float:
    """Whether d lies within the circle through a, b, c, which are counter-clockwise.

    Parameters
    ----------
    ax, ay, bx, by, cx, cy, dx, dy : float, model length
        Zero, or between `SMALLEST` and `LARGEST` in size.

    Returns
    -------
    float, model length to the fourth
        Positive within, negative outside, zero exactly on the circle; an exact sign. The other way round where a, b, c
        are clockwise.

    Notes
    -----
    Shewchuk 1997, as in `orient2d`.
    """
    ux, uy = ax - dx, ay - dy
    vx, vy = bx - dx, by - dy
    wx, wy = cx - dx, cy - dy
    vxwy, wxvy = vx * wy, wx * vy
    wxuy, uxwy = wx * uy, ux * wy
    uxvy, vxuy = ux * vy, vx * uy
    uu = ux * ux + uy * uy
    vv = vx * vx + vy * vy
    ww = wx * wx + wy * wy
    value = uu * (vxwy - wxvy) + vv * (wxuy - uxwy) + ww * (uxvy - vxuy)
    size = uu * vv + vv * ww + ww * uu
    if abs(value) > INCIRCLE_BOUND * size:
        return value
    if (bx == ax and by == dy and cx == dx and cy == ay) or (bx == dx and by == ay and cx == ax and cy == dy):
        return 0.0  # a rectangle with the diagonal b c, as in lattices
    value = _incircle_twofold(ax, ay, bx, by, cx, cy, dx, dy)
    if abs(value) > TWOFOLD_BOUND * size:
        return value
    return _incircle_exact(ax, ay, bx, by, cx, cy, dx, dy)


@njit(cache=True, error_model="numpy")
def first_out_of_range(points: Floats) -> int:
    """First of points (n, 2) with a coordinate that the predicates do not take, -1 if there is none."""
    for i in range(len(points)):
        for k in range(2):
            size = abs(points[i, k])
            if not (size == 0.0 or SMALLEST <= size <= LARGEST):
                return i
    return -1


def orient2d_plain(ax: float, ay: float, bx: float, by: float, cx: float, cy: float) -> Fraction:
    """Twin of `orient2d` in fractions."""
    ux, vx = (Fraction(x) - Fraction(cx) for x in (ax, bx))
    uy, vy = (Fraction(y) - Fraction(cy) for y in (ay, by))
    return ux * vy - uy * vx


def incircle_plain(ax: float, ay: float, bx: float, by: float, cx: float, cy: float, dx: float, dy: float) -> Fraction:
    """Twin of `incircle` in fractions."""
    ux, vx, wx = (Fraction(x) - Fraction(dx) for x in (ax, bx, cx))
    uy, vy, wy = (Fraction(y) - Fraction(dy) for y in (ay, by, cy))
    return (
        (ux * ux + uy * uy) * (vx * wy - wx * vy)
        + (vx * vx + vy * vy) * (wx * uy - ux * wy)
        + (wx * wx + wy * wy) * (ux * vy - vx * uy)
    )


@njit(cache=True, error_model="numpy")
def _incircle_twofold(ax, ay, bx, by, cx, cy, dx, dy):  # type: ignore[no-untyped-def]
    """Take the determinant in twofold precision, each number a sum of two: rounded points of a circle need no more."""
    u, v, w = (
        (_two_sum(ax, -dx), _two_sum(ay, -dy)),
        (_two_sum(bx, -dx), _two_sum(by, -dy)),
        (_two_sum(cx, -dx), _two_sum(cy, -dy)),
    )
    one = _times(_dot(u, u), _cross(v, w))
    two = _times(_dot(v, v), _cross(w, u))
    three = _times(_dot(w, w), _cross(u, v))
    return _plus(_plus(one, two), three)[0]


@njit(cache=True, error_model="numpy")
def _plus(a, b):  # type: ignore[no-untyped-def]
    """Sum of two twofold numbers."""
    high, error = _two_sum(a[0], b[0])
    low, rest = _two_sum(a[1], b[1])
    high, error = _two_sum(high, error + low)
    return _two_sum(high, error + rest)


@njit(cache=True, error_model="numpy")
def _times(a, b):  # type: ignore[no-untyped-def]
    """Product of two twofold numbers."""
    high, error = _two_product(a[0], b[0])
    return _two_sum(high, error + (a[0] * b[1] + a[1] * b[0]))


@njit(cache=True, error_model="numpy")
def _dot(a, b):  # type: ignore[no-untyped-def]
    """Scalar product of two twofold vectors."""
    return _plus(_times(a[0], b[0]), _times(a[1], b[1]))


@njit(cache=True, error_model="numpy")
def _cross(a, b):  # type: ignore[no-untyped-def]
    """Cross product of two twofold vectors."""
    right = _times(a[1], b[0])
    return _plus(_times(a[0], b[1]), (-right[0], -right[1]))


@njit(cache=True, error_model="numpy")
def _orient2d_exact(ax, ay, bx, by, cx, cy):  # type: ignore[no-untyped-def]
    """Largest part of the exact determinant, which has its sign."""
    room = np.empty(64)
    n = _minor(room, 0, _difference(room, 0, ax, cx), 2, _difference(room, 2, by, cy),
               4, _difference(room, 4, bx, cx), 6, _difference(room, 6, ay, cy), 8, 24)  # fmt: skip
    return room[8 + n - 1]


@njit(cache=True, error_model="numpy")
def _incircle_exact(ax, ay, bx, by, cx, cy, dx, dy):  # type: ignore[no-untyped-def]
    """Largest part of the exact determinant, which has its sign."""
    # Strategy: each difference of two coordinates is one number and perhaps its rounding error. All that follows are
    # sums and products of expansions, which leave out zeros: where the differences are exact, as between near points,
    # and where the coordinates have few bits, as in lattices, they stay short.
    room = np.empty(4200)
    ux, uy, vx, vy, wx, wy, square, minor, spare, term, total, other = 0, 2, 4, 6, 8, 10, 12, 28, 44, 588, 1100, 2636
    mux, muy = _difference(room, ux, ax, dx), _difference(room, uy, ay, dy)
    mvx, mvy = _difference(room, vx, bx, dx), _difference(room, vy, by, dy)
    mwx, mwy = _difference(room, wx, cx, dx), _difference(room, wy, cy, dy)
    room[total] = 0.0
    size = 1
    for _ in range(3):
        n = _square(room, ux, mux, uy, muy, square, spare)
        m = _minor(room, vx, mvx, wy, mwy, wx, mwx, vy, mvy, minor, spare)
        terms = _multiply(room, square, n, minor, m, term, spare)
        size = _add(room, total, size, term, terms, other)
        total, other = other, total
        ux, uy, vx, vy, wx, wy = vx, vy, wx, wy, ux, uy
        mux, muy, mvx, mvy, mwx, mwy = mvx, mvy, mwx, mwy, mux, muy
    return room[total + size - 1]


# An expansion is `n` numbers from place `e` on in a common array `room`. Each function writes its result from place `h`
# on, or, where it is named so, uses the places from `spare` on, and returns the number of parts, at least 1.


@njit(cache=True, error_model="numpy")
def _two_sum(a: float, b: float) -> tuple[float, float]:
    """Sum and its rounding error (Knuth)."""
    total = a + b
    part = total - a
    return total, (a - (total - part)) + (b - part)


@njit(cache=True, error_model="numpy")
def _two_product(a: float, b: float) -> tuple[float, float]:
    """Product and its rounding error (Dekker, Veltkamp)."""
    product = a * b
    wide = SPLITTER * a
    a_high = wide - (wide - a)
    a_low = a - a_high
    wide = SPLITTER * b
    b_high = wide - (wide - b)
    b_low = b - b_high
    return product, a_low * b_low - (((product - a_high * b_high) - a_low * b_high) - a_high * b_low)


@njit(cache=True, error_model="numpy")
def _difference(room: Floats, h: int, a: float, b: float) -> int:
    """Of two numbers."""
    total, error = _two_sum(a, -b)
    if error == 0.0:
        room[h] = total
        return 1
    room[h], room[h + 1] = error, total
    return 2


@njit(cache=True, error_model="numpy")
def _add(room: Floats, e: int, n: int, f: int, m: int, h: int) -> int:
    """Sum of two expansions, zeros left out."""
    # Strategy: merge by size and carry the sum along (Shewchuk's fast expansion sum).
    last_e, last_f, start = e + n, f + m, h
    carry = 0.0
    while e < last_e or f < last_f:
        if f == last_f or (e < last_e and abs(room[e]) <= abs(room[f])):
            part = room[e]
            e += 1
        else:
            part = room[f]
            f += 1
        carry, error = _two_sum(carry, part)
        if error != 0.0:
            room[h] = error
            h += 1
    if carry != 0.0 or h == start:
        room[h] = carry
        h += 1
    return h - start


@njit(cache=True, error_model="numpy")
def _scale(room: Floats, e: int, n: int, b: float, h: int) -> int:
    """Expansion times a number, zeros left out."""
    start = h
    carry, error = _two_product(room[e], b)
    if error != 0.0:
        room[h] = error
        h += 1
    for i in range(1, n):
        product, low = _two_product(room[e + i], b)
        carry, error = _two_sum(carry, low)
        if error != 0.0:
            room[h] = error
            h += 1
        carry, error = _two_sum(product, carry)
        if error != 0.0:
            room[h] = error
            h += 1
    if carry != 0.0 or h == start:
        room[h] = carry
        h += 1
    return h - start


@njit(cache=True, error_model="numpy")
def _multiply(room: Floats, e: int, n: int, f: int, m: int, h: int, spare: int) -> int:
    """Product of two expansions; needs 2 n m places from `h` and 2 n m + 2 n from `spare`."""
    size = _scale(room, e, n, room[f], h)
    row = spare + 2 * n * m
    for j in range(1, m):
        for k in range(size):
            room[spare + k] = room[h + k]
        size = _add(room, spare, size, row, _scale(room, e, n, room[f + j], row), h)
    return size


@njit(cache=True, error_model="numpy")
def _square(room: Floats, e: int, n: int, f: int, m: int, h: int, spare: int) -> int:
    """Sum e e + f f of expansions of at most two parts; needs 16 places from `h` and 28 from `spare`."""
    size = _multiply(room, e, n, e, n, spare, spare + 16)
    return _add(room, spare, size, spare + 8, _multiply(room, f, m, f, m, spare + 8, spare + 16), h)


@njit(cache=True, error_model="numpy")
def _minor(room: Floats, a: int, na: int, b: int, nb: int, c: int, nc: int, d: int, nd: int, h: int, spare: int) -> int:
    """Difference a b - c d of expansions of at most two parts; needs 16 places from `h` and 28 from `spare`."""
    size = _multiply(room, a, na, b, nb, spare, spare + 16)
    more = _multiply(room, c, nc, d, nd, spare + 8, spare + 16)
    for i in range(spare + 8, spare + 8 + more):
        room[i] = -room[i]
    return _add(room, spare, size, spare + 8, more, h)
