"""Where nodes stand: the throw of disks against its twin, nodes pushed apart."""

import numpy as np
import pytest

from vasculo.tissue.placement import apart, throw_disks, throw_disks_plain


@pytest.mark.parametrize("wrap", [True, False])
@pytest.mark.parametrize("most", [20_000, 90])
def test_disks_are_those_of_the_twin(wrap, most):
    radius, number, given = 0.07, 90, 5
    start = np.full((number, 2), np.nan)
    start[:given] = [[0.0, 0.0], [1.0, 1.0], [0.5, 1.0], [0.2, 0.2], [0.9, 0.05]]
    ours, plain = start.copy(), start.copy()
    grid = np.full((14, 14, 8), -1, np.int32)
    placed = throw_disks(np.random.default_rng(3), ours, given, radius, 0.03, wrap, grid, most)
    assert throw_disks_plain(np.random.default_rng(3), plain, given, radius, 0.03, wrap, most) == placed
    assert (placed == number) == (most == 20_000)
    assert np.array_equal(ours[:placed], plain[:placed])


@pytest.mark.parametrize("torus", [True, False])
def test_nodes_are_pushed_apart(torus):
    points = np.random.default_rng(1).random((150, 2))
    moved = apart(points.copy(), 0.03, torus=torus)
    arms = moved[:, None] - moved[None]
    if torus:
        arms -= np.round(arms)
    away = np.hypot(*arms.transpose(2, 0, 1)) + np.eye(150)
    assert away.min() > 0.029
    assert np.all((moved >= 0.0) & (moved <= 1.0))
