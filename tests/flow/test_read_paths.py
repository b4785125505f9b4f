"""One triangle of a path: rates, the first way out and its time, against the matrix exponential."""

import numpy as np
import pytest
from scipy.linalg import expm

from vasculo.flow.read.paths import first_zero, move_for, rates_in, time_of


def random_triangle(rng, turning):
    """Outflow through the edges of a triangle of area 1/2, divergence-free; a rigid rotation on top if `turning`."""
    outflow = rng.normal(size=(1, 3, 2)) * (0.2 if turning else 1.0)
    outflow[0, 2] -= outflow.sum() / 2.0
    if turning:
        # the same through all edges, in at one end and out at the other: no flux, only spin
        outflow += rng.choice([-3.0, 3.0]) * np.array([1.0, -1.0])
    return outflow


def rates_of(outflow, area=0.5):
    rates = np.empty((3, 3))
    return rates, rates_in(0, area, outflow, rates)


@pytest.mark.parametrize("turning", [False, True])
def test_rates_keep_the_sum_and_have_no_trace(turning):
    rng = np.random.default_rng(0)
    for _ in range(50):
        rates, square = rates_of(random_triangle(rng, turning))
        np.testing.assert_allclose(rates.sum(axis=0), 0.0, atol=1e-13)
        assert np.trace(rates) == pytest.approx(0.0, abs=1e-13)
        np.testing.assert_allclose(rates @ rates @ rates, square * rates, atol=1e-11)
        assert square < 0.0 or not turning


@pytest.mark.parametrize("turning", [False, True])
def test_the_way_out_is_the_first_zero(turning):
    rng = np.random.default_rng(1)
    late = 0
    for _ in range(60):
        rates, square = rates_of(random_triangle(rng, turning))
        now = rng.dirichlet([1.0, 1.0, 1.0])
        a, b = rates @ now, rates @ rates @ now
        for k in range(3):
            key = first_zero(now[k], a[k], b[k], square)
            period = 2.0 * np.pi / np.sqrt(-square) if square < 0.0 else 8.0 / np.abs(rates).max()
            step = expm(rates * period / 500)
            values = [now]
            for _ in range(500):
                values.append(step @ values[-1])
            shares = np.array(values)[:, k]
            if not np.isfinite(key):
                assert shares.min() > -1e-9
                continue
            time = time_of(-1.0 / key, square)
            late += square < 0.0 and time > 0.5 * period
            assert abs((expm(rates * time) @ now)[k]) < 1e-9 * max(1.0, np.exp(time * np.sqrt(abs(square))))
            before = shares[: int(0.999 * time / period * 500) + 1]
            assert before.min() > -1e-9
    assert late > 2


def test_an_edge_that_is_entered_is_no_way_out_at_once():
    # The coordinate is zero now and grows; with b < 0 it comes back.
    assert first_zero(0.0, 1.0, -4.0, 0.0) == pytest.approx(-2.0)
    assert first_zero(0.0, 1.0, 4.0, 0.0) == np.inf
    assert first_zero(0.0, 1.0, 0.0, 0.0) == np.inf
    assert first_zero(0.0, -1.0, 4.0, 0.0) == -np.inf


@pytest.mark.parametrize("square", [4.0, 1e-9, 0.0, -1e-9, -4.0])
def test_times(square):
    root = np.sqrt(complex(square))
    for time in (1e-3, 0.3, 1.0, 1.5):
        w = time if square == 0.0 else (2.0 * np.tanh(root * time / 2.0) / root).real
        assert time_of(w, square) == pytest.approx(time, rel=1e-12)
    if square == -4.0:
        for time in (1.7, 3.0):  # beyond half a turn, pi / 2
            assert time_of(np.tan(time), square) == pytest.approx(time, rel=1e-12)


@pytest.mark.parametrize("turning", [False, True])
def test_moving_for_a_time(turning):
    rng = np.random.default_rng(2)
    for scale in (1.0, 1e-5):
        rates, square = rates_of(random_triangle(rng, turning) * scale)
        now = rng.dirichlet([20.0, 20.0, 20.0])
        time = 0.05 / np.abs(rates).max()
        moved = now.copy()
        move_for(time, square, moved, rates @ now, rates @ rates @ now)
        np.testing.assert_allclose(moved, expm(rates * time) @ now, atol=1e-14)
