"""Arrays of pillars: drag and wall shear against reference values, balances and symmetries."""

import numpy as np
import pytest
from tests.flow.meshes import cylinder_in_square, rectangle

from vasculo.flow.boundary import Periodic, Pressure, Slip, Velocity
from vasculo.flow.stokes import solve_stokes
from vasculo.geometry.domain import Domain
from vasculo.mesh.generate import generate_mesh
from vasculo.mesh.triangulation import Triangulation

# Square arrays of cylinders (Sangani & Acrivos 1982, and a multipole series): drag / (viscosity U), largest and mean
# wall shear (viscosity U / L), friction's part of the drag.
SQUARE = {
    0.10: (24.831675, 22.7958, 12.0463, 0.4494),
    0.30: (102.881304, 50.2804, 20.1027, 0.3380),
    0.50: (532.54812, 161.035, 48.7299, 0.2115),
}
CELL = {"left": Pressure(1.0), "right": Pressure(0.0), "top": Slip(), "bottom": Slip()}
PERIODIC = {"left": Periodic("right", 1.0), "bottom": Periodic("top")}


def polygon(x, y, radius, corners, turn=0.0, wave=0.0):
    angle = turn + 2 * np.pi * np.arange(corners) / corners
    r = radius * (1 + wave * np.cos(3 * angle))
    return np.column_stack([x + r * np.cos(angle), y + r * np.sin(angle)])


def small_array(height=3.0):
    rng = np.random.default_rng(11)
    places = [(1.0 + i, 0.5 + j) for i in range(3) for j in range(int(height))]
    return Domain.rectangle(
        4.0,
        height,
        [polygon(*(p + rng.uniform(-0.08, 0.08, 2)), 0.34, 32, rng.uniform(0, 6), 0.1) for p in np.array(places)],
    )


def wall_forces(flow):
    """Viscous and pressure force on the solid, a row a wall edge."""
    along = np.diff(flow.mesh.points[flow.wall_edges], axis=1)[:, 0]
    outward = np.column_stack([along[:, 1], -along[:, 0]])
    return flow.wall_traction * np.hypot(*along.T)[:, None], flow.wall_pressure[:, None] * outward


@pytest.mark.parametrize("fraction", [0.10, 0.30, 0.50])
@pytest.mark.parametrize("conditions", [CELL, PERIODIC], ids=["cell", "periodic"])
def test_square_array(fraction, conditions):
    drag, top_shear, mean_shear, friction = SQUARE[fraction]
    mesh = cylinder_in_square(fraction, around=128)
    flow = solve_stokes(mesh, conditions)
    speed = flow.flow_rate("right")
    assert flow.flow_rate("left") == pytest.approx(-speed, rel=1e-12)
    assert 1.0 / speed == pytest.approx(drag, rel=5e-3)
    on_pillar = flow.wall_pillar == 0
    assert on_pillar.all()
    viscous, pressure = wall_forces(flow)
    np.testing.assert_allclose((viscous + pressure).sum(axis=0), [1.0, 0.0], atol=1e-4)
    assert (viscous + pressure).sum(axis=0)[0] == pytest.approx(1.0, abs=1e-12)
    assert viscous[:, 0].sum() == pytest.approx(friction, rel=3e-3)
    assert np.abs(flow.wall_shear).max() / speed == pytest.approx(top_shear, rel=0.01)
    assert np.abs(flow.wall_shear).mean() / speed == pytest.approx(mean_shear, rel=5e-3)


@pytest.mark.parametrize("fraction", [0.10, 0.30])
def test_square_array_on_the_packages_own_mesh(fraction):
    # Corners on the circle, so the polygon is a little smaller than the cylinder.
    circle = np.sqrt(fraction / np.pi)
    pillar = polygon(0.5, 0.5, circle, 128)
    mesh = generate_mesh(Domain.rectangle(1.0, 1.0, [pillar]), 0.04, 2.02 * np.pi * circle / 128)
    for conditions in (CELL, PERIODIC):
        flow = solve_stokes(mesh, conditions)
        assert 1.0 / flow.flow_rate("right") == pytest.approx(SQUARE[fraction][0], rel=5e-3)


def test_drag_converges_with_second_order():
    away = []
    for around in (32, 64, 128):
        flow = solve_stokes(cylinder_in_square(0.1, around), PERIODIC)
        away.append(abs(1.0 / flow.flow_rate("right") / SQUARE[0.1][0] - 1.0))
    assert np.log2(away[0] / away[2]) / 2 > 1.7, away


def test_cylinder_in_a_channel():
    # Half-width 1, radius 0.2, centre-line speed 1: 16.20723 (Faxen 1946).
    mesh = generate_mesh(Domain.rectangle(8.0, 2.0, [polygon(4.0, 1.0, 0.2, 72)]), 0.15, 0.04, grading=0.15)
    flow = solve_stokes(mesh, {"left": Velocity(lambda x, y: y * (2.0 - y) + 0 * x), "right": Pressure(0.0)})
    viscous, pressure = wall_forces(flow)
    drag, lift = (viscous + pressure)[flow.wall_pillar == 0].sum(axis=0)
    assert drag == pytest.approx(16.20723, rel=5e-3)
    assert abs(lift) < 5e-3


def test_forces_on_walls_and_pillars_balance_the_pressure_drop():
    domain = small_array()
    flow = solve_stokes(generate_mesh(domain, 0.2, 0.08), {"left": Pressure(2.0), "right": Pressure(0.5)})
    viscous, pressure = wall_forces(flow)
    force = (viscous + pressure).sum(axis=0)
    assert force[0] == pytest.approx(1.5 * 3.0, rel=1e-12)
    assert flow.mass_imbalance <= 1e-12
    assert flow.report["solver"] in {"pardiso", "splu"}
    assert set(flow.wall_pillar.tolist()) == set(range(-1, 9))
    on_pillars = flow.mesh.boundary_tags >= 0
    np.testing.assert_array_equal(flow.wall_edges[flow.wall_pillar >= 0], flow.mesh.boundary_edges[on_pillars])


def test_reversal_viscosity_and_pressure_level():
    mesh = generate_mesh(small_array(2.0), 0.25, 0.1)
    flow = solve_stokes(mesh, {"left": Pressure(1.0), "right": Pressure(0.0)})
    back = solve_stokes(mesh, {"left": Pressure(-1.0), "right": Pressure(0.0)})
    np.testing.assert_array_equal(back.velocity, -flow.velocity)
    np.testing.assert_array_equal(back.pressure, -flow.pressure)
    np.testing.assert_array_equal(back.wall_shear, -flow.wall_shear)
    top = np.abs(flow.velocity).max()
    swapped = solve_stokes(mesh, {"left": Pressure(7.0), "right": Pressure(8.0)})
    np.testing.assert_allclose(swapped.velocity, -flow.velocity, atol=1e-9 * top)
    thick = solve_stokes(mesh, {"left": Pressure(1.0), "right": Pressure(0.0)}, viscosity=37.0)
    np.testing.assert_allclose(37.0 * thick.velocity, flow.velocity, atol=1e-10 * top)
    np.testing.assert_allclose(thick.wall_shear, flow.wall_shear, atol=1e-10)
    again = solve_stokes(mesh, {"right": Pressure(0.0), "left": Pressure(1.0)})
    np.testing.assert_array_equal(again.velocity, flow.velocity)


@pytest.mark.parametrize("kind", ["mirrored", "turned", "renumbered"])
def test_flow_follows_its_mesh(kind):
    mesh = generate_mesh(small_array(2.0), 0.3, 0.12)
    rng = np.random.default_rng(3)
    points, triangles, edges = mesh.points, mesh.triangles, mesh.boundary_edges
    change = np.eye(2)
    shuffle = np.arange(len(triangles))
    if kind == "mirrored":
        change = np.diag([1.0, -1.0])
        triangles, edges = triangles[:, ::-1], edges[:, ::-1]
    elif kind == "turned":
        change = np.array([[np.cos(1.1), np.sin(1.1)], [-np.sin(1.1), np.cos(1.1)]])
    else:
        shuffle = rng.permutation(len(triangles))
        triangles = np.roll(triangles[shuffle], 1, axis=1)
    other = Triangulation(points @ change, triangles, edges, mesh.boundary_tags, mesh.side_names)
    conditions = {"left": Velocity(1.0, 0.0), "right": Pressure(0.0), "top": Slip()}
    flow = solve_stokes(mesh, conditions)
    inlet = change[0]
    found = solve_stokes(other, {**conditions, "left": Velocity(*inlet)})
    np.testing.assert_allclose(found.velocity, flow.velocity[shuffle] @ change, atol=1e-8)
    np.testing.assert_allclose(found.pressure, flow.pressure[shuffle], atol=1e-8 * np.abs(flow.pressure).max())
    sign = -1.0 if kind == "mirrored" else 1.0
    np.testing.assert_allclose(found.wall_shear, sign * flow.wall_shear, atol=1e-7 * np.abs(flow.wall_shear).max())


def test_slip_pillars_resist_less():
    mesh = cylinder_in_square(0.1, 64)
    held, slipping = solve_stokes(mesh, CELL), solve_stokes(mesh, {**CELL, "pillars": Slip()})
    assert slipping.flow_rate("right") > 1.5 * held.flow_rate("right")
    assert len(slipping.wall_edges) == 0


def test_a_pillar_that_leaks():
    mesh = cylinder_in_square(0.1, 64)
    flow = solve_stokes(mesh, {"pillars": Pressure(1.0), "left": Pressure(0.0)})
    assert flow.flow_rate("pillars") == pytest.approx(-flow.flow_rate("left"), rel=1e-10)
    assert flow.flow_rate("pillars") < 0


def test_a_lid_driven_box():
    # Speed at the centre of the unit square under a lid of speed 1: -0.2050 to -0.2053 in the literature.
    mesh = rectangle(1.0, 1.0, 32, seed=1)
    flow = solve_stokes(mesh, {"top": Velocity(1.0)})
    near = np.argmin(np.hypot(*(mesh.points - 0.5).T))
    at = mesh.points[near]
    nodes = flow.node_velocity()[near]
    assert nodes[0] == pytest.approx(-0.2050, abs=0.006), at
    assert flow.report["closed_parts"] == 1
    assert abs(np.sum(flow.pressure * mesh.areas)) < 1e-9 * np.abs(flow.pressure).max()
    assert flow.mass_imbalance < 1e-12
