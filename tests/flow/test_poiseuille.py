"""Plane Poiseuille flow is reproduced to round-off on irregular meshes, whatever drives it."""

import numpy as np
import pytest
from tests.flow.meshes import rectangle

from vasculo.flow.boundary import Periodic, Pressure, Slip, Velocity
from vasculo.flow.stokes import solve_stokes

EXACT = 1e-11


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
    assert flow.flow_rate("right") == pytest.approx(gap**3 / 12.0, rel=1e-9)
    np.testing.assert_allclose(np.abs(flow.wall_shear), 0.5 * gap, rtol=1e-8)


def test_in_the_units_of_a_capillary():
    # 0.2 mm long, 3.5 mPa s, 100 Pa.
    length, viscosity, drop = 2e-4, 3.5e-3, 100.0
    mesh = rectangle(length, length / 3, 8, seed=10)
    flow = solve_stokes(mesh, {"left": Pressure(drop), "right": Pressure(0.0)}, viscosity)
    exact = (length / 3) ** 3 * drop / length / (12 * viscosity)
    assert flow.flow_rate("right") == pytest.approx(exact, rel=1e-10)
    np.testing.assert_allclose(np.abs(flow.wall_shear), 0.5 * drop / length * length / 3, rtol=1e-10)
