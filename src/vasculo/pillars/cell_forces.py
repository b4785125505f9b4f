"""Forces in one cell: filaments, membrane springs, bending and area pressure.

A cell's nodes are copied twice round its membrane, so that neighbours and the far ends of filaments lie in one stretch
of memory and the compiler makes vectors of the loops.
"""

from __future__ import annotations

import math

from numba import njit

from vasculo.pillars.cell import LANES


@njit(cache=True, error_model="numpy", nogil=True)
def room_for(starts):  # type: ignore[no-untyped-def]
    """Length of the rows of a workspace that fits every cell."""
    most = 0
    for k in range(starts.size - 1):
        most = max(most, starts[k + 1] - starts[k])
    return most + most // 2 + 2 * LANES


@njit(cache=True, error_model="numpy", nogil=True)
def _go_round(values, row):  # type: ignore[no-untyped-def]
    """Fill the row with the values, again and again."""
    for begin in range(0, row.size, values.size):
        part = row[begin : begin + values.size]
        for t in range(part.size):
            part[t] = values[t]


@njit(cache=True, error_model="numpy", nogil=True)
def _fold(row, total):  # type: ignore[no-untyped-def]
    """Add up what a row holds for each node, once a round."""
    for t in range(total.size):
        total[t] = row[t]
    for begin in range(total.size, row.size, total.size):
        part = row[begin : begin + total.size]
        for t in range(part.size):
            total[t] += part[t]


# No fastmath: freshly compiled and cached code then sum in different orders, and a run does not repeat to the bit.
@njit(cache=True, error_model="numpy", nogil=True)
def _add_filaments(x, y, share, runs, rest, px, py, fx, fy):  # type: ignore[no-untyped-def]
    q = 0
    for r in range(runs.shape[0]):
        first, second, count = runs[r, 0], runs[r, 1], runs[r, 2]
        xi, yi, si = x[first : first + count], y[first : first + count], share[first : first + count]
        xj, yj, sj = x[second : second + count], y[second : second + count], share[second : second + count]
        length = rest[q : q + count]
        for t in range(count):
            dx = xj[t] - xi[t]
            dy = yj[t] - yi[t]
            g = si[t] * sj[t] * (1.0 - length[t] / math.sqrt(dx * dx + dy * dy))
            g = g if length[t] >= 0.0 else 0.0
            px[t] = g * dx
            py[t] = g * dy
        fxs, fys = fx[first : first + count], fy[first : first + count]
        for t in range(count):
            fxs[t] += px[t]
            fys[t] += py[t]
        fxs, fys = fx[second : second + count], fy[second : second + count]
        for t in range(count):
            fxs[t] -= px[t]
            fys[t] -= py[t]
        q += count


@njit(cache=True, error_model="numpy", nogil=True)
def _add_membrane(x, y, rest, ratio, rest_area, area_stiffness, bending, px, py, fx, fy):  # type: ignore[no-untyped-def]
    n = fx.size
    area = 0.0
    for t in range(n):
        area += x[t] * y[t + 1] - x[t + 1] * y[t]
    push = 0.5 * area_stiffness * (rest_area - 0.5 * area) / rest_area
    # pulls and bends of the nodes stand one place on, so that the last node's stands before the first
    for t in range(n):
        dx = x[t + 1] - x[t]
        dy = y[t + 1] - y[t]
        g = ratio * (1.0 - rest[t] / math.sqrt(dx * dx + dy * dy))
        px[t + 1] = g * dx
        py[t + 1] = g * dy
    px[0], py[0] = px[n], py[n]
    for t in range(n):
        fx[t] += px[t + 1] - px[t]
        fy[t] += py[t + 1] - py[t]
    # node t + 1 is the middle one of t, t + 1, t + 2
    for t in range(n):
        px[t] = x[t + 2] - x[t]
        py[t] = y[t + 2] - y[t]
    fx[0] += push * py[n - 1]
    fy[0] -= push * px[n - 1]
    for t in range(n - 1):
        fx[t + 1] += push * py[t]
        fy[t + 1] -= push * px[t]
    for t in range(n):
        px[t + 2] = bending * (x[t] - 2.0 * x[t + 1] + x[t + 2])
        py[t + 2] = bending * (y[t] - 2.0 * y[t + 1] + y[t + 2])
    px[0], py[0], px[1], py[1] = px[n], py[n], px[n + 1], py[n + 1]
    for t in range(n):
        fx[t] += 2.0 * px[t + 1] - px[t] - px[t + 2]
        fy[t] += 2.0 * py[t + 1] - py[t] - py[t + 2]


@njit(cache=True, error_model="numpy", nogil=True)
def cell_forces(  # type: ignore[no-untyped-def]
    x,
    y,
    share,
    runs,
    rest,
    membrane_rest,
    membrane_ratio,
    rest_area,
    area_stiffness,
    bending,
    work,
    fx,
    fy,
):
    """Write the forces on the nodes of one cell to fx and fy; twin: `vasculo.pillars.relax_plain.forces_plain`.

    Parameters
    ----------
    x, y : ndarray of float64, shape (n,)
        Nodes, R0.
    share : ndarray of float64, shape (n,), or (0,) for a cell without filaments
    runs : ndarray of int32, shape (r, 3)
    rest : ndarray of float64, shape (f,)
        Its part of `vasculo.pillars.cell.Filaments`.
    membrane_rest : ndarray of float64, shape (n,)
        Rest length of the side from each node to the next.
    membrane_ratio, rest_area, area_stiffness, bending : float
        See `vasculo.pillars.relax.Network`.
    work : ndarray of float64, shape (7, room_for(starts))
        Overwritten.
    fx, fy : ndarray of float64, shape (n,)
    """
    n = x.size
    size = n + n // 2 + 2 * LANES
    xx, yy, ss, px = work[0, :size], work[1, :size], work[2, :size], work[3, :size]
    py, gx, gy = work[4, :size], work[5, :size], work[6, :size]
    _go_round(x, xx)
    _go_round(y, yy)
    for t in range(size):
        gx[t], gy[t] = 0.0, 0.0
    if share.size > 0:
        _go_round(share, ss)
        _add_filaments(xx, yy, ss, runs, rest, px, py, gx, gy)
    _fold(gx, fx)
    _fold(gy, fy)
    _add_membrane(xx, yy, membrane_rest, membrane_ratio, rest_area, area_stiffness, bending, px, py, fx, fy)
