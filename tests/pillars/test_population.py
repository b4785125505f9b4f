import numpy as np
import pytest
from tests.pillars.shapes import disk

from vasculo.errors import ComputationError
from vasculo.geometry.outline import signed_area
from vasculo.pillars.population import Population, outline_areas, part, vanish


def dumbbell(neck):
    """Two disks of radius 1 at x = 0 and 4, joined by a bar of width `neck`."""
    half = neck / 2
    start = np.arcsin(half)
    t = np.linspace(start, 2 * np.pi - start, 41)
    left = np.column_stack((np.cos(t), np.sin(t)))
    right = np.column_stack((4 - np.cos(t), -np.sin(t)))
    bar = np.linspace(np.cos(start), 4 - np.cos(start), 12)[1:-1]
    below = np.column_stack((bar, np.full(len(bar), -half)))
    return np.concatenate((left, below, right, below[::-1] * (1, -1)))


def population(outlines):
    count = len(outlines)
    return Population(outlines, outline_areas(outlines), tuple((k,) for k in range(count)), np.arange(count), count)


def test_small_pillars_vanish_and_are_told():
    before = population([disk(30), disk(16, 0.05, 4.0, 1.0), disk(30, 0.8, 8.0)])
    after, events = vanish(before, 0.1, 7, 0.5)
    assert after.lineage == ((0,), (2,))
    np.testing.assert_array_equal(after.source, [0, 2])
    np.testing.assert_allclose(after.rest_areas, before.rest_areas[[0, 2]])
    (event,) = events
    assert (event.step, event.time, event.kind, event.pillars) == (7, 0.5, "vanish", ((1,),))
    assert event.place == pytest.approx((4.0, 1.0))


def test_a_pillar_turned_inside_out_vanishes_too():
    after, events = vanish(population([disk(30), disk(16, 0.5, 4.0)[::-1]]), 0.1, 1, 0.0)
    assert len(after.outlines) == len(events) == 1


def test_the_last_pillar_does_not_vanish_silently():
    with pytest.raises(ComputationError, match=r"no pillar is left: the last 2 .* radius of 0.1"):
        vanish(population([disk(16, 0.05), disk(16, 0.05, 1.0)]), 0.1, 1, 0.0)


def test_a_thin_neck_parts_and_the_larger_piece_keeps_the_name():
    outlines = [disk(30, 1.0, 0.0, 5.0), np.concatenate((dumbbell(0.02),)), disk(30, 1.0, 4.0, 5.0)]
    outlines[1] = np.where(outlines[1][:, :1] > 2, (outlines[1] - (4, 0)) * 1.2 + (4.4, 0), outlines[1])
    before = population(outlines)
    after, events = part(before, 0.05, 0.1, 0.18, 3, 0.2)
    assert len(after.outlines) == 4
    assert sorted(after.lineage) == [(0,), (1,), (2,), (3,)]
    assert after.next_pillar == 4
    (event,) = events
    assert (event.kind, event.pillars) == ("split", ((1,), (3,)))
    sizes = {names: signed_area(outline) for names, outline in zip(after.lineage, after.outlines, strict=True)}
    assert sizes[(1,)] > sizes[(3,)]
    assert after.rest_areas.sum() == pytest.approx(before.rest_areas.sum())
    assert sorted(after.source) == [-1, -1, 0, 2]


def test_a_thick_neck_holds():
    before = population([dumbbell(0.2)])
    after, events = part(before, 0.05, 0.1, 0.18, 3, 0.2)
    assert after is before
    assert events == ()
