import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.measure.shapes import bar, blob, ellipse, turned

from vasculo import measure
from vasculo.geometry.domain import Domain
from vasculo.measure.middle_lines import CUT, find_tips, find_tips_plain
from vasculo.mesh.triangulate.delaunay import fluid_triangles


def arc_straightness(length, width, angle):
    """What is left of an arc without `CUT` widths at both ends of a middle line that ends at the tips."""
    left = angle * (1.0 - 2.0 * CUT * width / length)
    return np.sin(0.5 * left) / (0.5 * left)


@settings(max_examples=30, deadline=None)
@given(
    length=st.floats(4.0, 15.0), width=st.floats(0.4, 1.6), degrees=st.floats(-90.0, 90.0), shift=st.floats(-1e3, 1e3)
)
def test_a_straight_bar_is_straight(length, width, degrees, shift):
    lines = measure.middle_lines([bar(length, width, degrees=degrees, centre=(shift, -shift))])
    assert lines.straightness[0] == pytest.approx(1.0, abs=5e-3)
    assert lines.straightness[0] <= 1.0 + 1e-12
    assert length - width <= lines.lengths[0] <= length + width


@pytest.mark.parametrize("ratio", [2.0, 3.0, 6.0])
def test_an_ellipse_is_straight_from_tip_to_tip(ratio):
    lines = measure.middle_lines([ellipse(ratio, 20.0)])
    assert lines.straightness[0] == pytest.approx(1.0, abs=1e-3)
    assert lines.lengths[0] == pytest.approx(2.0 * np.sqrt(ratio), rel=1e-3)
    assert lines.widths[0] == pytest.approx(np.pi / lines.lengths[0], rel=5e-3)


def test_bent_bars_are_less_straight_the_more_they_are_bent():
    before = 1.0
    for angle in (0.5, 1.0, 2.0, 3.0, 4.0):
        lines = measure.middle_lines([bar(12.0, 0.7, angle)])
        assert lines.straightness[0] == pytest.approx(arc_straightness(12.0, 0.7, angle), abs=0.025)
        assert lines.straightness[0] < before
        before = lines.straightness[0]


def test_a_bar_that_bends_both_ways():
    t = np.linspace(0.0, 2.0 * np.pi, 200)
    wave, slope = 0.8 * np.sin(t), 0.8 * np.cos(t)
    normal = np.stack([-slope, np.ones_like(t)], axis=1) / np.hypot(1.0, slope)[:, None]
    middle = np.stack([t, wave], axis=1)
    outline = np.concatenate((middle - 0.2 * normal, (middle + 0.2 * normal)[::-1]))
    length = np.hypot(*np.diff(middle, axis=0).T).sum()
    lines = measure.middle_lines([outline])
    assert lines.lengths[0] == pytest.approx(length, rel=0.05)
    assert lines.straightness[0] == pytest.approx(2.0 * np.pi / length, abs=0.03)


def test_short_pillars_and_triangles_have_no_straightness():
    lines = measure.middle_lines([ellipse(1.0), np.array([(3.0, 0.0), (5.0, 0.0), (4.0, 1.0)])])
    assert np.isnan(lines.straightness[0])
    assert lines.tips.shape == (2, 2)
    assert lines.lengths[1] == pytest.approx(2.0, rel=0.25)


@settings(max_examples=25, deadline=None)
@given(seeds=st.lists(st.integers(0, 10_000), min_size=1, max_size=3), degrees=st.integers(0, 359))
def test_tips_are_those_of_the_plain_twin(seeds, degrees):
    outlines = [turned(blob(seed), degrees, (10.0 * k, 0.0)) for k, seed in enumerate(seeds)]
    lines = measure.middle_lines(outlines)
    for outline, tips in zip(outlines, lines.tips, strict=True):
        step = np.arange(len(outline))
        edges = np.column_stack((step, np.roll(step, -1))).astype(np.int32)
        triangles, neighbours = fluid_triangles(outline, edges)
        last = np.array([len(triangles)])
        found, way = find_tips(outline, triangles, neighbours, last)
        _, plain = find_tips_plain(outline, triangles, neighbours, last)
        assert way[0] == pytest.approx(plain[0], rel=1e-12)
        assert sorted(tips) == sorted(found[0])


def test_chains_of_a_domain():
    shapes = [bar(8.0, 1.0, 1.0, 0.0, (6.0, 3.0)), bar(6.0, 1.0, 0.0, 60.0, (15.0, 5.0)), ellipse(1.0, 0.0, (6.0, 7.0))]
    domain = Domain.rectangle(20.0, 10.0, shapes)
    found = measure.chains(domain, [(0, 4, 5), (1, 2), (3,)])
    assert found.count == 2
    assert found.is_chain.tolist() == [True, True, False]
    assert found.directions[:2] == pytest.approx([0.0, 60.0], abs=0.5)
    assert found.straightness[0] < 0.98 < found.straightness[1]
    weights = found.path_lengths[:2]
    assert found.mean_straightness == pytest.approx(np.average(found.straightness[:2], weights=weights))
    assert found.lengths[1] == pytest.approx(6.0, rel=0.02)
    alone = measure.chains(domain)
    assert alone.count == 0
    assert np.isnan(alone.mean_straightness)
