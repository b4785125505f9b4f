"""Outlines of voids: node loops from the triangulation, and polygons that are valid whatever the nodes do."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import shapely
from numba import njit

from vasculo.springs.box import image_offsets

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.plexus.voids import InteriorEdges

    Ints = NDArray[np.int32]
    Floats = NDArray[np.float64]
    Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class Loops:
    """Closed loops of nodes around faces, end to end.

    Attributes
    ----------
    nodes : ndarray of int32, shape (k,)
        Nodes in order, the face on the left.
    start : ndarray of int64, shape (l + 1,)
        Loop i is the rows start[i] to start[i + 1].
    face : ndarray of int32, shape (l,)
        The face of each loop, ascending.
    """

    nodes: Ints
    start: NDArray[np.int64]
    face: Ints

    def of(self, face: int) -> list[Ints]:
        """Loops of one face, each a list of nodes; the outer loop is the counter-clockwise one."""
        mine = range(*np.searchsorted(self.face, [face, face + 1]).tolist())
        return [self.nodes[self.start[i] : self.start[i + 1]] for i in mine]

    def shares(self, values: Floats) -> Floats:
        """Sum of values (k, ...) over each loop; (l, ...)."""
        return np.asarray(np.add.reduceat(values, self.start[:-1], axis=0)) if len(self.face) else values[:0]


def face_loops(labels: Ints, triangles: Ints, edges: InteriorEdges, wanted: Flags) -> Loops:
    """Chain the directed triangle edges around faces into closed node loops.

    Parameters
    ----------
    labels : ndarray of int32, shape (t,)
        Face of each triangle.
    triangles : ndarray of int32, shape (t, 3)
        Node indices, all counter-clockwise in the undeformed state.
    edges : InteriorEdges
        Of these triangles.
    wanted : ndarray of bool, shape (f,)
        Faces to trace.

    Returns
    -------
    Loops
        All loops of the wanted faces.
    """
    tails = np.ascontiguousarray(triangles, dtype=np.int32).ravel()
    nodes, start, face = _chain(labels, tails, edges.first, edges.second, wanted)
    order = np.argsort(face, kind="stable")
    return _in_order(nodes, start, face, order)


@njit(cache=True, error_model="numpy")
def _chain(labels, tails, first, second, wanted):  # type: ignore[no-untyped-def]
    """Nodes, starts and faces of the loops of the wanted faces; loops in falling order of their first half-edges.

    Strategy: a half-edge bounds its face when the triangle across it belongs to another face or does not exist. From
    the end of such a half-edge, turn through the triangles of the face until the next bounding one: the turn stays
    inside the face, so nodes that are visited twice are chained rightly. Springs dangling into a face have the face on
    both sides and never appear.
    """
    twin = np.full(tails.size, -1, dtype=np.int32)
    for edge in range(first.size):
        if labels[first[edge] // 3] == labels[second[edge] // 3]:
            twin[first[edge]], twin[second[edge]] = second[edge], first[edge]
    # From here on a half-edge bounds its face when it has no twin.
    todo = np.zeros(tails.size, dtype=np.bool_)
    count = 0
    for half in range(tails.size):
        if twin[half] < 0 and wanted[labels[half // 3]]:
            todo[half] = True
            count += 1
    nodes, start, face = np.empty(count, np.int32), np.empty(count + 1, np.int64), np.empty(count, np.int32)
    row, loop = 0, 0
    for begin in range(tails.size - 1, -1, -1):
        if not todo[begin]:
            continue
        start[loop], face[loop] = row, labels[begin // 3]
        loop += 1
        half = begin
        while todo[half]:
            todo[half] = False
            nodes[row] = tails[half]
            row += 1
            half = half + 1 if half % 3 < 2 else half - 2
            while twin[half] >= 0:
                half = twin[half]
                half = half + 1 if half % 3 < 2 else half - 2
    start[loop] = row
    return nodes, start[: loop + 1], face[:loop]


def _chain_plain(
    labels: Ints, tails: Ints, first: Ints, second: Ints, wanted: Flags
) -> tuple[Ints, NDArray[np.int64], Ints]:
    """NumPy twin of `_chain`."""
    half = np.arange(len(tails))
    following = 3 * (half // 3) + (half + 1) % 3
    face, twin = np.repeat(labels, 3), np.full(len(tails), -1)
    twin[first], twin[second] = second, first
    bounds = (twin < 0) | (face != face[np.maximum(twin, 0)])
    mine = np.flatnonzero(bounds & wanted[face])
    after = following[mine]
    turning = np.flatnonzero(~bounds[after])
    while turning.size:
        after[turning] = following[twin[after[turning]]]
        turning = turning[~bounds[after[turning]]]
    step = dict(zip(mine.tolist(), after.tolist(), strict=True))
    chains = []
    while step:
        begin, edge = step.popitem()
        chain = [begin]
        while edge != begin:
            chain.append(edge)
            edge = step.pop(edge)
        chains.append(chain)
    start = np.concatenate([[0], np.cumsum([len(chain) for chain in chains], dtype=np.int64)])
    nodes = tails[np.concatenate([np.empty(0, dtype=np.int64), *chains]).astype(np.int64)]
    return nodes, start, face[[chain[0] for chain in chains]] if chains else np.empty(0, dtype=np.int32)


def _in_order(nodes: Ints, start: NDArray[np.int64], face: Ints, order: NDArray[np.int64]) -> Loops:
    """Choose loops by number and put them end to end in a new order."""
    rows, ends = _rows(start, order)
    return Loops(nodes[rows], ends, face[order])


def _rows(start: NDArray[np.int64], order: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Rows of chosen pieces of a ragged array, and where each piece then starts."""
    sizes = np.diff(start)[order]
    ends = np.concatenate([[0], np.cumsum(sizes)])
    return np.arange(ends[-1]) + np.repeat(start[order] - ends[:-1], sizes), ends


def laid_out(loops: Loops, points: Floats, reference: Floats, box: Floats | None) -> tuple[Floats, Floats]:
    """Lay the loops of a network out in the plane; in a periodic one edge by edge from the first node of each on.

    Parameters
    ----------
    loops : Loops
        Of l loops with k nodes in all.
    points, reference : ndarray of float64, shape (n, 2)
        Positions now and at first (model length); never wrapped into the box.
    box : ndarray of float64, shape (2,), optional
        Periods in x and y, infinite in a direction without.

    Returns
    -------
    positions : ndarray of float64, shape (k, 2)
        Positions of the nodes, or of their images.
    winding : ndarray of float64, shape (l, 2)
        How often each loop goes around the box in x and y; (0, 0) for one that closes on itself.
    """
    positions = points[loops.nodes]
    if box is None:
        return positions, np.zeros((len(loops.face), 2))
    last = loops.start[1:] - 1
    after = np.arange(1, len(positions) + 1)
    after[last] = loops.start[:-1]
    periods = np.rint(image_offsets(reference, loops.nodes, loops.nodes[after], box) / box)
    # Strategy: running sums of whole periods within each loop: one sum over all, less what stood at the loop's start.
    passed = np.concatenate([np.zeros((1, 2)), np.cumsum(periods, axis=0)])
    before = passed[loops.start[:-1]]
    away = passed[:-1] - np.repeat(before, np.diff(loops.start), axis=0)
    return positions - away * np.where(np.isfinite(box), box, 0.0), before - passed[loops.start[1:]]


def loop_areas(loops: Loops, positions: Floats) -> Floats:
    """Signed area (l,) of each loop from the positions (k, 2) of its nodes (model length squared)."""
    first = np.repeat(positions[loops.start[:-1]], np.diff(loops.start), axis=0)
    x, y = (positions - first).T
    after = np.arange(1, len(positions) + 1)
    after[loops.start[1:] - 1] = loops.start[:-1]
    return 0.5 * loops.shares(x * y[after] - x[after] * y)


def outer_loops(loops: Loops, positions: Floats) -> tuple[Loops, Floats]:
    """Of each face the loop of largest signed area, started at its smallest node, with its positions (k', 2)."""
    areas = loop_areas(loops, positions)
    largest = np.lexsort((-areas, loops.face))
    largest = largest[np.flatnonzero(np.diff(loops.face, prepend=-1))]
    rows, start = _rows(loops.start, largest)
    nodes = loops.nodes[rows]
    sizes = np.diff(start)
    lowest = np.minimum.reduceat(nodes, start[:-1]) if len(sizes) else nodes
    there = np.flatnonzero(nodes == np.repeat(lowest, sizes))
    begin = there[np.searchsorted(there, start[:-1])] - start[:-1]
    within = np.arange(len(nodes)) - np.repeat(start[:-1], sizes)
    turned = np.repeat(start[:-1], sizes) + (within + np.repeat(begin, sizes)) % np.repeat(sizes, sizes)
    return Loops(nodes[turned], start, loops.face[largest]), positions[rows][turned]


@njit(cache=True, error_model="numpy")
def count_touching(nodes, start):  # type: ignore[no-untyped-def]
    """Count the loops, given as in `Loops`, that visit a node twice."""
    last_seen = np.full(nodes.max() + 1 if nodes.size else 0, -1, dtype=np.int64)
    touching = 0
    for loop in range(start.size - 1):
        twice = False
        for row in range(start[loop], start[loop + 1]):
            twice |= last_seen[nodes[row]] == loop
            last_seen[nodes[row]] = loop
        touching += twice
    return touching


def count_touching_plain(nodes: Ints, start: NDArray[np.int64]) -> int:
    """NumPy twin of `count_touching`."""
    loops = np.split(nodes, start[1:-1])
    return sum(len(np.unique(loop)) < len(loop) for loop in loops)


def largest_part(shape: shapely.Geometry) -> shapely.Polygon:
    """Largest polygon of a shape, without holes; an empty polygon when there is none."""
    parts = shapely.get_parts(shape)
    parts = parts[shapely.get_type_id(parts) == shapely.GeometryType.POLYGON]
    if not len(parts):
        return shapely.Polygon()
    return shapely.Polygon(parts[int(np.argmax(shapely.area(parts)))].exterior)


def repaired(outline: Floats) -> tuple[shapely.Polygon, bool]:
    """Make a valid polygon of an outline that may touch or cross itself.

    Parameters
    ----------
    outline : ndarray of float64, shape (k, 2)
        Nodes in order (model length); coincident nodes are allowed.

    Returns
    -------
    polygon : shapely.Polygon
        The polygon, or its largest simple lobe without holes; empty when the outline has no area. Counter-clockwise,
        from its leftmost node on, so that nothing after depends on where the outline started.
    was_valid : bool
        Whether nothing had to be repaired.
    """
    if len(outline) < 3:
        return shapely.Polygon(), False
    polygon = shapely.Polygon(outline)
    valid = bool(polygon.is_valid)
    if not valid:
        polygon = largest_part(shapely.make_valid(polygon, method="structure", keep_collapsed=False))
    return polygon if polygon.is_empty else shapely.Polygon(ring_nodes(polygon)), valid


def ring_nodes(polygon: shapely.Polygon) -> Floats:
    """Nodes of a polygon's exterior, counter-clockwise, started at the leftmost (then lowest) node, not closed."""
    nodes = shapely.get_coordinates(polygon.exterior)[:-1]
    if not polygon.exterior.is_ccw:
        nodes = nodes[::-1]
    return np.ascontiguousarray(np.roll(nodes, -int(np.lexsort((nodes[:, 1], nodes[:, 0]))[0]), axis=0))
