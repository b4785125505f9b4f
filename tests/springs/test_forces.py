"""Hooke forces and the half-spring tables, against their twins and by hand."""

import numpy as np

from vasculo.springs.forces import (
    build_adjacency,
    hooke_forces,
    hooke_forces_plain,
    sort_half_springs,
    sort_half_springs_plain,
)
from vasculo.springs.network import SpringNetwork


def tables(function, springs, nodes):
    out = np.zeros(nodes + 1, np.int32), np.empty(springs.size, np.int32), np.empty(springs.size, np.int32)
    function(springs, *out)
    return out


def test_half_springs_are_those_of_the_twin(make_irregular):
    points, springs = make_irregular(400, 0)
    rng = np.random.default_rng(1)
    springs = rng.permutation(springs)
    turned = rng.random(len(springs)) < 0.5
    springs[turned] = springs[turned][:, ::-1]
    for ours, plain in zip(
        tables(sort_half_springs, springs, len(points)),
        tables(sort_half_springs_plain, springs, len(points)),
        strict=True,
    ):
        assert np.array_equal(ours, plain)


def test_half_springs_by_hand():
    start, neighbour, spring = build_adjacency(np.array([[2, 0], [1, 2], [0, 1]]), 4)
    assert start.tolist() == [0, 2, 4, 6, 6]
    assert neighbour.tolist() == [2, 1, 2, 0, 0, 1]
    assert spring.tolist() == [0, 2, 1, 2, 0, 1]


def test_no_springs():
    table = build_adjacency(np.empty((0, 2), np.int32), 3)
    assert table.start.tolist() == [0, 0, 0, 0]
    assert table.neighbour.size == table.spring.size == 0


def test_forces_are_those_of_the_twin(make_irregular):
    points, springs = make_irregular(400, 0)
    points[springs[5, 0]] = points[springs[5, 1]]  # a spring of zero length
    rng = np.random.default_rng(2)
    rows = build_adjacency(springs, len(points))
    stiffness, rest = (rng.uniform(0.5, 2.0, len(springs))[rows.spring] for _ in range(2))
    ours, plain = np.empty_like(points), np.empty_like(points)
    hooke_forces(points, rows.start, rows.neighbour, stiffness, rest, ours)
    hooke_forces_plain(points, rows.start, rows.neighbour, stiffness, rest, plain)
    assert np.abs(ours).max() > 1.0
    np.testing.assert_allclose(ours, plain, rtol=0.0, atol=1e-13)


def test_one_stretched_spring():
    network = SpringNetwork([[0.0, 0.0], [3.0, 4.0]], [[0, 1]], rest_lengths=2.0, stiffness=10.0)
    assert network.tensions().tolist() == [30.0]
    np.testing.assert_allclose(network.internal_forces(), [[18.0, 24.0], [-18.0, -24.0]], rtol=1e-15)
    assert network.elastic_energy() == 45.0


def test_a_spring_of_zero_length_pulls_nowhere():
    network = SpringNetwork([[1.0, 1.0], [1.0, 1.0]], [[0, 1]], rest_lengths=0.5)
    assert network.tensions().tolist() == [-0.5]
    assert not network.internal_forces().any()
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
