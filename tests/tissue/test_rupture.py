"""Thresholds, growth pieces and loose pieces."""

from itertools import pairwise

import numpy as np

from vasculo.springs.network import SpringNetwork
from vasculo.tissue.growth import check_interval, growth_steps, pieces
from vasculo.tissue.lattice import lattice
from vasculo.tissue.parameters import Vasculogenesis
from vasculo.tissue.rupture import WEAKEST, breaking_forces, largest_component


def test_thresholds_have_their_mean_spread_and_floor():
    tissue = lattice(3_000, 0)
    inner = ~tissue.pinned[tissue.springs].all(axis=1)
    for spread in (0.0, 0.2, 0.6):
        limits = breaking_forces(tissue, Vasculogenesis(threshold=0.4, threshold_spread=spread), 5)
        strain = limits[inner] / tissue.rest_lengths[inner]
        if spread <= 0.2:
            assert abs(strain.mean() / 0.4 - 1.0) < 0.01 + 1e-12
            assert abs(strain.std() / 0.4 - spread) < 0.006
        assert strain.min() >= 0.4 * WEAKEST * (1.0 - 1e-12)
        assert np.all(np.isinf(limits[~inner]))
    assert np.count_nonzero(np.isclose(strain, 0.4 * WEAKEST)) > 50  # spread 0.6 reaches the floor


def test_thresholds_scale_with_length_and_stiffness():
    tissue = lattice(200, 0)
    plain = breaking_forces(tissue, Vasculogenesis(), 1)
    tissue.stiffness *= 3.0
    tissue.rest_lengths *= 0.5
    np.testing.assert_allclose(breaking_forces(tissue, Vasculogenesis(), 1), 1.5 * plain, rtol=1e-14)
    assert not np.array_equal(
        breaking_forces(tissue, Vasculogenesis(), 2), breaking_forces(tissue, Vasculogenesis(), 1)
    )


def test_pieces_join_to_the_whole_run():
    parts = list(pieces(1.0, 0.4, 103, 10))
    assert sum(steps for steps, _, _ in parts) == 103
    assert parts[0][1] == 1.0
    assert abs(parts[-1][2] - 0.4) < 1e-15
    for (steps, first, last), (_, begin, _) in pairwise(parts):
        assert last == begin
        assert abs((first - last) / steps - 0.6 / 103) < 1e-15
    assert list(pieces(1.0, 0.4, 0, 10)) == []


def test_looks_come_every_half_percent():
    chosen = Vasculogenesis(growth_rate=0.0025, time_step=0.1)
    assert check_interval(chosen.growth_rate, chosen) == 20  # 0.005 / 0.0025 = 2 time units
    assert check_interval(1e-6, chosen) == 50  # never longer than 5
    assert check_interval(10.0, chosen) == 1
    assert growth_steps(chosen, 0.6) == 1600


def test_the_largest_piece():
    points = np.random.default_rng(0).random((7, 2))
    network = SpringNetwork(points, [[4, 5], [5, 6], [1, 2], [0, 1]])
    assert np.flatnonzero(largest_component(network)).tolist() == [0, 1, 2]
    network.remove_springs([3])
    assert np.flatnonzero(largest_component(network)).tolist() == [4, 5, 6]
