"""The stability limit, against eigenvalues found by differences of the forces, and by runs on both sides of it."""

import numpy as np
import pytest

from vasculo.errors import InputError
from vasculo.springs.engine import Drive
from vasculo.springs.network import SpringNetwork


def matrices(network):
    """Stiffness, by differences of the forces, and masses, of the free nodes; both dense."""
    free = np.flatnonzero(np.repeat(~network.pinned, 2))
    own = network.copy()
    slopes = np.empty((free.size, free.size))
    for column, where in enumerate(free):
        forces = []
        for shift in (1e-6, -1e-6):
            own.points = network.points.copy()
            own.points.flat[where] += shift
            forces.append(own.internal_forces().ravel()[free])
        slopes[:, column] = (forces[1] - forces[0]) / 2e-6
    return 0.5 * (slopes + slopes.T), np.diag(np.repeat(network.masses, 2)[free])


def eigenvalues(network):
    """Eigenvalues of stiffness over mass."""
    stiffness, mass = matrices(network)
    root = np.sqrt(np.diag(mass))
    return np.linalg.eigvalsh(stiffness / np.outer(root, root))


def kick(network, dt, steps, size):
    """Run the kernel itself, past any check of dt, from a small random disturbance; returns the largest one."""
    points = network.points.copy()
    speed = np.random.default_rng(0).normal(0.0, size, points.shape)
    keep = np.where(network.pinned, 0.0, 1.0 / (1.0 + network.damping * dt / network.masses))
    drive = Drive(dt / network.masses, keep, network.tether, network.reference, None, dt)
    largest = 0.0
    for _ in range(10):
        network.engine().move(points, speed, drive, steps // 10)
        largest = max(largest, float(np.abs(points - network.points).max()))
    return largest


def test_one_spring():
    for mass, stiffness, damping in ((1.0, 1.0, 0.0), (2.0, 5.0, 0.7)):
        network = SpringNetwork([[0, 0], [1, 0]], [[0, 1]], None, stiffness, mass, damping, [0])
        dt = network.stability_limit()
        w = np.sqrt(stiffness / mass)
        assert abs(dt * w - np.sqrt(4.0 + 2.0 * damping * dt / mass)) < 1e-12


@pytest.mark.parametrize("damping", [0.0, 1.0])
def test_the_limit_of_a_triangular_patch(make_triangular, damping):
    network = SpringNetwork(*make_triangular(9, 9), damping=damping)
    squared = eigenvalues(network).max()
    assert 5.8 < squared < 6.0  # the band of the infinite lattice ends at 6 k / m
    limit = network.stability_limit()
    assert abs(limit - (damping + np.sqrt(damping**2 + 4.0 * squared)) / squared) < 1e-6
    # A tiny disturbance stays tiny at 0.99 of the limit and grows without bound at 1.01.
    assert kick(network, 0.99 * limit, 5000, 1e-9) < 1e-6
    assert kick(network, 1.01 * limit, 1000, 1e-9) > 0.1


def test_advance_refuses_above_and_runs_below(make_triangular):
    network = SpringNetwork(*make_triangular(9, 9))
    limit = network.stability_limit()
    with pytest.raises(InputError, match=r"time step 0\.8\d+ exceeds the stability limit 0\.8\d+ \(largest node"):
        network.advance(1.01 * limit, 1)
    network.velocities = np.random.default_rng(1).normal(0.0, 1e-3, network.points.shape)
    energy = network.kinetic_energy()
    network.advance(0.99 * limit, 3000)
    assert network.kinetic_energy() + network.elastic_energy() < 100.0 * energy
    with pytest.raises(InputError, match=r"exceeds the stability limit.*lower dt or raise damping$"):
        network.advance(10.0, 1)


def test_uneven_masses_pins_and_tether(make_irregular):
    points, springs = make_irregular(64, 2)
    rng = np.random.default_rng(3)
    network = SpringNetwork(
        points,
        springs,
        stiffness=rng.uniform(0.5, 2.0, len(springs)),
        masses=rng.uniform(0.5, 2.0, len(points)),
        pinned=[0, 3, 9, 33],
        tether=0.4,
    )
    assert abs(network.stability_limit() - 2.0 / np.sqrt(eigenvalues(network).max())) < 1e-6
    network.damping = 0.8
    limit = network.stability_limit()
    # The limit is where the smallest eigenvalue of 4 M + 2 D dt - K dt^2 passes zero.
    stiffness, mass = matrices(network)
    below, above = (
        np.linalg.eigvalsh(4.0 * mass + 2.0 * network.damping * dt * np.eye(len(mass)) - stiffness * dt**2)[0]
        for dt in ((1.0 - 1e-5) * limit, (1.0 + 1e-5) * limit)
    )
    assert below > 0.0 > above
    assert kick(network, 0.99 * limit, 4000, 1e-9) < 1e-6
    assert kick(network, 1.01 * limit, 2000, 1e-9) > 0.1


def test_sparse_and_dense_agree(make_triangular):
    # 32 nodes go the dense way, 36 the sparse one; the limit falls smoothly with the size of the patch.
    limits = [SpringNetwork(*make_triangular(rows, 4)).stability_limit() for rows in (7, 8, 9, 10)]
    assert np.all(np.diff(limits) < 0.0)
    assert np.all(np.diff(limits, 2) > -1e-3)
    network = SpringNetwork(*make_triangular(9, 4))
    assert abs(network.stability_limit() - 2.0 / np.sqrt(eigenvalues(network).max())) < 1e-6


def test_the_safe_limit_is_below_the_limit_in_every_shape(moving):
    moving.damping = 0.3
    for rest in (1.0, 0.5, 0.0):
        moving.rest_lengths = rest * np.ones(len(moving.springs))
        assert moving.safe_limit() < moving.stability_limit()
    network = SpringNetwork([[0, 0], [1, 0], [2, 0]], [[0, 1], [1, 2]], 0.0, 3.0, 2.0, tether=0.5)
    assert abs(network.safe_limit() - 2.0 / np.sqrt((2.0 * 6.0 + 0.5) / 2.0)) < 1e-14


def test_nothing_that_pulls_has_no_limit():
    assert SpringNetwork([[0, 0], [1, 0]], [[0, 1]], pinned=[0, 1]).stability_limit() == np.inf
    free = SpringNetwork([[0, 0]], [])
    assert free.stability_limit() == free.safe_limit() == np.inf
    free.advance(1e3, 1)


def test_the_printed_order_of_the_equations_is_the_unstable_one():
    # Equation (3) with the old velocity: r and v of one undamped spring grow at any dt; with the new one they do not.
    position, speed, dt = 1e-3, 0.0, 0.1
    for _ in range(2000):
        position, speed = position + dt * speed, speed - dt * position
    assert abs(position) > 1.0
    network = SpringNetwork([[0, 0], [1, 0]], [[0, 1]], pinned=[0])
    network.points[1, 0] += 1e-3
    network.advance(dt, 2000)
    assert abs(network.points[1, 0] - 1.0) < 1.1e-3
