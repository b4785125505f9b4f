"""One closed polygon."""

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from vasculo.errors import InputError
from vasculo.geometry.outline import (
    as_outline,
    centroid,
    is_simple,
    perimeter,
    resample,
    second_moments,
    segment_lengths,
    signed_area,
)


def ellipse(a, b, k=400):
    t = 2 * np.pi * np.arange(k) / k
    return np.column_stack((a * np.cos(t), b * np.sin(t)))


def rotation(angle):
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


TRIANGLE = np.array([(0.0, 0.0), (4.0, 0.0), (0.0, 3.0)])


def test_triangle_has_its_textbook_numbers():
    assert signed_area(TRIANGLE) == pytest.approx(6.0)
    assert perimeter(TRIANGLE) == pytest.approx(12.0)
    assert centroid(TRIANGLE) == pytest.approx([4 / 3, 1.0])
    # central moments of a triangle: sum of (v - c)(v - c)^T over the vertices, over 12
    away = TRIANGLE - TRIANGLE.mean(axis=0)
    assert second_moments(TRIANGLE) == pytest.approx(away.T @ away / 12)
    assert segment_lengths(TRIANGLE) == pytest.approx([4, 5, 3])


def test_rectangle_moments():
    box = np.array([(1.0, 2.0), (7.0, 2.0), (7.0, 4.0), (1.0, 4.0)])
    assert second_moments(box) == pytest.approx(np.diag([36 / 12, 4 / 12]), abs=1e-14)


@settings(deadline=None)
@given(
    a=st.floats(0.5, 3.0), b=st.floats(0.5, 3.0), angle=st.floats(-3.0, 3.0), x=st.floats(-50, 50), y=st.floats(-50, 50)
)
def test_moments_move_and_turn_with_the_outline(a, b, angle, x, y):
    turn = rotation(angle)
    outline = ellipse(a, b) @ turn.T + (x, y)
    assert centroid(outline) == pytest.approx([x, y], abs=1e-10)
    exact = turn @ np.diag([a * a, b * b]) @ turn.T / 4
    assert np.abs(second_moments(outline) - exact).max() < 2e-4 * max(a, b) ** 2
    assert signed_area(outline) == pytest.approx(signed_area(outline[::-1]) * -1)


def test_reversed_outline_keeps_centroid_and_moments():
    assert centroid(TRIANGLE[::-1]) == pytest.approx(centroid(TRIANGLE))
    assert second_moments(TRIANGLE[::-1]) == pytest.approx(second_moments(TRIANGLE))


def test_area_keeps_its_digits_far_from_the_origin():
    assert signed_area(TRIANGLE + 1e8) == pytest.approx(6.0, rel=1e-12)


def test_as_outline_turns_drops_and_keeps_the_first_node():
    messy = [(0, 0), (0, 0), (0, 1), (1, 1), (1, 1), (1, 0), (0, 0)]
    clean = as_outline(messy)
    assert clean.dtype == np.float64
    assert np.array_equal(clean, [(0, 0), (1, 0), (1, 1), (0, 1)])
    assert signed_area(clean) == 1.0
    assert np.array_equal(as_outline(clean), clean)


def test_as_outline_does_not_touch_its_input():
    given_points = np.array([(0.0, 0.0), (0.0, 1.0), (1.0, 1.0)])
    kept = given_points.copy()
    as_outline(given_points)[0] = 9.0
    assert np.array_equal(given_points, kept)


@pytest.mark.parametrize(
    ("points", "words"),
    [
        ([(0, 0), (1, np.nan), (1, 1)], "node 1 of the outline is not finite"),
        ([(0, 0), (1, 0)], "at least 3 distinct nodes, not 2"),
        ([(0, 0), (1, 0), (1, 0), (0, 0)], "at least 3 distinct nodes, not 2"),
        ([(0, 0), (1, 1), (2, 2)], "encloses no area"),
        ([1, 2, 3], r"must have shape \(k, 2\), not \(3,\)"),
        ([], "must have shape"),
        ("abc", "array of numbers"),
        ([(0, 0), (1,), (2, 2)], "array of numbers"),
        (np.empty((0, 2)), "at least 3 distinct nodes, not 0"),
    ],
)
def test_as_outline_refuses(points, words):
    with pytest.raises(InputError, match=words) as caught:
        as_outline(points)
    assert "\n" not in str(caught.value)


def test_is_simple():
    assert is_simple(TRIANGLE)
    assert not is_simple(np.array([(0.0, 0.0), (1.0, 1.0), (1.0, 0.0), (0.0, 1.0)]))
    touching = np.array([(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (1.0, 0.0), (0.0, 2.0)])
    assert not is_simple(touching)


@pytest.mark.parametrize("smooth", [False, True])
def test_resample_spaces_evenly_from_node_0(smooth):
    outline = ellipse(2.0, 1.0, 90)
    fresh = resample(outline, 0.1, smooth=smooth)
    assert fresh[0] == pytest.approx(outline[0])
    lengths = segment_lengths(fresh)
    assert len(fresh) == round(perimeter(outline) / 0.1)
    assert lengths.max() / lengths.min() < 1.02
    assert lengths.mean() == pytest.approx(0.1, rel=0.02)
    assert signed_area(fresh) > 0


def test_resample_keeps_to_the_polygon_or_to_the_spline():
    outline = ellipse(1.0, 1.0, 24)
    straight, smooth = resample(outline, 0.05), resample(outline, 0.05, smooth=True)
    radius = np.hypot(*straight.T)
    assert radius.max() <= 1.0 + 1e-12
    assert radius.min() >= np.cos(np.pi / 24) - 1e-12
    assert np.abs(np.hypot(*smooth.T) - 1.0).max() < 1e-3


def test_smooth_resampling_converges_at_fourth_order():
    errors = []
    for k in (16, 32, 64):
        fresh = resample(ellipse(1.0, 1.0, k), 0.02, smooth=True)
        errors.append(np.abs(np.hypot(*fresh.T) - 1.0).max())
    slopes = np.log2(np.array(errors[:-1]) / errors[1:])
    assert slopes.min() > 3.5


def test_resample_minimum_and_refusals():
    assert len(resample(ellipse(1, 1), 10.0)) == 16
    assert len(resample(ellipse(1, 1), 10.0, minimum=5)) == 5
    for spacing in (0.0, -1.0, np.nan):
        with pytest.raises(InputError, match="positive spacing"):
            resample(ellipse(1, 1), spacing)
    with pytest.raises(InputError, match="at least 3 nodes"):
        resample(ellipse(1, 1), 1.0, minimum=2)


def jagged(rng, triangles):
    """Return a random simple polygon, with corners of every angle: the outline of a heap of triangles."""
    middle = 2.0 * rng.random((triangles, 1, 2))
    heap = shapely.union_all(shapely.polygons(middle + rng.normal(size=(triangles, 3, 2))))
    widest = max(shapely.get_parts(heap), key=lambda part: part.area)
    return as_outline(np.array(widest.exterior.coords))


@settings(max_examples=60, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    spacing=st.floats(0.05, 2.0),
    corners=st.one_of(st.none(), st.floats(5.0, 170.0)),
    minimum=st.integers(3, 30),
)
def test_kept_corners_and_area_never_make_an_outline_cross_itself(seed, spacing, corners, minimum):
    rng = np.random.default_rng(seed)
    for _ in range(50):
        outline = jagged(rng, rng.integers(1, 12))
        if not is_simple(outline):
            continue
        fresh = resample(outline, spacing, minimum=minimum, corners=corners, keep_area=True)
        assert is_simple(fresh)
        assert signed_area(fresh) == pytest.approx(signed_area(outline), rel=1e-3)
        assert len(fresh) >= min(minimum, len(outline))


def test_corners_of_a_polygon_stay_where_they_are():
    outline = as_outline([(0, 0), (5, 0), (5, 2), (2, 2), (2, 4), (0, 4)])
    fresh = resample(outline, 0.3, corners=45.0, keep_area=True)
    away = np.hypot(*(fresh[:, None] - outline[None]).T)
    assert away.min(axis=1) == pytest.approx(0.0, abs=1e-12)
    assert signed_area(fresh) == pytest.approx(14.0, rel=1e-12)
    lengths = segment_lengths(fresh)
    assert lengths.max() / lengths.min() < 1.25
    assert lengths.mean() == pytest.approx(0.3, rel=0.05)
    cut = resample(outline, 0.47)
    assert np.hypot(*(cut[:, None] - outline[None]).T).min(axis=1).max() > 0.1


def test_corners_do_not_depend_on_the_start():
    outline = as_outline([(0, 0), (5, 0), (5, 2), (2, 2), (2, 4), (0, 4)])
    one, two = (resample(np.roll(outline, k, axis=0), 0.3, corners=45.0) for k in (0, 4))
    shift = int(np.flatnonzero(np.hypot(*(two - one[0]).T) < 1e-12)[0])
    assert np.roll(two, -shift, axis=0) == pytest.approx(one, abs=1e-12)


@pytest.mark.parametrize(("radius", "wanted"), [(1.0, 0), (0.1, 4)])
def test_a_rounded_arc_is_no_corner(radius, wanted):
    # a square with rounded corners; an arc of radius r turns by spacing / (2 r) radians
    square = shapely.box(0, 0, 10, 10).buffer(-radius).buffer(radius, quad_segs=16)
    outline = as_outline(np.array(square.exterior.coords))
    fresh = resample(outline, 1.0, corners=40.0)
    middle = 10.0 - radius + radius / np.sqrt(2.0)
    corner = np.array(
        [(10.0 - middle, 10.0 - middle), (middle, 10.0 - middle), (middle, middle), (10.0 - middle, middle)]
    )
    assert np.count_nonzero(np.hypot(*(fresh[:, None] - corner).T).min(axis=1) < 1e-9) == wanted


def test_of_two_close_corners_the_sharper_stays():
    # a chamfer half a spacing long: its ends turn by 60 and 30 degrees
    outline = as_outline([(0, 0), (10, 0), (10, 6.0), (10 - 0.5 * np.sqrt(0.75), 6.25), (0, 6.25)])
    fresh = resample(outline, 1.0, corners=25.0)
    at = [np.hypot(*(fresh - node).T).min() for node in outline]
    assert np.count_nonzero(np.array(at[2:4]) < 1e-12) == 1
    assert at[2] < 1e-12


@pytest.mark.parametrize("nodes", [3, 4, 7, 16, 100])
@pytest.mark.parametrize("smooth", [False, True])
def test_area_is_kept_at_any_number_of_nodes(nodes, smooth):
    outline = ellipse(2.0, 1.0, 400)
    fresh = resample(outline, 1e9, minimum=nodes, smooth=smooth, keep_area=True)
    assert len(fresh) == nodes
    assert signed_area(fresh) == pytest.approx(2.0 * np.pi, rel=1e-3)
    lengths = segment_lengths(fresh)
    assert lengths.max() / lengths.min() < 1.3
    clockwise = resample(outline[::-1], 1e9, minimum=nodes, smooth=smooth, keep_area=True)
    assert signed_area(clockwise) == pytest.approx(-2.0 * np.pi, rel=1e-3)


def test_a_thin_outline_gets_nodes_until_it_is_simple():
    # two arms 0.01 apart: nodes one unit apart would make the sides cross
    t = np.linspace(0.0, 6.0, 200)
    wave = np.column_stack((t, np.sin(3.0 * t)))
    outline = as_outline(np.concatenate((wave, wave[::-1] + np.array((0.0, 0.01)))))
    assert not is_simple(resample(outline, 0.7))
    fresh = resample(outline, 0.7, keep_area=True)
    assert is_simple(fresh)
    assert len(fresh) > 2 * round(perimeter(outline) / 0.7)


def test_corner_refusals():
    for corners in (0.0, 180.0, -3.0, np.nan):
        with pytest.raises(InputError, match="angle between 0 and 180"):
            resample(TRIANGLE, 1.0, corners=corners)
    with pytest.raises(InputError, match="no spline"):
        resample(TRIANGLE, 1.0, corners=45.0, smooth=True)
