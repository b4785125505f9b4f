"""The triangles to the left of walls, by topology alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from vasculo.mesh.triangulate.flips import around
from vasculo.mesh.triangulate.walls import find_edge

if TYPE_CHECKING:
    from vasculo.geometry.arrays import Flags, Ints

CUT = -2
"""Neighbour across a wall; -1 outside of the hull."""

OPEN, TWICE, OUTSIDE, BOTH = 1, 2, 3, 4
"""What may be wrong: the fluid reaches the hull; two walls between the same nodes; nothing to the left of a wall; fluid
on both sides of a wall."""


@njit(cache=True, error_model="numpy")
def keep_left(triangles: Ints, neighbours: Ints, edges: Ints, at: Ints, kept: Flags) -> tuple[int, int, int]:
    """Mark the triangles to the left of walls, and part them from the others.

    Parameters
    ----------
    triangles, neighbours : (t, 3) int32
        A triangulation that has all the walls. Neighbours across walls become `CUT` on both sides.
    edges : (e, 2) int32
        Walls.
    at : (n,) int32
        A triangle of each node.
    kept : (t,) bool
        All False at entry; overwritten.

    Returns
    -------
    tuple of int
        What is wrong, 0 if nothing, and the edge where.
    """
    # Strategy: cut at the walls, remembering which triangles lie to their right; then flood from those to their left.
    beyond = np.full(len(edges), -1, dtype=np.int32)
    stack = np.empty(len(triangles), dtype=np.int32)
    place = np.empty(len(edges), dtype=np.int32)
    for w in range(len(edges)):
        place[w] = find_edge(triangles, neighbours, at[edges[w, 0]], edges[w, 0], edges[w, 1])
        if place[w] < 0:
            return OUTSIDE, edges[w, 0], edges[w, 1]
    top = 0
    for w in range(len(edges)):
        t, i = place[w] // 3, place[w] % 3
        if neighbours[t, i] == CUT:
            return TWICE, edges[w, 0], edges[w, 1]
        if neighbours[t, i] >= 0:
            u, j, _, _, _, _ = around(triangles, neighbours, t, i)
            beyond[w] = u
            neighbours[u, j] = CUT
        neighbours[t, i] = CUT
        if not kept[t]:
            kept[t] = True
            stack[top] = t
            top += 1
    while top > 0:
        top -= 1
        t = stack[top]
        for i in range(3):
            u = neighbours[t, i]
            if u == -1:
                return OPEN, triangles[t, (i + 1) % 3], triangles[t, (i + 2) % 3]
            if u >= 0 and not kept[u]:
                kept[u] = True
                stack[top] = u
                top += 1
    for w in range(len(edges)):
        if beyond[w] >= 0 and kept[beyond[w]]:
            return BOTH, edges[w, 0], edges[w, 1]
    return 0, -1, -1


@njit(cache=True, error_model="numpy")
def pick(triangles: Ints, neighbours: Ints, kept: Flags, dirty: Flags) -> tuple[Ints, Ints, Flags]:
    """Kept triangles in their order, their neighbours, -1 where there is none, and which of them are dirty."""
    number = np.empty(len(triangles), dtype=np.int32)
    count = 0
    for t in range(len(triangles)):
        number[t] = -1
        if kept[t]:
            number[t] = count
            count += 1
    corners, beside = np.empty((count, 3), dtype=np.int32), np.empty((count, 3), dtype=np.int32)
    marked = np.empty(count, dtype=np.bool_)
    for t in range(len(triangles)):
        i = number[t]
        if i >= 0:
            marked[i] = dirty[t]
            for k in range(3):
                corners[i, k] = triangles[t, k]
                beside[i, k] = number[neighbours[t, k]] if neighbours[t, k] >= 0 else -1
    return corners, beside, marked
