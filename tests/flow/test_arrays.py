"""Arrays of pillars: drag and wall shear against reference values, balances and symmetries."""

import numpy as np
import pytest
from tests.flow.exact import CHANNEL, HEXAGONAL, SQUARE
from tests.flow.meshes import cylinder_in_square, rectangle

from vasculo.flow.boundary import Periodic, Pressure, Slip, Velocity
from vasculo.flow.stokes import solve_stokes
from vasculo.geometry.domain import Domain
from vasculo.mesh.generate import generate_mesh
from vasculo.mesh.triangulation import Triangulation

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


def same_area(fraction, corners, first, second):
    """A cell of an array of cylinders in a mesh of the package; the polygon has the cylinder's area."""
    turn = 2 * np.pi / corners
    radius = np.sqrt(2.0 * fraction * second[1] / (corners * np.sin(turn)))
    outer = np.array([[0.0, 0.0], first, np.add(first, second), second])
    pillar = polygon(*outer.mean(axis=0), radius, corners)
    domain = Domain(outer, [pillar], ["bottom", "right", "top", "left"])
    return generate_mesh(domain, 0.03, 1.01 * turn * radius)


@pytest.mark.parametrize("fraction", [0.05, 0.10, 0.30, 0.50])
@pytest.mark.parametrize("conditions", [CELL, PERIODIC], ids=["cell", "periodic"])
def test_square_array_on_the_packages_own_mesh(fraction, conditions):
    drag, top_shear, mean_shear, friction = SQUARE[fraction]
    flow = solve_stokes(same_area(fraction, 192, (1.0, 0.0), (0.0, 1.0)), conditions)
    speed = flow.flow_rate("right")
    assert 1.0 / speed == pytest.approx(drag, rel=1e-3)
    assert np.abs(flow.wall_shear).max() / speed == pytest.approx(top_shear, rel=5e-3)
    assert np.abs(flow.wall_shear).mean() / speed == pytest.approx(mean_shear, rel=3e-3)
    assert wall_forces(flow)[0][:, 0].sum() == pytest.approx(friction, rel=3e-3)


@pytest.mark.parametrize("fraction", [0.10, 0.30, 0.50])
def test_hexagonal_array_on_the_packages_own_mesh(fraction):
    # Flow towards a nearest neighbour; a mean pressure drop of 1 per length along x.
    drag, top_shear, mean_shear, friction = HEXAGONAL[fraction]
    height = np.sqrt(0.75)
    mesh = same_area(fraction, 192, (1.0, 0.0), (0.5, height))
    flow = solve_stokes(mesh, {"left": Periodic("right", 1.0), "bottom": Periodic("top", 0.5)})
    speed = flow.flow_rate("right") / height
    force = sum(wall_forces(flow)).sum(axis=0)
    np.testing.assert_allclose(force, [height, 0.0], atol=1e-4)
    assert force[0] == pytest.approx(height, rel=1e-11)
    assert height / speed == pytest.approx(drag, rel=1e-3)
    assert np.abs(flow.wall_shear).max() / speed == pytest.approx(top_shear, rel=5e-3)
    assert np.abs(flow.wall_shear).mean() / speed == pytest.approx(mean_shear, rel=3e-3)
    assert wall_forces(flow)[0][:, 0].sum() / height == pytest.approx(friction, rel=3e-3)


def test_drag_converges_with_second_order():
    away = []
    for around in (32, 64, 128):
        flow = solve_stokes(cylinder_in_square(0.1, around), PERIODIC)
        away.append(abs(1.0 / flow.flow_rate("right") / SQUARE[0.1][0] - 1.0))
    assert np.log2(away[0] / away[2]) / 2 > 1.7, away


@pytest.mark.parametrize("ratio", [0.1, 0.2, 0.5])
def test_cylinder_in_a_channel(ratio):
    # Half-width 1, centre-line speed 1; then the cylinder moves with speed 1 between closed ends.
    fixed, moving = CHANNEL[ratio]
    pillar = polygon(4.0, 1.0, ratio, 72)
    mesh = generate_mesh(Domain.rectangle(8.0, 2.0, [pillar]), 0.12, 0.09 * ratio, grading=0.15)
    flow = solve_stokes(mesh, {"left": Velocity(lambda x, y: y * (2.0 - y) + 0 * x), "right": Pressure(0.0)})
    drag, lift = sum(wall_forces(flow))[flow.wall_pillar == 0].sum(axis=0)
    assert drag == pytest.approx(fixed, rel=4e-3)
    assert abs(lift) < 2e-3 * drag
    flow = solve_stokes(mesh, {"pillars": Velocity(1.0)})
    drag, lift = sum(wall_forces(flow))[flow.wall_pillar == 0].sum(axis=0)
    assert -drag == pytest.approx(moving, rel=4e-3)
    assert abs(lift) < 2e-3 * abs(drag)


@pytest.mark.parametrize(("fraction", "within"), [(0.5, 0.003), (0.7, 0.005)])
def test_a_gap_between_two_cylinders(fraction, within):
    # A cell of the square array around the gap, four triangles across; the resistance is the drag of the array.
    radius, corners = np.sqrt(fraction / np.pi), 256
    angle = np.pi * np.arange(corners // 2 + 1) / (corners // 2)
    arc = radius * np.column_stack([-np.cos(angle), np.sin(angle)])
    arc[[0, -1], 1] = 0.0
    below, above = np.array([0.5, 0.0]) + arc, np.array([0.5, 1.0]) - arc
    outer = [[[0.0, 0.0]], below, [[1.0, 0.0], [1.0, 1.0]], above, [[0.0, 1.0]]]
    walls = ["wall"] * (corners // 2)
    sides = ["bottom", *walls, "bottom", "right", "top", *walls, "top", "left"]
    mesh = generate_mesh(Domain(np.concatenate(outer), [], sides), 0.08, across=4)
    flow = solve_stokes(mesh, CELL)
    assert 1.0 / flow.flow_rate("right") == pytest.approx(SQUARE[fraction][0], rel=within)


def test_forces_on_walls_and_pillars_balance_the_pressure_drop():
    domain = small_array()
    flow = solve_stokes(generate_mesh(domain, 0.2, 0.08), {"left": Pressure(2.0), "right": Pressure(0.5)})
    viscous, pressure = wall_forces(flow)
    force = (viscous + pressure).sum(axis=0)
    assert force[0] == pytest.approx(1.5 * 3.0, rel=1e-12)
    assert flow.mass_imbalance <= 1e-12
    assert flow.report["solver"] in {"direct", "splu"}
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
