"""Which triangles share an edge, and whether a list of triangles is a conforming mesh."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from vasculo.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.geometry.arrays import Ints


def adjacency(triangles: NDArray[np.int32], nodes: int) -> NDArray[np.int32]:
    """Triangle across the edge opposite to each corner.

    Parameters
    ----------
    triangles : (t, 3) int32
        Corners, consistently oriented.
    nodes : int
        Number of nodes.

    Returns
    -------
    (t, 3) int32
        -1 where an edge has one triangle only.

    Raises
    ------
    InputError
        An edge is used twice in the same direction: triangles overlap or are oriented differently.
    """
    corners = np.ascontiguousarray(triangles, dtype=np.int32)
    neighbours = np.empty(corners.shape, dtype=np.int32)
    twice = join_edges(corners, *stars(corners, nodes), neighbours)
    if twice >= 0:
        t, k = divmod(twice, 3)
        start, end = corners[t, (k + 1) % 3], corners[t, (k + 2) % 3]
        raise InputError(f"edge {start}-{end} is used twice in the same direction: triangles overlap there")
    return neighbours


def stars(triangles: NDArray[np.int32], nodes: int) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Corners around each node: star[first[i]:first[i + 1]] holds 3 t + corner for the triangles t of node i."""
    first, star = np.zeros(nodes + 1, dtype=np.int32), np.empty(triangles.size, dtype=np.int32)
    list_corners(np.ascontiguousarray(triangles), first, star)
    return first, star


def adjacency_plain(triangles: NDArray[np.int32]) -> NDArray[np.int32]:
    """Plain twin of `adjacency`, for triangles that conform."""
    owner = {(int(row[(k + 1) % 3]), int(row[(k + 2) % 3])): t for t, row in enumerate(triangles) for k in range(3)}
    across = [[owner.get((int(row[(k + 2) % 3]), int(row[(k + 1) % 3])), -1) for k in range(3)] for row in triangles]
    return np.array(across, dtype=np.int32).reshape(-1, 3)


@njit(cache=True, error_model="numpy")
def list_corners(triangles: Ints, first: Ints, star: Ints) -> None:
    """Sort the corners by their nodes, by counting; `first` is given as zeros."""
    for t in range(len(triangles)):
        for k in range(3):
            first[triangles[t, k] + 1] += 1
    for i in range(1, len(first)):
        first[i] += first[i - 1]
    for t in range(len(triangles)):
        for k in range(3):
            i = triangles[t, k]
            star[first[i]] = 3 * t + k
            first[i] += 1
    for i in range(len(first) - 1, 0, -1):
        first[i] = first[i - 1]
    first[0] = 0


@njit(cache=True, error_model="numpy")
def join_edges(triangles: Ints, first: Ints, star: Ints, neighbours: Ints) -> int:
    """Fill `neighbours`; returns an edge that is used twice in one direction as 3 t + corner, or -1.

    `first` and `star` come from `stars`.
    """
    for t in range(len(triangles)):
        for k in range(3):
            start = triangles[t, k + 1 if k < 2 else 0]
            end = triangles[t, k - 1 if k > 0 else 2]
            for s in range(first[start], first[start + 1]):
                other = star[s] // 3
                c = star[s] - 3 * other
                if other != t and triangles[other, c + 1 if c < 2 else 0] == end:
                    return 3 * t + k
            neighbours[t, k] = -1
            for s in range(first[end], first[end + 1]):
                other = star[s] // 3
                c = star[s] - 3 * other
                if triangles[other, c + 1 if c < 2 else 0] == start:
                    neighbours[t, k] = other
    return -1


@njit(cache=True, error_model="numpy")
def first_fault(triangles: Ints, neighbours: Ints) -> int:
    """First edge, as 3 t + corner, whose neighbour does not have the same edge backwards and point back; or -1."""
    for t in range(len(triangles)):
        for k in range(3):
            u = neighbours[t, k]
            if u < 0:
                continue
            if u >= len(triangles) or u == t:
                return 3 * t + k
            back = False
            for j in range(3):
                if (
                    neighbours[u, j] == t
                    and triangles[u, j + 1 if j < 2 else 0] == triangles[t, k - 1 if k > 0 else 2]
                    and triangles[u, j - 1 if j > 0 else 2] == triangles[t, k + 1 if k < 2 else 0]
                ):
                    back = True
            if not back:
                return 3 * t + k
    return -1


@njit(cache=True, error_model="numpy")
def list_faces(triangles: Ints, neighbours: Ints, ends: Ints, beside: Ints) -> int:
    """List each inner edge once, from its lower triangle, which lies on the left; returns their number."""
    count = 0
    for t in range(len(triangles)):
        for k in range(3):
            if neighbours[t, k] > t:
                ends[count, 0] = triangles[t, k + 1 if k < 2 else 0]
                ends[count, 1] = triangles[t, k - 1 if k > 0 else 2]
                beside[count, 0] = t
                beside[count, 1] = neighbours[t, k]
                count += 1
    return count


@njit(cache=True, error_model="numpy")
def match_rim(triangles: Ints, neighbours: Ints, edges: Ints, first: Ints, after: Ints, owner: Ints) -> int:
    """Find the triangle of each boundary edge, into `owner`; returns 0 when they are exactly the edges of one triangle.

    `first` (n,), given as -1, and `after` (b,) are buffers: chains of the given edges by their start node.
    """
    for e in range(len(edges)):
        after[e] = first[edges[e, 0]]
        first[edges[e, 0]] = e
        owner[e] = -1
    for t in range(len(triangles)):
        for k in range(3):
            if neighbours[t, k] >= 0:
                continue
            end = triangles[t, k - 1 if k > 0 else 2]
            e = first[triangles[t, k + 1 if k < 2 else 0]]
            while e >= 0 and (edges[e, 1] != end or owner[e] >= 0):
                e = after[e]
            if e < 0:
                return 1
            owner[e] = t
    for e in range(len(edges)):
        if owner[e] < 0:
            return 1
    return 0
