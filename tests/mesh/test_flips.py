"""Edge flips against Qhull, and recovered walls."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.spatial import Delaunay

from vasculo.errors import ComputationError
from vasculo.mesh.delaunay import fluid_triangles
from vasculo.mesh.flips import flip, incircle, recover_edges, restore_delaunay, turn
from vasculo.mesh.quality import signed_areas
from vasculo.mesh.triangulation import adjacency


def as_set(triangles):
    return {tuple(sorted(row)) for row in triangles.tolist()}


def random_mesh(seed, count):
    """Points within a square frame, and Qhull's triangulation of them."""
    points = np.concatenate(
        ([(-9.0, -9.0), (9.0, -9.0), (9.0, 9.5), (-9.0, 9.0)], np.random.default_rng(seed).random((count, 2)))
    )
    found = Delaunay(points)
    return points, found.simplices.astype(np.int32), found.neighbors.astype(np.int32)


def test_predicates():
    points = np.array([(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0), (0.4, 0.4), (0.5, 0.0), (0.1 + 0.2, 0.0)])
    assert turn(points, 0, 1, 2) == 1.0
    assert turn(points, 0, 2, 1) == -1.0
    assert turn(points, 0, 1, 5) == 0.0
    assert turn(points, 0, 5, 6) == 0.0
    assert incircle(points, 0, 1, 2, 4) > 0
    assert incircle(points, 0, 1, 2, 3) == 0.0
    assert incircle(points * (1, 2), 0, 1, 2, 3) == 0.0
    assert incircle(points + np.array([0.5, 0]), 1, 3, 2, 0) == 0.0


@pytest.mark.parametrize("seed", range(5))
def test_flip_keeps_the_topology_and_undoes_itself(seed):
    points, triangles, neighbours = random_mesh(seed, 60)
    before = as_set(triangles)
    rng = np.random.default_rng(seed)
    done = 0
    while done < 40:
        t, i = rng.integers(len(triangles)), rng.integers(3)
        u = neighbours[t, i]
        if u < 0:
            continue
        j = int(np.flatnonzero(neighbours[u] == t)[0])
        p, a, b, q = triangles[t, i], triangles[t, (i + 1) % 3], triangles[t, (i + 2) % 3], triangles[u, j]
        if turn(points, p, a, q) <= 0 or turn(points, p, q, b) <= 0:
            continue
        flip(triangles, neighbours, t, i)
        assert np.array_equal(adjacency(triangles, len(points)), neighbours)
        done += 1
    assert as_set(triangles) != before
    assert signed_areas(points, triangles).min() > 0
    assert restore_delaunay(points, triangles, neighbours, np.ones(len(triangles), dtype=bool), 100) > 0
    assert as_set(triangles) == before
    assert np.array_equal(adjacency(triangles, len(points)), neighbours)


def test_grid_of_cocircular_points_comes_to_rest():
    x, y = np.meshgrid(np.arange(12.0), np.arange(12.0))
    points = np.column_stack((x.ravel(), y.ravel()))
    found = Delaunay(points)
    triangles, neighbours = found.simplices.astype(np.int32), found.neighbors.astype(np.int32)
    before = triangles.copy()
    assert restore_delaunay(points, triangles, neighbours, np.ones(len(triangles), dtype=bool), 100) == 0
    assert np.array_equal(before, triangles)


@settings(deadline=None, max_examples=60)
@example(seed=364, count=183)  # flips that undo each other
@example(seed=560, count=188)
@given(seed=st.integers(0, 10**6), count=st.integers(10, 200))
def test_wanted_edges_appear(seed, count):
    points, triangles, neighbours = random_mesh(seed, count)
    area = signed_areas(points, triangles).sum()
    # the longest way there is: from the leftmost node to the rightmost
    order = 4 + np.argsort(points[4:, 0])
    wanted = np.array([(order[0], order[-1])], dtype=np.int32)
    at = np.empty(len(points), dtype=np.int32)
    assert recover_edges(points, triangles, neighbours, wanted, at) == -1
    edges = {tuple(sorted(pair)) for row in triangles.tolist() for pair in zip(row, row[1:] + row[:1], strict=True)}
    assert tuple(sorted(wanted[0].tolist())) in edges
    assert signed_areas(points, triangles).min() > 0
    assert signed_areas(points, triangles).sum() == pytest.approx(area, rel=1e-12)
    assert np.array_equal(adjacency(triangles, len(points)), neighbours)


def test_an_edge_through_a_node_is_reported():
    points = np.array([(-9.0, -9.0), (9.0, -9.0), (9.0, 9.5), (-9.0, 9.0), (0.0, 0.0), (1.0, 0.0), (2.0, 0.0)])
    found = Delaunay(points)
    triangles, neighbours = found.simplices.astype(np.int32), found.neighbors.astype(np.int32)
    at = np.empty(len(points), dtype=np.int32)
    assert recover_edges(points, triangles, neighbours, np.array([(4, 6)], dtype=np.int32), at) == 0


def test_walls_that_cross_and_nodes_that_coincide_are_refused():
    bow_tie = np.array([(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)])
    ring = np.array([(0, 1), (1, 2), (2, 3), (3, 0)], dtype=np.int32)
    with pytest.raises(ComputationError, match=r"could not be made an edge|do not part"):
        fluid_triangles(bow_tie, ring)
    twice = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.5, 0.5), (0.5, 0.5)])
    with pytest.raises(ComputationError, match=r"1 nodes coincide within rounding, the first at \(0.5, 0.5\)"):
        fluid_triangles(twice, ring)


def test_a_wall_facing_the_wrong_way_is_refused():
    square = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    with pytest.raises(ComputationError, match="a far node was reached"):
        fluid_triangles(square, np.array([(1, 0), (2, 1), (3, 2), (0, 3)], dtype=np.int32))
