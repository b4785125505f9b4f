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
    Flags = NDArray[np.bool_]

VOID_CUTOFF = 10.0
"""A face is a void when its area exceeds this many mean initial triangles (dimensionless, ours)."""


@dataclass(frozen=True)
class InteriorEdges:
    """The interior edges of a triangulation, sorted by lower and then higher node: what `faces` needs, made once.

    Half-edge 3 t + k runs from corner k of triangle t to its next corner.

    Attributes
    ----------
    start : ndarray of int32, shape (n + 1,)
        Edges whose lower node is i are the rows start[i] to start[i + 1].
    high : ndarray of int32, shape (e,)
        Higher node of each edge.
    first, second : ndarray of int32, shape (e,)
        The two half-edges of each edge, the smaller first.
    """

    start: Ints
    high: Ints
    first: Ints
    second: Ints


@njit(cache=True, error_model="numpy")
def _edges(triangles, nodes):  # type: ignore[no-untyped-def]
    """Tables as in `InteriorEdges`, of all edges; the second half-edge is -1 where there is none, -2 with a third one.

    Strategy: sort the half-edges into one row a lower node by counting, and each short row by insertion, so that the
    half-edges of one edge lie side by side, the smaller first.
    """
    corners = triangles.ravel()
    count = corners.size
    start = np.zeros(nodes + 1, dtype=np.int32)
    for half in range(count):
        start[min(corners[half], corners[half + 1 if half % 3 < 2 else half - 2]) + 1] += 1
    for node in range(nodes):
        start[node + 1] += start[node]
    place = start[:-1].copy()
    tops, halves = np.empty(count, dtype=np.int32), np.empty(count, dtype=np.int32)
    for half in range(count):
        tail, head = corners[half], corners[half + 1 if half % 3 < 2 else half - 2]
        low, top = min(tail, head), max(tail, head)
        row = place[low]
        place[low] += 1
        while row > start[low] and tops[row - 1] > top:
            tops[row], halves[row] = tops[row - 1], halves[row - 1]
            row -= 1
        tops[row], halves[row] = top, half
    edge, first_row = -1, 0
    second = np.empty(count, dtype=np.int32)
    for node in range(nodes):
        last_row, start[node] = start[node + 1], edge + 1
        for row in range(first_row, last_row):
            if row == first_row or tops[row] != tops[edge]:
                edge += 1
                tops[edge], halves[edge], second[edge] = tops[row], halves[row], -1
            else:
                second[edge] = halves[row] if second[edge] == -1 else -2
        first_row = last_row
    start[nodes] = edge + 1
    return start, tops[: edge + 1], halves[: edge + 1], second[: edge + 1]


def _edges_plain(triangles: Ints, nodes: int) -> tuple[Ints, Ints, Ints, Ints]:
    """NumPy twin of `_edges`."""
    tails, heads = triangles.ravel().astype(np.int64), triangles[:, (1, 2, 0)].ravel().astype(np.int64)
    keys = np.minimum(tails, heads) * nodes + np.maximum(tails, heads)
    order = np.argsort(keys, kind="stable")
    edge, row, uses = np.unique(keys[order], return_index=True, return_counts=True)
    other = order[np.minimum(row + 1, len(order) - 1)]
    second = np.where(uses == 1, -1, np.where(uses == 2, other, -2))
    start = np.searchsorted(edge // nodes, np.arange(nodes + 1))
    tables = start, edge % nodes, order[row], second
    return tuple(table.astype(np.int32) for table in tables)  # type: ignore[return-value]


def triangle_edges(triangles: Ints, nodes: int) -> Ints:
    """Edges (e, 2) of triangles (t, 3), each once, the lower node first, in order."""
    start, high, _, _ = _edges(np.ascontiguousarray(triangles, dtype=np.int32), nodes)
    return np.stack([_lows(start), high], axis=1)


def interior_edges(triangles: Ints, nodes: int) -> InteriorEdges:
    """Find the interior edges of a triangulation and the two half-edges of each.

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
    return all_edges(triangles, nodes)[0]


def all_edges(triangles: Ints, nodes: int) -> tuple[InteriorEdges, Ints]:
    """Interior edges and, as node pairs (e, 2), all edges of a triangulation; see both functions of these names."""
    corners = np.asarray(triangles).reshape(-1, 3)
    if corners.size and (corners.min() < 0 or corners.max() >= nodes):
        raise InputError(f"triangles name nodes {corners.min()} to {corners.max()}, but there are {nodes} nodes")
    start, high, first, second = _edges(np.ascontiguousarray(corners, dtype=np.int32), nodes)
    low = _lows(start)
    if second.min(initial=0) < -1:
        edge = int(np.argmin(second))
        raise InputError(f"the edge between nodes {low[edge]} and {high[edge]} belongs to three triangles or more")
    inner = second >= 0
    start = np.concatenate([[0], np.cumsum(inner)])[start].astype(np.int32)
    return InteriorEdges(start, high[inner], first[inner], second[inner]), np.stack([low, high], axis=1)


def _lows(start: Ints) -> Ints:
    """Lower node of each edge of a table."""
    return np.repeat(np.arange(len(start) - 1, dtype=np.int32), np.diff(start))


@njit(cache=True, error_model="numpy")
def _mark(start, high, springs, intact):  # type: ignore[no-untyped-def]
    """Mark the edges that carry a spring; overwrites intact (e,), which starts as zero."""
    for row in range(springs.shape[0]):
        low, top = min(springs[row, 0], springs[row, 1]), max(springs[row, 0], springs[row, 1])
        for edge in range(start[low], start[low + 1]):
            if high[edge] == top:
                intact[edge] = True


def _mark_plain(start: Ints, high: Ints, springs: NDArray[np.integer], intact: Flags) -> None:
    """NumPy twin of `_mark`."""
    nodes = np.int64(start.size - 1)
    living = springs.min(axis=1).astype(np.int64) * nodes + springs.max(axis=1)
    intact[:] = np.isin(_lows(start) * nodes + high, living)


@njit(cache=True, error_model="numpy")
def join(one, two, apart, labels):  # type: ignore[no-untyped-def]
    """Give numbers to the groups that pairs make of items; returns how many.

    Overwrites labels (k,) with the group of each item, 0, 1, ... in order of first appearance.

    Parameters
    ----------
    one, two : ndarray of int32, shape (p,)
        Pairs of items.
    apart : ndarray of bool, shape (p,)
        Pairs that join nothing.
    labels : ndarray of int32, shape (k,)

    Strategy: union-find with the smaller root on top, then number the roots.
    """
    for item in range(labels.size):
        labels[item] = item
    for pair in range(one.size):
        if not apart[pair]:
            a, b = one[pair], two[pair]
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
    for item in range(labels.size):
        if labels[item] == item:
            labels[item] = count
            count += 1
        else:
            labels[item] = labels[labels[item]]
    return count


def join_plain(one: Ints, two: Ints, apart: Flags, labels: Ints) -> int:
    """NumPy and SciPy twin of `join`."""
    pairs = one[~apart], two[~apart]
    graph = coo_array((np.ones(len(pairs[0])), pairs), shape=(labels.size, labels.size))
    count, groups = connected_components(graph, directed=False)
    _, appearance = np.unique(groups, return_index=True)
    rank = np.empty(count, dtype=np.int32)
    rank[np.argsort(appearance)] = np.arange(count, dtype=np.int32)
    labels[:] = rank[groups]
    return int(count)


def intact_edges(edges: InteriorEdges, springs: NDArray[np.integer]) -> Flags:
    """Whether each interior edge (e,) carries one of the living springs (m, 2), which come in any order."""
    intact = np.zeros(len(edges.high), dtype=np.bool_)
    _mark(edges.start, edges.high, np.ascontiguousarray(springs, dtype=np.int32).reshape(-1, 2), intact)
    return intact


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
    return joined(table, intact_edges(table, springs), len(triangles))


def joined(edges: InteriorEdges, intact: Flags, triangles: int) -> Ints:
    """Face of each triangle, as `faces`, from the interior edges (e,) that are intact."""
    labels = np.empty(triangles, dtype=np.int32)
    join(edges.first // 3, edges.second // 3, intact, labels)
    return labels


@njit(cache=True, error_model="numpy")
def _signed_areas(triangles, points, reference, box, areas):  # type: ignore[no-untyped-def]
    """Signed areas of triangles; overwrites areas (t,). As `triangle_areas`, with infinite periods for no box."""
    for t in range(triangles.shape[0]):
        a, b, c = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        bx, by = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]
        cx, cy = points[c, 0] - points[a, 0], points[c, 1] - points[a, 1]
        if np.isfinite(box[0]):
            bx -= np.rint((reference[b, 0] - reference[a, 0]) / box[0]) * box[0]
            cx -= np.rint((reference[c, 0] - reference[a, 0]) / box[0]) * box[0]
        if np.isfinite(box[1]):
            by -= np.rint((reference[b, 1] - reference[a, 1]) / box[1]) * box[1]
            cy -= np.rint((reference[c, 1] - reference[a, 1]) / box[1]) * box[1]
        areas[t] = 0.5 * (bx * cy - cx * by)


def _signed_areas_plain(triangles: Ints, points: Floats, reference: Floats, box: Floats, areas: Floats) -> None:
    """NumPy twin of `_signed_areas`."""
    a, b, c = triangles.T
    one, two = arms_between(points, a, b, reference, box), arms_between(points, a, c, reference, box)
    areas[:] = 0.5 * (one[:, 0] * two[:, 1] - two[:, 0] * one[:, 1])


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
    period = np.full(2, np.inf) if box is None or reference is None else np.asarray(box, dtype=np.float64)
    areas = np.empty(len(triangles))
    corners = np.ascontiguousarray(triangles, dtype=np.int32)
    _signed_areas(corners, points, points if reference is None else reference, period, areas)
    return areas


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
