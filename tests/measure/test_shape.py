import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.measure.shapes import blob

from vasculo import measure
from vasculo.errors import InputError
from vasculo.geometry.domain import Domain
from vasculo.geometry.outline import centroid, second_moments


def ellipse(long, short, degrees, centre=(0.0, 0.0), nodes=400):
    t = 2.0 * np.pi * np.arange(nodes) / nodes
    flat = np.stack([long * np.cos(t), short * np.sin(t)], axis=1)
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return flat @ np.array([[c, s], [-s, c]]) + centre


@settings(max_examples=30, deadline=None)
@given(
    ratio=st.floats(1.05, 7.5),
    degrees=st.floats(-89.0, 90.0),
    x=st.floats(8.0, 12.0),
    y=st.floats(8.0, 12.0),
)
def test_an_ellipse(ratio, degrees, x, y):
    domain = Domain.rectangle(20.0, 20.0, [ellipse(ratio, 1.0, degrees, (x, y))])
    table = measure.pillars(domain)
    assert len(table) == 1
    assert table.area[0] == pytest.approx(np.pi * ratio, rel=1e-3)
    np.testing.assert_allclose(table.centroid[0], (x, y), atol=1e-9)
    assert table.aspect_ratio[0] == pytest.approx(ratio, rel=1e-9)
    assert np.sin(np.radians(table.orientation[0] - degrees)) == pytest.approx(0.0, abs=1e-6)
    assert -90.0 < table.orientation[0] <= 90.0
    assert np.isinf(table.nearest_gap[0])
    assert measure.order(domain) == pytest.approx(np.cos(2.0 * np.radians(degrees)), abs=1e-6)
    assert measure.order(domain, degrees) == pytest.approx(1.0, abs=1e-9)


def test_rotated_and_mirrored():
    shapes = [ellipse(2.0, 1.0, angle, centre) for angle, centre in ((20, (4, 4)), (-50, (9, 9)), (80, (4, 12)))]
    plain = measure.pillars(Domain.rectangle(16.0, 16.0, shapes))
    mirrored = measure.pillars(Domain.rectangle(16.0, 16.0, [p * [1.0, -1.0] + [0.0, 16.0] for p in shapes]))
    turned = measure.pillars(
        Domain.rectangle(16.0, 16.0, [p @ [[0.0, 1.0], [-1.0, 0.0]] + [16.0, 0.0] for p in shapes])
    )
    np.testing.assert_allclose(mirrored.orientation, -plain.orientation, atol=1e-9)
    np.testing.assert_allclose(np.sin(np.radians(turned.orientation - plain.orientation - 90.0)), 0.0, atol=1e-9)
    for table in (mirrored, turned):
        np.testing.assert_allclose(table.area, plain.area)
        np.testing.assert_allclose(table.aspect_ratio, plain.aspect_ratio)
        np.testing.assert_allclose(table.nearest_gap, plain.nearest_gap)


def test_gaps_and_columns():
    squares = [np.array([(x, 1.0), (x + 2.0, 1.0), (x + 2.0, 3.0), (x, 3.0)]) for x in (1.0, 4.0, 8.0)]
    domain = Domain.rectangle(12.0, 4.0, squares)
    table = measure.pillars(domain)
    np.testing.assert_allclose(table.nearest_gap, [1.0, 1.0, 2.0])
    assert measure.mean_gap(domain) == pytest.approx(4.0 / 3.0)
    columns = table.columns()
    assert list(columns) == ["area", "centroid_x", "centroid_y", "aspect_ratio", "orientation", "nearest_gap"]
    assert all(column.shape == (3,) for column in columns.values())
    np.testing.assert_allclose(columns["centroid_x"], [2.0, 5.0, 9.0])
    np.testing.assert_allclose(table.aspect_ratio, 1.0)


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10_000), shift=st.floats(-1e4, 1e4))
def test_axes_of_many_outlines_are_those_of_each(seed, shift):
    shapes = [blob(seed + k) + np.array([shift + 6.0 * k, shift]) for k in range(3)]
    low, high = (np.array([shift - 5.0, shift - 5.0]), np.array([shift + 20.0, shift + 5.0]))
    domain = Domain([low, (high[0], low[1]), high, (low[0], high[1])], shapes, ("a", "b", "c", "d"))
    table = measure.pillars(domain)
    for k, outline in enumerate(shapes):
        small, large = np.linalg.eigvalsh(second_moments(outline))
        assert table.aspect_ratio[k] == pytest.approx(np.sqrt(large / small), rel=1e-8)
        np.testing.assert_allclose(table.centroid[k], centroid(outline), rtol=1e-12, atol=1e-9)


def test_no_order_in_a_star():
    centres = [(4.0, 4.0), (12.0, 4.0), (8.0, 12.0)]
    shapes = [ellipse(2.0, 1.0, angle, centre) for angle, centre in zip((0, 60, -60), centres, strict=True)]
    assert measure.order(Domain.rectangle(16.0, 16.0, shapes)) == pytest.approx(0.0, abs=1e-9)


def test_chains():
    shapes = [ellipse(3.0, 1.0, 30.0, (5.0, 4.0)), ellipse(1.0, 0.5, 90.0, (12.0, 4.0))]
    domain = Domain.rectangle(16.0, 8.0, shapes)
    alone = measure.chains(domain)
    assert (alone.largest, alone.fraction) == (1, 0.0)
    np.testing.assert_allclose(alone.lengths, [6.0, 2.0], rtol=1e-3)
    merged = measure.chains(domain, [(0, 2, 4), (1,)])
    assert merged.sizes.tolist() == [3, 1]
    assert (merged.largest, merged.fraction) == (3, 0.75)
    for wrong in ([(0,)], [(0, 1), (1,)], [(0,), ()]):
        with pytest.raises(InputError, match="lineage"):
            measure.chains(domain, wrong)


def test_no_pillars():
    empty = Domain.rectangle(2.0, 1.0)
    assert len(measure.pillars(empty)) == 0
    for function in (measure.order, measure.mean_gap, measure.chains):
        with pytest.raises(InputError, match="at least one pillar"):
            function(empty)


def test_round_pillars_have_no_order():
    corners = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False) + 0.1
    ring = np.column_stack((np.cos(corners), np.sin(corners)))
    domain = Domain.rectangle(10.0, 6.0, [ring + np.array([3.0, 3.0]), ring + np.array([7.0, 3.0])])
    assert measure.order(domain) == 0.0
    flat = Domain.rectangle(10.0, 6.0, [ring + np.array([3.0, 3.0]), ring * [1.5, 1.0] + np.array([7.0, 3.0])])
    assert measure.order(flat) == pytest.approx(0.5)
