"""Predicates against fractions: random, degenerate by a hair, exactly degenerate, tiny and huge."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numba import njit

from vasculo.geometry.predicates import LARGEST, SMALLEST, incircle, incircle_plain, orient2d, orient2d_plain


@njit
def all_turns(rows):
    signs = np.empty(len(rows))
    for i in range(len(rows)):
        r = rows[i]
        signs[i] = np.sign(orient2d(r[0], r[1], r[2], r[3], r[4], r[5]))
    return signs


@njit
def all_circles(rows):
    signs = np.empty(len(rows))
    for i in range(len(rows)):
        r = rows[i]
        signs[i] = np.sign(incircle(r[0], r[1], r[2], r[3], r[4], r[5], r[6], r[7]))
    return signs


def sign(value):
    return (value > 0) - (value < 0)


def exact_signs(rows):
    """Signs of both determinants for rows of whole numbers, which Python does not round."""
    ax, ay, bx, by, cx, cy, dx, dy = rows.astype(object).T
    turn = (ax - cx) * (by - cy) - (ay - cy) * (bx - cx)
    ax, ay, bx, by, cx, cy = ax - dx, ay - dy, bx - dx, by - dy, cx - dx, cy - dy
    circle = (
        (ax * ax + ay * ay) * (bx * cy - cx * by)
        + (bx * bx + by * by) * (cx * ay - ax * cy)
        + (cx * cx + cy * cy) * (ax * by - bx * ay)
    )
    return [np.array([sign(value) for value in values]) for values in (turn, circle)]


def whole(rng, kind, count):
    """Rows of four points with whole coordinates below 2^53, which are float64 numbers."""
    if kind == "random":
        return rng.integers(-(2**53), 2**53, (count, 8))
    if kind == "lattice":
        return rng.integers(0, 5, (count, 8)) * rng.integers(1, 2**50, (count, 1))
    if kind == "nearly on a line":
        start, step = rng.integers(-(2**40), 2**40, (count, 1, 2)), rng.integers(-(2**30), 2**30, (count, 1, 2))
        rows = start + step * rng.integers(-(2**18), 2**18, (count, 4, 1))
        return (rows + rng.integers(-1, 2, rows.shape)).reshape(count, 8)
    if kind == "on a line":
        start, step = rng.integers(-(2**40), 2**40, (count, 1, 2)), rng.integers(-(2**30), 2**30, (count, 1, 2))
        return (start + step * rng.integers(-(2**18), 2**18, (count, 4, 1))).reshape(count, 8)
    # corners of a rectangle: the lattice vectors (a, b) and (-b, a), so that all have whole coordinates
    a, b, long, wide = (rng.integers(-(2**20), 2**20, count) for _ in range(4))
    u, v = np.stack((a * long, b * long), axis=1), np.stack((-b * wide, a * wide), axis=1)
    centre = rng.integers(-(2**50), 2**50, (count, 2))
    rows = np.concatenate((centre, centre + u, centre + u + v, centre + v), axis=1)
    if kind == "nearly on a circle":
        rows += rng.integers(-1, 2, rows.shape)
    return rows


@pytest.mark.parametrize("scale", [1.0, 2.0**-200, 2.0**170])
@pytest.mark.parametrize(
    "kind", ["random", "lattice", "nearly on a line", "on a line", "on a circle", "nearly on a circle"]
)
def test_signs_are_exact(kind, scale):
    rng = np.random.default_rng(7)
    rows = whole(rng, kind, 8_000)
    turns, circles = exact_signs(rows)
    assert np.array_equal(all_turns(rows.astype(np.float64) * scale), turns)
    assert np.array_equal(all_circles(rows.astype(np.float64) * scale), circles)
    if kind == "on a line":
        assert not turns.any()
    if kind == "on a circle":
        assert not circles.any()


coordinates = st.one_of(
    st.floats(SMALLEST, LARGEST), st.floats(-LARGEST, -SMALLEST), st.just(0.0), st.sampled_from([0.1, 0.3, 1 / 3, 1.0])
)


@settings(deadline=None, max_examples=500)
@given(values=st.lists(coordinates, min_size=8, max_size=8))
def test_coordinates_of_any_size(values):
    assert sign(orient2d(*values[:6])) == sign(orient2d_plain(*values[:6]))
    assert sign(incircle(*values)) == sign(incircle_plain(*values))


@settings(deadline=None, max_examples=300)
@given(
    corner=st.tuples(st.floats(-10, 10), st.floats(-10, 10)).map(
        lambda c: tuple(0.0 if abs(v) < SMALLEST else v for v in c)
    ),
    moves=st.lists(st.integers(-3, 3), min_size=8, max_size=8),
)
def test_points_a_few_roundings_apart(corner, moves):
    points = np.array([corner, corner[::-1], [-v for v in corner], [-v for v in corner[::-1]]]).ravel()
    for _ in range(3):
        points = np.where(np.array(moves) > 0, np.nextafter(points, 20.0), np.where(points == 0.0, 0.0, points))
    points = [0.0 if abs(value) < SMALLEST else float(value) for value in points]
    assert sign(orient2d(*points[:6])) == sign(orient2d_plain(*points[:6]))
    assert sign(incircle(*points)) == sign(incircle_plain(*points))


def test_where_the_filter_is_wrong_without_the_exact_sum():
    # on the line y = x but for the last bit: the determinant in float64 is 0 or has the wrong sign for many of these
    step = 2.0**-53
    grid = [(0.5 + i * step, 0.5 + j * step) for i in range(16) for j in range(16)]
    rows = np.array([(12.0, 12.0, 24.0, 24.0, x, y, 0.0, 0.0) for x, y in grid])
    naive = (rows[:, 0] - rows[:, 4]) * (rows[:, 3] - rows[:, 5]) - (rows[:, 1] - rows[:, 5]) * (
        rows[:, 2] - rows[:, 4]
    )
    exact = np.array([sign(orient2d_plain(*row[:6])) for row in rows])
    assert np.count_nonzero(np.sign(naive) != exact) > 20
    assert np.array_equal(all_turns(rows), exact)


def test_known_values():
    assert orient2d(0.0, 0.0, 1.0, 0.0, 0.0, 1.0) == 1.0
    assert orient2d(0.0, 0.0, 0.0, 1.0, 1.0, 0.0) == -1.0
    assert incircle(0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.4, 0.4) > 0.0
    assert incircle(0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0) == 0.0
    assert incircle(0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0 + 2.0**-52) < 0.0
