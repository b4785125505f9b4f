"""What a broken network holds: its voids, and a count of every artefact met on the way."""

from __future__ import annotations

from dataclasses import dataclass
from math import fsum
from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from vasculo.errors import InputError
from vasculo.geometry.planar import planar_faces, planar_graph
from vasculo.plexus.coincident import in_company
from vasculo.plexus.outlines import Loops, count_touching, face_loops, laid_out, loop_areas, outer_loops
from vasculo.plexus.voids import VOID_CUTOFF, all_edges, intact_edges, join, joined, triangle_areas
from vasculo.springs.box import arms_between

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
    """Voids of one kind of network: their outer loops, the positions on these, their areas; and counts."""

    loops: Loops
    positions: Floats
    areas: Floats
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
        oriented = triangles.astype(np.int32)
        first_areas = triangle_areas(oriented, reference, reference, box)
        oriented[first_areas < 0.0] = oriented[first_areas < 0.0][:, ::-1]
        edges, all_pairs = all_edges(oriented, len(points))
        unit = fsum(lengths := _lengths(all_pairs, reference, reference, box)) / len(lengths)
        area_unit = float(np.mean(np.abs(first_areas)))
        found = _from_triangles(oriented, edges, springs, points, area_unit, reference, box)
    elif box is not None:
        raise InputError(f"a periodic network of {len(points)} nodes without triangles has no faces to measure")
    else:
        unit = fsum(lengths := _lengths(springs, reference, reference, None)) / len(lengths)
        area_unit = TRIANGLE_SHARE * unit**2
        found = _from_springs(springs, np.asarray(reference), points, area_unit)
    low, high = np.array([(axis.min(), axis.max()) for axis in points.T]).T  # axis=0 is several times slower
    used = points[np.flatnonzero(np.bincount(springs.ravel()))]
    rim = np.minimum(found.positions - low, high - found.positions)
    period = np.full(2, np.inf)
    if box is not None:
        framed = np.isinf(box)
        low = np.where(framed, low, reference.min(axis=0))
        high = np.where(framed, high, low + box)
        rim[:, ~framed] = np.inf
        period = box
    at_frame = found.loops.shares((rim < 1e-6 * unit).any(axis=1).astype(np.int64)) > 0
    counts |= found.counts
    counts["short_springs"] = int(np.sum(_lengths(springs, points, reference, box) < SHORT * unit))
    counts["coincident_nodes"] = int(np.count_nonzero(in_company(used, COINCIDENT * unit, period)))
    counts["touching_outlines"] = count_touching(found.loops.nodes, found.loops.start)
    counts["frame_voids"] = int(np.count_nonzero(at_frame))
    bounds = (float(low[0]), float(low[1]), float(high[0]), float(high[1]))
    return Survey(_voids(found), springs, unit, area_unit, bounds, found.largest, found.whole, counts)


def _voids(found: _Found) -> tuple[Void, ...]:
    """Cut the flat arrays of all voids into one object a void."""
    start = found.loops.start.tolist()
    nodes, positions = found.loops.nodes, found.positions
    return tuple(
        Void(face, nodes[first:last], area, positions[first:last])
        for face, area, first, last in zip(
            found.loops.face.tolist(), found.areas.tolist(), start[:-1], start[1:], strict=True
        )
    )


def _largest_part(springs: Ints, nodes: int) -> tuple[Ints, dict[str, int]]:
    """Springs of the connected part with most nodes, and how much was dropped."""
    springs = np.ascontiguousarray(springs, dtype=np.int32)
    part = np.empty(nodes, dtype=np.int32)
    join(springs[:, 0], springs[:, 1], np.zeros(len(springs), dtype=np.bool_), part)
    sizes = np.bincount(part)
    mine = part[springs[:, 0]] == int(np.argmax(sizes))
    counts = {
        "nodes": nodes,
        "springs": len(springs),
        "fragments": int(np.count_nonzero(sizes > 1)) - 1,
        "fragment_springs": int(np.count_nonzero(~mine)),
        "lone_nodes": int(np.count_nonzero(sizes == 1)),
    }
    return springs if mine.all() else springs[mine], counts


def _lengths(edges: Ints, points: Floats, reference: Floats, box: Floats | None) -> Floats:
    """Lengths of edges (e,), in a box to the image of the head that they run to."""
    lengths = np.empty(len(edges))
    period = np.full(2, np.inf) if box is None else np.asarray(box, dtype=np.float64)
    _measure(edges, points, reference, period, lengths)
    return lengths


@njit(cache=True, error_model="numpy")
def _measure(edges, points, reference, box, lengths):  # type: ignore[no-untyped-def]
    """Lengths of edges (e, 2); overwrites lengths (e,). The box has infinite periods where there are none."""
    for edge in range(edges.shape[0]):
        tail, head = edges[edge, 0], edges[edge, 1]
        x, y = points[head, 0] - points[tail, 0], points[head, 1] - points[tail, 1]
        if np.isfinite(box[0]):
            x -= np.rint((reference[head, 0] - reference[tail, 0]) / box[0]) * box[0]
        if np.isfinite(box[1]):
            y -= np.rint((reference[head, 1] - reference[tail, 1]) / box[1]) * box[1]
        lengths[edge] = np.hypot(x, y)


def _measure_plain(edges: Ints, points: Floats, reference: Floats, box: Floats, lengths: Floats) -> None:
    """NumPy twin of `_measure`."""
    arms = arms_between(points, edges[:, 0], edges[:, 1], reference, box)
    lengths[:] = np.hypot(arms[:, 0], arms[:, 1])


def _from_triangles(
    triangles: Ints,
    edges: InteriorEdges,
    springs: Ints,
    points: Floats,
    area_unit: float,
    reference: Floats,
    box: Floats | None,
) -> _Found:
    """Voids and counts from the initial triangulation."""
    living = intact_edges(edges, springs)
    labels = joined(edges, living, len(triangles))
    pieces = triangle_areas(triangles, points, reference, box)
    areas = np.bincount(labels, weights=pieces).astype(np.float64)
    is_void = areas > VOID_CUTOFF * area_unit
    loops = face_loops(labels, triangles, edges, is_void)
    positions, winding = laid_out(loops, points, reference, box)
    outer, outline = outer_loops(loops, positions)
    if box is not None:
        _refuse_around(loops, winding, outer, outline, areas / area_unit)
    one, two = labels[edges.first // 3], labels[edges.second // 3]
    apart = np.flatnonzero(living & is_void[one] & is_void[two])
    apart = apart[one[apart] != two[apart]]
    folded = labels[np.flatnonzero(pieces < 0.0)]
    folded = folded[is_void[folded]]
    sizes = np.bincount(labels)
    counts = {
        "faces": len(areas),
        "small_faces": int(np.count_nonzero((sizes > 1) & ~is_void)),
        "dangling_springs": int(np.count_nonzero(living & (one == two))),
        "one_spring_cords": _pairs(one[apart], two[apart]),
        "folded_triangles": len(folded),
        "folded_voids": len(np.unique(folded)),
        "second_loops": int(np.count_nonzero(np.bincount(loops.face) > 1)),
        "crossings": 0,
    }
    return _Found(outer, outline, areas[outer.face], float(areas.max()), float(areas.sum()), counts)


def _pairs(one: Ints, two: Ints) -> int:
    """How many different unordered pairs there are."""
    return len({*zip(np.minimum(one, two).tolist(), np.maximum(one, two).tolist(), strict=True)})


def _refuse_around(loops: Loops, winding: Floats, outer: Loops, outline: Floats, triangles: Floats) -> None:
    """Refuse a periodic network with a void that reaches around the box, so that it has no outer loop."""
    around = winding.any(axis=1)
    open_faces = [loops.face[around], outer.face[loop_areas(outer, outline) <= 0.0]]
    if not (len(open_faces[0]) or len(open_faces[1])):
        return
    face = int(min(faces.min() for faces in open_faces if len(faces)))
    times = np.abs(winding[loops.face == face]).max(axis=0).astype(int).tolist()
    raise InputError(
        f"everything is broken: the void of face {face} ({triangles[face]:.3g} mean initial triangles) reaches around "
        f"the periodic box, {times} times in x and y: stop rupture earlier"
    )


def _from_springs(springs: Ints, reference: Floats, points: Floats, area_unit: float) -> _Found:
    """Voids and counts from the planar graph of the springs in their reference positions."""
    graph = planar_graph(reference, springs)
    at_rest = graph.carry(reference)
    result = planar_faces(at_rest, graph.edges)
    if not len(result.face):
        raise InputError(f"no void: the {len(springs)} springs of the largest connected part enclose nothing")
    positions = graph.carry(points)
    inner = result.areas(at_rest) > 0.0
    areas = np.where(inner, result.areas(positions), 0.0)
    is_void = areas > VOID_CUTOFF * area_unit
    loops = Loops(*result.loops(is_void))
    outer, outline = outer_loops(loops, positions[loops.nodes])
    half = len(result.face) // 2
    one, two = result.face[:half], result.face[half:]
    apart = is_void[one] & is_void[two]
    counts = {
        "faces": int(np.count_nonzero(inner)),
        "small_faces": int(np.count_nonzero(inner & ~is_void & (np.bincount(result.face) > 3))),
        "dangling_springs": result.loose,
        "one_spring_cords": _pairs(one[apart], two[apart]),
        "folded_triangles": 0,
        "folded_voids": 0,
        "second_loops": int(np.count_nonzero(~inner)) - 1,
        "crossings": len(graph.share),
    }
    return _Found(outer, outline, areas[outer.face], float(areas.max()), float(areas.sum()), counts)
