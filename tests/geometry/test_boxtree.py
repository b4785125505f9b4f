"""Searches in the tree of boxes, against all segments."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vasculo.geometry.boxtree import STACK, box_tree, distance_to, least


def search(tree, slope, x, y, bound=np.inf):
    stack = np.empty(STACK, dtype=np.int64)
    return least(tree.segments, tree.weights, tree.boxes, tree.lowest, stack, slope, x, y, bound, np.int64(-1))


@settings(deadline=None, max_examples=60)
@given(count=st.integers(1, 70), seed=st.integers(0, 10**6), slope=st.floats(0.05, 2.0), points=st.booleans())
def test_least_is_the_least(count, seed, slope, points):
    rng = np.random.default_rng(seed)
    start = rng.normal(size=(count, 2))
    segments = np.hstack((start, start if points else start + rng.normal(size=(count, 2)) * 10 ** rng.uniform(-3, 1)))
    weights = rng.random(count)
    tree = box_tree(segments, weights)
    assert np.array_equal(tree.segments, segments[tree.order])
    for x, y in rng.normal(size=(20, 2)) * 3:
        values = [weights[k] + slope * distance_to(segments, k, x, y)[0] for k in range(count)]
        value, item = search(tree, slope, x, y)
        assert value == pytest.approx(min(values), rel=1e-12)
        assert values[tree.order[item]] == pytest.approx(value, rel=1e-12)


def test_nothing_beats_a_low_bound():
    tree = box_tree(np.array([[0.0, 0.0, 1.0, 0.0]]))
    assert search(tree, 1.0, 0.5, 2.0, 1.5) == (1.5, -1)
    assert search(tree, 1.0, 0.5, 2.0, 2.5) == (2.0, 0)


def test_distance_to_a_segment_and_a_point():
    segments = np.array([[0.0, 0.0, 4.0, 0.0], [1.0, 1.0, 1.0, 1.0]])
    assert distance_to(segments, 0, 1.0, 3.0) == (3.0, 0.25)
    assert distance_to(segments, 0, 7.0, 4.0) == (5.0, 1.0)
    assert distance_to(segments, 1, 1.0, 3.0) == (2.0, 0.0)


def test_coincident_segments():
    tree = box_tree(np.zeros((1000, 4)), np.arange(1000.0)[::-1] + 1.0)
    assert search(tree, 1.0, 0.0, 2.0)[0] == 3.0
