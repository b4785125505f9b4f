import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import Delaunay

from vasculo.errors import InputError
from vasculo.plexus.survey import _measure, _measure_plain
from vasculo.plexus.voids import (
    _edges,
    _edges_plain,
    _mark,
    _mark_plain,
    _signed_areas,
    _signed_areas_plain,
    face_areas,
    faces,
    interior_edges,
    join,
    join_plain,
    mean_triangle_area,
    triangle_areas,
    void_fraction,
)
from vasculo.springs.network import SpringNetwork


def triangulated(nodes, seed):
    rng = np.random.default_rng(seed)
    points = rng.random((nodes, 2))
    triangles = Delaunay(points).simplices.astype(np.int32)
    pairs = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    edges, uses = np.unique(pairs, axis=0, return_counts=True)
    return points, triangles, edges.astype(np.int32), uses == 1, rng


@settings(max_examples=40, deadline=None)
@given(nodes=st.integers(4, 120), seed=st.integers(0, 10_000), left=st.floats(0.0, 1.0))
def test_kernel_equals_twin_and_euler(nodes, seed, left):
    points, triangles, edges, frame, rng = triangulated(nodes, seed)
    alive = frame | (rng.random(len(edges)) < left)
    springs = edges[alive][rng.permutation(int(alive.sum()))]
    springs[::2] = springs[::2, ::-1].copy()
    table = interior_edges(triangles, nodes)
    for one, two in zip(_edges(triangles, nodes), _edges_plain(triangles, nodes), strict=True):
        np.testing.assert_array_equal(one, two)
    intact, marked = np.zeros(len(table.high), dtype=bool), np.zeros(len(table.high), dtype=bool)
    _mark(table.start, table.high, np.ascontiguousarray(springs), intact)
    _mark_plain(table.start, table.high, springs, marked)
    np.testing.assert_array_equal(intact, marked)
    fast, plain = np.empty(len(triangles), dtype=np.int32), np.empty(len(triangles), dtype=np.int32)
    count = join(table.first // 3, table.second // 3, intact, fast)
    assert count == join_plain(table.first // 3, table.second // 3, intact, plain)
    np.testing.assert_array_equal(fast, plain)
    np.testing.assert_array_equal(fast, faces(triangles, springs, nodes))
    # Euler: inner faces = edges - nodes + connected parts (every node counts, frame edges all alive)
    graph = coo_array((np.ones(len(springs)), (springs[:, 0], springs[:, 1])), shape=(nodes, nodes))
    parts, _ = connected_components(graph, directed=False)
    assert count == len(springs) - nodes + parts
    areas = face_areas(fast, triangles, points)
    assert areas.sum() == pytest.approx(triangle_areas(triangles, points).sum(), rel=1e-12)


@pytest.mark.parametrize("box", [(np.inf, np.inf), (1.0, np.inf), (1.0, 1.0)])
def test_areas_equal_their_twin(box):
    points, triangles, _, _, rng = triangulated(300, 5)
    triangles = triangles[:, [0, 2, 1]]
    moved = points + 0.3 * rng.normal(size=points.shape)
    fast, plain = np.empty(len(triangles)), np.empty(len(triangles))
    _signed_areas(np.ascontiguousarray(triangles), moved, points, np.array(box), fast)
    _signed_areas_plain(triangles, moved, points, np.array(box), plain)
    np.testing.assert_array_equal(fast, plain)
    edges = np.ascontiguousarray(triangles[:, :2])
    _measure(edges, moved, points, np.array(box), fast)
    _measure_plain(edges, moved, points, np.array(box), plain)
    np.testing.assert_allclose(fast, plain, rtol=1e-15)


def test_percolation_limits():
    _, triangles, edges, frame, _ = triangulated(400, 3)
    whole = faces(triangles, edges, 400)
    np.testing.assert_array_equal(whole, np.arange(len(triangles)))
    assert faces(triangles, edges[frame], 400).max() == 0
    assert faces(triangles, np.empty((0, 2), dtype=np.int32), 400).max() == 0


def test_springs_outside_the_triangulation_do_not_matter():
    _, triangles, edges, _, _ = triangulated(60, 1)
    known = {tuple(edge) for edge in edges.tolist()}
    extra = next((i, j) for i in range(60) for j in range(i + 1, 60) if (i, j) not in known)
    more = np.concatenate([edges[5:], np.array([extra], dtype=np.int32)])
    np.testing.assert_array_equal(faces(triangles, more, 60), faces(triangles, edges[5:], 60))


def test_void_fraction_counts_deformed_area(carver):
    network = carver(20, 20, [[(5, 5), (10, 5), (10, 10), (5, 10)]])
    assert mean_triangle_area(network.triangles, network.reference) == pytest.approx(0.5)
    assert void_fraction(network) == (pytest.approx(25.0 / 400.0), 1)
    network.points[:] = network.points * [2.0, 1.0]
    assert void_fraction(network) == (pytest.approx(25.0 / 400.0), 1)
    table = interior_edges(network.triangles, len(network.points))
    assert void_fraction(network, table) == void_fraction(network)
    # folding a loose node inside the void changes no area
    network.points[7 + 21 * 7] = (19.0, 9.5)
    assert void_fraction(network)[0] == pytest.approx(25.0 / 400.0)


def test_small_faces_are_no_voids(carver):
    exactly_ten = carver(20, 20, [[(5, 5), (10, 5), (10, 6), (5, 6)]])  # ten triangles: not more than ten
    assert void_fraction(exactly_ten) == (0.0, 0)
    twelve = carver(20, 20, [[(5, 5), (11, 5), (11, 6), (5, 6)]])
    assert void_fraction(twelve) == (pytest.approx(6.0 / 400.0), 1)


def test_bad_input():
    with pytest.raises(InputError, match="three triangles"):
        interior_edges(np.array([[0, 1, 2], [1, 0, 3], [0, 1, 4]], dtype=np.int32), 5)
    with pytest.raises(InputError, match="5 nodes"):
        interior_edges(np.array([[0, 1, 9]], dtype=np.int32), 5)
    with pytest.raises(InputError, match="without triangles"):
        void_fraction(SpringNetwork([(0, 0), (1, 0)], [(0, 1)]))
