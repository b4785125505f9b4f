"""Tracers: exact in their field, conservative, and right about residence times."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.flow.exact import ANNULUS, AT_REST
from tests.flow.meshes import annulus, cylinder_in_square, rectangle

from vasculo.errors import InputError
from vasculo.flow.boundary import Periodic, Pressure, Slip, Velocity
from vasculo.flow.read.conservative import WALL, conservative_field, corner_velocities
from vasculo.flow.read.locate import Locator
from vasculo.flow.read.paths_plain import follow_plain
from vasculo.flow.read.residence import residence_times
from vasculo.flow.read.seeds import seed_side
from vasculo.flow.read.stream import stream_function
from vasculo.flow.read.tracers import trace
from vasculo.flow.stokes import solve_stokes
from vasculo.springs.threads import get_threads, set_threads


def channel(across=8):
    return solve_stokes(rectangle(2.0, 1.0, across, seed=1), {"left": Pressure(24.0), "right": Pressure(0.0)})


@pytest.fixture(scope="module")
def around():
    """Flow around one pillar between walls."""
    return solve_stokes(cylinder_in_square(0.1, 32), {"left": Pressure(1.0), "right": Pressure(0.0)}, viscosity=0.01)


def quadratic(flow, at):
    """Stream function of the conservative field at points: linear between nodes, and what its edges bend."""
    mesh, psi, field = flow.mesh, stream_function(flow), conservative_field(flow)
    cell, shares = Locator(mesh).find(at)
    value = np.einsum("kc,kc->k", shares, psi[mesh.triangles[cell]])
    for k in range(3):
        one, two = field.outflow[cell, k].T
        value += 0.5 * (one - two) * shares[:, (k + 1) % 3] * shares[:, (k + 2) % 3]
    return value


def test_the_field_has_the_fluxes_and_no_divergence(around):
    mesh, field = around.mesh, conservative_field(around)
    passing = field.passing
    assert np.abs(field.outflow.sum(axis=(1, 2))).max() < 1e-12 * passing
    here = np.flatnonzero(field.beyond.ravel() >= 0)
    beyond = field.beyond.ravel()[here]
    np.testing.assert_allclose(
        field.outflow.reshape(-1, 2)[here], -field.outflow.reshape(-1, 2)[beyond][:, ::-1], atol=1e-15 * passing
    )
    np.testing.assert_array_equal(field.beyond.ravel()[beyond], here)
    walls = field.beyond == WALL
    assert walls.sum() == len(around.wall_edges)
    assert not field.outflow[walls].any()
    # The fluid sticks to walls.
    velocity = corner_velocities(mesh.points, mesh.triangles, field.outflow)
    on_wall = np.zeros(len(mesh.points), dtype=bool)
    on_wall[around.wall_edges] = True
    gap = on_wall[mesh.triangles].all(axis=1)
    corner = on_wall[mesh.triangles] & ~gap[:, None]
    assert np.abs(velocity[corner]).max() < 1e-12 * np.abs(velocity).max()


def test_the_field_is_of_second_order():
    worst = []
    for across in (8, 16, 32):
        mesh = rectangle(1.0, 1.0, across, seed=3)
        field = conservative_field(solve_stokes(mesh, {}, force=AT_REST.force(mesh)))
        middle = corner_velocities(mesh.points, mesh.triangles, field.outflow).mean(axis=1)
        away = middle - np.column_stack([AT_REST.u(*mesh.centroids.T), AT_REST.v(*mesh.centroids.T)])
        worst.append(np.sqrt(mesh.areas @ (away**2).sum(axis=1)))
    assert np.log2(worst[0] / worst[2]) / 2.0 > 1.7


@settings(deadline=None, max_examples=12)
@given(st.integers(0, 10_000))
def test_kernel_and_twin(around, seed):
    rng = np.random.default_rng(seed)
    field = conservative_field(around)
    start = rng.uniform(0.0, 1.0, (3, 2))
    start = start[Locator(around.mesh).find(start)[0] >= 0]
    duration = float(rng.uniform(0.1, 3.0)) / field.passing
    found = trace(around, start, duration=duration)
    for k, (cell, shares) in enumerate(zip(*Locator(around.mesh).find(start), strict=True)):
        edge, time, end = follow_plain(around.mesh, field, int(cell), shares, duration)
        assert found.edge[k] == edge
        assert found.time[k] == pytest.approx(time, rel=1e-6)
        np.testing.assert_allclose(found.end[k], end, atol=1e-6)


def test_paths_keep_their_stream_function_and_stay_out_of_the_pillar(around):
    tracers = trace(around, side="left", count=300)
    assert tracers.left_through("right").all()
    assert tracers.weight.sum() == pytest.approx(around.flow_rate("right"), rel=1e-12)
    start, end = (quadratic(around, at) for at in (tracers.start, tracers.end))
    np.testing.assert_allclose(end, start, atol=1e-12 * np.ptp(stream_function(around)))
    assert (Locator(around.mesh).find(tracers.path)[0] >= 0).all()
    assert [len(path) for path in tracers.paths()] == np.diff(tracers.first).tolist()
    for k, path in enumerate(tracers.paths()):
        np.testing.assert_array_equal(path[[0, -1]], [tracers.start[k], tracers.end[k]])
    ascending = np.diff(tracers.path_time)
    ascending[tracers.first[1:-1] - 1] = 0.0
    assert (ascending >= 0.0).all()
    np.testing.assert_array_equal(tracers.path_time[tracers.first[1:] - 1], tracers.time)


@pytest.mark.parametrize("make", [channel, lambda: channel(16)])
def test_mean_residence_time_is_area_over_flow(make):
    flow = make()
    times = residence_times(flow, count=1000)
    assert times.mean * flow.flow_rate("right") / flow.mesh.areas.sum() == pytest.approx(1.0, rel=1e-6)
    assert times.lost == pytest.approx(0.0, abs=1e-12)


def test_residence_times_of_poiseuille_flow():
    # The middle share s of the flow, 3 d - 4 d^3 = s for |y - 1/2| < d, has left by 2 / (6 (1/4 - d^2)).
    shares = np.array([0.1, 0.25, 0.5, 0.75, 0.9])
    worst = []
    for across in (8, 16, 32):
        times = residence_times(channel(across), count=2000)
        half = np.array([np.roots([-4.0, 0.0, 3.0, -s]) for s in shares])
        half = half.real[np.arange(5), np.argmin(np.abs(half.real - 0.25), axis=1)]
        exact = 2.0 / (6.0 * (0.25 - half**2))
        worst.append(np.abs(times.quantile(shares) / exact - 1.0).max())
        np.testing.assert_allclose(times.share(times.quantile(shares)), shares, atol=2e-3)
    assert worst[1] < 5e-3
    assert worst[2] < 1e-3


def test_mean_time_around_a_pillar(around):
    times = residence_times(around, count=4000)
    assert times.mean * around.flow_rate("right") / around.mesh.areas.sum() == pytest.approx(1.0, rel=3e-3)


def test_a_turning_flow_closes_its_circles():
    swirl = Velocity(lambda x, y: (ANNULUS.u(x, y), ANNULUS.v(x, y)))
    flow = solve_stokes(annulus(16, 120), {"pillars": swirl})
    radius = np.array([0.55, 0.7, 0.85])
    # u / r as in the exact flow
    turn = 2.0 * np.pi / ((1.0 / radius**2 - 1.0) * 0.5 / 0.75)
    for r, time in zip(radius, turn, strict=True):
        tracers = trace(flow, [[r, 0.0]], duration=float(time))
        assert tracers.edge.tolist() == [-1]
        assert tracers.time[0] == time
        np.testing.assert_allclose(tracers.end[0], [r, 0.0], atol=5e-3)
        np.testing.assert_allclose(np.hypot(*tracers.path.T), r, atol=2e-3)


def test_tracers_go_on_across_seams():
    flow = solve_stokes(rectangle(2.0, 1.0, 16, seed=4), {"left": Periodic("right", 12.0), "top": Slip()})
    # Half a channel of twice the height: u = 3 y (2 - y).
    start = np.column_stack([np.full(4, 0.3), [0.2, 0.5, 0.8, 1.0]])
    tracers = trace(flow, start, duration=5.0)
    speed = 3.0 * start[:, 1] * (2.0 - start[:, 1])
    np.testing.assert_allclose(tracers.end - start, np.column_stack([5.0 * speed, np.zeros(4)]), rtol=5e-3, atol=2e-3)
    assert (tracers.edge == -1).all()
    steps = np.diff(tracers.path, axis=0)
    steps[tracers.first[1:-1] - 1] = 0.0
    assert np.abs(steps).max() < 0.3


def test_seeds_stand_for_equal_turns(around):
    field = conservative_field(around)
    for count in (1, 7, 200):
        cell, shares, weight = seed_side(around, field, "left", count)
        at = np.einsum("kc,kcd->kd", shares, around.mesh.points[around.mesh.triangles[cell]])
        np.testing.assert_allclose(at[:, 0], 0.0, atol=1e-15)
        assert weight.sum() == pytest.approx(around.flow_rate("right"), rel=1e-12)
        assert (np.diff(at[:, 1]) < 0.0).all()
        psi = quadratic(around, at)
        wanted = 0.5 * (1.0 + np.cos(np.pi * (np.arange(count) + 0.5) / count)) * np.ptp(stream_function(around))
        np.testing.assert_allclose(psi - stream_function(around).min(), wanted, atol=1e-12)


def test_threads_change_no_bit(around):
    before = get_threads()
    try:
        set_threads(1)
        one = trace(around, side="left", count=300)
        set_threads(2)
        two = trace(around, side="left", count=300)
    finally:
        set_threads(before)
    np.testing.assert_array_equal(two.path, one.path)
    np.testing.assert_array_equal(two.time, one.time)


def test_faults(around):
    with pytest.raises(InputError, match="one of start= and side="):
        trace(around)
    with pytest.raises(InputError, match="1 of 2 tracers start outside the fluid, first 1"):
        trace(around, [[0.1, 0.1], [0.5, 0.5]])
    with pytest.raises(InputError, match="no fluid enters through 'top'"):
        trace(around, side="top")
    with pytest.raises(InputError, match="count of tracers is 0"):
        trace(around, side="left", count=0)
    with pytest.raises(InputError, match=r"duration of the tracers is -1\.0"):
        trace(around, side="left", duration=-1.0)
    with pytest.raises(InputError, match="none of 1000 tracers from 'left' left through 'top'"):
        residence_times(around, outlet="top")
    with pytest.raises(InputError, match="between 0 and 1"):
        residence_times(around).quantile(1.5)
    still = solve_stokes(rectangle(1.0, 1.0, 4), {})
    with pytest.raises(InputError, match="give the tracers a duration"):
        trace(still, [[0.5, 0.5]])
    assert trace(still, [[0.5, 0.5]], duration=2.0).time.tolist() == [2.0]
