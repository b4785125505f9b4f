"""Thresholds, growth pieces and loose pieces."""

from itertools import pairwise

import numpy as np
import pytest
from scipy import stats
from scipy.spatial import cKDTree
from scipy.special import gamma

from vasculo.tissue.growth import check_interval, growth_steps, pieces, steps_in
from vasculo.tissue.lattice import lattice
from vasculo.tissue.parameters import Vasculogenesis
from vasculo.tissue.rupture import LAWS, WEAKEST, breaking_forces, correlated


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
    assert check_interval(0.0025, 0.1) == 20  # 0.005 / 0.0025 = 2 time units
    assert check_interval(1e-6, 0.1) == 50  # never longer than 5
    assert check_interval(10.0, 0.1) == 1
    assert growth_steps(0.0025, 0.6, 0.1) == 1600
    assert steps_in(100.0, 0.2) == 500


@pytest.mark.parametrize("law", ["normal", "weibull"])
@pytest.mark.parametrize("spread", [0.0, 0.1, 0.2])
def test_laws_have_mean_one_and_their_spread(law, spread):
    scores = np.random.default_rng(3).standard_normal(400_000)
    values = LAWS[law](scores, spread)
    assert abs(values.mean() - 1.0) < 0.002
    assert abs(values.std() - spread) < 0.002
    assert np.all(np.diff(values[np.argsort(scores)]) >= 0.0)  # a higher score is a stronger fibre


@pytest.mark.parametrize(("spread", "shape"), [(1.0, 1.0), (0.52272320, 2.0), (0.22910, 5.0)])
def test_weibull_is_the_law_of_that_name(spread, shape):
    # P(X < x) = 1 - exp(-(x / scale)^shape); the standard deviation over the mean decides on the shape.
    values = LAWS["weibull"](np.random.default_rng(4).standard_normal(100_000), spread)
    result = stats.kstest(values, stats.weibull_min(shape, scale=1.0 / gamma(1.0 + 1.0 / shape)).cdf)
    assert result.pvalue > 0.01


def test_thresholds_of_force_do_not_know_the_length():
    tissue = lattice(500, 0)
    inner = ~tissue.pinned[tissue.springs].all(axis=1)
    limits = breaking_forces(tissue, Vasculogenesis(threshold_kind="force", threshold_spread=0.0), 0)
    np.testing.assert_allclose(limits[inner], 0.5 * tissue.rest_lengths.mean(), rtol=1e-14)
    tissue.stiffness[:] = 4.0
    stiff = breaking_forces(tissue, Vasculogenesis(threshold_kind="force", threshold_spread=0.0), 0)
    np.testing.assert_allclose(stiff[inner], 4.0 * limits[inner], rtol=1e-14)


@pytest.mark.parametrize("boundary", ["pinned", "periodic"])
def test_correlated_scores_have_the_correlation_they_are_named_for(boundary):
    tissue = lattice(6_000, 1, boundary=boundary)
    unit = float(tissue.rest_lengths.mean())
    length = 4.0 * unit
    place = tissue.points[tissue.springs[:, 0]] + 0.5 * tissue.arms()
    near = cKDTree(place).query_pairs(9.0 * unit, output_type="ndarray")
    away = np.hypot(*(place[near[:, 0]] - place[near[:, 1]]).T)
    means, spreads, found = [], [], []
    for seed in range(60):
        scores = correlated(tissue, length, np.random.default_rng(seed))
        means.append(scores.mean())
        spreads.append(np.mean(scores**2))
        product = scores[near[:, 0]] * scores[near[:, 1]]
        found.append([product[np.abs(away - at * length) < 0.1 * length].mean() for at in (0.5, 1.0, 2.0)])
    assert abs(np.mean(means)) < 0.06
    assert abs(np.mean(spreads) - 1.0) < 0.05
    np.testing.assert_allclose(np.mean(found, axis=0), np.exp(-np.array([0.125, 0.5, 2.0])), atol=0.05)


def test_correlated_scores_go_on_across_the_seam():
    tissue = lattice(3_000, 2, boundary="periodic")
    scores = correlated(tissue, 5.0 * float(tissue.rest_lengths.mean()), np.random.default_rng(0))
    middle = tissue.points[tissue.springs[:, 0]] + 0.5 * tissue.arms()
    inside = middle - np.floor(middle)
    nearest = cKDTree(np.minimum(inside, 1.0 - 1e-12), boxsize=1.0).query(inside, k=2)
    jumps = np.abs(scores - scores[nearest[1][:, 1]])
    seam = np.abs(inside - np.round(inside)).min(axis=1) < 0.01
    assert seam.sum() > 100
    assert jumps[seam].mean() < 1.3 * jumps[~seam].mean()


def test_correlated_thresholds_are_those_of_the_seed():
    tissue = lattice(400, 0)
    chosen = Vasculogenesis(threshold_correlation=3.0, threshold_law="weibull")
    one, again, other = (breaking_forces(tissue, chosen, seed) for seed in (5, 5, 6))
    assert np.array_equal(one, again)
    assert not np.array_equal(one, other)
