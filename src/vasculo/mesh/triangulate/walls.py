"""Wanted edges in a triangulation: found, or made by flips that always come to an end."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from vasculo.geometry.predicates import orient2d
from vasculo.mesh.triangulate.flips import around, flip

if TYPE_CHECKING:
    from vasculo.geometry.arrays import Flags, Floats, Ints

MISSING = -1
"""The edge is not there."""


@njit(cache=True, error_model="numpy")
def any_triangle(triangles: Ints, nodes: int) -> Ints:
    """One triangle (n,) of each node."""
    at = np.full(nodes, -1, dtype=np.int32)
    for t in range(len(triangles)):
        for k in range(3):
            at[triangles[t, k]] = t
    return at


@njit(cache=True, error_model="numpy")
def find_edge(triangles: Ints, neighbours: Ints, t: int, a: int, b: int) -> int:
    """Place 3 u + k of the edge from a to b, opposite to corner k of the triangle u on its left; t is one of node a.

    Returns `MISSING` if there is no such edge, -2 - place if only the triangle on its right is there.
    """
    right = MISSING
    for way in (1, 2):  # counter-clockwise around a, and from the hull the other way round
        u = t
        while u >= 0:
            k = 0
            while triangles[u, k] != a:
                k += 1
            if triangles[u, (k + 1) % 3] == b:
                return 3 * u + (k + 2) % 3
            if triangles[u, (k + 2) % 3] == b:
                right = -2 - (3 * u + (k + 1) % 3)
            u = neighbours[u, (k + way) % 3]
            if u == t:
                return right
    return right


@njit(cache=True, error_model="numpy")
def recover_edges(
    points: Floats, triangles: Ints, neighbours: Ints, wanted: Ints, at: Ints, dirty: Flags
) -> tuple[int, int, int]:
    """Flip edges until each wanted edge is there.

    Parameters
    ----------
    points : (n, 2) float64, model length
    triangles, neighbours : (t, 3) int32
        A triangulation of the convex hull of its nodes, neighbours -1 outside. Overwritten.
    wanted : (w, 2) int32
        Edges.
    at : (n,) int32
        A triangle of each node. Overwritten.
    dirty : (t,) bool
        Set True at triangles that are new.

    Returns
    -------
    tuple of int
        All -1, or what is in the way: the number of a wanted edge and the two ends of another one that crosses it; or
        the number, a node that lies on it, and -1.

    Notes
    -----
    Of the nodes to the left of a wanted edge whose triangles it crosses there is always one with an angle below 180
    degrees, the farthest for one. All edges from there across the wanted edge can be flipped away, in the order of a
    Graham scan of their other ends. So the nodes along the edge get fewer each time (Osherovich & Bruckstein 2008).
    """
    first, other = _stars(wanted, len(points))
    ends = np.empty(len(points) + 2, dtype=np.int32)
    for w in range(len(wanted)):
        a, b = wanted[w, 0], wanted[w, 1]
        while find_edge(triangles, neighbours, at[a], a, b) == MISSING:
            x, size, c, d = _first_ear(points, triangles, neighbours, at[a], a, b, first, other, ends)
            if x < 0:
                return w, c, d
            # ends: of the fan of x, from the node before it on the left of the edge to the node after it
            kept = 1
            for i in range(1, size):
                end = ends[i]
                while kept > 1 and _turn(points, ends[kept - 2], ends[kept - 1], end) > 0.0:
                    kept -= 1
                    place = find_edge(triangles, neighbours, at[x], x, ends[kept])
                    t, u = place // 3, neighbours[place // 3, place % 3]
                    flip(triangles, neighbours, t, place % 3)
                    for k in range(3):
                        at[triangles[t, k]], at[triangles[u, k]] = t, u
                    dirty[t] = dirty[u] = True
                ends[kept] = end
                kept += 1
    return -1, -1, -1


@njit(cache=True, error_model="numpy")
def _stars(edges: Ints, nodes: int) -> tuple[Ints, Ints]:
    """Other ends of the edges of each node: other[first[i]:first[i + 1]]."""
    first, other = np.zeros(nodes + 2, dtype=np.int32), np.empty(2 * len(edges), dtype=np.int32)
    for a in edges.ravel():
        first[a + 2] += 1
    for i in range(2, nodes + 2):
        first[i] += first[i - 1]
    for a, b in edges:
        other[first[a + 1]], other[first[b + 1]] = b, a
        first[a + 1] += 1
        first[b + 1] += 1
    return first, other


@njit(cache=True, error_model="numpy")
def _turn(points: Floats, a: int, b: int, c: int) -> float:
    """Orientation of three nodes."""
    return orient2d(points[a, 0], points[a, 1], points[b, 0], points[b, 1], points[c, 0], points[c, 1])


@njit(cache=True, error_model="numpy")
def _first_ear(points, triangles, neighbours, t, a, b, first, other, ends):  # type: ignore[no-untyped-def]
    """Walk from a to b, to the first node x on the left with an angle below 180 degrees on the side of the way.

    Writes the node before x, the other ends of the edges from x that cross the way, and the node after x to `ends`.
    Returns x, the number of ends, -1, -1; or -1, 0 and the ends of a wanted edge that crosses; or -1, 0, the node on
    the way, -1.
    """
    t, k = _leave(points, triangles, neighbours, t, a, b)
    right, left = triangles[t, (k + 1) % 3], triangles[t, (k + 2) % 3]
    if _turn(points, a, b, right) == 0.0:
        return -1, 0, right, -1
    if _turn(points, a, b, left) == 0.0:
        return -1, 0, left, -1
    ends[0], ends[1] = a, right
    size = 2
    while True:
        for i in range(first[left], first[left + 1]):
            if other[i] == right:
                return -1, 0, left, right
        t, k, _, _, _, q = around(triangles, neighbours, t, k)
        side = _turn(points, a, b, q)
        if side == 0.0 and q != b:
            return -1, 0, q, -1
        if side < 0.0:
            k = (k + 2) % 3
            right = q
            ends[size] = q
            size += 1
        else:
            ends[size] = q
            if _turn(points, ends[0], left, q) < 0.0:
                return left, size + 1, -1, -1
            k = (k + 1) % 3
            ends[0], ends[1] = left, right
            size = 2
            left = q


@njit(cache=True, error_model="numpy")
def _leave(points: Floats, triangles: Ints, neighbours: Ints, t: int, a: int, b: int) -> tuple[int, int]:
    """Triangle around node a through which the way to b leaves it, and the corner of a in it; t is one of node a."""
    for way in (1, 2):
        u = t
        while u >= 0:
            k = 0
            while triangles[u, k] != a:
                k += 1
            right = _turn(points, a, b, triangles[u, (k + 1) % 3])
            left = _turn(points, a, b, triangles[u, (k + 2) % 3])
            if right <= 0.0 <= left and right < left:
                return u, k
            u = neighbours[u, (k + way) % 3]
            if u == t:
                break
    return -1, -1
