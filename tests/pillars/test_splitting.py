import numpy as np
import pytest
import shapely
from tests.pillars.shapes import disk

from vasculo.geometry.neighbours import near_pairs
from vasculo.geometry.outline import is_simple, resample, segment_lengths, signed_area
from vasculo.pillars.merge import merge
from vasculo.pillars.splitting import CLEAR, shared_areas, split, split_thin, thin

SPACING = 0.18
NECK = 0.25 * 0.5 * SPACING


def dumb_bell(width, length=1.5, small=0.8):
    """Two disks, 1 and `small`, joined by a bridge; evenly spaced nodes unless it is short."""
    bridge = shapely.box(0.0, -width / 2, 1 + small + length, width / 2)
    disks = [shapely.Point(0, 0).buffer(1.0), shapely.Point(1 + small + length, 0).buffer(small)]
    outline = np.asarray(shapely.union_all([bridge, *disks]).exterior.coords)[:-1]
    return resample(outline, SPACING) if length > SPACING else outline


def test_a_thin_neck_parts_and_a_thicker_one_holds():
    for width, pieces in ((0.9 * NECK, 2), (1.3 * NECK, 1), (0.5, 1)):
        outline = dumb_bell(width)
        parts, source = split_thin([disk(30, 1.0, -5.0), outline, disk(30, 1.0, 9.0)], NECK, 0.1, SPACING)
        assert len(parts) == 2 + pieces
        np.testing.assert_array_equal(source, [0, *[1] * pieces, 2])
        if pieces == 1:
            assert parts[1] is outline


def test_pieces_are_valid_apart_and_little_smaller():
    outline = dumb_bell(0.5 * NECK)
    (first, second), source = split_thin([outline], NECK, 0.1, SPACING)
    assert is_simple(first)
    assert is_simple(second)
    assert signed_area(first) > signed_area(second) > 0
    assert signed_area(first) + signed_area(second) > 0.96 * signed_area(outline)
    assert shapely.distance(shapely.Polygon(first), shapely.Polygon(second)) > CLEAR * NECK
    for piece in (first, second):
        assert segment_lengths(piece).max() < 1.3 * SPACING
    rest = shared_areas(np.array([5.0]), [first, second], source)
    assert rest.sum() == pytest.approx(5.0)
    assert rest[0] / rest[1] == pytest.approx(signed_area(first) / signed_area(second))


def test_a_short_neck_parts_for_good():
    # the pieces of the opening alone would be nearer than the gap at which pillars merge
    outline = dumb_bell(0.8 * NECK, length=0.3 * SPACING)
    parts, _ = split_thin([outline], NECK, 0.1, SPACING)
    assert len(parts) == 2
    assert len(near_pairs(parts, 4 * NECK)) == 0


def test_a_piece_too_small_for_a_pillar_stays():
    outline = dumb_bell(0.8 * NECK, small=0.12)
    assert len(split(outline, NECK, 0.1, 5 * NECK)) == 2
    assert split(outline, NECK, 0.2, 5 * NECK)[0] is outline


@pytest.mark.parametrize("squeeze", [1.0, 1.5, 2.5])
def test_what_has_just_merged_does_not_part(squeeze):
    # from blunt to pointed tips, just near enough to merge
    first = resample(disk(60, 1.0, 0.0, 0.0, squeeze), SPACING)
    mirror = 2 * first[:, 0].max() + 0.08
    outlines = [first, np.column_stack((mirror - first[::-1, 0], first[::-1, 1]))]
    merged = merge(outlines, np.ones(2), ((0,), (1,)), 0.5 * SPACING, SPACING, SPACING, 1, 0.0)
    assert len(merged.outlines) == 1
    assert split(merged.outlines[0], NECK, 0.1, 5 * NECK)[0] is merged.outlines[0]


def test_round_pillars_need_no_look():
    assert len(thin([disk(35), disk(16, 0.12, 4.0), disk(40, 1.0, 0.0, 5.0, 1.6)], NECK)) == 0
    assert len(thin([], NECK)) == 0
