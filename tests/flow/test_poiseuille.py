"""Plane Poiseuille flow is reproduced to round-off on irregular meshes, whatever drives it."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.flow.meshes import fan, rectangle, scattered

from vasculo.flow.boundary import Periodic, Pressure, Slip, Velocity
from vasculo.flow.stokes import solve_stokes
from vasculo.mesh.triangulation import Triangulation

EXACT = 1e-12


def parabola(x, y):
    return 0.5 * y * (1.0 - y) + 0.0 * x


def check(mesh, flow, *, level=0.0):
    x, y = mesh.centroids.T
    np.testing.assert_allclose(flow.velocity[:, 0], parabola(x, y), atol=EXACT)
    np.testing.assert_allclose(flow.velocity[:, 1], 0.0, atol=EXACT)
    np.testing.assert_allclose(flow.pressure, level - x, atol=10 * EXACT)
    middle = mesh.points[flow.wall_edges].mean(axis=1)
    # Edges run along the flow at the bottom and against it at the top; both walls are dragged along.
    np.testing.assert_allclose(flow.wall_shear, np.where(middle[:, 1] < 0.5, -0.5, 0.5), atol=10 * EXACT)
    np.testing.assert_allclose(flow.wall_traction, np.tile([0.5, 0.0], (len(middle), 1)), atol=10 * EXACT)
    assert (flow.wall_pillar == -1).all()
    np.testing.assert_allclose(flow.wall_pressure, level - middle[:, 0], atol=10 * EXACT)
    assert flow.flow_rate("right") == pytest.approx(1.0 / 12.0, abs=EXACT)
    assert flow.flow_rate("left") == pytest.approx(-1.0 / 12.0, abs=EXACT)
    assert flow.flow_rate("top") == 0.0
    assert flow.mass_imbalance < 1e-12
    assert flow.residual < 1e-12


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize("across", [4, 11])
def test_between_two_pressures(seed, across):
    mesh = rectangle(3.0, 1.0, across, seed)
    check(mesh, solve_stokes(mesh, {"left": Pressure(3.0), "right": Pressure(0.0)}), level=3.0)


def test_from_a_parabolic_inlet():
    mesh = rectangle(3.0, 1.0, 8, seed=4)
    check(mesh, solve_stokes(mesh, {"left": Velocity(parabola), "right": Pressure(0.0)}), level=3.0)


def test_between_two_parabolic_profiles_without_a_pressure():
    mesh = rectangle(3.0, 1.0, 8, seed=5)
    flow = solve_stokes(mesh, {"left": Velocity(parabola, 0.0), "right": Velocity(parabola)})
    check(mesh, flow, level=1.5)
    assert flow.report["closed_parts"] == 1


def test_through_periodic_sides():
    mesh = rectangle(3.0, 1.0, 8, seed=6)
    for conditions in ({"left": Periodic("right", 3.0)}, {"right": Periodic("left", pressure_drop=-3.0)}):
        check(mesh, solve_stokes(mesh, conditions), level=1.5)


def test_driven_by_a_body_force():
    mesh = rectangle(3.0, 1.0, 8, seed=7)
    flow = solve_stokes(mesh, {"left": Periodic("right")}, force=(1.0, 0.0))
    np.testing.assert_allclose(flow.velocity[:, 0], parabola(*mesh.centroids.T), atol=EXACT)
    np.testing.assert_allclose(flow.pressure, 0.0, atol=10 * EXACT)


@pytest.mark.parametrize("turn", [0.0, 0.6, 2.2])
def test_half_channel_with_a_mirror_line_and_oblique_openings(turn):
    mesh = rectangle(2.0, 0.5, 6, seed=8, turn=turn)
    flow = solve_stokes(mesh, {"left": Pressure(2.0), "right": Pressure(0.0), "top": Slip()})
    along, across = np.array([np.cos(turn), np.sin(turn)]), np.array([-np.sin(turn), np.cos(turn)])
    y = mesh.centroids @ across
    np.testing.assert_allclose(flow.velocity, np.outer(parabola(0.0, y), along), atol=EXACT)
    np.testing.assert_allclose(flow.wall_shear, -0.5, atol=10 * EXACT)
    assert flow.flow_rate("right") == pytest.approx(1.0 / 24.0, abs=EXACT)


@pytest.mark.parametrize("kappa", [0.5, 2.0, 30.0])
def test_the_smoothing_does_not_touch_it(monkeypatch, kappa):
    monkeypatch.setattr("vasculo.flow.assemble.SMOOTHING", kappa)
    mesh = rectangle(3.0, 1.0, 8, seed=9)
    check(mesh, solve_stokes(mesh, {"left": Pressure(3.0), "right": Pressure(0.0)}), level=3.0)


@pytest.mark.parametrize("gap", [0.1, 0.01])
def test_a_gap_with_one_layer_of_triangles(gap):
    mesh = rectangle(20 * gap, gap, 1, jitter=0.0)
    flow = solve_stokes(mesh, {"left": Pressure(20 * gap), "right": Pressure(0.0)})
    assert flow.flow_rate("right") == pytest.approx(gap**3 / 12.0, rel=1e-10)
    np.testing.assert_allclose(np.abs(flow.wall_shear), 0.5 * gap, rtol=1e-10)


@pytest.mark.parametrize("seed", [3, 4, 5])
def test_among_slivers(seed):
    mesh = scattered(16, seed)
    assert mesh.quality().min() < 0.02
    check(mesh, solve_stokes(mesh, {"left": Pressure(1.0), "right": Pressure(0.0)}), level=1.0)


@pytest.mark.parametrize(("across", "centre"), [(1, (0.5, 0.5)), (1, (0.4, 0.55)), (2, (0.0, 0.0)), (4, (0.4, 0.55)),
                                                (10, (0.3, 0.6))])  # fmt: skip
def test_through_a_fan_of_triangles_around_one_point(across, centre):
    mesh = fan(across, centre)
    check(mesh, solve_stokes(mesh, {"left": Pressure(1.0), "right": Pressure(0.0)}), level=1.0)


@settings(max_examples=20, deadline=None)
@given(turn=st.floats(0.0, 2 * np.pi), seed=st.integers(0, 2**16), slip=st.booleans())
def test_plane_shear_flow_however_it_is_turned(turn, seed, slip):
    # The top moves with speed 1 past the wall below; or (slip) the bottom moves and takes everything with it.
    mesh = rectangle(1.5, 1.0, 4, seed=seed, turn=turn)
    along, across = np.array([np.cos(turn), np.sin(turn)]), np.array([-np.sin(turn), np.cos(turn)])
    walls = {"top": Slip(), "bottom": Velocity(*along)} if slip else {"top": Velocity(*along)}
    flow = solve_stokes(mesh, {"left": Periodic("right"), **walls})
    speed = np.ones(len(mesh.areas)) if slip else mesh.centroids @ across
    np.testing.assert_allclose(flow.velocity, np.outer(speed, along), atol=EXACT)
    np.testing.assert_allclose(flow.pressure, 0.0, atol=100 * EXACT)
    np.testing.assert_allclose(flow.wall_shear, -1.0, atol=10 * EXACT)
    assert flow.flow_rate("right") == pytest.approx(1.0 if slip else 0.5, abs=EXACT)


@pytest.mark.parametrize("triangles", [1, 2, 3])
def test_a_pocket_beside_a_channel_stays_at_rest(triangles):
    channel = rectangle(3.0, 1.0, 6, seed=11)
    shape = np.array([[1.0, 2.0], [1.4, 2.1], [1.5, 2.6], [1.1, 2.5], [0.9, 2.2]])[: triangles + 2]
    first = len(channel.points)
    nodes = first + np.arange(len(shape))
    fans = [[first, first + k + 1, first + k + 2] for k in range(triangles)]
    mesh = Triangulation(
        np.concatenate([channel.points, shape]),
        np.concatenate([channel.triangles, fans]),
        np.concatenate([channel.boundary_edges, np.column_stack([nodes, np.roll(nodes, -1)])]),
        np.concatenate([channel.boundary_tags, np.zeros(len(nodes))]),
        channel.side_names,
    )
    sides = {"left": Pressure(3.0), "right": Pressure(0.0)}
    flow, alone = solve_stokes(mesh, sides, pockets="rest"), solve_stokes(channel, sides)
    here = len(channel.triangles)
    np.testing.assert_allclose(flow.velocity[:here], alone.velocity, atol=EXACT)
    np.testing.assert_allclose(flow.velocity[here:], 0.0, atol=EXACT)
    np.testing.assert_allclose(flow.pressure[here:], 0.0, atol=10 * EXACT)
    assert flow.report["pocket_triangles"] == triangles
    assert flow.report["closed_parts"] == 1
    # Too few pressures for a plane: each face takes those of its own triangles.
    assert flow.report["two_point_pressures"] == 2 * triangles + 1


def test_in_the_units_of_a_capillary():
    # 0.2 mm long, 3.5 mPa s, 100 Pa.
    length, viscosity, drop = 2e-4, 3.5e-3, 100.0
    mesh = rectangle(length, length / 3, 8, seed=10)
    flow = solve_stokes(mesh, {"left": Pressure(drop), "right": Pressure(0.0)}, viscosity)
    exact = (length / 3) ** 3 * drop / length / (12 * viscosity)
    assert flow.flow_rate("right") == pytest.approx(exact, rel=1e-10)
    np.testing.assert_allclose(np.abs(flow.wall_shear), 0.5 * drop / length * length / 3, rtol=1e-10)
