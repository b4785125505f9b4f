"""What a broken network holds: its voids, and a count of every artefact met on the way."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from vasculo.errors import InputError
from vasculo.geometry.planar import planar_faces, planar_graph
from vasculo.plexus.outlines import face_loops, outer_loop
from vasculo.plexus.voids import VOID_CUTOFF, face_areas, faces, interior_edges, triangle_areas

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
        Positions of the nodes (model length).
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
        Smallest x and y, largest x and y of the nodes.
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
        springs in their reference positions.

    Returns
    -------
    Survey

    Raises
    ------
    InputError
        When positions are not finite or no spring is left.
    """
    points = np.asarray(network.points, dtype=np.float64)
    if not np.isfinite(points).all():
        bad = int(np.flatnonzero(~np.isfinite(points).all(axis=1))[0])
        raise InputError(f"node {bad} of {len(points)} is not finite: {points[bad, 0]}, {points[bad, 1]}")
    if not len(network.springs):
        raise InputError(f"everything is broken: none of the springs between {len(points)} nodes is left")
    springs, counts = _largest_part(network.springs, len(points))
    triangles = network.triangles
    if triangles is not None and len(triangles):
        oriented = triangles.astype(np.int32).copy()
        backward = triangle_areas(oriented, network.reference) < 0.0
        oriented[backward] = oriented[backward][:, ::-1]
        corners = np.sort(oriented[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        unit = _mean_length(np.unique(corners, axis=0), network.reference)
        area_unit = float(np.mean(np.abs(triangle_areas(oriented, network.reference))))
        found = _from_triangles(oriented, springs, points, area_unit)
    else:
        unit = _mean_length(springs, network.reference)
        area_unit = TRIANGLE_SHARE * unit**2
        found = _from_springs(springs, np.asarray(network.reference), points, area_unit)
    voids = found.voids
    low, high = points.min(axis=0), points.max(axis=0)
    steps = points[springs[:, 0]] - points[springs[:, 1]]
    used = points[np.unique(springs)]
    counts |= found.counts
    counts["short_springs"] = int(np.sum(np.hypot(*steps.T) < SHORT * unit))
    counts["coincident_nodes"] = len(np.unique(KDTree(used).query_pairs(COINCIDENT * unit, output_type="ndarray")))
    counts["touching_outlines"] = sum(len(np.unique(void.nodes)) < len(void.nodes) for void in voids)
    rim = [np.minimum(void.outline - low, high - void.outline).min() for void in voids]
    counts["frame_voids"] = int(np.sum(np.array(rim) < 1e-6 * unit))
    bounds = (float(low[0]), float(low[1]), float(high[0]), float(high[1]))
    return Survey(tuple(voids), springs, unit, area_unit, bounds, found.largest, found.whole, counts)


def _largest_part(springs: Ints, nodes: int) -> tuple[Ints, dict[str, int]]:
    """Springs of the connected part with most nodes, and how much was dropped."""
    graph = coo_array((np.ones(len(springs)), (springs[:, 0], springs[:, 1])), shape=(nodes, nodes))
    _, part = connected_components(graph, directed=False)
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


def _mean_length(edges: Ints, points: Floats) -> float:
    """Mean length of edges."""
    step = points[edges[:, 0]] - points[edges[:, 1]]
    return float(np.mean(np.hypot(step[:, 0], step[:, 1])))


def _from_triangles(triangles: Ints, springs: Ints, points: Floats, area_unit: float) -> _Found:
    """Voids and counts from the initial triangulation."""
    table = interior_edges(triangles, len(points))
    labels = faces(triangles, springs, len(points), table)
    areas = face_areas(labels, triangles, points)
    is_void = areas > VOID_CUTOFF * area_unit
    loops = face_loops(labels, triangles, np.flatnonzero(is_void).tolist())
    voids = []
    for face, rings in sorted(loops.items()):
        nodes = outer_loop(rings, points)
        voids.append(Void(face, nodes, float(areas[face]), points[nodes]))
    one, two = labels[table.first], labels[table.second]
    living = _living(table, springs)
    apart = living & (one != two) & is_void[one] & is_void[two]
    folded = (triangle_areas(triangles, points) < 0.0) & is_void[labels]
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
