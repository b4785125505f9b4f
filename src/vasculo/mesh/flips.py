"""Edge flips: making a wanted edge appear, and restoring the Delaunay property (Sloan 1993; Lawson 1977)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

if TYPE_CHECKING:
    from vasculo.geometry.arrays import Flags, Floats, Ints
    from vasculo.mesh.draft import Draft

SWEEPS = 100
"""Most passes of edge flips in a row."""

ROUNDING = 1e-14
"""Relative error of the float64 determinants below; smaller values count as zero."""


def retriangulate(draft: Draft) -> None:
    """Make the triangles of a draft Delaunay again by flips, the walls kept; overwrites them."""
    dirty = np.ones(len(draft.triangles), dtype=np.bool_)
    restore_delaunay(draft.points, draft.triangles, draft.neighbours, dirty, SWEEPS)


@njit(cache=True, error_model="numpy")
def turn(points: Floats, a: int, b: int, c: int) -> float:
    """Twice the signed area of the triangle a, b, c; zero when it is lost in rounding."""
    left = (points[b, 0] - points[a, 0]) * (points[c, 1] - points[a, 1])
    right = (points[b, 1] - points[a, 1]) * (points[c, 0] - points[a, 0])
    area = left - right
    if abs(area) <= ROUNDING * (abs(left) + abs(right)):
        return 0.0
    return area


@njit(cache=True, error_model="numpy")
def flip(triangles: Ints, neighbours: Ints, t: int, i: int) -> None:
    """Replace the edge opposite to corner i of triangle t by the other diagonal; overwrites both triangles.

    Afterwards t = (p, a, q) and its neighbour u = (p, q, b), where p is corner i of t, (a, b) the old edge, q opposite.
    """
    u = neighbours[t, i]
    j = 0
    while neighbours[u, j] != t:
        j += 1
    p = triangles[t, i]
    a = triangles[t, (i + 1) % 3]
    b = triangles[t, (i + 2) % 3]
    q = triangles[u, j]
    across_bp = neighbours[t, (i + 1) % 3]
    across_pa = neighbours[t, (i + 2) % 3]
    across_aq = neighbours[u, (j + 1) % 3]
    across_qb = neighbours[u, (j + 2) % 3]
    triangles[t, 0] = p
    triangles[t, 1] = a
    triangles[t, 2] = q
    neighbours[t, 0] = across_aq
    neighbours[t, 1] = u
    neighbours[t, 2] = across_pa
    triangles[u, 0] = p
    triangles[u, 1] = q
    triangles[u, 2] = b
    neighbours[u, 0] = across_qb
    neighbours[u, 1] = across_bp
    neighbours[u, 2] = t
    if across_aq >= 0:
        for k in range(3):
            if neighbours[across_aq, k] == u:
                neighbours[across_aq, k] = t
    if across_bp >= 0:
        for k in range(3):
            if neighbours[across_bp, k] == t:
                neighbours[across_bp, k] = u


@njit(cache=True, error_model="numpy")
def incircle(points: Floats, a: int, b: int, c: int, d: int) -> float:
    """Positive when d lies inside the circle through the counter-clockwise a, b, c; zero when lost in rounding."""
    ax = points[a, 0] - points[d, 0]
    ay = points[a, 1] - points[d, 1]
    bx = points[b, 0] - points[d, 0]
    by = points[b, 1] - points[d, 1]
    cx = points[c, 0] - points[d, 0]
    cy = points[c, 1] - points[d, 1]
    aa = ax * ax + ay * ay
    bb = bx * bx + by * by
    cc = cx * cx + cy * cy
    value = aa * (bx * cy - by * cx) + bb * (cx * ay - cy * ax) + cc * (ax * by - ay * bx)
    size = aa * (abs(bx * cy) + abs(by * cx)) + bb * (abs(cx * ay) + abs(cy * ax)) + cc * (abs(ax * by) + abs(ay * bx))
    if abs(value) <= ROUNDING * size:
        return 0.0
    return value


@njit(cache=True, error_model="numpy")
def restore_delaunay(points: Floats, triangles: Ints, neighbours: Ints, dirty: Flags, sweeps: int) -> int:
    """Flip edges until each is locally Delaunay, walls excepted; overwrites triangles and neighbours.

    Returns the number of flips; at most `sweeps` passes are made. `dirty` (t,) marks the triangles to look at
    (given: all) and is overwritten. Every triangle keeps a positive area.
    """
    flips = 0
    for _ in range(sweeps):
        done = 0
        for t in range(len(triangles)):
            if not dirty[t]:
                continue
            dirty[t] = False
            for i in range(3):
                u = neighbours[t, i]
                if u < 0:
                    continue
                j = 0
                while neighbours[u, j] != t:
                    j += 1
                p = triangles[t, i]
                a = triangles[t, (i + 1) % 3]
                b = triangles[t, (i + 2) % 3]
                q = triangles[u, j]
                if incircle(points, p, a, b, q) > 0.0 and turn(points, p, a, q) > 0.0 and turn(points, p, q, b) > 0.0:
                    flip(triangles, neighbours, t, i)
                    done += 1
                    dirty[t] = True
                    dirty[u] = True
                    for k in range(3):
                        if neighbours[t, k] >= 0:
                            dirty[neighbours[t, k]] = True
                        if neighbours[u, k] >= 0:
                            dirty[neighbours[u, k]] = True
                    break
        flips += done
        if done == 0:
            break
    return flips


@njit(cache=True, error_model="numpy")
def recover_edges(points: Floats, triangles: Ints, neighbours: Ints, wanted: Ints, at: Ints) -> int:
    """Flip edges until each wanted edge is there; overwrites triangles and neighbours.

    Every wanted edge must end at inner nodes of the triangulation and cross no other wanted edge. `at` (n,) is
    a buffer. Returns the first edge that could not be made, or -1.
    """
    for t in range(len(triangles)):
        for k in range(3):
            at[triangles[t, k]] = t
    # Strategy: walk from a to b over the crossed edges. Flip the first one whose flip leaves fewer crossings; if there
    # is none, flip one that can be flipped at all, drawn by a linear congruence, so that flips which undo each other
    # do not go on for ever.
    draw = np.int64(1)
    for w in range(len(wanted)):
        a = wanted[w, 0]
        b = wanted[w, 1]
        tries = 0
        limit = 100_000
        while True:
            t = at[a]
            found = False
            for _ in range(len(triangles)):
                k = 0
                while triangles[t, k] != a:
                    k += 1
                v = triangles[t, (k + 1) % 3]
                z = triangles[t, (k + 2) % 3]
                if b in (v, z):
                    found = True
                    break
                if turn(points, a, v, b) > 0.0 and turn(points, a, z, b) < 0.0:
                    break
                t = neighbours[t, (k + 1) % 3]
                if t == at[a]:
                    return w
            if found:
                break
            tries += 1
            if tries > limit:
                return w
            spare_t = -1
            spare_i = 0
            spares = 0
            i = k
            while True:
                u = neighbours[t, i]
                j = 0
                while neighbours[u, j] != t:
                    j += 1
                p = triangles[t, i]
                c = triangles[t, (i + 1) % 3]
                d = triangles[t, (i + 2) % 3]
                q = triangles[u, j]
                if turn(points, p, c, q) > 0.0 and turn(points, p, q, d) > 0.0:
                    side = turn(points, a, b, p) if p != a else 0.0
                    other = turn(points, a, b, q) if q != b else 0.0
                    if side * other >= 0.0:
                        spare_t = t
                        spare_i = i
                        break
                    spares += 1
                    draw = (draw * 1103515245 + 12345) & 0x7FFFFFFF
                    if (draw >> 8) % spares == 0:
                        spare_t = t
                        spare_i = i
                if q == b:
                    break
                if turn(points, a, b, q) > 0.0:
                    # q is left of the way: the next crossed edge joins q and the right end c
                    t = u
                    i = 0
                    while triangles[t, i] != d:
                        i += 1
                else:
                    t = u
                    i = 0
                    while triangles[t, i] != c:
                        i += 1
            if spare_t < 0:
                return w
            u = neighbours[spare_t, spare_i]
            flip(triangles, neighbours, spare_t, spare_i)
            for k in range(3):
                at[triangles[spare_t, k]] = spare_t
                at[triangles[u, k]] = u
    return -1
