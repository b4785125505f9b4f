"""What a broken network holds: its voids, and a count of every artefact met on the way."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import KDTree

from vasculo.errors import InputError
from vasculo.geometry.outline import signed_area
from vasculo.geometry.planar import planar_faces, planar_graph
from vasculo.plexus.outlines import face_loops, outer_loop, unrolled
from vasculo.plexus.voids import VOID_CUTOFF, faces, interior_edges, triangle_areas, triangle_edges
from vasculo.springs.box import arms_between, wrapped
from vasculo.springs.parts import connected_parts

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.plexus.voids import InteriorEdges
    from vasculo.springs.network import SpringNetwork

    Ints = NDArray[np.int32]
    Floats = NDArray[np.float64]

TRIANGLE_SHARE = 0.41
"""Mean initial triangle over the square of the mean spring, for networks without a triangulation (ours, measured)."""
SHORT = 0.1
"""Springs below this many mean initial lengths are counted as short."""
COINCIDENT = 0.01
"""Nodes closer than this many mean initial lengths are counted as coincident."""
COME_APART = 0.9
"""Above this share of the area in one void the network has come apart."""


@dataclass(frozen=True)
class Void:
    """One void of the network.

    Attributes
    ----------
    face : int
        Number of the face (see `vasculo.plexus.voids.faces`).
    nodes : ndarray of int32, shape (k,)
        Nodes of its outer loop, counter-clockwise, from the smallest one on. In a network without triangulation,
        numbers from n on are points where springs cross.
    area : float
        Signed area of its triangles (model length squared); the loop's area without triangulation.
    outline : ndarray of float64, shape (k, 2)
        Positions of the nodes (model length); in a periodic network of their images, so that the outline closes.
    """

    face: int
    nodes: Ints
    area: float
    outline: Floats


@dataclass(frozen=True)
class Survey:
    """Voids of a network and what was found on the way; lengths in model length.

    Attributes
    ----------
    voids : tuple of Void
        In order of their faces.
    springs : ndarray of int32, shape (m, 2)
        Springs of the largest connected part.
    length_unit : float
        L0, mean initial spring length.
    triangle_area : float
        A0, mean initial triangle.
    bounds : tuple of four floats
        Smallest x and y, largest x and y of the nodes; of a periodic network one box.
    largest_face, area : float
        Area of the largest face, void or not; summed area of all faces.
    counts : dict of str to int
        The artefacts, by the names of `ExtractionReport`.
    """

    voids: tuple[Void, ...]
    springs: Ints
    length_unit: float
    triangle_area: float
    bounds: tuple[float, float, float, float]
    largest_face: float
    area: float
    counts: dict[str, int]

    def require_voids(self) -> None:
        """Refuse a network in which nothing is broken, or everything."""
        unit = self.triangle_area
        if not self.voids:
            raise InputError(
                f"no void: the largest face covers {self.largest_face / unit:.3g} mean initial triangles, a void needs "
                f"more than {VOID_CUTOFF:g} ({len(self.springs)} springs are left): break more springs"
            )
        share = max(void.area for void in self.voids) / self.area
        if share > COME_APART:
            raise InputError(
                f"everything is broken: one void covers {100.0 * share:.3g} % of the network, {len(self.springs)} "
                f"springs are left (limit {100.0 * COME_APART:g} %): stop rupture earlier"
            )


@dataclass(frozen=True)
class _Found:
    """Faces of one kind of network, before the voids are chosen."""

    voids: list[Void]
    largest: float
    whole: float
    counts: dict[str, int]


def survey(network: SpringNetwork) -> Survey:
    """Find the voids of a network and count its artefacts.

    Fragments (springs not joined to the largest connected part) are dropped first, so that an island does not count
    as the border of anything.

    Parameters
    ----------
    network : SpringNetwork
        With its initial triangulation, or without one; then the faces are those of the planar graph of living
        springs in their reference positions. A periodic one needs its triangulation.

    Returns
    -------
    Survey

    Raises
    ------
    InputError
        When positions are not finite, no spring is left, a periodic network has no triangulation, or one of its
        voids reaches around the box, so that it has no outline that closes.
    """
    points = np.asarray(network.points, dtype=np.float64)
    if not np.isfinite(points).all():
        bad = int(np.flatnonzero(~np.isfinite(points).all(axis=1))[0])
        raise InputError(f"node {bad} of {len(points)} is not finite: {points[bad, 0]}, {points[bad, 1]}")
    if not len(network.springs):
        raise InputError(f"everything is broken: none of the springs between {len(points)} nodes is left")
    springs, counts = _largest_part(network.springs, len(points))
    triangles, reference, box = network.triangles, network.reference, network.box
    if triangles is not None and len(triangles):
        oriented = triangles.astype(np.int32).copy()
        first_areas = triangle_areas(oriented, reference, reference, box)
        oriented[first_areas < 0.0] = oriented[first_areas < 0.0][:, ::-1]
        unit = float(np.mean(_lengths(triangle_edges(oriented, len(points)), reference, reference, box)))
        area_unit = float(np.mean(np.abs(first_areas)))
        found = _from_triangles(oriented, springs, points, area_unit, reference, box)
    elif box is not None:
        raise InputError(f"a periodic network of {len(points)} nodes without triangles has no faces to measure")
    else:
        unit = float(np.mean(_lengths(springs, reference, reference, None)))
        area_unit = TRIANGLE_SHARE * unit**2
        found = _from_springs(springs, np.asarray(reference), points, area_unit)
    voids = found.voids
    low, high = points.min(axis=0), points.max(axis=0)
    used = points[np.flatnonzero(np.bincount(springs.ravel()))]
    rims = [np.minimum(void.outline - low, high - void.outline).min(axis=0) for void in voids]
    rim, period = np.array(rims).reshape(-1, 2), np.zeros(2)
    if box is not None:
        framed = np.isinf(box)
        low = np.where(framed, low, reference.min(axis=0))
        high = np.where(framed, high, low + box)
        rim[:, ~framed] = np.inf
        period = np.where(framed, 0.0, box)  # a tree takes 0 for no period
        used = wrapped(used, box)
    pairs = KDTree(used, boxsize=period).query_pairs(COINCIDENT * unit, output_type="ndarray")
    counts |= found.counts
    counts["short_springs"] = int(np.sum(_lengths(springs, points, reference, box) < SHORT * unit))
    counts["coincident_nodes"] = len(np.unique(pairs))
    counts["touching_outlines"] = sum(len(np.unique(void.nodes)) < len(void.nodes) for void in voids)
    counts["frame_voids"] = int(np.sum((rim < 1e-6 * unit).any(axis=1)))
    bounds = (float(low[0]), float(low[1]), float(high[0]), float(high[1]))
    return Survey(tuple(voids), springs, unit, area_unit, bounds, found.largest, found.whole, counts)


def _largest_part(springs: Ints, nodes: int) -> tuple[Ints, dict[str, int]]:
    """Springs of the connected part with most nodes, and how much was dropped."""
    part = connected_parts(springs, nodes)
    sizes = np.bincount(part)
    mine = part[springs[:, 0]] == int(np.argmax(sizes))
    counts = {
        "nodes": nodes,
        "springs": len(springs),
        "fragments": int(np.count_nonzero(sizes > 1)) - 1,
        "fragment_springs": int(np.count_nonzero(~mine)),
        "lone_nodes": int(np.count_nonzero(sizes == 1)),
    }
    return np.ascontiguousarray(springs[mine], dtype=np.int32), counts


def _lengths(edges: Ints, points: Floats, reference: Floats, box: Floats | None) -> Floats:
    """Lengths of edges (e,), in a box to the image of the head that they run to."""
    step = arms_between(points, edges[:, 0], edges[:, 1], reference, box)
    return np.hypot(step[:, 0], step[:, 1])


def _from_triangles(
    triangles: Ints, springs: Ints, points: Floats, area_unit: float, reference: Floats, box: Floats | None
) -> _Found:
    """Voids and counts from the initial triangulation."""
    table = interior_edges(triangles, len(points))
    labels = faces(triangles, springs, len(points), table)
    pieces = triangle_areas(triangles, points, reference, box)
    areas = np.bincount(labels, weights=pieces).astype(np.float64)
    is_void = areas > VOID_CUTOFF * area_unit
    loops = face_loops(labels, triangles, np.flatnonzero(is_void).tolist())
    voids = []
    for face, rings in sorted(loops.items()):
        if box is None:
            nodes = outer_loop(rings, points)
            outline = points[nodes]
        else:
            nodes, outline = _closed(face, rings, points, reference, box, float(areas[face]) / area_unit)
        voids.append(Void(face, nodes, float(areas[face]), outline))
    one, two = labels[table.first], labels[table.second]
    living = _living(table, springs)
    apart = living & (one != two) & is_void[one] & is_void[two]
    folded = (pieces < 0.0) & is_void[labels]
    sizes = np.bincount(labels)
    counts = {
        "faces": len(areas),
        "small_faces": int(np.count_nonzero((sizes > 1) & ~is_void)),
        "dangling_springs": int(np.count_nonzero(living & (one == two))),
        "one_spring_cords": len(np.unique(np.sort(np.stack([one[apart], two[apart]], axis=1), axis=1), axis=0)),
        "folded_triangles": int(np.count_nonzero(folded)),
        "folded_voids": len(np.unique(labels[folded])),
        "second_loops": sum(len(rings) > 1 for rings in loops.values()),
        "crossings": 0,
    }
    return _Found(voids, float(areas.max()), float(areas.sum()), counts)


def _closed(
    face: int, rings: list[Ints], points: Floats, reference: Floats, box: Floats, triangles: float
) -> tuple[Ints, Floats]:
    """Outer loop of a void of a periodic network and its outline; refuse a void that reaches around the box."""
    laid = [unrolled(ring, points, reference, box) for ring in rings]
    sizes = [signed_area(outline) for outline, _ in laid]
    around = np.abs([winding for _, winding in laid]).max(axis=0)
    if around.any() or max(sizes) <= 0.0:
        raise InputError(
            f"everything is broken: the void of face {face} ({triangles:.3g} mean initial triangles) reaches around "
            f"the periodic box, {around.astype(int).tolist()} times in x and y: stop rupture earlier"
        )
    widest = int(np.argmax(sizes))
    ring = rings[widest]
    start = int(np.argmin(ring))
    return np.roll(ring, -start), np.roll(laid[widest][0], -start, axis=0)


def _living(table: InteriorEdges, springs: Ints) -> NDArray[np.bool_]:
    """Whether each interior edge carries a living spring."""
    nodes = np.int64(len(table.start) - 1)
    low = np.repeat(np.arange(nodes), np.diff(table.start))
    return np.isin(low * nodes + table.high, springs.min(axis=1).astype(np.int64) * nodes + springs.max(axis=1))


def _from_springs(springs: Ints, reference: Floats, points: Floats, area_unit: float) -> _Found:
    """Voids and counts from the planar graph of the springs in their reference positions."""
    graph = planar_graph(reference, springs)
    result = planar_faces(graph.carry(reference), graph.edges)
    if not len(result.face):
        raise InputError(f"no void: the {len(springs)} springs of the largest connected part enclose nothing")
    positions = graph.carry(points)
    inner = result.areas(graph.carry(reference)) > 0.0
    areas = np.where(inner, result.areas(positions), 0.0)
    is_void = areas > VOID_CUTOFF * area_unit
    voids = []
    for face in np.flatnonzero(is_void).tolist():
        nodes = outer_loop([result.loop(face)], positions)
        voids.append(Void(face, nodes, float(areas[face]), positions[nodes]))
    half = len(result.face) // 2
    one, two = result.face[:half], result.face[half:]
    apart = is_void[one] & is_void[two]
    counts = {
        "faces": int(np.count_nonzero(inner)),
        "small_faces": int(np.count_nonzero(inner & ~is_void & (np.bincount(result.face) > 3))),
        "dangling_springs": result.loose,
        "one_spring_cords": len(np.unique(np.sort(np.stack([one[apart], two[apart]], axis=1), axis=1), axis=0)),
        "folded_triangles": 0,
        "folded_voids": 0,
        "second_loops": int(np.count_nonzero(~inner)) - 1,
        "crossings": len(graph.share),
    }
    return _Found(voids, float(areas.max()), float(areas.sum()), counts)
