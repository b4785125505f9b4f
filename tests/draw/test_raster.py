"""Lines as an image: the kernel against its twin, exact coverage, exact ink, and nothing outside."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from vasculo.draw.raster import CAP, paint, raster, to_rgba
from vasculo.draw.raster_plain import area, cut, paint_plain, strip


def drawn(segments, widths, greys=0.0, shape=(16, 24), by=paint):
    """Opacity of lines on an empty canvas."""
    segments = np.atleast_2d(np.array(segments, dtype=float))
    canvas = np.zeros((*shape, 2), dtype=np.float32)
    widths, greys = (np.broadcast_to(np.array(x, dtype=float), len(segments)).copy() for x in (widths, greys))
    by(canvas, segments, widths, greys)
    return canvas


def test_kernel_and_twin_agree():
    rng = np.random.default_rng(0)
    segments = rng.uniform(-8.0, 32.0, (160, 4))
    segments[:15, 2:] = segments[:15, :2]  # no length
    segments[15:30, 3] = segments[15:30, 1]  # along x
    segments[30:45, 2] = segments[30:45, 0]  # along y
    segments[45:75] = np.rint(segments[45:75])  # on the corners of the pixels
    segments[75:80] = [-900.0, -700.0, 950.0, 740.0]  # far longer than the image
    widths, greys = rng.uniform(0.01, 4.0, 160), rng.random(160)
    for one in range(160):
        rows = slice(one, one + 1)
        both = [drawn(segments[rows], widths[rows], greys[rows], by=by) for by in (paint, paint_plain)]
        np.testing.assert_allclose(both[0], both[1], atol=2e-6, err_msg=f"line {one}: {segments[one]}")
    together = [drawn(segments, widths, greys, by=by) for by in (paint, paint_plain)]
    np.testing.assert_allclose(together[0], together[1], atol=1e-5)


place = st.floats(-30.0, 50.0, width=32)


@given(place, place, place, place, st.floats(0.01, 8.0))
def test_kernel_and_twin_agree_on_any_line(a, b, c, d, width):
    one, two = (drawn([a, b, c, d], width, by=by) for by in (paint, paint_plain))
    np.testing.assert_allclose(one, two, atol=1e-5)


def test_a_horizontal_line_covers_what_it_covers():
    opacity = drawn([4.0, 5.25, 10.0, 5.25], 1.0)[:, :, 1]
    np.testing.assert_allclose(opacity[4:7, 7], [0.25, 0.75, 0.0])
    np.testing.assert_allclose(opacity[5, 2:5], [0.0, 0.75 * CAP, 0.75], rtol=1e-6)
    np.testing.assert_allclose(opacity[5, 9:12], [0.75, 0.75 * CAP, 0.0], rtol=1e-6)


def test_a_vertical_line_is_the_horizontal_one_turned():
    lying = drawn([4.0, 5.25, 10.0, 5.25], 1.3, shape=(16, 16))
    standing = drawn([5.25, 4.0, 5.25, 10.0], 1.3, shape=(16, 16))
    np.testing.assert_allclose(standing, lying.transpose(1, 0, 2), atol=1e-6)


def test_a_diagonal_line_through_the_corners_of_pixels():
    # A strip of width sqrt(2) about y = x covers |y - x| < 1: all of its pixels, half of their neighbours.
    opacity = drawn([-5.0, -5.0, 30.0, 30.0], 2.0**0.5)[:, :, 1]
    np.testing.assert_allclose(np.diag(opacity), 1.0, atol=1e-6)
    np.testing.assert_allclose(np.diag(opacity, 1), 0.5, atol=1e-6)
    np.testing.assert_allclose(np.diag(opacity, -1), 0.5, atol=1e-6)
    assert np.count_nonzero(np.triu(opacity, 2) > 1e-6) == 0


@pytest.mark.parametrize("width", [0.03, 0.4, 1.0, 3.7])
@pytest.mark.parametrize("angle", np.deg2rad([0.0, 10.0, 45.0, 77.0, 90.0, 200.0, 315.0]))
def test_the_ink_is_length_times_width(width, angle):
    centre, half = np.array([12.3, 8.1]), 2.7 * np.array([np.cos(angle), np.sin(angle)])
    ink = drawn([*(centre - half), *(centre + half)], width)[:, :, 1].sum()
    assert ink == pytest.approx(5.4 * width + 0.25 * np.pi * width**2, rel=1e-5)


def test_a_line_without_length_is_a_dot():
    assert drawn([7.2, 6.6, 7.2, 6.6], 2.0)[:, :, 1].sum() == pytest.approx(np.pi, rel=1e-6)


def test_what_lies_outside_leaves_no_trace():
    outside = [[-9, 3, -4, 8], [30, 3, 40, 8], [3, -9, 8, -4], [3, 20, 8, 40], [-20, 10, 10, 60], [-5, -5, -5, -5]]
    assert not drawn(outside, 1.0).any()
    assert drawn([3, 3, 9, 9], 1.0, shape=(0, 0)).size == 0
    assert not drawn([np.nan, 3, 9, 9], 1.0).any()
    assert not drawn(np.empty((0, 4)), 1.0).any()


def test_a_line_is_cut_off_at_the_border():
    large = drawn([-7.0, 2.0, 50.0, 31.0], 2.3, shape=(40, 60))
    small = drawn([-17.0, -8.0, 40.0, 21.0], 2.3, shape=(16, 24))
    np.testing.assert_allclose(small, large[10:26, 10:34], atol=1e-6)
    assert small[:, :, 1].any()


def test_paint_adds_up_and_the_last_line_lies_on_top():
    line = [2.0, 5.5, 20.0, 5.5]
    thin = drawn([line] * 20, 0.1)[5, 10, 1]
    assert thin == pytest.approx(1.0 - 0.9**20, rel=1e-5)
    grey, opacity = drawn([line, line], 1.0, [0.8, 0.1])[5, 10]
    assert (grey, opacity) == pytest.approx((0.1, 1.0))


def test_the_image_has_its_grey_and_is_clear_elsewhere():
    image = raster(np.array([[2.0, 5.5, 20.0, 5.5]]), np.array([0.5]), np.array([0.2]), (16, 24))
    assert image.shape == (16, 24, 4)
    assert list(image[5, 10]) == [51, 51, 51, 128]
    assert not image[8:].any()
    assert list(to_rgba(np.array([[[0.5, 0.5]]], dtype=np.float32))[0, 0]) == [255, 255, 255, 128]


def test_single_precision_is_enough():
    rng = np.random.default_rng(1)
    lines = rng.uniform(0.0, 16.0, (500, 4)), rng.uniform(0.05, 2.0, 500), rng.random(500)
    double, single = raster(*lines, (16, 16)), raster(*(x.astype(np.float32) for x in lines), (16, 16))
    assert np.abs(double.astype(int) - single).max() <= 1


def test_the_twin_cuts_polygons_exactly():
    corners = strip(np.array([0.0, 0.0, 10.0, 0.0]), 1.0)
    assert area(corners) == pytest.approx(10.0 + 2 * CAP)
    assert area(cut(corners, 3, 0)) == pytest.approx(0.5)
    assert area(cut(corners, 30, 0)) == 0.0
