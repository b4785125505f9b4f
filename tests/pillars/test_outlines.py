import numpy as np
import pytest
from tests.pillars.shapes import disk

from vasculo.errors import InputError
from vasculo.geometry.outline import is_simple, segment_lengths, signed_area
from vasculo.pillars.outlines import keep_inside, needs_nodes, tidy

BOX = np.array([[0.0, 0.0], [10.0, 0.0], [10.0, 4.0], [0.0, 4.0]])


def test_nodes_are_kept_off_the_border():
    outline = disk(40, 1.0, 9.2, 0.9)
    kept = keep_inside(outline, BOX, 0.05)
    assert kept.min() >= 0.05 - 1e-12
    assert kept[:, 0].max() <= 9.95 + 1e-12
    inside = (outline[:, 1] > 0.05) & (outline[:, 0] < 9.95)
    np.testing.assert_array_equal(kept[inside], outline[inside])
    np.testing.assert_allclose(kept[(outline[:, 1] < 0.05) & (outline[:, 0] < 9.95), 1], 0.05)


def test_nodes_are_kept_off_a_slanted_border():
    outer = np.array([[0.0, 0.0], [10.0, 5.0], [10.0, 9.0], [0.0, 4.0]])
    kept = keep_inside(disk(40, 1.0, 5.0, 3.5), outer, 0.1)
    distance = (kept[:, 1] - 0.5 * kept[:, 0]) / np.hypot(1.0, 0.5)
    assert distance.min() == pytest.approx(0.1)


def test_a_domain_too_narrow_is_reported():
    with pytest.raises(InputError, match="too narrow"):
        keep_inside(disk(20), BOX, 2.1)


def test_even_outlines_are_left_alone():
    outline = disk(35)
    assert not needs_nodes(outline, 0.18)
    np.testing.assert_array_equal(tidy([outline], 0.18, 0.18)[0], outline)


def test_uneven_or_too_few_nodes_are_renewed_at_constant_area():
    t = np.linspace(0, 2 * np.pi, 35, endpoint=False)
    t += 0.25 * np.sin(t)
    uneven = np.column_stack((1.5 * np.cos(t), 0.7 * np.sin(t)))
    coarse = disk(24, 1.2)
    for outline in (uneven, coarse):
        assert needs_nodes(outline, 0.18)
        new = tidy([outline], 0.18, 0.18)[0]
        sides = segment_lengths(new)
        assert sides.max() < 1.1 * sides.min()
        assert sides.mean() == pytest.approx(0.18, rel=0.03)
        true = np.pi * (1.05 if outline is uneven else 1.44)
        assert abs(signed_area(new) - true) < 0.012 * true


def test_a_crossing_outline_becomes_simple():
    outline = disk(60, 1.0, 0.0, 0.0, 1.5)
    outline[15] = (0.0, -0.7)
    assert is_simple(tidy([outline], 0.18, 0.18)[0])


def test_small_pillars_keep_sixteen_nodes():
    assert len(tidy([disk(12, 0.2)], 0.18, 0.18)[0]) == 16
