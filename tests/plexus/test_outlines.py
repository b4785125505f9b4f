import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import Delaunay

from vasculo.plexus.clearing import clear, even_outlines
from vasculo.plexus.outlines import (
    _chain,
    _chain_plain,
    count_touching,
    count_touching_plain,
    face_loops,
    laid_out,
    largest_part,
    outer_loops,
    repaired,
    ring_nodes,
)
from vasculo.plexus.voids import faces, interior_edges

SQUARE = np.array([(0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)])
FIGURE_EIGHT = np.array([(0, 0), (5, 0), (5, 4), (2, 4), (3, 6), (0, 6), (3, 4), (0, 4)], dtype=float)


def largest_face(network):
    """All loops of the largest face, and the outer one with its positions."""
    nodes = len(network.points)
    labels = faces(network.triangles, network.springs, nodes)
    sizes = np.bincount(labels)
    loops = face_loops(labels, network.triangles, interior_edges(network.triangles, nodes), sizes == sizes.max())
    outer, outline = outer_loops(loops, laid_out(loops, network.points, network.reference, None)[0])
    assert outer.face.tolist() == [sizes.argmax()]
    return loops.of(int(sizes.argmax())), outer.nodes, outline


def test_loop_of_one_face_is_its_border(carver):
    loops, outer, ring = largest_face(carver(12, 12, [[(3, 3), (8, 3), (8, 8), (3, 8)]]))
    assert len(loops) == 1
    assert outer[0] == outer.min()
    assert len(ring) == 20
    assert shapely.Polygon(ring).equals(shapely.box(3, 3, 8, 8))
    assert shapely.LinearRing(ring).is_ccw


def test_node_visited_twice_stays_one_loop_inside_the_face(carver):
    hole = [(2, 2), (10, 2), (10, 10), (2, 10)]
    network = carver(12, 12, [hole], [[(2, 6), (3, 6), (3, 7), (2, 6)]])  # a triangle hangs on the border by one node
    (loop,), outer, ring = largest_face(network)
    assert len(loop) == len(outer) == 32 + 3
    assert len(np.unique(loop)) == 32 + 2
    polygon, valid = repaired(ring)
    assert not valid
    assert polygon.equals(shapely.box(2, 2, 10, 10))


def test_ring_around_a_block_gives_two_loops(carver):
    hole = [(2, 2), (10, 2), (10, 10), (2, 10)]
    ring = [[(5, 5), (6, 5), (7, 5), (7, 6), (7, 7), (6, 7), (5, 7), (5, 6), (5, 5)]]
    loops, outer, _ = largest_face(carver(12, 12, [hole], ring))
    assert sorted(len(loop) for loop in loops) == [8, 32]
    assert len(outer) == 32


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10_000), nodes=st.integers(4, 150), left=st.floats(0.0, 1.0))
def test_chains_equal_their_twin(seed, nodes, left):
    rng = np.random.default_rng(seed)
    triangles = Delaunay(rng.random((nodes, 2))).simplices.astype(np.int32)
    edges = interior_edges(triangles, nodes)
    springs = triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    springs = springs[rng.random(len(springs)) < left]
    labels = faces(triangles, springs, nodes, edges)
    wanted = rng.random(labels.max() + 1) < 0.7
    tables = labels, triangles.ravel(), edges.first, edges.second, wanted
    fast, plain = _chain(*tables), _chain_plain(*tables)
    for one, two in zip(fast, plain, strict=True):
        np.testing.assert_array_equal(one, two)
    assert count_touching(*fast[:2]) == count_touching_plain(*fast[:2])
    loops = face_loops(labels, triangles, edges, wanted)
    assert sum(len(loops.of(face)) for face in range(len(wanted))) == len(loops.face) == len(fast[2])
    assert set(loops.face.tolist()) == set(np.flatnonzero(wanted).tolist())


def test_figure_eight_keeps_its_largest_lobe():
    polygon, valid = repaired(FIGURE_EIGHT)
    assert not valid
    assert polygon.is_valid
    assert polygon.area == pytest.approx(20.0, abs=1.0)
    swapped, _ = repaired(FIGURE_EIGHT[::-1])
    assert swapped.area == pytest.approx(polygon.area)


def test_collapsed_outlines_are_empty():
    assert repaired(np.array([(0.0, 0.0), (1.0, 0.0)]))[0].is_empty
    assert repaired(np.array([(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (1.0, 0.0)]))[0].is_empty
    assert largest_part(shapely.LineString([(0, 0), (1, 1)])).is_empty


def test_coincident_nodes_change_nothing():
    doubled = np.repeat(SQUARE, 3, axis=0)
    polygon, valid = repaired(doubled)
    assert valid
    assert polygon.equals(shapely.Polygon(SQUARE))


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10_000), turn=st.integers(0, 30), rule=st.sampled_from(["offset", "minimum"]))
def test_start_node_and_direction_do_not_matter(seed, turn, rule):
    rng = np.random.default_rng(seed)
    angle = np.sort(rng.random(24)) * 2.0 * np.pi
    star = (4.0 + 2.0 * rng.random(24))[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    other = star * 0.6 + (9.5, 0.0)
    outer = shapely.box(-8, -8, 16, 8)

    def pillars(loops):
        raw = np.array([repaired(loop)[0] for loop in loops], dtype=object)
        return even_outlines(clear(raw, outer, 0.75, rule, 0.3, 0.6).shapes, 0.6, 0.75)[0]

    plain = pillars([star, other])
    rolled = pillars([np.roll(star, turn, axis=0)[::-1], np.roll(other, -turn, axis=0)])
    for one, two in zip(plain, rolled, strict=True):
        np.testing.assert_array_equal(one, two)
        assert shapely.LinearRing(two).is_ccw


def test_offset_gap_is_the_width():
    raw = np.array([shapely.box(1, 1, 6, 6), shapely.box(6, 1, 11, 6)], dtype=object)
    outer = shapely.box(0, 0, 12, 7)
    result = clear(raw, outer, 0.8, "offset", 0.3, 0.6)
    assert shapely.distance(*result.shapes) == pytest.approx(0.8, rel=1e-9)
    assert result.shapes[0].bounds == pytest.approx((1.4, 1.4, 5.6, 5.6))
    # corners of radius 0.3 cost (4 - pi) 0.09 each pillar
    assert result.shapes[0].area == pytest.approx(4.2**2 - (4.0 - np.pi) * 0.09, rel=1e-3)


def test_minimum_width_leaves_wide_cords_alone():
    raw = np.array([shapely.box(1, 1, 6, 6), shapely.box(6, 1, 11, 6), shapely.box(14, 1, 19, 6)], dtype=object)
    result = clear(raw, shapely.box(0, 0, 20, 7), 0.8, "minimum", 0.3, 0.6)
    assert 0.95 * 0.8 < shapely.distance(result.shapes[0], result.shapes[1]) < 1.05 * 0.8
    assert result.cut == 0
    assert result.shapes[2].bounds == pytest.approx((14.0, 1.0, 19.0, 6.0))


def test_half_a_width_from_the_frame():
    raw = np.array([shapely.box(0, 0, 6, 6)], dtype=object)
    for rule in ("offset", "minimum"):
        shape = clear(raw, shapely.box(0, 0, 12, 12), 0.8, rule, 0.3, 0.6).shapes[0]
        assert shape.bounds[:2] == pytest.approx((0.4, 0.4), abs=1e-6)


def test_overlapping_and_nested_outlines():
    raw = np.array([shapely.box(1, 1, 7, 7), shapely.box(6.5, 2, 9, 6), shapely.box(2, 2, 5, 5)], dtype=object)
    result = clear(raw, shapely.box(0, 0, 12, 12), 0.5, "offset", 0.2, 0.5)
    assert result.void.tolist() == [0, 1]
    assert result.nested == 1
    assert shapely.distance(*result.shapes) > 0.8 * 0.5


def test_neck_and_small_and_vanished():
    dumbbell = shapely.union_all([shapely.box(0, 0, 4, 4), shapely.box(4, 1.9, 6, 2.1), shapely.box(6, 0, 9, 3)])
    raw = np.array([dumbbell, shapely.box(0, 6, 1.5, 7.5), shapely.box(4, 6, 4.5, 8)], dtype=object)
    result = clear(raw, shapely.box(-1, -1, 10, 10), 0.5, "offset", 0.2, 0.6)
    assert (result.split, result.small, result.vanished) == (1, 1, 1)
    assert result.void.tolist() == [0]


def test_ring_nodes_start_at_the_left():
    ring = ring_nodes(shapely.Polygon(SQUARE[::-1]))
    np.testing.assert_array_equal(ring, SQUARE)
