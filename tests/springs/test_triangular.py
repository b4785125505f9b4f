"""Elasticity of the regular triangular lattice: exact values of the continuum and of single bonds."""

import numpy as np
import pytest

from vasculo.springs.network import SpringNetwork


@pytest.mark.parametrize("strain", [1e-3, 0.1])
def test_uniaxial_stress_along_the_bonds(make_triangular, strain):
    stiffness, rows, columns = 2.0, 8, 9
    points, springs = make_triangular(rows, columns)
    network = SpringNetwork(points, springs, stiffness=stiffness)
    pull = np.zeros_like(points)
    pull[::columns, 0] = -stiffness * strain
    pull[columns - 1 :: columns, 0] = stiffness * strain
    network.relax(tolerance=1e-12, forces=pull)
    # Aligned bonds carry all of it, the other two families exactly nothing, at any strain.
    aligned = springs[:, 1] - springs[:, 0] == 1
    np.testing.assert_allclose(network.tensions()[aligned], stiffness * strain, rtol=0.0, atol=1e-10)
    np.testing.assert_allclose(network.tensions()[~aligned], 0.0, atol=1e-10)
    # Stress is force over row height: E = 2 k / sqrt 3. The rows come closer: nu = 1/3 for small strains.
    width = network.points[columns - 1] - network.points[0]
    modulus = stiffness * strain / np.sqrt(0.75) / (width[0] / (columns - 1) - 1.0)
    assert abs(modulus - 2.0 * stiffness / np.sqrt(3.0)) < 1e-7
    height = (network.points[-1, 1] - network.points[0, 1]) / ((rows - 1) * np.sqrt(0.75))
    assert abs(height - np.sqrt((1.0 - (0.5 * (1.0 + strain)) ** 2) / 0.75)) < 1e-8
    if strain < 0.01:
        assert abs((1.0 - height) / strain - 1.0 / 3.0) < strain


def test_bulk_and_shear_modulus(make_triangular):
    points, springs = make_triangular(24, 24)
    inside = (points > 4.0).all(axis=1) & (points < 15.0).all(axis=1)
    both = inside[springs].all(axis=1)
    small = 1e-5
    density = len(points) * np.sqrt(0.75) / len(points)  # area a node
    for change, expected in (
        (np.diag([1.0, 1.0]), 2.0 * np.sqrt(3.0) / 2.0),  # energy density 2 K e^2
        (np.diag([1.0, -1.0]), 2.0 * np.sqrt(3.0) / 4.0),  # 2 mu e^2
        (np.array([[0.0, 1.0], [1.0, 0.0]]), 2.0 * np.sqrt(3.0) / 4.0),
    ):
        network = SpringNetwork(points, springs)
        network.points = points @ (np.eye(2) + small * change)
        stored = 0.5 * network.tensions()[both] ** 2
        families = [stored[springs[both][:, 1] - springs[both][:, 0] == 1]]
        arms = points[springs[both][:, 1]] - points[springs[both][:, 0]]
        up = np.abs(arms[:, 1]) > 0.1
        families += [stored[up & (arms[:, 0] > 0.0)], stored[up & (arms[:, 0] < 0.0)]]
        energy = sum(family.mean() for family in families) / density
        assert abs(energy / small**2 - expected) < 1e-3


def disk(join, radius):
    """Lattice nodes within a radius of the middle of a bond between nodes at (-1/2, 0) and (1/2, 0)."""
    reach = int(2 * radius) + 2
    points = np.array(
        [(i + 0.5 * j + 0.5, j * np.sqrt(0.75)) for j in range(-reach, reach + 1) for i in range(-2 * reach, 2 * reach)]
    )
    return join(points[np.hypot(*points.T) < radius], 1.1)


def cut_ratio(join, radius, direction):
    """Largest force in a strained disk after its middle bond is cut, over the force before; and how many carry it."""
    small = 1e-4
    points, springs = disk(join, radius)
    network = SpringNetwork(points, springs, pinned=np.hypot(*points.T) > radius - 1.5)
    network.points = points @ (np.eye(2) + small * direction)
    before = np.abs(network.tensions()).max()
    middle = np.flatnonzero(np.abs(points[springs].mean(axis=1)).sum(axis=1) < 1e-9)
    assert len(middle) == 1
    network.remove_springs(middle)
    network.relax(tolerance=1e-12)
    forces = np.sort(network.tensions())[::-1] / before
    return forces[0], int(np.sum(forces > forces[0] - 1e-3)), forces


@pytest.mark.parametrize("direction", [np.eye(2), np.array([[1.0, 0.0], [0.0, -1.0 / 3.0]])])
def test_a_cut_bond_loads_four_neighbours(join, direction):
    # Infinite lattice: 1.2405 on four bonds. A disk of radius R differs by a share ~ 1 / R^2, which two radii remove.
    near, number, _ = cut_ratio(join, 17.0, direction)
    far, _, forces = cut_ratio(join, 34.0, direction)
    assert number == 4
    assert abs(far - 1.2405) < 0.002
    assert abs(far + (far - near) / 3.0 - 1.2405) < 0.0003, (near, far)
    if direction[1, 1] > 0.0:
        assert abs(forces[4] - 1.1730) < 0.0005


def test_strain_is_uniform_while_rest_lengths_shrink(make_triangular):
    points, springs = make_triangular(16, 16)
    x, y = points.T
    edge = (x < 0.6) | (x > 14.9) | (y < 0.1) | (y > 12.9)
    network = SpringNetwork(points, springs, damping=5.0, pinned=edge, tether=0.01)
    for last in (0.9, 0.75, 0.6):
        first = 1.0 if last == 0.9 else {0.75: 0.9, 0.6: 0.75}[last]
        assert network.advance(0.2, 100, break_above=0.41, rest_factor=(first, last)).size == 0
        strain = (network.lengths() - last * network.rest_lengths) / network.rest_lengths
        np.testing.assert_allclose(strain, 1.0 - last, rtol=0.0, atol=1e-12)
