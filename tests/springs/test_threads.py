"""Threads: the same bits on any number of them, also when they wait for each other, are busy elsewhere or forked."""

import multiprocessing
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from vasculo.errors import ComputationError, InputError
from vasculo.springs import threads as threads_module
from vasculo.springs.network import SpringNetwork
from vasculo.springs.threads import get_threads, run_team, set_threads


@pytest.fixture(autouse=True)
def _as_before(monkeypatch):
    """A team whatever else the machine does, and the number of threads as it was."""
    monkeypatch.setattr(threads_module, "CROWDED", 0.0)
    monkeypatch.setattr(threads_module._TEAM, "paused_until", 0.0)
    before = get_threads()
    yield
    set_threads(before)


@pytest.fixture
def large(make_irregular):
    """Twenty-five patches of nodes, so that three threads have work."""
    points, springs = make_irregular(6400, 5)
    return SpringNetwork(points, springs, rest_lengths=0.8, damping=0.4, tether=0.01)


def ran(network, threads):
    twin = network.copy()
    set_threads(threads)
    broken = twin.advance(0.1, 101, break_above=0.35)
    return twin, broken


def test_any_number_of_threads_gives_the_same_bits(large):
    first, gone = ran(large, 1)
    assert len(gone) > 100
    for threads in (2, 3, 5):
        other, broken = ran(large, threads)
        assert np.array_equal(gone, broken)
        assert np.array_equal(first.points, other.points)
        assert np.array_equal(first.velocities, other.velocities)


def test_all_threads_stop_at_a_step_that_is_lost(large):
    push = np.zeros_like(large.points)
    push[37] = 1e308, 0.0
    large.masses[37] = 1e-3
    ends = []
    for threads in (1, 3):
        set_threads(threads)
        twin = large.copy()
        with pytest.raises(ComputationError, match="node 37 leaves the finite numbers") as caught:
            twin.advance(0.01, 50, forces=push)
        ends.append((str(caught.value), twin.points))
    assert ends[0][0] == ends[1][0]
    assert np.array_equal(ends[0][1], ends[1][1])


def test_two_networks_at_once(large):
    expected, _ = ran(large, 2)
    with ThreadPoolExecutor(3) as pool:
        results = list(pool.map(lambda _: ran(large, 2)[0].points, range(6)))
    assert all(np.array_equal(points, expected.points) for points in results)


def _in_child(network):
    return ran(network, 2)[0].points


def test_after_a_fork(large):
    expected, _ = ran(large, 2)
    with multiprocessing.get_context("fork").Pool(1) as pool:
        assert np.array_equal(pool.apply(_in_child, (large,)), expected.points)


def test_work_of_one_thread_is_done_by_the_caller():
    set_threads(4)
    assert run_team(lambda rank, threads, base: base + 10 * rank + threads, 1, 100) == 101
    assert run_team(lambda rank, threads, base: base + 10 * rank + threads, 3, 100) == 103


def test_on_a_crowded_machine_a_team_pauses(monkeypatch):
    monkeypatch.setattr(threads_module, "CROWDED", 2.0)  # always crowded
    monkeypatch.setattr(threads_module, "LONG", 0.0)
    set_threads(2)
    soon, late = 3.0 + np.array([0.9, 1.1]) * threads_module.PAUSE
    clock = iter([0.0, 1.0, 2.0, 3.0, soon, late, 5.0, 6.0, 7.0])
    monkeypatch.setattr(threads_module, "perf_counter", lambda: next(clock))
    seen = []
    for _ in range(3):
        run_team(lambda rank, threads: seen.append((rank, threads)) or 0, 2)
    assert sorted(seen[:2]) == [(0, 2), (1, 2)]
    assert seen[2] == (0, 1)
    assert sorted(seen[3:]) == [(0, 2), (1, 2)]


@pytest.mark.parametrize("threads", [0, -1, 1.5, True, None])
def test_bad_numbers(threads):
    with pytest.raises(InputError, match=r"^threads is .*, expected a whole number >= 1"):
        set_threads(threads)


@pytest.mark.parametrize(("given", "printed"), [("3", "3"), ("", str(len(os.sched_getaffinity(0))))])
def test_the_environment_says_how_many(given, printed):
    code = "from vasculo.springs.threads import get_threads; print(get_threads())"
    done = subprocess.run(
        [sys.executable, "-c", code], env=os.environ | {"VASCULO_THREADS": given}, capture_output=True, check=True
    )
    assert done.stdout.decode().strip() == printed


def test_a_bad_environment_is_told():
    code = "from vasculo.springs.threads import get_threads; get_threads()"
    done = subprocess.run(
        [sys.executable, "-c", code], env=os.environ | {"VASCULO_THREADS": "two"}, capture_output=True, check=False
    )
    assert "VASCULO_THREADS is 'two', expected a whole number >= 1" in done.stderr.decode()
