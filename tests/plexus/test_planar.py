import numpy as np
import pytest
import shapely
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.spatial import Delaunay

from vasculo.errors import InputError
from vasculo.geometry.planar import PlanarFaces, _number, _number_plain, planar_faces, planar_graph


def test_crossing_diagonals_dangling_and_island():
    points = np.array([[0, 0], [1, 0], [1, 1], [0, 1], [0.2, 0.5], [5, 5], [6, 5], [5, 6]], dtype=float)
    edges = np.array([[0, 1], [1, 2], [2, 3], [3, 0], [0, 2], [1, 3], [3, 4], [5, 6], [6, 7], [7, 5]], dtype=np.int32)
    graph = planar_graph(points, edges)
    assert len(graph.share) == 1
    whole = graph.carry(points)
    np.testing.assert_allclose(whole[-1], (0.5, 0.5))
    result = planar_faces(whole, graph.edges)
    assert result.loose == 1
    np.testing.assert_allclose(np.sort(result.areas(whole)), [-1.0, -0.5, 0.25, 0.25, 0.25, 0.25, 0.5])
    island = int(np.argmax(result.areas(whole)))
    nodes, start, face = result.loops(np.arange(result.face.max() + 1) == island)
    assert sorted(nodes.tolist()) == [5, 6, 7]
    assert (start.tolist(), face.tolist()) == ([0, 3], [island])
    # the crossing point moves with the spring it lies on
    np.testing.assert_allclose(graph.carry(points * 2.0)[-1], (1.0, 1.0))


def test_coincident_nodes_are_one():
    points = np.array([[0, 0], [1, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
    edges = np.array([[0, 1], [1, 2], [2, 3], [3, 4], [4, 0], [0, 2]], dtype=np.int32)
    graph = planar_graph(points, edges)
    assert len(graph.edges) == 4
    result = planar_faces(graph.carry(points), graph.edges)
    assert sorted(result.areas(graph.carry(points))) == pytest.approx([-1.0, 1.0])


def outer_loop_area(polygon):
    """Area inside the outer loop: islands that hang on it by a node are outside, free ones are not noticed."""
    loop, islands = polygon.exterior, list(polygon.interiors)
    area = shapely.Polygon(loop).area
    while hanging := [ring for ring in islands if ring.intersects(loop)]:
        area -= sum(shapely.Polygon(ring).area for ring in hanging)
        islands = [ring for ring in islands if ring not in hanging]
        loop = shapely.union_all([loop, *hanging])
    return area


@settings(max_examples=30, deadline=None)
@given(nodes=st.integers(5, 60), seed=st.integers(0, 10_000), left=st.floats(0.3, 1.0))
@example(nodes=54, seed=10_000, left=0.625)
def test_faces_equal_polygonised_lines(nodes, seed, left):
    rng = np.random.default_rng(seed)
    points = rng.random((nodes, 2))
    triangles = Delaunay(points).simplices
    edges = np.unique(np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0).astype(np.int32)
    edges = edges[rng.random(len(edges)) < left]
    if not len(edges):
        return
    result = planar_faces(points, edges)
    areas = result.areas(points) if len(result.face) else np.empty(0)
    polygons = shapely.get_parts(shapely.polygonize(list(shapely.linestrings(points[edges]))))
    shells = sorted(outer_loop_area(polygon) for polygon in polygons)
    np.testing.assert_allclose(np.sort(areas[areas > 0.0]), shells, rtol=1e-9, atol=1e-12)


def test_random_chords_keep_their_area():
    rng = np.random.default_rng(2)
    points = np.concatenate([[(0, 0), (1, 0), (1, 1), (0, 1)], rng.random((30, 2))])
    edges = [(0, 1), (1, 2), (2, 3), (3, 0)] + [(4 + 2 * k, 5 + 2 * k) for k in range(15)]
    edges += [(0, 4), (2, 7)]
    graph = planar_graph(points, np.array(edges, dtype=np.int32))
    whole = graph.carry(points)
    assert len(graph.share) > 5
    result = planar_faces(whole, graph.edges)
    areas = result.areas(whole)
    assert areas[areas < 0.0].min() == pytest.approx(-1.0)


def test_no_edge_of_any_length():
    with pytest.raises(InputError, match="no edge of any length"):
        planar_graph(np.zeros((2, 2)), np.array([[0, 1]], dtype=np.int32))


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 10_000), count=st.integers(0, 200), share=st.floats(0.0, 1.0))
def test_cycles_equal_their_twin(seed, count, share):
    rng = np.random.default_rng(seed)
    following = rng.permutation(count).astype(np.int32)
    fast, plain = np.empty(count, dtype=np.int32), np.empty(count, dtype=np.int32)
    _number(following, fast)
    _number_plain(following, plain)
    np.testing.assert_array_equal(fast, plain)
    wanted = rng.random(int(fast.max(initial=-1)) + 1) < share
    nodes, start, face = PlanarFaces(np.arange(count, dtype=np.int32), following, fast, following, 0).loops(wanted)
    for index, number in enumerate(face.tolist()):
        chain = [int(np.argmax(fast == number))]
        while following[chain[-1]] != chain[0]:
            chain.append(int(following[chain[-1]]))
        assert nodes[start[index] : start[index + 1]].tolist() == chain
    assert face.tolist() == np.flatnonzero(wanted).tolist()
