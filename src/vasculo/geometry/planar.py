"""Faces of a planar graph by half-edges.

For networks that carry no triangulation: coincident nodes become one, crossing edges are split where they cross, edges
that hang loose are taken off, and the faces are the cycles of half-edges that keep turning to the next edge clockwise.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import shapely
from numba import njit
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from vasculo.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Ints = NDArray[np.int32]
    Floats = NDArray[np.float64]

COINCIDENT = 1e-9
"""Nodes closer than this fraction of the graph's extent are one node."""


@dataclass(frozen=True)
class PlanarGraph:
    """A graph whose edges meet at nodes only.

    Attributes
    ----------
    edges : ndarray of int32, shape (m, 2)
        Node pairs; nodes from n on are crossing points of the given edges.
    twin_of : ndarray of int32, shape (n,)
        The node that stands for each given node (coincident nodes share one).
    crossed : ndarray of int32, shape (c, 2)
        End nodes of the given edge on which each crossing point lies.
    share : ndarray of float64, shape (c,)
        Where on that edge it lies: 0 at the first end, 1 at the second.
    """

    edges: Ints
    twin_of: Ints
    crossed: Ints
    share: Floats

    def carry(self, points: Floats) -> Floats:
        """Positions (n + c, 2) of all nodes of this graph for positions (n, 2) of the given nodes."""
        ends = points[self.crossed]
        inner = ends[:, 0] + self.share[:, None] * (ends[:, 1] - ends[:, 0])
        return np.concatenate([points[self.twin_of], inner])


@dataclass(frozen=True)
class PlanarFaces:
    """Faces of a planar graph.

    Attributes
    ----------
    tail, head : ndarray of int32, shape (h,)
        Nodes of each half-edge; half-edges i and i + h/2 are the two directions of one edge.
    face : ndarray of int32, shape (h,)
        Face on the left of each half-edge, numbered in order of first appearance.
    following : ndarray of int32, shape (h,)
        Next half-edge around the same face.
    loose : int
        Edges that were taken off because the same face lay on both sides.
    """

    tail: Ints
    head: Ints
    face: Ints
    following: Ints
    loose: int

    def areas(self, points: Floats) -> Floats:
        """Signed area of each face (model length squared); negative for the outer face of each connected part."""
        x, y = (points - points.mean(axis=0)).T
        cross = x[self.tail] * y[self.head] - x[self.head] * y[self.tail]
        return 0.5 * np.bincount(self.face, weights=cross).astype(np.float64)

    def loops(self, wanted: NDArray[np.bool_]) -> tuple[Ints, NDArray[np.int64], Ints]:
        """Loops of nodes around the wanted faces (f,), end to end, counter-clockwise for inner faces.

        Returns
        -------
        nodes : ndarray of int32, shape (k,)
        start : ndarray of int64, shape (l + 1,)
            Loop i is the rows start[i] to start[i + 1].
        face : ndarray of int32, shape (l,)
            Ascending.
        """
        nodes, start = np.empty(len(self.tail), dtype=np.int32), np.empty(len(wanted) + 1, dtype=np.int64)
        count = _walk(self.tail, self.following, self.face, wanted, nodes, start)
        return nodes[: start[count]], start[: count + 1], np.flatnonzero(wanted).astype(np.int32)


@njit(cache=True, error_model="numpy")
def _walk(tail, following, face, wanted, nodes, start):  # type: ignore[no-untyped-def]
    """Nodes around the wanted faces, each from its first half-edge on; returns how many faces.

    Overwrites nodes (h,) and start (f + 1,) as far as needed. For all others see `PlanarFaces`: faces are numbered in
    order of their first half-edges.
    """
    row, loop, seen = 0, 0, 0
    for begin in range(tail.size):
        if face[begin] != seen:
            continue
        seen += 1
        if not wanted[face[begin]]:
            continue
        start[loop] = row
        loop += 1
        half = begin
        while True:
            nodes[row] = tail[half]
            row += 1
            half = following[half]
            if half == begin:
                break
    start[loop] = row
    return loop


@njit(cache=True, error_model="numpy")
def _number(following, face):  # type: ignore[no-untyped-def]
    """Give the cycles of half-edges numbers in order of first appearance; overwrites face (h,)."""
    face[:] = -1
    count = 0
    for begin in range(following.size):
        half = begin
        while face[half] < 0:
            face[half] = count
            half = following[half]
        if half == begin and face[begin] == count:
            count += 1


def _number_plain(following: Ints, face: Ints) -> None:
    """NumPy twin of `_number`."""
    half = np.arange(len(following))
    face[:] = np.unique(_groups(len(half), np.stack([half, following], axis=1)), return_inverse=True)[1]


def planar_graph(points: Floats, edges: Ints) -> PlanarGraph:
    """Make a graph planar: identify coincident nodes, drop repeated edges, split edges where they cross.

    Parameters
    ----------
    points : ndarray of float64, shape (n, 2)
        Node positions (model length).
    edges : ndarray of int32, shape (m, 2)
        Node pairs.

    Returns
    -------
    PlanarGraph

    Raises
    ------
    InputError
        When there is no edge of any length.
    """
    extent = float(np.ptp(points, axis=0).max()) if len(points) else 0.0
    pairs = KDTree(points).query_pairs(COINCIDENT * extent, output_type="ndarray")
    twin_of = _groups(len(points), pairs)
    single = _unique(twin_of[edges])
    if not len(single):
        raise InputError(f"a graph of {len(points)} nodes and {len(edges)} edges has no edge of any length")
    lines = shapely.linestrings(points[single])
    first, second = shapely.STRtree(lines).query(lines, predicate="crosses")
    once = first < second
    first, second = first[once], second[once]
    order = np.lexsort((second, first))
    first, second = first[order], second[order]
    a, b = points[single[first, 0]], points[single[second, 0]]
    u, v = points[single[first, 1]] - a, points[single[second, 1]] - b
    denominator = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    offset = b - a
    on_first = (offset[:, 0] * v[:, 1] - offset[:, 1] * v[:, 0]) / denominator
    on_second = (offset[:, 0] * u[:, 1] - offset[:, 1] * u[:, 0]) / denominator
    # Strategy: list the nodes on every edge in order of their place on it, then join neighbours in the list.
    count, crossings = len(single), len(first)
    names = np.arange(len(points), len(points) + crossings)
    owner = np.concatenate([np.arange(count), np.arange(count), first, second])
    place = np.concatenate([np.zeros(count), np.ones(count), on_first, on_second])
    node = np.concatenate([single[:, 0], single[:, 1], names, names])
    order = np.lexsort((place, owner))
    owner, node = owner[order], node[order]
    joined = owner[1:] == owner[:-1]
    pieces = _unique(np.stack([node[:-1][joined], node[1:][joined]], axis=1))
    return PlanarGraph(pieces, twin_of, single[first], on_first)


def planar_faces(points: Floats, edges: Ints) -> PlanarFaces:
    """Find the faces of a planar graph; edges with the same face on both sides are taken off first.

    Parameters
    ----------
    points : ndarray of float64, shape (n, 2)
        Node positions (model length).
    edges : ndarray of int32, shape (m, 2)
        Node pairs without repetition, of positive length, meeting at nodes only (see `planar_graph`).

    Returns
    -------
    PlanarFaces
    """
    whole = _trace(points, edges)
    half = len(edges)
    kept = whole.face[:half] != whole.face[half:]
    firm = _trace(points, edges[kept]) if not kept.all() else whole
    return PlanarFaces(firm.tail, firm.head, firm.face, firm.following, int(half - kept.sum()))


def _trace(points: Floats, edges: Ints) -> PlanarFaces:
    """Faces by turning at every node to the next edge clockwise, so that the face stays on the left."""
    half = len(edges)
    tail = np.concatenate([edges[:, 0], edges[:, 1]]).astype(np.int32)
    head = np.concatenate([edges[:, 1], edges[:, 0]]).astype(np.int32)
    step = points[head] - points[tail]
    order = np.lexsort((np.arctan2(step[:, 1], step[:, 0]), tail))
    place = np.empty(2 * half, dtype=np.int64)
    place[order] = np.arange(2 * half)
    start = np.searchsorted(tail[order], np.arange(len(points) + 1))
    twin = np.concatenate([np.arange(half, 2 * half), np.arange(half)])
    before = place[twin] - 1
    first_here = before < start[head]
    before[first_here] = start[head[first_here] + 1] - 1
    following = order[before].astype(np.int32)
    face = np.empty(2 * half, dtype=np.int32)
    _number(following, face)
    return PlanarFaces(tail, head, face, following, 0)


def _unique(edges: NDArray[np.integer]) -> Ints:
    """Edges each once, lower node first, without those that join a node to itself."""
    ordered = np.sort(edges.reshape(-1, 2), axis=1)
    return np.unique(ordered[ordered[:, 0] != ordered[:, 1]], axis=0).astype(np.int32)


def _groups(count: int, pairs: NDArray[np.integer]) -> Ints:
    """Smallest member of the connected group of each item."""
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(count, count))
    _, labels = connected_components(graph, directed=False)
    _, first = np.unique(labels, return_index=True)
    return first[labels].astype(np.int32)
