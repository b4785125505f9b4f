"""Searches through the grid, against SciPy's tree."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from vasculo.tissue.nearest import (
    add_to_nearest,
    add_to_nearest_plain,
    find_close_pairs,
    find_nearest,
    nearest_points_plain,
    sort_into_cells,
)


@settings(max_examples=40, deadline=None)
@given(nodes=st.integers(1, 400), seed=st.integers(0, 99), wrap=st.booleans(), power=st.floats(1.0, 4.0))
def test_nearest_points_also_of_uneven_ones(nodes, seed, wrap, power):
    rng = np.random.default_rng(seed)
    points, samples = rng.random((nodes, 2)) ** power, rng.random((300, 2))
    nearest = find_nearest(samples, points, sort_into_cells(points, wrap))
    assert np.array_equal(nearest, nearest_points_plain(samples, points, wrap))


def test_points_on_the_far_border_are_found():
    points = np.array([[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]])
    samples = np.array([[0.9, 0.95], [0.2, 0.9], [1.0, 1.0], [0.0, 0.0]])
    assert find_nearest(samples, points, sort_into_cells(points, wrap=False)).tolist() == [1, 3, 1, 0]


@pytest.mark.parametrize("wrap", [True, False])
def test_sums_of_the_nearest(wrap):
    rng = np.random.default_rng(0)
    points, samples = rng.random((50, 2)), rng.random((2_000, 2))
    nearest = nearest_points_plain(samples, points, wrap)
    results = []
    for function in (add_to_nearest, add_to_nearest_plain):
        total, count = np.zeros((50, 2)), np.zeros(50, np.int64)
        function(samples, points, nearest, wrap, total, count)
        results.append((total, count))
    np.testing.assert_allclose(results[0][0], results[1][0], rtol=1e-12)
    assert np.array_equal(results[0][1], results[1][1])
    middle = results[0][0] / results[0][1][:, None]
    assert np.abs(middle - points).max() < 0.5  # images next to their point


@settings(max_examples=40, deadline=None)
@given(nodes=st.integers(2, 300), seed=st.integers(0, 99), wrap=st.booleans(), distance=st.floats(0.001, 0.3))
def test_close_pairs(nodes, seed, wrap, distance):
    points = np.random.default_rng(seed).random((nodes, 2))
    tree = cKDTree(points, boxsize=1.0) if wrap else cKDTree(points)
    expected = tree.query_pairs(distance, output_type="ndarray")
    expected = expected[np.lexsort(expected.T[::-1])]
    assert np.array_equal(find_close_pairs(points, distance, wrap), expected)
