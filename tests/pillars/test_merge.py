import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.pillars.shapes import disk

from vasculo.errors import ComputationError
from vasculo.geometry.domain import Domain
from vasculo.geometry.neighbours import near_pairs
from vasculo.geometry.outline import is_simple, resample, segment_lengths, signed_area
from vasculo.pillars.closing import close_up, joined
from vasculo.pillars.merge import direction, merge
from vasculo.pillars.outlines import inner_polygon

GAP, RADIUS, SPACING = 0.09, 0.18, 0.18


def merge_all(outlines, lineage=None):
    areas = np.array([signed_area(o) for o in outlines])
    lineage = lineage or tuple((k,) for k in range(len(outlines)))
    return merge(outlines, areas, lineage, GAP, RADIUS, SPACING, 7, 0.5)


def test_two_near_ellipses_become_one_pillar():
    # tips 0.05 apart
    outlines = [disk(40, 1.0, 0.0, 0.0, 1.3), disk(40, 1.0, 2.65, 0.0, 1.3)]
    merged, areas, lineage, merges, source = merge_all(outlines)
    assert len(merged) == 1
    np.testing.assert_array_equal(source, [-1])
    assert is_simple(merged[0])
    total = sum(signed_area(o) for o in outlines)
    assert areas[0] == pytest.approx(total)
    assert total < signed_area(merged[0]) < 1.03 * total  # the closing fills the notch
    assert lineage == ((0, 1),)
    (event,) = merges
    assert (event.kind, event.step, event.time, event.pillars) == ("merge", 7, 0.5, ((0,), (1,)))
    assert event.angle == pytest.approx(0.0, abs=1e-9)
    assert event.place == pytest.approx((1.325, 0.0), abs=1e-9)
    sides = segment_lengths(merged[0])
    assert sides.max() < 1.2 * SPACING
    assert sides.min() > 0.8 * SPACING


def test_pillars_apart_are_left_as_they_are():
    outlines = [disk(30), disk(30, 1.0, 2.1), disk(30, 1.0, 0.0, 2.2)]
    merged, _, lineage, merges, source = merge_all(outlines)
    assert merges == ()
    np.testing.assert_array_equal(source, [0, 1, 2])
    assert lineage == ((0,), (1,), (2,))
    for a, b in zip(outlines, merged, strict=True):
        np.testing.assert_array_equal(a, b)


def test_a_row_merges_once_with_its_lineage_and_keeps_its_place():
    outlines = [disk(30, 1.0, 0.0, 9.0), disk(30, 1.0, 4.1), disk(30, 1.0, 2.05), disk(30)]
    merged, areas, lineage, merges, source = merge_all(outlines, ((4,), (0, 9), (2,), (1, 3)))
    np.testing.assert_array_equal(source, [0, -1])
    assert lineage == ((4,), (0, 1, 2, 3, 9))
    assert len(merges) == 2 == len(outlines) - len(merged)
    assert {m.pillars for m in merges} <= {((0, 9), (2,)), ((2,), (1, 3)), ((0, 2, 9), (1, 3)), ((0, 9), (1, 2, 3))}
    assert areas[1] == pytest.approx(3 * signed_area(outlines[0]))


def test_overlapping_pillars_merge_too():
    merged, *_ = merge_all([disk(30), disk(30, 1.0, 1.5, 0.2)])
    assert len(merged) == 1


def test_fluid_that_a_ring_encloses_is_filled():
    angle = np.arange(6) * np.pi / 3
    outlines = [disk(30, 1.0, 2.03 * np.cos(a), 2.03 * np.sin(a)) for a in angle] + [disk(16, 0.3)]
    merged, areas, lineage, merges, _ = merge_all(outlines)
    assert lineage == (tuple(range(7)),)
    assert len(merges) == 6
    assert signed_area(merged[0]) > areas[0]


def test_directions_are_folded():
    assert direction(disk(16), disk(16, 1.0, 1.0, 1.0)) == pytest.approx(45.0)
    assert direction(disk(16), disk(16, 1.0, -1.0, -1.0)) == pytest.approx(45.0)
    assert direction(disk(16), disk(16, 1.0, -1.0, 1.0)) == pytest.approx(-45.0)
    assert abs(direction(disk(16), disk(16, 1.0, 0.0, -2.0))) == pytest.approx(90.0)


def test_a_bay_narrower_than_the_gap_is_filled():
    tooth = shapely.box(0.0, 0.0, 2.0, 2.0).difference(shapely.box(0.96, 0.5, 1.04, 3.0))
    outline = resample(np.asarray(tooth.exterior.coords)[:-1], SPACING, corners=30.0)
    merged, _, _, merges, source = merge_all([outline, disk(30, 1.0, 5.0)])
    assert merges == ()
    np.testing.assert_array_equal(source, [-1, 1])
    assert signed_area(merged[0]) > 3.97
    wide = shapely.box(0.0, 0.0, 2.0, 2.0).difference(shapely.box(0.94, 0.5, 1.06, 3.0))
    outline = resample(np.asarray(wide.exterior.coords)[:-1], SPACING, corners=30.0)
    assert merge_all([outline]).outlines[0] is outline


def test_a_spike_thinner_than_a_neck_falls_off():
    spike = shapely.union_all([shapely.Point(0, 0).buffer(1.0), shapely.box(0.0, -0.008, 2.5, 0.008)])
    outline = resample(np.asarray(spike.exterior.coords)[:-1], SPACING)
    merged, *_ = merge_all([outline])
    assert outline[:, 0].max() > 2.4
    assert merged[0][:, 0].max() < 1.2
    assert is_simple(merged[0])


def test_a_merged_outline_does_not_reach_over_a_corner_of_the_border():
    # a border with a peak between two pillars that meet above it
    outer = np.array([(0, 0), (3, 0), (3.9, 1.9), (4.8, 0), (8, 0), (8, 6), (0, 6)], dtype=float)
    inner = inner_polygon(outer, 0.25 * SPACING)
    outlines = [
        resample(np.asarray(shapely.intersection(shapely.box(*box), inner).exterior.coords)[:-1], SPACING, corners=30.0)
        for box in ((2.0, 0.5, 3.87, 2.6), (3.94, 0.5, 6.0, 2.6))
    ]
    areas = np.array([signed_area(o) for o in outlines])
    merged = merge(outlines, areas, ((0,), (1,)), GAP, RADIUS, SPACING, 1, 0.0, inner)
    assert len(merged.outlines) == 1
    assert shapely.contains_properly(shapely.Polygon(outer), shapely.Polygon(merged.outlines[0]))


def test_closing_takes_a_crossing_away():
    bow = disk(60, 1.0, 0.0, 0.0, 1.5)
    bow[15] = (0.0, -0.7)  # the upper side reaches through the lower one
    assert not is_simple(bow)
    assert is_simple(close_up([bow], RADIUS))
    sides = segment_lengths(joined([bow], RADIUS, SPACING))
    assert sides.max() < 1.3 * SPACING


def test_pieces_too_far_apart_are_an_error():
    with pytest.raises(ComputationError, match="2 pillars cannot be joined"):
        close_up([disk(16), disk(16, 1.0, 1e6)], 0.18)


@given(st.lists(st.tuples(st.floats(0, 8), st.floats(0, 8), st.floats(0.4, 1.2), st.floats(0.7, 1.4)), max_size=9))
@settings(max_examples=40, deadline=None)
def test_what_remains_is_valid_and_apart(ellipses):
    outlines = [disk(24, r, 2 + x, 2 + y, s) for x, y, r, s in ellipses]
    merged, areas, lineage, merges, source = merge_all(outlines)
    for outline, given_one in zip(merged, source, strict=True):
        assert given_one < 0 or outline is outlines[given_one]
    assert len(merges) == len(outlines) - len(merged)
    assert sorted(i for group in lineage for i in group) == list(range(len(outlines)))
    assert areas.sum() == pytest.approx(sum(signed_area(o) for o in outlines))
    assert len(near_pairs(merged, GAP)) == 0
    Domain([(-2, -2), (14, -2), (14, 14), (-2, 14)], merged, ("a", "b", "c", "d"))
