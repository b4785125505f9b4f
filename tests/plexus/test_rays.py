import numpy as np
import pytest
import shapely

from vasculo.errors import InputError
from vasculo.plexus.rays import ray_agreement, ray_distances


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


def test_a_dangling_spring_shades_the_wall():
    angle = 2.0 * np.pi * np.arange(40) / 40
    circle = 3.0 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    points, springs = polygon_network(circle)
    points = np.concatenate([points, [(1.0, -1.0), (1.0, 1.0)]])
    shaded = np.concatenate([springs, [[40, 41]]]).astype(np.int32)
    assert ray_agreement(points, shaded, [circle])[0] < 0.85 < ray_agreement(points, springs, [circle])[0]


def test_too_few_rays():
    points, springs = polygon_network(np.eye(3, 2))
    with pytest.raises(InputError, match="at least 3"):
        ray_distances(points, springs, np.zeros((1, 2)), 2)
