"""Voids of a broken network: connected faces, read from the undeformed triangulation.

A ruptured interior edge joins the two triangles beside it. The connected groups of triangles are the faces of the
network, and a face that has opened beyond ten initial triangles is a void, the place of a tissue pillar. No geometry
enters the topology, so springs of zero length, coincident nodes and folded triangles cannot disturb it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numba import njit
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from vasculo.errors import InputError
from vasculo.springs.box import arms_between

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.springs.network import SpringNetwork

    Ints = NDArray[np.int32]
    Floats = NDArray[np.float64]

VOID_CUTOFF = 10.0
"""A face is a void when its area exceeds this many mean initial triangles (dimensionless, ours)."""


@dataclass(frozen=True)
class InteriorEdges:
    """The interior edges of a triangulation, sorted by their lower node: what `faces` needs, made once.

    Attributes
    ----------
    start : ndarray of int32, shape (n + 1,)
        Edges whose lower node is i are the rows start[i] to start[i + 1].
    high : ndarray of int32, shape (e,)
        Higher node of each edge.
    first, second : ndarray of int32, shape (e,)
        The two triangles beside each edge.
    """

    start: Ints
    high: Ints
    first: Ints
    second: Ints


def triangle_edges(triangles: Ints, nodes: int) -> Ints:
    """Edges (e, 2) of triangles (t, 3), each once, the lower node first, in order."""
    pairs = triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    keys = np.sort(pairs.min(axis=1).astype(np.int64) * nodes + pairs.max(axis=1))
    keys = keys[np.append(True, keys[1:] != keys[:-1])]  # np.unique is several times slower here
    return np.stack([keys // nodes, keys % nodes], axis=1).astype(np.int32)


def interior_edges(triangles: Ints, nodes: int) -> InteriorEdges:
    """Find the interior edges of a triangulation and the two triangles beside each.

    Parameters
    ----------
    triangles : ndarray of int32, shape (t, 3)
        Node indices of each triangle.
    nodes : int
        Number of nodes.

    Returns
    -------
    InteriorEdges
        Edges with one triangle only (the frame) are left out.

    Raises
    ------
    InputError
        When an edge belongs to more than two triangles, or a triangle names a node that does not exist.
    """
    corners = np.asarray(triangles, dtype=np.int64).reshape(-1, 3)
    if corners.size and (corners.min() < 0 or corners.max() >= nodes):
        raise InputError(f"triangles name nodes {corners.min()} to {corners.max()}, but there are {nodes} nodes")
    tails = corners.ravel()
    heads = corners[:, (1, 2, 0)].ravel()
    keys = np.minimum(tails, heads) * nodes + np.maximum(tails, heads)
    order = np.argsort(keys, kind="stable")
    keys = keys[order]
    owners = (order // 3).astype(np.int32)
    same = keys[1:] == keys[:-1]
    if np.any(same[1:] & same[:-1]):
        edge = int(keys[1:-1][same[1:] & same[:-1]][0])
        raise InputError(
            f"the edge between nodes {edge // nodes} and {edge % nodes} belongs to three triangles or more"
        )
    rows = np.flatnonzero(same)
    start = np.searchsorted(keys[rows] // nodes, np.arange(nodes + 1)).astype(np.int32)
    return InteriorEdges(start, (keys[rows] % nodes).astype(np.int32), owners[rows], owners[rows + 1])


@njit(cache=True, error_model="numpy")
def _join(start, high, first, second, springs, labels):  # type: ignore[no-untyped-def]
    """Label triangles by the face they belong to; overwrites labels with 0, 1, ... in order of first appearance.

    Strategy: mark the edges that carry a living spring (a short scan among the edges of the lower node), join the
    two triangles of every unmarked edge by union-find with the smaller root on top, then number the roots.
    """
    intact = np.zeros(high.size, dtype=np.uint8)
    for row in range(springs.shape[0]):
        low, top = min(springs[row, 0], springs[row, 1]), max(springs[row, 0], springs[row, 1])
        for edge in range(start[low], start[low + 1]):
            if high[edge] == top:
                intact[edge] = 1
    for triangle in range(labels.size):
        labels[triangle] = triangle
    for edge in range(high.size):
        if intact[edge] == 0:
            a, b = first[edge], second[edge]
            while labels[a] != a:
                labels[a] = labels[labels[a]]
                a = labels[a]
            while labels[b] != b:
                labels[b] = labels[labels[b]]
                b = labels[b]
            if a < b:
                labels[b] = a
            else:
                labels[a] = b
    # A parent is never larger than its child, so every parent is already numbered when its child is reached.
    count = 0
    for triangle in range(labels.size):
        if labels[triangle] == triangle:
            labels[triangle] = count
            count += 1
        else:
            labels[triangle] = labels[labels[triangle]]
    return count


def _join_plain(start: Ints, high: Ints, first: Ints, second: Ints, springs: NDArray[np.integer], labels: Ints) -> int:
    """NumPy and SciPy twin of `_join`."""
    nodes = np.int64(start.size - 1)
    low = np.repeat(np.arange(nodes), np.diff(start))
    living = springs.min(axis=1).astype(np.int64) * nodes + springs.max(axis=1)
    broken = ~np.isin(low * nodes + high, living)
    graph = coo_array((np.ones(int(broken.sum())), (first[broken], second[broken])), shape=(labels.size, labels.size))
    count, groups = connected_components(graph, directed=False)
    _, appearance = np.unique(groups, return_index=True)
    rank = np.empty(count, dtype=np.int32)
    rank[np.argsort(appearance)] = np.arange(count, dtype=np.int32)
    labels[:] = rank[groups]
    return int(count)


def faces(triangles: Ints, springs: Ints, nodes: int, edges: InteriorEdges | None = None) -> Ints:
    """Label the triangles by face: triangles joined across ruptured interior edges share a label.

    Parameters
    ----------
    triangles : ndarray of int32, shape (t, 3)
        The initial triangulation.
    springs : ndarray of int32, shape (m, 2)
        Living springs, in any order and direction. Springs that are no triangle edge are ignored.
    nodes : int
        Number of nodes.
    edges : InteriorEdges, optional
        Result of `interior_edges` for the same triangulation, to save its cost on repeated calls.

    Returns
    -------
    labels : ndarray of int32, shape (t,)
        Face of each triangle, 0 ... f - 1 in order of first appearance.
    """
    table = interior_edges(triangles, nodes) if edges is None else edges
    labels = np.empty(len(triangles), dtype=np.int32)
    living = np.ascontiguousarray(springs, dtype=np.int32).reshape(-1, 2)
    _join(table.start, table.high, table.first, table.second, living, labels)
    return labels


def triangle_areas(
    triangles: Ints, points: Floats, reference: Floats | None = None, box: Floats | None = None
) -> Floats:
    """Signed areas of triangles, positive when counter-clockwise (model length squared).

    Parameters
    ----------
    triangles : ndarray of int32, shape (t, 3)
        Node indices.
    points : ndarray of float64, shape (n, 2)
        Node positions (model length).
    reference : ndarray of float64, shape (n, 2), optional
        Initial positions, needed with a box.
    box : ndarray of float64, shape (2,), optional
        Periods in x and y of a periodic network; an edge then runs to the image that `vasculo.springs.box` tells.

    Returns
    -------
    ndarray of float64, shape (t,)
    """
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    x, y = np.ascontiguousarray(points[:, 0]), np.ascontiguousarray(points[:, 1])
    xa, ya = x[a], y[a]
    if box is None or reference is None:
        return np.asarray(0.5 * ((x[b] - xa) * (y[c] - ya) - (x[c] - xa) * (y[b] - ya)))
    one, two = arms_between(points, a, b, reference, box), arms_between(points, a, c, reference, box)
    return np.asarray(0.5 * (one[:, 0] * two[:, 1] - two[:, 0] * one[:, 1]))


def face_areas(
    labels: Ints, triangles: Ints, points: Floats, reference: Floats | None = None, box: Floats | None = None
) -> Floats:
    """Area of each face, as the sum of the signed areas of its triangles.

    Triangles that fold over inside a void count negative, so the sum stays the area inside the face's outline.

    Parameters
    ----------
    labels : ndarray of int32, shape (t,)
        Face of each triangle.
    triangles : ndarray of int32, shape (t, 3)
        Node indices, counter-clockwise in the undeformed state.
    points : ndarray of float64, shape (n, 2)
        Node positions (model length).
    reference, box : ndarray of float64, shapes (n, 2) and (2,), optional
        For a periodic network, see `triangle_areas`.

    Returns
    -------
    areas : ndarray of float64, shape (f,)
        Model length squared.
    """
    return np.bincount(labels, weights=triangle_areas(triangles, points, reference, box)).astype(np.float64)


def mean_triangle_area(triangles: Ints, reference: Floats, box: Floats | None = None) -> float:
    """Mean area A0 of the initial triangles (model length squared), from the initial positions (n, 2)."""
    return float(np.mean(np.abs(triangle_areas(triangles, reference, reference, box))))


def void_fraction(
    network: SpringNetwork, edges: InteriorEdges | None = None, unit: float | None = None
) -> tuple[float, int]:
    """Share of the domain covered by voids, and their number.

    A void is a face whose deformed area exceeds ten mean initial triangles (our reading; the paper gives no number).

    Parameters
    ----------
    network : SpringNetwork
        A network with its initial triangulation, in a frame or periodic.
    edges : InteriorEdges, optional
        `interior_edges(network.triangles, len(network.points))`, for repeated calls.
    unit : float, optional
        `mean_triangle_area` of the network, for repeated calls (model length squared).

    Returns
    -------
    fraction : float
        Summed void area over the area of the triangulated domain, dimensionless.
    voids : int
        Number of voids.

    Raises
    ------
    InputError
        When the network has no triangulation.
    """
    if network.triangles is None:
        raise InputError(f"a network of {len(network.points)} nodes without triangles has no faces to measure")
    labels = faces(network.triangles, network.springs, len(network.points), edges)
    box = network.box
    areas = face_areas(labels, network.triangles, network.points, network.reference, box)
    if unit is None:
        unit = mean_triangle_area(network.triangles, network.reference, box)
    voids = areas > VOID_CUTOFF * unit
    return float(areas[voids].sum() / areas.sum()), int(np.count_nonzero(voids))
