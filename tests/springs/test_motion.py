"""Equations (2) and (3): exact solutions, invariants, the twin."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vasculo.errors import InputError
from vasculo.springs.engine import Drive, Engine
from vasculo.springs.motion import damped_steps_plain
from vasculo.springs.network import SpringNetwork


@pytest.mark.parametrize(("mass", "damping", "dt"), [(1.0, 0.3, 0.1), (2.5, 5.0, 0.4), (0.1, 0.0, 1.0)])
def test_a_damped_mass_decays_exactly(mass, damping, dt):
    network = SpringNetwork([[0.0, 0.0]], [], masses=mass, damping=damping)
    network.velocities = np.array([[1.0, -2.0]])
    position, speed = np.zeros(2), np.array([1.0, -2.0])
    for _ in range(50):
        network.advance(dt, 1)
        speed = speed / (1.0 + damping * dt / mass)
        position = position + dt * speed
        np.testing.assert_allclose(network.velocities[0], speed, rtol=1e-13)
        np.testing.assert_allclose(network.points[0], position, rtol=1e-13)


def test_a_constant_force_gives_the_discrete_fall():
    network = SpringNetwork([[0.0, 0.0]], [], masses=2.0)
    network.advance(0.25, 40, forces=[[0.0, -6.0]])
    # v_n = n dt F/m, r_n = dt (v_1 + ... + v_n): the new velocity moves the node.
    np.testing.assert_allclose(network.velocities[0], [0.0, -30.0], rtol=1e-14)
    np.testing.assert_allclose(network.points[0], [0.0, -(0.25**2) * 3.0 * 40 * 41 / 2], rtol=1e-14)


def test_an_oscillator_has_the_discrete_frequency():
    dt, amplitude = 0.3, 0.01
    network = SpringNetwork([[0.0, 0.0], [1.0 + amplitude, 0.0]], [[0, 1]], rest_lengths=1.0, pinned=[0])
    # r_(n+1) - 2 r_n + r_(n-1) = -dt^2 (r_n - 1), so the phase a step is acos(1 - dt^2 / 2).
    phase = np.arccos(1.0 - dt**2 / 2.0)
    network.velocities[1, 0] = (amplitude - amplitude * np.cos(phase)) / dt  # as if it had come from n = -1
    for n in range(1, 200):
        network.advance(dt, 1)
        assert abs(network.points[1, 0] - 1.0 - amplitude * np.cos(n * phase)) < 1e-14


def test_terminal_speed_of_a_dragged_node():
    network = SpringNetwork([[0.0, 0.0]], [], damping=4.0)
    network.advance(0.5, 200, forces=[[2.0, 0.0]])
    np.testing.assert_allclose(network.velocities[0], [0.5, 0.0], rtol=1e-14)


def test_momentum_and_spin_are_kept(moving):
    def both():
        momentum = moving.masses @ moving.velocities
        x, y = moving.points.T
        spin = np.sum(moving.masses * (x * moving.velocities[:, 1] - y * moving.velocities[:, 0]))
        return np.append(momentum, spin)

    before = both()
    broken = moving.advance(0.1, 500, break_above=0.7)
    assert 5 < len(broken) < len(moving.springs)
    np.testing.assert_allclose(both(), before, rtol=0.0, atol=1e-10)


def test_energy_of_an_undamped_run_stays_bounded(moving):
    begin = moving.kinetic_energy() + moving.elastic_energy()
    seen = []
    for _ in range(200):
        moving.advance(0.1, 20)
        seen.append(moving.kinetic_energy() + moving.elastic_energy())
    assert max(seen) < 1.1 * begin
    assert min(seen) > 0.9 * begin
    assert abs(np.mean(seen[:100]) - np.mean(seen[100:])) < 0.01 * begin


def test_energy_error_is_of_first_order(moving):
    errors = []
    for halvings in range(3):
        run = moving.copy()
        begin = run.kinetic_energy() + run.elastic_energy()
        run.advance(0.005 / 2**halvings, 400 * 2**halvings)
        errors.append(abs(run.kinetic_energy() + run.elastic_energy() - begin))
    slopes = np.log2(np.array(errors[:-1]) / errors[1:])
    assert np.all(np.abs(slopes - 1.0) < 0.1), (errors, slopes)


def test_energy_falls_with_damping(moving):
    moving.damping = 2.0
    seen = [moving.kinetic_energy() + moving.elastic_energy()]
    for _ in range(100):
        moving.advance(0.05, 2)
        seen.append(moving.kinetic_energy() + moving.elastic_energy())
    assert np.all(np.diff(seen) < 0.0)
    assert seen[-1] < 0.3 * seen[0]


def test_a_network_at_rest_stays_there(make_irregular):
    points, springs = make_irregular(100, 3)
    network = SpringNetwork(points, springs, tether=0.1, damping=0.5)
    network.advance(0.2, 500, break_above=0.0)
    assert np.array_equal(network.points, points)
    assert not network.velocities.any()
    assert len(network.springs) == len(springs)


def test_pinned_nodes_do_not_move(moving):
    moving.pinned[[0, 5]] = True
    before = moving.points.copy()
    moving.advance(0.1, 100, forces=np.ones_like(before))
    assert np.array_equal(moving.points[[0, 5]], before[[0, 5]])
    assert not moving.velocities[[0, 5]].any()
    assert np.all(np.any(moving.points[~moving.pinned] != before[~moving.pinned], axis=1))


def test_the_tether_pulls_back_to_the_first_position():
    network = SpringNetwork([[1.0, 2.0]], [], tether=0.5, damping=1.0)
    network.points[0] = 3.0, 1.0
    np.testing.assert_allclose(network.internal_forces(), [[-1.0, 0.5]], rtol=1e-15)
    assert network.elastic_energy() == 0.25 * 5.0
    network.advance(0.2, 500)
    np.testing.assert_allclose(network.points, [[1.0, 2.0]], rtol=1e-12)


def quarter_turn(vectors):
    return np.column_stack([-vectors[:, 1], vectors[:, 0]])


def mirror(vectors):
    return np.column_stack([-vectors[:, 0], vectors[:, 1]])


def changed(network, change):
    twin = SpringNetwork(
        change(network.points),
        network.springs,
        network.rest_lengths,
        network.stiffness,
        network.masses,
        0.2,
        [0, 9],
        tether=0.05,
    )
    twin.velocities = change(network.velocities)
    return twin


@pytest.mark.parametrize("change", [quarter_turn, mirror])
def test_turned_and_mirrored_networks_move_alike_to_the_bit(moving, change):
    plain, other = changed(moving, np.array), changed(moving, change)
    push = np.random.default_rng(7).normal(0.0, 0.05, plain.points.shape)
    first = plain.advance(0.1, 200, forces=push, break_above=0.6)
    second = other.advance(0.1, 200, forces=change(push), break_above=0.6)
    assert len(first) > 5
    assert np.array_equal(first, second)
    assert np.array_equal(change(plain.points), other.points)


@settings(max_examples=20, deadline=None)
@given(angle=st.floats(0.0, 6.3), shift=st.floats(-5.0, 5.0), seed=st.integers(0, 100))
def test_rotated_shifted_networks_move_alike(angle, shift, seed):
    rng = np.random.default_rng(seed)
    points = rng.uniform(0.0, 5.0, (12, 2))
    springs = np.array([(i, j) for i in range(12) for j in range(i) if (i + j) % 3 == 0])
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    plain = SpringNetwork(points, springs, rest_lengths=1.0, damping=0.3)
    other = SpringNetwork(points @ turn.T + shift, springs, rest_lengths=1.0, damping=0.3)
    plain.advance(0.1, 20)
    other.advance(0.1, 20)
    np.testing.assert_allclose(other.points, plain.points @ turn.T + shift, rtol=0.0, atol=1e-10)


def test_the_numbering_of_nodes_does_not_matter(moving):
    order = np.random.default_rng(8).permutation(len(moving.points))
    place = np.argsort(order)
    other = SpringNetwork(
        moving.points[order], place[moving.springs], moving.rest_lengths, moving.stiffness, moving.masses[order]
    )
    other.velocities = moving.velocities[order]
    broken = moving.advance(0.1, 60, break_above=0.8)
    assert len(broken) > 3
    assert np.array_equal(other.advance(0.1, 60, break_above=0.8), broken)
    np.testing.assert_allclose(other.points, moving.points[order], rtol=0.0, atol=1e-11)


@pytest.mark.parametrize("nodes", [64, 225, 2500])
@pytest.mark.parametrize("loaded", [True, False])
def test_kernel_and_twin_agree_while_springs_break(make_irregular, nodes, loaded):
    points, springs = make_irregular(nodes, 9)
    rng = np.random.default_rng(10)
    length = np.hypot(*(points[springs[:, 0]] - points[springs[:, 1]]).T)
    dt, mass, damping = 0.2, rng.uniform(0.5, 2.0, len(points)), 0.8
    keep = 1.0 / (1.0 + damping * dt / mass)
    keep[: nodes // 15] = 0.0
    stiffness, limit = rng.uniform(0.5, 2.0, len(springs)), rng.uniform(0.1, 0.5, len(springs))
    load = rng.normal(0.0, 0.02, points.shape) if loaded else None
    ours = points.copy(), rng.normal(0.0, 0.1, points.shape)
    plain = tuple(part.copy() for part in ours)
    drive = Drive(dt / mass, keep, 0.05 * loaded, points, load, dt, 1.0, -0.002)
    moved = Engine(springs, stiffness, length, points, None).move(*ours, drive, 151, limit)
    broken = np.zeros(len(springs), bool)
    force = np.zeros_like(points) if load is None else load
    fixed = dt / mass, keep, 0.05 * loaded, points, force, dt, 1.0, -0.002, 151, broken
    assert damped_steps_plain(*plain, springs, np.zeros_like(length)[:, None], stiffness, length, limit, *fixed) == 151
    assert (moved.done, moved.lost) == (151, -1)
    assert 0 < np.count_nonzero(broken) < len(springs)
    assert np.array_equal(moved.broken, broken)
    np.testing.assert_allclose(ours[0], plain[0], rtol=0.0, atol=1e-10)
    np.testing.assert_allclose(ours[1], plain[1], rtol=0.0, atol=1e-10)


def test_even_and_odd_numbers_of_steps_join(make_irregular):
    points, springs = make_irregular(100, 3)
    whole = SpringNetwork(points, springs, rest_lengths=0.8, damping=0.3)
    parts = whole.copy()
    whole.advance(0.1, 12)
    for steps in (1, 0, 4, 7):
        parts.advance(0.1, steps)
    assert np.array_equal(whole.points, parts.points)
    assert np.array_equal(whole.velocities, parts.velocities)


def test_the_default_step_is_a_round_one_below_half_the_limit(moving):
    for damping in (0.0, 0.3, 5.0):
        moving.damping = damping
        dt = moving.default_step()
        assert 0.2 * moving.safe_limit() < dt <= 0.5 * moving.safe_limit()
        assert f"{dt:.0e}"[0] in "125"
    twin = moving.copy()
    moving.advance(steps=10)
    twin.advance(dt, 10)
    assert np.array_equal(moving.points, twin.points)
    with pytest.raises(InputError, match="a network of 0 springs with 1 of 1 nodes free has no stability limit"):
        SpringNetwork([[0, 0]], []).advance()
