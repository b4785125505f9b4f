"""Outlines of voids: node loops from the triangulation, and polygons that are valid whatever the nodes do."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import shapely

from vasculo.springs.box import image_offsets

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    Ints = NDArray[np.int32]
    Floats = NDArray[np.float64]


def face_loops(labels: Ints, triangles: Ints, wanted: Iterable[int]) -> dict[int, list[Ints]]:
    """Chain the directed triangle edges around faces into closed node loops.

    Strategy: an edge bounds its face when the triangle across it belongs to another face or does not exist. From the
    end of such an edge, turn through the triangles of the face until the next bounding edge: the turn stays inside the
    face, so nodes that are visited twice are chained rightly. Springs dangling into a face have the face on both
    sides and never appear.

    Parameters
    ----------
    labels : ndarray of int32, shape (t,)
        Face of each triangle.
    triangles : ndarray of int32, shape (t, 3)
        Node indices, all counter-clockwise in the undeformed state.
    wanted : iterable of int
        Faces to trace.

    Returns
    -------
    dict of int to list of int32 arrays
        For each wanted face its loops of nodes, face on the left (the outer loop counter-clockwise).
    """
    count = len(triangles)
    half = np.arange(3 * count)
    tail = triangles.ravel().astype(np.int64)
    following = 3 * (half // 3) + (half + 1) % 3
    head = tail[following]
    twin = _twins(tail, head)
    face = np.repeat(labels, 3)
    bounds = (twin < 0) | (face != face[np.maximum(twin, 0)])
    mine = np.flatnonzero(bounds & np.isin(face, np.fromiter(wanted, dtype=np.int64)))
    after = following[mine]
    turning = np.flatnonzero(~bounds[after])
    while turning.size:
        after[turning] = following[twin[after[turning]]]
        turning = turning[~bounds[after[turning]]]
    step = dict(zip(mine.tolist(), after.tolist(), strict=True))
    loops: dict[int, list[Ints]] = {int(label): [] for label in np.unique(face[mine])}
    while step:
        start, edge = step.popitem()
        chain = [start]
        while edge != start:
            chain.append(edge)
            edge = step.pop(edge)
        loops[int(face[start])].append(tail[chain].astype(np.int32))
    return loops


def _twins(tail: NDArray[np.int64], head: NDArray[np.int64]) -> NDArray[np.int64]:
    """Half-edge in the opposite direction of each half-edge, -1 where there is none."""
    nodes = int(max(tail.max(), head.max())) + 1
    key = tail * nodes + head
    order = np.argsort(key)
    place = np.minimum(np.searchsorted(key[order], head * nodes + tail), len(key) - 1)
    found = order[place]
    return np.where(key[found] == head * nodes + tail, found, -1)


def outer_loop(loops: list[Ints], points: Floats) -> Ints:
    """Return the loop of largest signed area, started at its smallest node."""
    areas = []
    for loop in loops:
        x, y = (points[loop] - points[loop[0]]).T
        areas.append(float(x @ np.roll(y, -1) - np.roll(x, -1) @ y))
    loop = loops[int(np.argmax(areas))]
    return np.roll(loop, -int(np.argmin(loop)))


def unrolled(loop: Ints, points: Floats, reference: Floats, box: Floats) -> tuple[Floats, Floats]:
    """Lay a loop of a periodic network out in the plane, edge by edge from its first node on.

    Parameters
    ----------
    loop : ndarray of int32, shape (k,)
        Nodes in order.
    points, reference : ndarray of float64, shape (n, 2)
        Positions now and at first (model length); never wrapped into the box.
    box : ndarray of float64, shape (2,)
        Periods in x and y, infinite in a direction without.

    Returns
    -------
    outline : ndarray of float64, shape (k, 2)
        Positions of the nodes, or of their images.
    winding : ndarray of float64, shape (2,)
        How often the loop goes around the box in x and y; (0, 0) for one that closes on itself.
    """
    offsets = image_offsets(reference, loop, np.roll(loop, -1), box)
    passed = np.concatenate([np.zeros((1, 2)), np.cumsum(offsets, axis=0)])
    return points[loop] - passed[:-1], np.rint(-passed[-1] / box)


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
