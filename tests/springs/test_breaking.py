"""Rupture: which springs go, when, and what stays of the network."""

import numpy as np
import pytest

from vasculo.errors import ComputationError
from vasculo.springs.engine import Drive, Engine
from vasculo.springs.motion import damped_steps_plain
from vasculo.springs.network import SpringNetwork


def chain():
    """Three springs of rest length 1, stretched by 0.1, 0.5, 0.3; the outer nodes pinned."""
    return SpringNetwork(
        [[0.0, 0.0], [1.1, 0.0], [2.6, 0.0], [3.9, 0.0]], [[0, 1], [2, 1], [2, 3]], rest_lengths=1.0, pinned=[0, 3]
    )


def test_springs_above_the_force_go_all_at_once():
    network = chain()
    assert network.advance(0.1, 1, break_above=0.25).tolist() == [1, 2]
    assert network.springs.tolist() == [[0, 1]]
    assert network.rest_lengths.tolist() == [1.0]
    # The broken springs pulled no more: only the first one moved a node.
    np.testing.assert_allclose(network.velocities, [[0, 0], [-0.01, 0], [0, 0], [0, 0]], atol=1e-16)


def test_a_force_a_spring_and_the_exact_threshold():
    network = chain()
    exact = network.tensions()[1]
    assert network.advance(0.1, 1, break_above=[np.inf, exact, 0.2]).tolist() == [2]


def test_compressed_springs_do_not_break():
    network = SpringNetwork([[0.0, 0.0], [0.5, 0.0]], [[0, 1]], rest_lengths=1.0, damping=10.0)
    assert network.advance(0.1, 50, break_above=1e-3).size == 0


def test_the_test_is_made_every_step():
    # The middle mass is thrown to the right: its left spring passes 0.5 after a few steps, and not before.
    network = SpringNetwork([[0, 0], [1, 0], [2, 0]], [[0, 1], [1, 2]], rest_lengths=1.0, pinned=[0, 2])
    network.velocities[1, 0] = 1.0
    forces = []
    while len(network.springs) == 2:
        forces.append(network.tensions()[0])
        network.advance(0.05, 1, break_above=0.5)
    assert np.all(np.array(forces[:-1]) <= 0.5)
    assert forces[-1] > 0.5
    assert len(forces) > 5


def test_single_steps_of_a_growing_run_are_the_run(make_irregular):
    points, springs = make_irregular(400, 12)
    limits = np.random.default_rng(13).uniform(0.1, 0.5, len(springs))
    whole = SpringNetwork(points, springs, damping=0.5, tether=0.01)
    parts = whole.copy()
    gone = whole.advance(0.2, 100, break_above=limits, rest_factor=(1.0, 0.75))
    alive = np.arange(len(springs))
    for step in range(100):
        ramp = (1.0 - 0.25 * step / 100, 1.0 - 0.25 * (step + 1) / 100)
        broken = parts.advance(0.2, 1, break_above=limits[alive], rest_factor=ramp)
        alive = np.delete(alive, broken)
    assert 50 < len(gone) < len(springs)
    assert np.array_equal(np.setdiff1d(np.arange(len(springs)), gone), alive)
    assert np.array_equal(whole.springs, parts.springs)
    np.testing.assert_allclose(whole.points, parts.points, rtol=0.0, atol=1e-13)


def test_two_halves_of_a_run_are_the_run_to_the_bit(make_irregular):
    points, springs = make_irregular(400, 12)
    whole = SpringNetwork(points, springs, rest_lengths=0.8, damping=0.5)
    parts = whole.copy()
    gone = whole.advance(0.2, 64, break_above=0.3)
    assert len(gone) > 50
    for _ in range(4):
        parts.advance(0.2, 16, break_above=0.3)
    assert np.array_equal(whole.points, parts.points)
    assert np.array_equal(whole.velocities, parts.velocities)


def test_the_count_of_springs_never_rises(make_irregular):
    points, springs = make_irregular(225, 14)
    network = SpringNetwork(points, springs, rest_lengths=0.7, damping=1.0)
    counts = [len(network.springs)]
    for _ in range(30):
        broken = network.advance(0.1, 3, break_above=0.4)
        counts.append(len(network.springs))
        assert counts[-2] - len(broken) == counts[-1]
    assert counts[-1] < counts[0]


def test_remove_springs_by_mask_and_by_number():
    network = chain()
    network.remove_springs([1])
    assert network.springs.tolist() == [[0, 1], [2, 3]]
    network.remove_springs(np.array([True, False]))
    assert network.springs.tolist() == [[2, 3]]
    network.advance(0.1, 3)


def test_the_kernel_and_its_twin_stop_before_the_step_that_is_lost():
    # Node 2 overstretches its spring in step 1, the step in which node 3 leaves the finite numbers.
    springs, home = np.array([[0, 1], [1, 2]], np.int32), np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [9.0, 9.0]])
    push, load = np.array([0.1, 0.1, 0.1, 1e5]), np.zeros((4, 2))
    load[3, 1] = 1.5e303
    speed = np.array([[0.0, 0.0], [0.0, 0.0], [2.0, 0.0], [0.0, 0.0]])
    ours, plain = (home.copy(), speed.copy()), (home.copy(), speed.copy())
    engine = Engine(springs, np.ones(2), np.ones(2), home, None)
    moved = engine.move(*ours, Drive(push, np.ones(4), 0.0, home, load, 0.1), 10, np.array(0.15))
    assert (moved.done, moved.lost) == (1, 3)
    assert np.array_equal(ours[0], home)
    broken = np.zeros(2, bool)
    springy = springs, np.zeros((2, 2)), np.ones(2), np.ones(2), np.full(2, 0.15)
    with np.errstate(over="ignore"):
        assert damped_steps_plain(*plain, *springy, push, np.ones(4), 0.0, home, load, 0.1, 1.0, 0.0, 10, broken) == 1
    assert not broken.any()
    engine.refresh(np.ones(2), np.ones(2))
    assert not engine.move(*ours, Drive(push, np.ones(4), 0.0, home, load, 0.1), 1, np.array(0.15)).broken.any()
    for one, other in zip(ours, plain, strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-15)
    np.testing.assert_allclose(ours[0], [[0.0, 0.0], [1.0, 0.0], [2.2, 0.0], [9.0, 1.5e307]], rtol=1e-15)


def test_a_node_that_leaves_the_finite_numbers_stops_the_run():
    network = SpringNetwork([[0, 0], [1.5, 0], [2.5, 0]], [[0, 1], [1, 2]], 1.0, masses=1e-3)
    push = np.zeros((3, 2))
    push[2, 1] = 1.7e308
    good = network.copy()
    with pytest.raises(
        ComputationError, match=r"^step 1 of 5: node 2 leaves the finite numbers from position \[2\.5, 0"
    ):
        network.advance(0.01, 5, forces=push, break_above=0.4)
    assert np.array_equal(network.points, good.points)
    assert np.array_equal(network.springs, good.springs)
    network.advance(0.01, 5)
    good.advance(0.01, 5)
    assert np.array_equal(network.points, good.points)


def test_a_copy_keeps_the_springs_that_break_in_the_other():
    network = chain()
    network.advance(0.1, 1)
    twin, fresh = network.copy(), network.copy()
    assert network.advance(0.1, 5, break_above=0.25).size == 2
    twin.advance(0.1, 5)
    fresh.stiffness = fresh.stiffness + 0.0
    fresh.springs = fresh.springs[:, ::-1].copy()  # sorted anew
    fresh.advance(0.1, 5)
    np.testing.assert_allclose(twin.points, fresh.points, rtol=0.0, atol=1e-15)
    assert len(twin.springs) == 3


def test_tables_that_carry_broken_springs_give_the_bits_of_new_ones(make_irregular):
    points, springs = make_irregular(900, 21)
    limits = np.random.default_rng(22).uniform(0.15, 0.6, len(springs))
    worn = SpringNetwork(points, springs, rest_lengths=0.75, damping=1.0)
    alive = np.arange(len(springs))
    kept = rebuilt = 0
    for _ in range(40):
        fresh = SpringNetwork(points, worn.springs, worn.rest_lengths, damping=1.0)
        fresh.points, fresh.velocities = worn.points.copy(), worn.velocities.copy()
        tables = worn.engine()
        broken = worn.advance(0.1, 5, break_above=limits[alive])
        assert np.array_equal(fresh.advance(0.1, 5, break_above=limits[alive]), broken)
        assert np.array_equal(worn.points, fresh.points)
        assert np.array_equal(worn.velocities, fresh.velocities)
        alive = np.delete(alive, broken)
        kept, rebuilt = kept + (worn.engine() is tables), rebuilt + (worn.engine() is not tables)
    assert kept > 20
    assert rebuilt >= 1
