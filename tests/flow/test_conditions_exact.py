"""Every condition on flows that are known exactly."""

import numpy as np
import pytest
from numpy import cos, sin
from tests.flow.exact import ANNULUS, MOVING
from tests.flow.meshes import annulus, rectangle

from vasculo.flow.body_force import cell_forces
from vasculo.flow.boundary import Periodic, Pressure, Slip, Velocity, Wall
from vasculo.flow.stokes import solve_stokes
from vasculo.mesh.triangulation import Triangulation

EXACT = 1e-11


def parabola(y):
    return 0.5 * y * (1.0 - y)


def moved(mesh, place):
    """Give the mesh with its points moved."""
    return Triangulation(place(mesh.points), mesh.triangles, mesh.boundary_edges, mesh.boundary_tags, mesh.side_names)


def assert_flow(flow, velocity, pressure):
    np.testing.assert_allclose(flow.velocity, velocity, atol=EXACT)
    np.testing.assert_allclose(flow.pressure, pressure, atol=10 * EXACT)
    assert flow.mass_imbalance < 1e-12


@pytest.mark.parametrize("turn", [0.0, 0.7])
def test_couette_flow_between_moving_walls(turn):
    mesh = rectangle(3.0, 1.0, 7, seed=1, turn=turn)
    along, across = np.array([cos(turn), sin(turn)]), np.array([-sin(turn), cos(turn)])
    walls = {"top": Wall(tuple(along)), "bottom": Wall(lambda x, y: (-along[0] + 0 * x, -along[1] + 0 * y))}
    flow = solve_stokes(mesh, {"left": Periodic("right"), **walls}, viscosity=3.0)
    assert_flow(flow, np.outer(2.0 * (mesh.centroids @ across) - 1.0, along), 0.0)
    # Both walls count as walls; the fluid pulls the top one back and the bottom one on.
    np.testing.assert_array_equal(flow.wall_edges, mesh.boundary_edges[np.isin(mesh.boundary_tags, [-1, -4])])
    middle = mesh.points[flow.wall_edges].mean(axis=1) @ across
    np.testing.assert_allclose(flow.wall_traction, np.outer(np.where(middle > 0.5, -6.0, 6.0), along), atol=1e-9)


def test_a_pressure_drop_against_a_moving_wall():
    mesh = rectangle(3.0, 1.0, 7, seed=2)
    flow = solve_stokes(mesh, {"left": Periodic("right", -3.0), "top": Wall((1.0, 0.0))})
    x, y = mesh.centroids.T
    assert_flow(flow, np.column_stack([y - parabola(y), 0 * y]), x - 1.5)
    assert flow.flow_rate("right") == pytest.approx(0.5 - 1.0 / 12.0, abs=EXACT)


def test_walls_that_stretch():
    mesh = rectangle(1.0, 1.3, 6, seed=3)
    flow = solve_stokes(mesh, dict.fromkeys(mesh.side_names, Wall(lambda x, y: (x, -y))), viscosity=2.0)
    assert_flow(flow, mesh.centroids * [1.0, -1.0], 0.0)
    ends = mesh.points[flow.wall_edges]
    along = (ends[:, 1] - ends[:, 0]) / np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)[:, None]
    normal = np.column_stack([along[:, 1], -along[:, 0]])
    np.testing.assert_allclose(flow.wall_traction, -4.0 * normal * [1.0, -1.0], atol=1e-9)


def test_a_rigid_turn_does_no_work():
    mesh = annulus(5, 30)
    turning = Wall.turning(1.5, (0.3, -0.2))
    flow = solve_stokes(mesh, {"pillars": turning, "rim": turning})
    x, y = mesh.centroids.T
    assert_flow(flow, 1.5 * np.column_stack([-(y + 0.2), x - 0.3]), 0.0)
    np.testing.assert_allclose(flow.wall_traction, 0.0, atol=1e-9)


@pytest.mark.parametrize("name", ["pillars", "pillar 0"])
def test_a_cylinder_that_turns_in_another(name):
    found = []
    for k in (1, 2):
        mesh = annulus(5 * k, 36 * k)
        flow = solve_stokes(mesh, {name: Wall.turning(2.0)})
        assert set(flow.wall_pillar) == {0, -1}
        inside = flow.wall_pillar == 0
        ends = mesh.points[flow.wall_edges[inside]]
        arm = ends.mean(axis=1)
        torque = np.sum((arm[:, 0] * flow.wall_traction[inside, 1] - arm[:, 1] * flow.wall_traction[inside, 0])
                        * np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1))  # fmt: skip
        found.append([errors_of_velocity(mesh, flow, ANNULUS), abs(torque / -ANNULUS.torque - 1.0)])
    slopes = np.log2(np.divide(*found))
    assert found[1][0] < 2e-3
    assert found[1][1] < 0.01
    assert slopes.min() > 1.8


def errors_of_velocity(mesh, flow, exact):
    x, y = mesh.centroids.T
    away = (flow.velocity[:, 0] - exact.u(x, y)) ** 2 + (flow.velocity[:, 1] - exact.v(x, y)) ** 2
    return float(np.sqrt(np.sum(away * mesh.areas)))


@pytest.mark.parametrize("inlet", [Velocity.parabolic(1.0 / 12.0), Velocity.parabolic(peak=0.125)])
@pytest.mark.parametrize("turn", [0.0, 1.1])
def test_poiseuille_flow_from_a_parabolic_inlet(inlet, turn):
    mesh = rectangle(2.0, 1.0, 7, seed=4, turn=turn)
    flow = solve_stokes(mesh, {"left": inlet, "right": Pressure(0.0)})
    along, across = np.array([cos(turn), sin(turn)]), np.array([-sin(turn), cos(turn)])
    assert_flow(flow, np.outer(parabola(mesh.centroids @ across), along), 2.0 - mesh.centroids @ along)
    assert flow.flow_rate("left") == pytest.approx(-1.0 / 12.0, abs=1e-14)


def test_poiseuille_flow_through_bent_inlets_and_outlets():
    def bend(points):
        x, y = points.T
        return np.column_stack(
            [x + 0.3 * np.minimum(y, 1.0 - y) * (2.0 - x) - 0.4 * np.minimum(3.0 * y, 1.0 - y) * x, y]
        )

    mesh = moved(rectangle(2.0, 1.0, 7, seed=5), bend)
    flow = solve_stokes(mesh, {"left": Velocity.parabolic(1.0 / 12.0), "right": Velocity.parabolic(-1.0 / 12.0)})
    x, y = mesh.centroids.T
    level = -np.sum(mesh.areas * x) / np.sum(mesh.areas)
    assert_flow(flow, np.column_stack([parabola(y), 0 * y]), -x - level)


def test_half_a_channel_with_a_mirror_line():
    mesh = rectangle(1.5, 0.5, 5, seed=6)
    inlet = Velocity(lambda _x, y: 0.5 * y * (1.0 - y))
    flow = solve_stokes(mesh, {"left": inlet, "right": Pressure(1.0), "top": Slip()})
    x, y = mesh.centroids.T
    assert_flow(flow, np.column_stack([parabola(y), 0 * y]), 2.5 - x)
    assert flow.flow_rate("top") == 0.0


def test_gravity_is_held_by_pressures_that_vary_along_the_openings():
    mesh = rectangle(2.0, 1.0, 7, seed=7)
    x, y = mesh.centroids.T
    still = {"left": Pressure(lambda _x, y: 2.0 - 3.0 * y)}
    assert_flow(solve_stokes(mesh, still, force=(0.0, -3.0)), 0.0, 2.0 - 3.0 * y)
    driven = {"left": Pressure(lambda x, y: 2.0 - x - 3.0 * y), "right": Pressure(lambda _x, y: -3.0 * y)}
    flow = solve_stokes(mesh, driven, force=(0.0, -3.0))
    assert_flow(flow, np.column_stack([parabola(y), 0 * y]), 2.0 - x - 3.0 * y)


def test_second_order_with_a_pressure_that_varies_along_the_opening():
    # Stream function (1 + x^2) sin 2y: no velocity along the side x = 0.
    def velocity(x, y):
        return 2.0 * (1.0 + x**2) * cos(2.0 * y), -2.0 * x * sin(2.0 * y)

    def pressure(x, y):
        return sin(3.0 * y) + x * cos(2.0 * y)

    def force(x, y):
        laplace_u = 4.0 * cos(2.0 * y) - 8.0 * (1.0 + x**2) * cos(2.0 * y)
        laplace_v = 8.0 * x * sin(2.0 * y)
        return cos(2.0 * y) - laplace_u, 3.0 * cos(3.0 * y) - 2.0 * x * sin(2.0 * y) - laplace_v

    found = []
    for across in (8, 16, 32):
        mesh = rectangle(1.0, 1.0, across, seed=8)
        sides = dict.fromkeys(("bottom", "right", "top"), Velocity(velocity)) | {"left": Pressure(pressure)}
        flow = solve_stokes(mesh, sides, force=cell_forces(mesh, force))
        at = mesh.centroids.T
        away = flow.velocity - np.column_stack(velocity(*at))
        found.append([
            np.sqrt(np.sum(mesh.areas[:, None] * away**2)),
            np.sqrt(np.sum(mesh.areas * (flow.pressure - pressure(*at)) ** 2)),
        ])  # fmt: skip
    slopes = np.log2(np.array(found[0]) / found[2]) / 2.0
    assert slopes[0] > 2.0
    assert slopes[1] > 1.8


def test_an_enclosed_cavity_has_a_mean_pressure_of_zero():
    found = []
    for across in (8, 16):
        mesh = rectangle(1.0, 1.0, across, seed=9)
        walls = dict.fromkeys(mesh.side_names, Wall((MOVING.u, MOVING.v)))
        flow = solve_stokes(mesh, walls, force=MOVING.force(mesh))
        assert np.sum(mesh.areas * flow.pressure) == pytest.approx(0.0, abs=1e-12)
        np.testing.assert_array_equal(flow.wall_edges, mesh.boundary_edges)
        x, y = mesh.centroids.T
        exact = MOVING.p(x, y)
        away = flow.pressure - exact + np.sum(mesh.areas * exact)
        found.append([errors_of_velocity(mesh, flow, MOVING), np.sqrt(np.sum(mesh.areas * away**2))])
    assert np.log2(np.divide(*found)).min() > 1.8
