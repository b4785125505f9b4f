"""Exact paths through a velocity that is linear and free of divergence in each triangle."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from vasculo.flow.read.conservative import WALL

if TYPE_CHECKING:
    from vasculo.geometry.arrays import Floats, Ints, Longs

SMALL = 1e-6  # below, the time of a step is taken from a series
INSIDE, GIVEN_UP = -1, -2  # a tracer that left through no edge: its time was over, or its steps were

# Strategy: in barycentric coordinates the velocity is L' = G L, and the columns of G sum to zero. Without divergence
# its trace is zero too, so its eigenvalues are 0, m, -m, with m real or imaginary, and
#     L(t) = L + a S + b C,   a = G L,   b = G a,   S = sinh(m t) / m,   C = (cosh(m t) - 1) / m^2.
# With w = 2 tanh(m t / 2) / m, which grows with t, S = w / (1 - m^2 w^2 / 4) and C = (w^2 / 2) / (1 - m^2 w^2 / 4). So
# a coordinate vanishes where L (1 - m^2 w^2 / 4) + a w + b w^2 / 2 does: a quadratic equation, whatever the kind of
# flow. The first of its roots is the way out, with no step size and no error but round-off.


@njit(cache=True, error_model="numpy")
def rates_in(triangle: int, area: float, outflow: Floats, rates: Floats) -> float:
    """Fill G (3, 3) of a triangle, per time; return m^2."""
    for k in range(3):
        rates[k, (k + 1) % 3] = -outflow[triangle, k, 0] / (2.0 * area)
        rates[k, (k + 2) % 3] = -outflow[triangle, k, 1] / (2.0 * area)
    for k in range(3):
        rates[k, k] = -rates[(k + 1) % 3, k] - rates[(k + 2) % 3, k]
    minors = 0.0
    for k in range(3):
        n = (k + 1) % 3
        minors += rates[k, k] * rates[n, n] - rates[k, n] * rates[n, k]
    return -minors


@njit(cache=True, error_model="numpy")
def first_zero(share: float, a: float, b: float, square: float) -> float:
    """First zero of a coordinate as -1 / w, which grows with the time; infinite if there is none.

    `share` is its value now and a, b are its entries of G L and G G L; a coordinate that is zero now must have become
    positive in between, or is on its way out.
    """
    two, one = 0.5 * b - 0.25 * square * share, a
    best = np.inf
    if share <= 0.0:
        if one < 0.0 or (one == 0.0 and two < 0.0):
            return -np.inf
        root = -one / two if two != 0.0 else np.inf
        return _key(root, square) if np.isfinite(root) and root != 0.0 else np.inf
    inside = one * one - 4.0 * two * share
    if inside < 0.0:
        return best
    half = -0.5 * (one + (np.sqrt(inside) if one >= 0.0 else -np.sqrt(inside)))
    if half != 0.0:
        best = min(best, _key(share / half, square))
    if two != 0.0 and half != 0.0:
        best = min(best, _key(half / two, square))
    return best


@njit(cache=True, error_model="numpy")
def _key(root: float, square: float) -> float:
    """Order of a root in time: -1 / root; infinite for a root that no time reaches."""
    if square >= 0.0 and (root <= 0.0 or square * root * root >= 4.0):
        return np.inf
    return -1.0 / root


@njit(cache=True, error_model="numpy")
def time_of(w: float, square: float) -> float:
    """Time from w = 2 tanh(m t / 2) / m, with m^2 = square."""
    x = 0.25 * square * w * w
    if abs(x) < SMALL and w >= 0.0:
        return w * (1.0 + x / 3.0 + x * x / 5.0)
    m = np.sqrt(abs(square))
    if square > 0.0:
        return 2.0 / m * np.arctanh(0.5 * m * w)
    return 2.0 / m * (np.arctan(0.5 * m * w) + (np.pi if w < 0.0 else 0.0))


@njit(cache=True, error_model="numpy")
def move_for(time: float, square: float, shares: Floats, a: Floats, b: Floats) -> None:
    """Move within a triangle for a given time; overwrites `shares`."""
    x = square * time * time
    if abs(x) < SMALL:
        s, c = time * (1.0 + x / 6.0 + x * x / 120.0), time * time * (0.5 + x / 24.0 + x * x / 720.0)
    else:
        m = np.sqrt(abs(square))
        turn = m * time
        if square > 0.0:
            s, c = np.sinh(turn) / m, (np.cosh(turn) - 1.0) / square
        else:
            s, c = np.sin(turn) / m, (np.cos(turn) - 1.0) / square
    for k in range(3):
        shares[k] += a[k] * s + b[k] * c
    _mend(shares)


@njit(cache=True, error_model="numpy")
def _mend(shares: Floats) -> None:
    """Take round-off out of barycentric coordinates; overwrites `shares`."""
    total = 0.0
    for k in range(3):
        shares[k] = max(shares[k], 0.0)
        total += shares[k]
    for k in range(3):
        shares[k] /= total


@njit(cache=True, error_model="numpy", nogil=True)
def follow(
    rank: int,
    threads: int,
    points: Floats,
    triangles: Ints,
    areas: Floats,
    outflow: Floats,
    beyond: Ints,
    duration: float,
    most: int,
    cell: Ints,
    shares: Floats,
    time: Floats,
    shift: Floats,
    edge: Ints,
    steps: Longs,
    first: Longs,
    path: Floats,
    path_time: Floats,
) -> int:
    """Follow each tracer of this thread's share until it leaves, its time is over, or it has made `most` steps.

    Overwrites `cell` (k,), `shares` (k, 3) and `time` (k,) by those at the end, `shift` (k, 2) by the way across
    periodic sides, `edge` (k,) by the boundary edge it left through, INSIDE or GIVEN_UP, and `steps` (k,) by the number
    of its path's points. Points of the path and their times are written from first[k] on, if `path` has any room.
    """
    rates, a, b = np.empty((3, 3)), np.empty(3), np.empty(3)
    write = len(path) > 0
    for tracer in range(rank, len(cell), threads):
        t = cell[tracer]
        now = shares[tracer]
        elapsed = 0.0
        edge[tracer] = GIVEN_UP
        steps[tracer] = 0
        for _ in range(most):
            if write:
                place = first[tracer] + steps[tracer]
                for axis in range(2):
                    path[place, axis] = shift[tracer, axis]
                    for k in range(3):
                        path[place, axis] += now[k] * points[triangles[t, k], axis]
                path_time[place] = elapsed
            steps[tracer] += 1
            if edge[tracer] != GIVEN_UP:
                break
            square = rates_in(t, areas[t], outflow, rates)
            for k in range(3):
                a[k] = rates[k, 0] * now[0] + rates[k, 1] * now[1] + rates[k, 2] * now[2]
            for k in range(3):
                b[k] = rates[k, 0] * a[0] + rates[k, 1] * a[1] + rates[k, 2] * a[2]
            out, best = -1, np.inf
            for k in range(3):
                if beyond[t, k] != WALL:
                    key = first_zero(now[k], a[k], b[k], square)
                    if key < best:
                        out, best = k, key
            w = 0.0 if best == -np.inf else -1.0 / best
            took = time_of(w, square) if out >= 0 else np.inf
            if elapsed + took >= duration:
                move_for(duration - elapsed, square, now, a, b)
                elapsed = duration
                edge[tracer] = INSIDE
                continue
            elapsed += took
            scale = 1.0 - 0.25 * square * w * w
            for k in range(3):
                now[k] += (a[k] * w + 0.5 * b[k] * w * w) / scale
            now[out] = 0.0
            _mend(now)
            if beyond[t, out] < WALL:
                edge[tracer] = -2 - beyond[t, out]
                continue
            other, into = beyond[t, out] // 3, beyond[t, out] % 3
            start, meets = triangles[t, (out + 1) % 3], triangles[other, (into + 2) % 3]
            for axis in range(2):
                shift[tracer, axis] += points[start, axis] - points[meets, axis]
            one, two = now[(out + 1) % 3], now[(out + 2) % 3]
            now[into], now[(into + 1) % 3], now[(into + 2) % 3] = 0.0, two, one
            t = other
        cell[tracer] = t
        time[tracer] = elapsed
    return 0
