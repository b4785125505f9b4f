"""Delaunay triangulation node by node: each digs a cavity, and a fan of triangles fills it (Bowyer; Watson 1981)."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeAlias

import numpy as np
from numba import njit

from vasculo.geometry.predicates import incircle, orient2d

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.geometry.arrays import Floats, Ints

    Rows: TypeAlias = NDArray[np.uint32]

ROW = 8
"""Numbers a triangle: its corners, one unused, the half-edges across from them, one unused."""

FAR = 2**32 - 1
"""The node at infinity: with it, each edge of the hull has a triangle on its outer side too."""

NEAR = 2**31
"""All other nodes and all half-edges are below."""

MOST = NEAR // (2 * ROW)
"""Most nodes: beyond, half-edges have no number of 31 bits."""

ROUNDS = np.array((512, 64, 8, 1))
"""Steps in which the nodes are gone through: first every 512th, at last all that are left."""

# Triangle t has the places t to t + 7 of `rows`, t being a multiple of 8: rows[t + k] is corner k, counter-clockwise,
# and rows[t + 4 + k] = u + j names the triangle u across the edge opposite to it and the corner j there opposite to the
# same edge. A place h = t + k stands for a corner and for the edge opposite to it. Node i is at xy[2 i], xy[2 i + 1].
# The numbers are unsigned, which spares every access the question whether its index counts from the end.


@njit(cache=True, error_model="numpy")
def insert_nodes(xy: Floats, third: int, rows: Rows) -> int:
    """Make the Delaunay triangulation of nodes, with the far node.

    Parameters
    ----------
    xy : (2 n,) float64
        Nodes in an order in which neighbours follow each other.
    third : int
        A node that does not lie on the line through nodes 0 and 1.
    rows : (16 n,) uint32
        Overwritten: the triangles as above, two rows a node. A row of the far node alone is unused.

    Returns
    -------
    int
        A node that coincides with an earlier one; -1 if none does.
    """
    # Strategy: a node is found by a walk from the one before it. Going through the nodes in steps at first lets nearly
    # all of them fall into a mesh that is there already, with few triangles to replace, and costs no sorting. Node i
    # takes the rows of the triangles that go, and rows 2 i and 2 i + 1, so that rows stay in the order of the nodes.
    n = len(xy) // 2
    stack, rim, start, free = np.empty((4, 2 * n + 8), dtype=np.uint32)
    t = _first_triangle(xy, third, rows)
    for turn in range(len(ROUNDS)):
        for i in range(0, n, ROUNDS[turn]):
            if i < 2 or i == third or (turn > 0 and i % ROUNDS[turn - 1] == 0):
                continue
            h = _find(xy, rows, t, xy[2 * i], xy[2 * i + 1])
            if h < 0:
                return i
            size = _dig(xy, rows, h, xy[2 * i], xy[2 * i + 1], stack, rim, start, free)
            free[size - 2] = 2 * ROW * i
            free[size - 1] = 2 * ROW * i + ROW
            t = _fill(rows, i, size, rim, start, free)
    return -1


@njit(cache=True, error_model="numpy")
def write_triangles(rows: Rows) -> tuple[Ints, Ints]:
    """Write the triangles without the far node: corners and neighbours, both (t, 3), -1 outside of the hull."""
    number = np.empty(len(rows) // ROW, dtype=np.int32)
    count = 0
    for slot in range(len(number)):
        t = ROW * slot
        number[slot] = -1
        if (rows[t] | rows[t + 1] | rows[t + 2]) < NEAR:
            number[slot] = count
            count += 1
    triangles, neighbours = np.empty((count, 3), dtype=np.int32), np.empty((count, 3), dtype=np.int32)
    for slot in range(len(number)):
        t, i = ROW * slot, number[slot]
        if i >= 0:
            for k in range(3):
                triangles[i, k] = rows[t + k]
                neighbours[i, k] = number[rows[t + 4 + k] // ROW]
    return triangles, neighbours


@njit(cache=True, error_model="numpy")
def first_corner(xy: Floats) -> int:
    """First node that does not lie on the line through nodes 0 and 1, -1 if there is none."""
    for i in range(2, len(xy) // 2):
        if _side(xy, 0, 1, xy[2 * i], xy[2 * i + 1]) != 0.0:
            return i
    return -1


@njit(cache=True, error_model="numpy")
def _after(h: int) -> int:
    """Next corner of the same triangle, counter-clockwise."""
    return (h & -4) + (0b001001 >> 2 * (h & 3) & 3)


@njit(cache=True, error_model="numpy")
def _before(h: int) -> int:
    """Corner before it in the same triangle, counter-clockwise."""
    return (h & -4) + (0b010010 >> 2 * (h & 3) & 3)


@njit(cache=True, error_model="numpy")
def _side(xy: Floats, a: int, b: int, x: float, y: float) -> float:
    """On which side of the way from node a to node b the point (x, y) lies: positive on the left."""
    return orient2d(xy[2 * a], xy[2 * a + 1], xy[2 * b], xy[2 * b + 1], x, y)


@njit(cache=True, error_model="numpy")
def _first_triangle(xy: Floats, third: int, rows: Rows) -> int:
    """Triangle of nodes 0, 1 and `third`, and the three between its edges and the far node."""
    b, c = 1, third
    if _side(xy, 0, 1, xy[2 * third], xy[2 * third + 1]) < 0.0:
        b, c = third, 1
    rows[2 * ROW * third : 2 * ROW * third + 3] = FAR
    rows[2 * ROW * third + ROW : 2 * ROW * third + ROW + 3] = FAR
    rows[0], rows[1], rows[2] = 0, b, c
    for k in range(3):
        t, following, preceding = ROW * (k + 1), ROW * ((k + 1) % 3 + 1), ROW * ((k + 2) % 3 + 1)
        rows[t], rows[t + 1], rows[t + 2] = FAR, rows[(k + 2) % 3], rows[(k + 1) % 3]
        rows[t + 4], rows[t + 5], rows[t + 6] = k, preceding + 2, following + 1
        rows[4 + k] = t
    return 0


@njit(cache=True, error_model="numpy", forceinline=True)
def _find(xy: Floats, rows: Rows, t: int, x: float, y: float) -> int:
    """Walk from triangle t to one that holds (x, y), or to one outside of a hull edge that sees it.

    Returns a place in it, or -1 if there is a node at (x, y). In a Delaunay triangulation the walk comes to an end: the
    power of the point with respect to the circumcircles falls from triangle to triangle.
    """
    h = t
    if _side(xy, rows[_after(h)], rows[_before(h)], x, y) < 0.0:
        h = rows[h + 4]
    while rows[h] != FAR:
        # The point is on this side of the edge opposite to h.
        a, b, c = rows[h], rows[_after(h)], rows[_before(h)]
        left, right = _side(xy, c, a, x, y), _side(xy, a, b, x, y)
        if left < 0.0 or right < 0.0:
            h = rows[(_after(h) if left < right else _before(h)) + 4]
            continue
        if left == 0.0 or right == 0.0:
            for k in (a, b, c):
                if xy[2 * k] == x and xy[2 * k + 1] == y:
                    return -1
        break
    return h


@njit(cache=True, error_model="numpy", forceinline=True)
def _dig(xy, rows, h, x, y, stack, rim, start, free):  # type: ignore[no-untyped-def]
    """Find the triangles whose circumcircle holds (x, y), from the one of place h on; returns the edges around them.

    Writes the half-edges outside of the cavity to `rim`, counter-clockwise, where each begins to `start`, and the
    triangles that go to `free`, two fewer.
    """
    # The triangles of a cavity form a tree, as no node lies inside of it: so depth first needs no marks, and meets the
    # edges around it in order.
    t = h & -ROW
    free[0] = t
    stack[0], stack[1], stack[2] = rows[t + 6], rows[t + 5], rows[t + 4]
    gone, size, top = 1, 0, 3
    while top > 0:
        top -= 1
        h = stack[top]
        a, b, c = rows[h], rows[_after(h)], rows[_before(h)]
        if (a | b | c) >= NEAR:
            goes = _sees(xy, a, b, c, x, y)
        else:
            goes = incircle(xy[2 * a], xy[2 * a + 1], xy[2 * b], xy[2 * b + 1], xy[2 * c], xy[2 * c + 1], x, y) > 0.0
        if goes:
            free[gone] = h & -ROW
            gone += 1
            stack[top], stack[top + 1] = rows[_before(h) + 4], rows[_after(h) + 4]
            top += 2
        else:
            rim[size], start[size] = h, c
            size += 1
    return size


@njit(cache=True, error_model="numpy")
def _sees(xy: Floats, a: int, b: int, c: int, x: float, y: float) -> bool:
    """Whether the hull edge of a triangle with the far node can be seen from (x, y), or holds it between its ends."""
    if a == FAR:
        a, b = b, c
    elif b == FAR:
        a, b = c, a
    side = _side(xy, a, b, x, y)
    if side != 0.0:
        return side > 0.0
    ax, ay, bx, by = xy[2 * a], xy[2 * a + 1], xy[2 * b], xy[2 * b + 1]
    return min(ax, bx) < x < max(ax, bx) or min(ay, by) < y < max(ay, by)


@njit(cache=True, error_model="numpy", forceinline=True)
def _fill(rows: Rows, node: int, size: int, rim: Rows, start: Rows, free: Rows) -> int:
    """Fill a cavity with the triangles between a node and the edges around; returns one without the far node."""
    found = 0
    last = free[size - 1]
    free[size], start[size] = free[0], start[0]
    for k in range(size):
        t = free[k]
        rows[t], rows[t + 1], rows[t + 2] = node, start[k], start[k + 1]
        rows[t + 4], rows[t + 5], rows[t + 6] = rim[k], free[k + 1] + 2, last + 1
        rows[rim[k] + 4] = t
        if (start[k] | start[k + 1]) < NEAR:
            found = t
        last = t
    return found
