"""Hooke forces, by hand and as the slope of the energy."""

import numpy as np

from vasculo.springs.network import SpringNetwork


def test_forces_are_those_of_a_plain_sum(make_irregular):
    points, springs = make_irregular(400, 0)
    rng = np.random.default_rng(2)
    stiffness, rest = rng.uniform(0.5, 2.0, len(springs)), rng.uniform(0.5, 2.0, len(springs))
    points[springs[5, 0]] = points[springs[5, 1]]  # a spring of zero length
    network = SpringNetwork(points, springs, rest, stiffness, pinned=[0, 7], tether=0.2)
    network.points = points + rng.normal(0.0, 0.1, points.shape)
    network.points[springs[5, 0]] = network.points[springs[5, 1]]
    for factor in (1.0, 0.6):
        plain = -0.2 * (network.points - network.reference)
        for (i, j), k, r in zip(springs, stiffness, rest, strict=True):
            arm = network.points[j] - network.points[i]
            length = np.hypot(*arm)
            if length > 0.0:
                plain[i] += k * (length - factor * r) * arm / length
                plain[j] -= k * (length - factor * r) * arm / length
        np.testing.assert_allclose(network.internal_forces(factor), plain, rtol=0.0, atol=1e-12)


def test_one_stretched_spring():
    network = SpringNetwork([[0.0, 0.0], [3.0, 4.0]], [[0, 1]], rest_lengths=2.0, stiffness=10.0)
    assert network.tensions().tolist() == [30.0]
    np.testing.assert_allclose(network.internal_forces(), [[18.0, 24.0], [-18.0, -24.0]], rtol=1e-15)
    assert network.elastic_energy() == 45.0
    # Largest force 30 over stiffness 10 times length 5; a pull against it leaves a third of it.
    assert abs(network.residual() - 0.6) < 1e-15
    assert abs(network.residual([[-12.0, -16.0], [12.0, 16.0]]) - 0.2) < 1e-15


def test_a_spring_of_zero_length_pulls_nowhere():
    network = SpringNetwork([[1.0, 1.0], [1.0, 1.0]], [[0, 1]], rest_lengths=0.5)
    assert network.tensions().tolist() == [-0.5]
    assert not network.internal_forces().any()
    assert network.residual() == 0.0
    network.advance(0.1, 5)
    assert np.array_equal(network.points, network.reference)


def test_no_springs():
    network = SpringNetwork([[0.0, 0.0], [1.0, 0.0]], np.empty((0, 2), np.int32), tether=1.0)
    assert not network.internal_forces().any()
    assert network.residual() == 0.0
    network.advance(0.1, 5)
    assert np.array_equal(network.points, network.reference)


def test_forces_are_the_slope_of_the_energy(make_irregular):
    points, springs = make_irregular(36, 5)
    rng = np.random.default_rng(6)
    network = SpringNetwork(
        points, springs, rng.uniform(0.5, 1.5, len(springs)), rng.uniform(0.5, 2.0, len(springs)), tether=0.3
    )
    network.points = points + rng.normal(0.0, 0.1, points.shape)
    forces = network.internal_forces()
    for node, axis in ((0, 0), (7, 1), (20, 0)):
        energies = []
        for shift in (1e-5, -2e-5):
            network.points[node, axis] += shift
            energies.append(network.elastic_energy())
        network.points[node, axis] += 1e-5
        assert abs((energies[1] - energies[0]) / 2e-5 - forces[node, axis]) < 1e-8
