import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import Delaunay

from vasculo.errors import InputError
from vasculo.plexus.raycast import ray_directions, ray_distances, spring_grid
from vasculo.plexus.rays import mended, ray_agreement, ray_outlines, void_centres
from vasculo.plexus.rays_plain import inspect_plain, ray_distances_plain
from vasculo.plexus.survey import survey


def polygon_network(outline):
    count = len(outline)
    return outline, np.stack([np.arange(count), (np.arange(count) + 1) % count], axis=1).astype(np.int32)


def test_distances_to_a_square():
    points, springs = polygon_network(np.array([(-1.0, -1.0), (2.0, -1.0), (2.0, 3.0), (-1.0, 3.0)]))
    distances, hits = ray_distances(points, springs, np.array([[0.0, 0.0]]), 8)
    np.testing.assert_allclose(distances[0, ::2], [2.0, 3.0, 1.0, 1.0], rtol=1e-12)
    np.testing.assert_allclose(distances[0, 1::2], np.sqrt(2.0) * np.array([2.0, 1.0, 1.0, 1.0]), rtol=1e-12)
    assert hits[0, ::2].tolist() == [1, 2, 3, 0]


def test_distances_equal_shapely_on_random_springs():
    rng = np.random.default_rng(4)
    start = rng.random((300, 2)) * 20.0
    points = np.concatenate([start, start + rng.normal(size=(300, 2))])
    springs = np.stack([np.arange(300), np.arange(300, 600)], axis=1).astype(np.int32)
    centres = rng.random((5, 2)) * 20.0
    rays = 48
    distances, hits = ray_distances(points, springs, centres, rays)
    lines = shapely.linestrings(points[springs])
    for c, centre in enumerate(centres):
        for k in range(rays):
            angle = 2.0 * np.pi * k / rays
            ray = shapely.LineString([centre, centre + 100.0 * np.array([np.cos(angle), np.sin(angle)])])
            met = shapely.intersection(lines, ray)
            there = ~shapely.is_empty(met)
            if not there.any():
                assert np.isinf(distances[c, k])
                assert hits[c, k] == -1
            else:
                exact = shapely.distance(met[there], shapely.Point(centre)).min()
                assert distances[c, k] == pytest.approx(exact, abs=1e-9)
                assert shapely.distance(met[hits[c, k]], shapely.Point(centre)) == pytest.approx(exact, abs=1e-9)


def test_agreement_of_round_and_of_wrong_outlines():
    angle = 2.0 * np.pi * np.arange(40) / 40
    circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    points, springs = polygon_network(circle)
    right, wrong = ray_agreement(points, springs, [circle, 0.5 * circle], 64)
    assert right > 0.99
    assert wrong == pytest.approx(0.25, abs=0.01)


def ring(count, radius):
    angle = 2.0 * np.pi * np.arange(count) / count
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    count=st.integers(0, 60),
    length=st.sampled_from([0.0, 0.1, 1.0, 30.0]),
    whole=st.booleans(),
)
def test_grid_walk_equals_every_spring(seed, count, length, whole):
    # whole numbers bring springs that are seen end on, lie on a centre, have no length or end on cell borders
    rng = np.random.default_rng(seed)
    points = rng.random((2 * count, 2)) * (10.0, rng.choice([0.0, 1.0, 10.0]))
    points[count:] = points[:count] + length * rng.normal(size=(count, 2))
    centres = rng.random((8, 2)) * 14.0 - 2.0
    if whole:
        points, centres = np.rint(points), np.rint(centres)
    springs = np.stack([np.arange(count), np.arange(count, 2 * count)], axis=1).astype(np.int32)
    distances, hits = ray_distances(points, springs, centres, 8)
    exact, nearest = ray_distances_plain(points, springs, centres, ray_directions(8))
    np.testing.assert_array_equal(distances, exact)
    np.testing.assert_array_equal(hits, nearest)


def test_ties_and_springs_seen_end_on():
    points = np.array([(1.0, -1.0), (1.0, 0.0), (1.0, 1.0), (2.0, 0.0), (0.0, -3.0), (0.0, -2.0), (-2.0, 0.0)])
    springs = np.array([(3, 1), (1, 2), (0, 1), (4, 5), (6, 6)], dtype=np.int32)
    distances, hits = ray_distances(points, springs, np.zeros((1, 2)), 4)
    # three springs meet the first ray at one node, the one seen end on is the lowest; the last one has no length
    np.testing.assert_allclose(distances, [[1.0, np.inf, 2.0, 2.0]])
    assert hits.tolist() == [[0, -1, 4, 3]]


def test_the_grid_stays_small_whatever_the_springs():
    rng = np.random.default_rng(3)
    springs = np.arange(2000, dtype=np.int32).reshape(-1, 2)
    far = np.concatenate([rng.random((1999, 2)), [(1e6, 2.0)]])
    for points in (rng.random((2000, 2)), rng.random((2000, 1)) * (1.0, 0.0), np.zeros((2000, 2)), far):
        grid = spring_grid(points, springs)
        assert len(grid.start) <= 4 * 2000
        assert len(grid.spring) <= 10 * 2000


def test_a_dangling_spring_shades_the_wall_but_is_left_out():
    circle = ring(40, 3.0)
    points, springs = polygon_network(circle)
    points = np.concatenate([points, [(1.0, -1.0), (1.0, 1.0)]])
    for more in ([[40, 41]], [[40, 41], [41, 5]]):  # free, and joined to the wall
        shaded = np.concatenate([springs, more]).astype(np.int32)
        distances, _ = ray_distances(points, shaded, np.zeros((1, 2)))
        assert distances.min() == pytest.approx(1.0)
        found = ray_outlines(points, shaded, np.zeros((1, 2)))
        assert found.same_nodes([np.arange(40)]).all()
        assert ray_agreement(points, shaded, [circle])[0] == pytest.approx(1.0, abs=1e-9)


def test_links_are_told_apart():
    # a hexagon seen by three rays that meet every other side, and one by six that meet all
    points, springs = polygon_network(ring(6, 1.0) @ np.array([(0.866, 0.5), (-0.5, 0.866)]))
    few = ray_outlines(points, springs, np.zeros((1, 2)), 3)
    assert few.closed.tolist() == [True]
    assert few.links.tolist() == [[0, 3, 0]]
    assert few.nodes.tolist() in [np.roll(np.arange(6), -k).tolist() for k in range(6)]
    assert ray_outlines(points, springs, np.zeros((1, 2)), 6).links.tolist() == [[6, 0, 0]]
    # not allowed to go over the springs between them, the loop stays open
    held = ray_outlines(points, springs, np.zeros((1, 2)), 3, longest=0)
    assert held.closed.tolist() == [False]
    assert held.links.tolist() == [[0, 0, 0]]
    assert not held.same_nodes([np.arange(6)]).any()


def test_a_ring_with_a_gap_stays_open():
    points, springs = polygon_network(ring(20, 1.0))
    found = ray_outlines(points, springs[1:], np.zeros((1, 2)))
    assert found.closed.tolist() == [False]
    assert np.isinf(found.distances).any()


def test_an_island_is_dropped_and_springs_of_no_length_are_passed():
    outer, island = ring(24, 4.0), ring(5, 0.5) + np.array((1.5, 0.0))
    outer[7] = outer[6]  # a spring of no length in the wall
    one, two = polygon_network(outer)[1], polygon_network(island)[1] + 24
    points, springs = np.concatenate([outer, island]), np.concatenate([one, two]).astype(np.int32)
    found = ray_outlines(points, springs, np.zeros((1, 2)))
    assert np.isin(found.hits, np.arange(24, 29)).any()
    assert sorted(found.nodes.tolist()) == [*range(7), *range(8, 24)]
    assert found.same_nodes([np.arange(24)]).all()


@settings(max_examples=40, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    left=st.floats(0.3, 1.0),
    rays=st.integers(3, 40),
    longest=st.sampled_from([0, 2, 64]),
)
def test_inspection_equals_its_twin(seed, left, rays, longest):
    rng = np.random.default_rng(seed)
    points = rng.random((40, 2))
    pairs = np.sort(Delaunay(points).simplices[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    edges = np.unique(pairs, axis=0).astype(np.int32)
    springs = edges[rng.random(len(edges)) < left]
    points[1] = points[springs[0, 0]]  # perhaps a spring of no length, else a node on another
    centres = rng.random((6, 2))
    found = ray_outlines(points, springs, centres, rays, longest)
    merged = found.same_as[springs]
    for c, centre in enumerate(centres):
        nodes, closed, links = inspect_plain(points, merged, centre, found.hits[c], longest)
        assert bool(found.closed[c]) == closed
        assert found.links[c].tolist() == links
        mine = found.nodes[found.start[c] : found.start[c + 1]].tolist()
        assert sorted(mine) == sorted(nodes)
        if closed:
            turn = next(k for k in range(len(nodes)) if nodes[k:] + nodes[:k] == mine)
            assert nodes[turn:] + nodes[:turn] == mine


def test_rays_find_the_loops_of_the_topology(carver):
    holes = [[(x, y), (x + 6, y), (x + 6, y + 6), (x, y + 6)] for x in (2, 8, 14) for y in (2, 8)]
    keep = [[(x, y) for y in range(2, 15)] for x in (8, 14)] + [[(x, 8) for x in range(2, 21)]]
    keep.append([(14, 11), (13, 11), (12, 11)])  # dangles
    network = carver(24, 18, holes, keep, jitter=0.2)
    voids = survey(network).voids
    centres = void_centres(mended([void.outline for void in voids]))
    found = ray_outlines(network.points, network.springs, centres)
    assert found.same_nodes([void.nodes for void in voids]).all()
    assert ray_agreement(network.points, network.springs, [void.outline for void in voids]).min() > 1.0 - 1e-9


def test_too_few_rays():
    points, springs = polygon_network(np.eye(3, 2))
    with pytest.raises(InputError, match="at least 3"):
        ray_distances(points, springs, np.zeros((1, 2)), 2)
