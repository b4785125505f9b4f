import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from vasculo.plexus.clearing import clear
from vasculo.plexus.rules import near_pairs, sample_gaps, sample_gaps_plain

BOX = shapely.box(0, 0, 40, 30)


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_gaps_of_samples_against_the_twin(seed):
    draw = np.random.default_rng(seed)
    shapes = [shapely.Point(*draw.uniform(0.0, 6.0, 2)).buffer(draw.uniform(0.5, 2.0), quad_segs=3) for _ in range(4)]
    rings = np.concatenate([shapely.get_coordinates(shape) for shape in shapes])
    first = np.concatenate(([0], np.cumsum([shapely.get_num_coordinates(shape) for shape in shapes])))
    pairs = np.array([(i, j) for i in range(4) for j in range(4) if i != j])
    one, two = np.full(len(rings), 1.5), np.full(len(rings), 1.5)
    sample_gaps(rings, first, rings, first, pairs, one)
    sample_gaps_plain(rings, first, rings, first, pairs, two)
    np.testing.assert_allclose(one, two, atol=1e-12)


def test_pairs_in_order():
    shapes = np.array([shapely.box(x, 0, x + 1, 1) for x in (6.0, 0.0, 1.5, 4.0)], dtype=object)
    near = near_pairs(shapes, 2.0)
    assert near.pairs.tolist() == [[0, 3], [1, 2], [2, 3]]
    np.testing.assert_allclose(near.gap, [1.0, 0.5, 1.5])


@pytest.mark.parametrize("width", [0.4, 1.0, 2.0])
def test_minimum_width_of_a_wedge(width):
    # the gap grows from 0 to 3: where it is below the width it becomes the width, and no more than a level wider
    low = shapely.Polygon([(2, 2), (38, 2), (38, 13), (2, 13)])
    high = shapely.Polygon([(2, 13), (38, 16), (38, 28), (2, 28)])
    raw = np.array([low, high], dtype=object)
    result = clear(raw, BOX, width, "minimum", 0.3, 0.6)
    one, two = result.shapes
    assert result.cut == 0
    assert 0.98 * width < shapely.distance(one, two)
    for x in np.linspace(4.0, 36.0, 20):
        line = shapely.LineString([(x, 0), (x, 30)])
        gap = shapely.intersection(two, line).bounds[1] - shapely.intersection(one, line).bounds[3]
        wide = max(width, (x - 2.0) / 12.0)
        assert 0.97 * wide < gap < 1.1 * wide + 0.02
    assert one.area < low.area
    assert shapely.difference(one, low).area < 1e-9


def test_pairs_that_are_given_change_nothing():
    raw = np.array([shapely.box(1, 1, 10, 10), shapely.box(10, 1, 20, 10), shapely.box(1, 10.3, 20, 20)], dtype=object)
    for rule in ("offset", "minimum"):
        plain = clear(raw, BOX, 0.8, rule, 0.3, 0.6)
        given_pairs = clear(raw, BOX, 0.8, rule, 0.3, 0.6, near_pairs(raw, 3.0))
        too_short = clear(raw, BOX, 0.8, rule, 0.3, 0.6, near_pairs(raw, 0.1))
        for one, two, three in zip(plain.shapes, given_pairs.shapes, too_short.shapes, strict=True):
            assert one.equals_exact(two, 0.0)
            assert one.equals_exact(three, 0.0)
