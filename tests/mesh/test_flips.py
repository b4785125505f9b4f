"""Edge flips against Qhull, and wanted edges that appear."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.spatial import Delaunay

from vasculo.geometry.predicates import orient2d
from vasculo.mesh.quality import signed_areas
from vasculo.mesh.triangulate.flips import around, flip, restore_delaunay
from vasculo.mesh.triangulate.walls import MISSING, any_triangle, find_edge, recover_edges
from vasculo.mesh.triangulation import adjacency


def as_set(triangles):
    return {tuple(sorted(row)) for row in triangles.tolist()}


def qhull(points):
    """Qhull's triangulation, counter-clockwise."""
    found = Delaunay(points)
    return found.simplices.astype(np.int32), found.neighbors.astype(np.int32)


def random_mesh(seed, count):
    points = np.random.default_rng(seed).random((count, 2))
    return points, *qhull(points)


def turn(points, a, b, c):
    return orient2d(*points[a], *points[b], *points[c])


def shuffle(points, triangles, neighbours, rng, flips):
    """Flip edges at random; returns the number of those that could be flipped."""
    done = 0
    for _ in range(flips):
        t, i = rng.integers(len(triangles)), rng.integers(3)
        if neighbours[t, i] < 0:
            continue
        _, _, p, a, b, q = around(triangles, neighbours, t, i)
        if turn(points, p, a, q) > 0 and turn(points, p, q, b) > 0:
            flip(triangles, neighbours, t, i)
            done += 1
    return done


@pytest.mark.parametrize("seed", range(5))
def test_flip_keeps_the_topology_and_undoes_itself(seed):
    points, triangles, neighbours = random_mesh(seed, 60)
    before = as_set(triangles)
    assert shuffle(points, triangles, neighbours, np.random.default_rng(seed), 200) > 20
    assert np.array_equal(adjacency(triangles, len(points)), neighbours)
    assert as_set(triangles) != before
    assert signed_areas(points, triangles).min() > 0
    dirty = np.ones(len(triangles), dtype=bool)
    assert restore_delaunay(points, triangles, neighbours, dirty) > 0
    assert not dirty.any()
    assert as_set(triangles) == before
    assert np.array_equal(adjacency(triangles, len(points)), neighbours)


def test_only_what_is_dirty_needs_a_look():
    points, triangles, neighbours = random_mesh(3, 400)
    before = as_set(triangles)
    for t, i in ((5, 0), (100, 1), (300, 2), (5, 2), (444, 1)):
        if neighbours[t, i] < 0:
            continue
        u, _, p, a, b, q = around(triangles, neighbours, t, i)
        if not (turn(points, p, a, q) > 0 and turn(points, p, q, b) > 0):
            continue
        flip(triangles, neighbours, t, i)
        dirty = np.zeros(len(triangles), dtype=bool)
        dirty[[t, u]] = True
        assert restore_delaunay(points, triangles, neighbours, dirty) == 1
        assert as_set(triangles) == before


def test_walls_are_never_flipped():
    points = np.array([(0.0, 0.0), (4.0, 0.0), (2.0, 0.1), (2.0, -0.1)])
    triangles = np.array([(0, 1, 2), (1, 0, 3)], dtype=np.int32)
    wall = np.full((2, 3), -1, dtype=np.int32)
    assert restore_delaunay(points, triangles.copy(), wall.copy(), np.ones(2, dtype=bool)) == 0
    assert restore_delaunay(points, triangles, adjacency(triangles, 4), np.ones(2, dtype=bool)) == 1


def test_grid_of_cocircular_points_comes_to_rest():
    x, y = np.meshgrid(np.arange(12.0), np.arange(12.0))
    points = 0.1 * np.column_stack((x.ravel(), y.ravel()))
    triangles, neighbours = qhull(points)
    before = triangles.copy()
    assert restore_delaunay(points * 10, triangles, neighbours, np.ones(len(triangles), dtype=bool)) == 0
    assert np.array_equal(before, triangles)
    # by rounding, some squares of the grid with a spacing of 0.1 have a preferred diagonal: flipped once, then never
    restore_delaunay(points, triangles, neighbours, np.ones(len(triangles), dtype=bool))
    assert restore_delaunay(points, triangles, neighbours, np.ones(len(triangles), dtype=bool)) == 0


def crossing(points, one, other):
    """Whether two segments have more in common than an end."""
    (a, b), (c, d) = one, other
    if {a, b} & {c, d}:
        return False
    return turn(points, a, b, c) * turn(points, a, b, d) <= 0 and turn(points, c, d, a) * turn(points, c, d, b) <= 0


@settings(deadline=None, max_examples=60)
@example(seed=364, count=183, wanted=1)
@given(seed=st.integers(0, 10**6), count=st.integers(10, 200), wanted=st.integers(1, 20))
def test_wanted_edges_appear(seed, count, wanted):
    points, triangles, neighbours = random_mesh(seed, count)
    area = signed_areas(points, triangles).sum()
    rng = np.random.default_rng(seed)
    order = np.argsort(points[:, 0])
    edges = [(int(order[0]), int(order[-1]))]  # the longest way there is
    for _ in range(60):
        pair = tuple(rng.choice(count, 2, replace=False).tolist())
        if len(edges) < wanted and not any(crossing(points, pair, edge) for edge in edges):
            edges.append(pair)
    dirty = np.zeros(len(triangles), dtype=bool)
    at = any_triangle(triangles, count)
    found = recover_edges(points, triangles, neighbours, np.array(edges, dtype=np.int32), at, dirty)
    assert found == (-1, -1, -1)
    there = {pair for row in triangles.tolist() for pair in zip(row, row[1:] + row[:1], strict=True)}
    assert all((a, b) in there or (b, a) in there for a, b in edges)
    assert signed_areas(points, triangles).min() > 0
    assert signed_areas(points, triangles).sum() == pytest.approx(area, rel=1e-12)
    assert np.array_equal(adjacency(triangles, count), neighbours)
    assert all(i in triangles[at[i]] for i in range(count))
    # each edge is found, in both directions, from any triangle of its start
    for a, b in edges:
        for start, end in ((a, b), (b, a)):
            place = find_edge(triangles, neighbours, at[start], start, end)
            assert place != MISSING
            t, k = divmod(place if place >= 0 else -2 - place, 3)
            ends = (triangles[t, (k + 1) % 3], triangles[t, (k + 2) % 3])
            assert ends == ((start, end) if place >= 0 else (end, start))


GRID = np.array([(x, y) for x in range(5) for y in range(4)], dtype=np.float64)


@pytest.mark.parametrize(
    ("wanted", "found"),
    [
        ([(0, 12)], {(0, 4, -1), (0, 8, -1)}),  # along the hull, over nodes
        ([(1, 13)], {(0, 5, -1), (0, 9, -1)}),
        ([(0, 10)], {(0, 5, -1)}),
        ([(0, 9), (1, 8)], {(1, 0, 9), (1, 9, 0), (0, 1, 8), (0, 8, 1)}),
        ([(0, 5), (1, 4)], {(1, 0, 5), (1, 5, 0), (0, 1, 4), (0, 4, 1)}),
    ],
)
def test_what_is_in_the_way_is_reported(wanted, found):
    triangles, neighbours = qhull(GRID)
    at, dirty = any_triangle(triangles, len(GRID)), np.zeros(len(triangles), dtype=bool)
    answer = recover_edges(GRID, triangles, neighbours, np.array(wanted, dtype=np.int32), at, dirty)
    assert answer in found
