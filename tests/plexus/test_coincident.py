import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vasculo.plexus.coincident import in_company, in_company_plain


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 10_000),
    nodes=st.integers(0, 300),
    distance=st.floats(1e-3, 0.1),
    box=st.sampled_from([(np.inf, np.inf), (1.0, np.inf), (np.inf, 1.0), (1.0, 0.7)]),
)
def test_grid_equals_tree(seed, nodes, distance, box):
    points = np.random.default_rng(seed).normal(0.5, 1.0, (nodes, 2))
    points[::7] = points[: len(points[::7])] + 0.5 * distance
    period = np.array(box)
    np.testing.assert_array_equal(in_company(points, distance, period), in_company_plain(points, distance, period))


def test_at_exactly_the_distance_and_across_a_seam():
    points = np.array([(0.0, 0.0), (0.25, 0.0), (0.75, 0.5), (1e9, 3.0), (4.0, 0.0)])
    infinite = np.full(2, np.inf)
    assert in_company(points, 0.25, infinite).tolist() == [True, True, False, False, False]
    assert in_company(points[[0, 4]], 0.25, np.array([4.125, np.inf])).tolist() == [True, True]
    assert in_company(points[[0, 4]], 0.125, infinite).tolist() == [False, False]


def test_all_nodes_in_one_place():
    assert in_company(np.zeros((50_000, 2)), 1e-3, np.full(2, np.inf)).all()


@pytest.mark.parametrize("distance", [0.0, np.nan])
def test_no_distance_no_company(distance):
    assert not in_company(np.zeros((3, 2)), distance, np.full(2, np.inf)).any()
