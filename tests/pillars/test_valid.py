"""Geometry that stays valid: gaps that are not jumped over, moves that are cut, outlines inside the border."""

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.pillars.blobs import BORDERS, SPACING, blob, inside, scene
from tests.pillars.shapes import disk

from vasculo.geometry.neighbours import as_polygons, near_pairs
from vasculo.geometry.outline import signed_area
from vasculo.pillars.cell import stack
from vasculo.pillars.gaps import APPROACH, gap_factors, gap_factors_plain
from vasculo.pillars.merge import merge
from vasculo.pillars.outlines import MARGIN, crossing, inner_polygon, keep_inside, tidy, uncrossed


def apart(outlines):
    """Those of the outlines, in order, that keep a merge gap from the earlier ones."""
    kept = []
    for outline in outlines:
        if not len(near_pairs([*kept, outline], 0.5 * SPACING)):
            kept.append(outline)
    return kept


def random_shift(random, points, starts, size):
    """A move of every pillar as a whole, and of every node on top of it."""
    whole = np.repeat(random.normal(0, 1, (len(starts) - 1, 2)), np.diff(starts), axis=0)
    shift = whole + random.normal(0, 0.3, points.shape)
    return size * SPACING * shift / np.hypot(*shift.T).max()


def valid(points, starts):
    polygons = as_polygons(np.split(points, starts[1:-1]))
    areas = [signed_area(outline) for outline in np.split(points, starts[1:-1])]
    one, two = shapely.STRtree(polygons).query(polygons, predicate="intersects")
    return shapely.is_valid(polygons).all() and min(areas) > 0 and (one == two).all()


def test_two_pillars_may_close_most_of_their_gap_together():
    points, starts = stack([disk(36), disk(36, 1.0, 2.3), disk(36, 1.0, 9.0)])
    gap = 0.3
    shift = np.zeros_like(points)
    shift[:36, 0], shift[36:72, 0], shift[72:, 0] = 0.4, -0.2, -0.4
    factors = gap_factors(points, starts, shift)
    np.testing.assert_allclose(factors, [APPROACH * gap / 0.6, APPROACH * gap / 0.6, 1.0])
    moved = points + np.repeat(factors, 36)[:, None] * shift
    assert moved[36:72, 0].min() - moved[:36, 0].max() == pytest.approx((1 - APPROACH) * gap)


def test_only_those_that_approach_are_held_back():
    points, starts = stack([disk(36), disk(36, 1.0, 2.3)])
    shift = np.zeros_like(points)
    shift[:36, 0], shift[36:, 0] = 0.5, 0.5
    np.testing.assert_allclose(gap_factors(points, starts, shift), [APPROACH * 0.3 / 0.5, 1.0])
    np.testing.assert_array_equal(gap_factors(points, starts, -shift * [[0.5, 0.0]])[0], 1.0)
    np.testing.assert_array_equal(gap_factors(points, starts, np.zeros_like(points)), 1.0)


def test_small_moves_are_left_alone():
    points, starts = stack(apart(scene(3, "box", 12)))
    gap = 0.5 * SPACING
    for seed in range(5):
        shift = random_shift(np.random.default_rng(seed), points, starts, 0.24)
        assert APPROACH * gap > 2 * 0.24 * SPACING
        np.testing.assert_array_equal(gap_factors(points, starts, shift), 1.0)


def test_a_pillar_does_not_close_its_own_bay_too_fast():
    horseshoe = shapely.Point(0, 0).buffer(1.0).difference(shapely.box(-0.1, 0.0, 0.1, 2.0))
    points = inside(np.asarray(horseshoe.exterior.coords) + np.array([5.0, 3.0]), "box")
    starts = np.array([0, len(points)], dtype=np.int32)
    shift = np.zeros_like(points)
    beside = (points[:, 1] > 3.1) & (np.abs(points[:, 0] - 5.0) < 0.3)
    shift[beside, 0] = -np.sign(points[beside, 0] - 5.0) * 0.2
    factor = gap_factors(points, starts, shift)
    assert 0.3 < factor[0] < 0.8
    assert valid(points + factor * shift, starts)
    assert not valid(points + shift, starts)


@given(st.integers(0, 10**6), st.floats(0.05, 3.0))
@settings(max_examples=25, deadline=None)
def test_kernel_and_plain_gap_factors_agree(seed, size):
    outlines = apart(scene(seed, "box"))
    if not outlines:
        return
    points, starts = stack(outlines)
    shift = random_shift(np.random.default_rng(seed), points, starts, size)
    expected = gap_factors_plain(points, starts, shift)
    np.testing.assert_allclose(gap_factors(points, starts, shift), expected, rtol=1e-9, atol=1e-12)


def test_a_cut_move_is_halved_until_nothing_crosses():
    before, starts = stack([disk(36), disk(36, 1.0, 2.5), disk(36, 1.0, 0.0, 5.0)])
    after = before.copy()
    after[:36, 0] += 0.8
    after[72:, 1] += 1.0
    points, shares = uncrossed(before, after, starts)
    np.testing.assert_array_equal(shares, [0.5, 0.5, 1.0])
    np.testing.assert_allclose(points[:36], before[:36] + np.array([0.4, 0.0]))
    np.testing.assert_array_equal(points[72:], after[72:])


def test_a_move_that_never_fits_is_left_out():
    before, starts = stack([disk(36), disk(36, 1.0, 2.02), disk(36, 1.0, 0.0, 5.0)])
    after = before.copy()
    after[:36, 0] += 0.8
    points, shares = uncrossed(before, after, starts)
    np.testing.assert_array_equal(shares, [0.0, 0.0, 1.0])
    np.testing.assert_array_equal(points, before)
    assert uncrossed(before, after, starts, times=6)[1][0] == 0.5**6


def test_crossing_names_who_is_concerned():
    bow = disk(60, 1.0, 0.0, 0.0, 1.5)
    bow[15] = (0.0, -0.7)
    points, starts = stack(
        [disk(30, 1.0, 9.0), bow, disk(30, 1.0, 4.0), disk(30, 1.0, 5.0), disk(30, 1.0, 0.0, 9.0)[::-1]]
    )
    np.testing.assert_array_equal(crossing(points, starts), [1, 2, 3, 4])


@given(st.integers(0, 10**6), st.sampled_from(sorted(BORDERS)), st.floats(0.1, 4.0))
@settings(max_examples=40, deadline=None)
def test_any_move_of_any_pillars_stays_valid(seed, border, size):
    base = BORDERS[border]
    outlines = apart(scene(seed, border))
    if not outlines:
        return
    points, starts = stack(outlines)
    shift = random_shift(np.random.default_rng(seed), points, starts, size)
    shift *= np.repeat(gap_factors(points, starts, shift), np.diff(starts))[:, None]
    moved = keep_inside(points + shift, base.outer, MARGIN * SPACING)
    cut, shares = uncrossed(points, moved, starts)
    assert valid(cut, starts)
    np.testing.assert_array_equal(
        cut[np.repeat(shares == 1.0, np.diff(starts))], moved[np.repeat(shares == 1.0, np.diff(starts))]
    )
    tidied = tidy(np.split(cut, starts[1:-1]), SPACING, SPACING)
    lineage = tuple((k,) for k in range(len(tidied)))
    limit = inner_polygon(base.outer, MARGIN * SPACING)
    merged = merge(tidied, np.ones(len(tidied)), lineage, 0.5 * SPACING, SPACING, SPACING, 1, 0.0, limit)
    domain = base.with_pillars(merged.outlines)  # refuses crossings, overlaps and what is outside
    assert domain.repairs == ()
    assert len(near_pairs(domain.pillars, 0.5 * SPACING)) == 0


def test_blobs_are_what_they_should_be():
    assert valid(*stack([blob(np.random.default_rng(0), 1.0, 0.0, 0.0)]))
