"""Edge flips, and the Delaunay property restored by them (Lawson 1977)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from vasculo.geometry.predicates import incircle

if TYPE_CHECKING:
    from vasculo.geometry.arrays import Flags, Floats, Ints
    from vasculo.mesh.draft import Draft


def retriangulate(draft: Draft) -> None:
    """Make the triangles of a draft Delaunay again by flips, the walls kept; overwrites them."""
    dirty = np.ones(len(draft.triangles), dtype=np.bool_)
    restore_delaunay(draft.points, draft.triangles, draft.neighbours, dirty)


@njit(cache=True, error_model="numpy")
def around(triangles: Ints, neighbours: Ints, t: int, i: int) -> tuple[int, int, int, int, int, int]:
    """Triangle u across the edge opposite to corner i of t, its corner j opposite to that edge, and the four nodes.

    Returns u, j, p, a, b, q: t is (p, a, b) and u is (q, b, a).
    """
    u = neighbours[t, i]
    j = 0
    while neighbours[u, j] != t:
        j += 1
    return u, j, triangles[t, i], triangles[t, (i + 1) % 3], triangles[t, (i + 2) % 3], triangles[u, j]


@njit(cache=True, error_model="numpy")
def flip(triangles: Ints, neighbours: Ints, t: int, i: int) -> None:
    """Replace the edge opposite to corner i of triangle t by the other diagonal; overwrites both triangles.

    Afterwards t = (p, a, q) and its neighbour u = (p, q, b), where p is corner i of t, (a, b) the old edge, q opposite.
    """
    u, j, p, a, b, q = around(triangles, neighbours, t, i)
    across_bp = neighbours[t, (i + 1) % 3]
    across_pa = neighbours[t, (i + 2) % 3]
    across_aq = neighbours[u, (j + 1) % 3]
    across_qb = neighbours[u, (j + 2) % 3]
    triangles[t, 0], triangles[t, 1], triangles[t, 2] = p, a, q
    triangles[u, 0], triangles[u, 1], triangles[u, 2] = p, q, b
    neighbours[t, 0], neighbours[t, 1], neighbours[t, 2] = across_aq, u, across_pa
    neighbours[u, 0], neighbours[u, 1], neighbours[u, 2] = across_qb, across_bp, t
    if across_aq >= 0:
        for k in range(3):
            if neighbours[across_aq, k] == u:
                neighbours[across_aq, k] = t
    if across_bp >= 0:
        for k in range(3):
            if neighbours[across_bp, k] == t:
                neighbours[across_bp, k] = u


@njit(cache=True, error_model="numpy")
def restore_delaunay(points: Floats, triangles: Ints, neighbours: Ints, dirty: Flags) -> int:
    """Flip edges until none has a node inside the circumcircle of the triangle on its other side, walls excepted.

    Parameters
    ----------
    points : (n, 2) float64, model length
    triangles, neighbours : (t, 3) int32
        Counter-clockwise corners with a positive area, which they keep; triangle across the edge opposite to each
        corner, negative at the walls. Overwritten.
    dirty : (t,) bool
        The triangles to look at; all others must be Delaunay with each other. All False afterwards.

    Returns
    -------
    int
        Number of flips.

    Notes
    -----
    Lawson 1977. Each flip lowers the surface over the triangles whose nodes have the height x^2 + y^2, and the test is
    exact, so no triangulation comes back and the flips come to an end.
    """
    # Strategy: a stack of dirty triangles, started anew from each one in turn. An edge between two of them is tested by
    # the one that comes last, so only once.
    stack = np.empty(len(triangles), dtype=np.int32)
    flips = 0
    for start in range(len(triangles)):
        if not dirty[start]:
            continue
        stack[0] = start
        top = 1
        while top > 0:
            top -= 1
            t = stack[top]
            dirty[t] = False
            for i in range(3):
                if neighbours[t, i] < 0 or dirty[neighbours[t, i]]:
                    continue
                u, _, p, a, b, q = around(triangles, neighbours, t, i)
                inside = incircle(
                    points[p, 0], points[p, 1], points[a, 0], points[a, 1], points[b, 0], points[b, 1],
                    points[q, 0], points[q, 1],
                )  # fmt: skip
                if inside > 0.0:
                    flip(triangles, neighbours, t, i)
                    flips += 1
                    dirty[t] = dirty[u] = True
                    stack[top], stack[top + 1] = u, t
                    top += 2
                    break
    return flips
