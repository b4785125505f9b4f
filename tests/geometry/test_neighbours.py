"""Gaps and near pairs, against all pairs."""

import numpy as np
import pytest
import shapely

from vasculo.errors import InputError
from vasculo.geometry.neighbours import near_pairs, pillar_gaps


def disks(seed, count):
    rng = np.random.default_rng(seed)
    t = 2 * np.pi * np.arange(20) / 20
    circle = np.column_stack((np.cos(t), np.sin(t)))
    return [circle * rng.uniform(0.1, 0.5) + rng.uniform(0, 10, 2) for _ in range(count)]


@pytest.mark.parametrize("seed", range(4))
def test_all_pairs(seed):
    pillars = disks(seed, 30)
    polygons = [shapely.Polygon(p) for p in pillars]
    table = np.array([[a.distance(b) for b in polygons] for a in polygons])
    np.fill_diagonal(table, np.inf)
    assert pillar_gaps(pillars) == pytest.approx(table.min(axis=1), abs=1e-12)
    for distance in (0.0, 0.3, 1.0):
        expected = np.argwhere(np.triu(table < distance, 1))
        found = near_pairs(pillars, distance)
        assert found.dtype == np.int32
        assert np.array_equal(found, expected)


def test_few_pillars():
    assert pillar_gaps([]).shape == (0,)
    assert pillar_gaps(disks(0, 1))[0] == np.inf
    assert near_pairs([], 1.0).shape == (0, 2)
    assert near_pairs(disks(0, 1), 1.0).shape == (0, 2)


def test_exactly_the_distance_does_not_count():
    square = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    assert len(near_pairs([square, square + np.array([1.5, 0])], 0.5)) == 0
    assert len(near_pairs([square, square + np.array([1.5, 0])], 0.5000001)) == 1


@pytest.mark.parametrize("distance", [-1.0, np.nan])
def test_refused_distance(distance):
    with pytest.raises(InputError, match="must not be negative"):
        near_pairs(disks(0, 3), distance)
