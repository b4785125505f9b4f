"""Relaxation to equilibrium, against direct solutions."""

import numpy as np
import pytest
from scipy.sparse import coo_array, diags_array
from scipy.sparse.linalg import spsolve

from vasculo.errors import ComputationError
from vasculo.springs.network import SpringNetwork


def test_springs_of_zero_rest_length_are_a_linear_system(make_irregular):
    points, springs = make_irregular(400, 1)
    rng = np.random.default_rng(2)
    stiffness, tether = rng.uniform(0.1, 10.0, len(springs)), 0.05
    pinned = (points < 0.5).any(axis=1)
    load = rng.normal(0.0, 0.5, points.shape)
    network = SpringNetwork(
        points, springs, 0.0, stiffness, rng.uniform(0.1, 9.0, len(points)), 0.3, pinned, tether=tether
    )
    assert network.relax(tolerance=1e-12, forces=load) > 0
    first, second = springs.T
    n = len(points)
    links = coo_array((stiffness, (first, second)), shape=(n, n)).tocsr()
    links = links + links.T
    matrix = (diags_array(links.sum(axis=1) + tether) - links).tocsr()
    free = ~pinned
    expected = points.copy()
    for axis in range(2):
        right = load[:, axis] + tether * points[:, axis] - matrix[:, pinned] @ points[pinned, axis]
        expected[free, axis] = spsolve(matrix[free][:, free].tocsc(), right[free])
    np.testing.assert_allclose(network.points, expected, rtol=0.0, atol=1e-8)
    assert not network.velocities.any()
    assert network.damping == 0.3


def test_two_springs_in_line_share_the_load():
    network = SpringNetwork([[0, 0], [1, 0], [2, 0]], [[0, 1], [1, 2]], 1.0, [2.0, 1.0], pinned=[0])
    network.relax(forces=[[0, 0], [0, 0], [1.0, 0]], tolerance=1e-13)
    np.testing.assert_allclose(network.points, [[0, 0], [1.5, 0], [3.5, 0]], atol=1e-11)


def test_equilibrium_is_that_of_the_damped_motion(make_irregular):
    points, springs = make_irregular(100, 4)
    edge = (points < 0.5).any(axis=1) | (points > 8.5).any(axis=1)
    network = SpringNetwork(points, springs, damping=0.5, pinned=edge)
    network.rest_lengths *= 0.7
    moved = network.copy()
    network.relax(tolerance=1e-13)
    moved.advance(0.2, 3000)
    np.testing.assert_allclose(network.points, moved.points, rtol=0.0, atol=1e-10)


def test_nothing_to_do():
    network = SpringNetwork([[0, 0], [1, 0]], [[0, 1]])
    assert network.relax() == 0
    assert SpringNetwork([[0, 0]], []).relax() == 0


def test_too_few_steps_say_so(make_irregular):
    points, springs = make_irregular(100, 4)
    network = SpringNetwork(points, springs, 0.0, pinned=[0, 9, 90, 99])
    with pytest.raises(ComputationError, match=r"^relaxation stopped after 40 steps with force [\d.e-]+ on node \d+"):
        network.relax(steps=40)
    assert np.isfinite(network.points).all()
    network.relax()


def test_a_force_that_nothing_holds_does_not_end():
    with pytest.raises(ComputationError, match="relaxation stopped after 60 steps"):
        SpringNetwork([[0, 0], [1, 0]], [[0, 1]]).relax(steps=60, forces=[[1.0, 0], [1.0, 0]])
