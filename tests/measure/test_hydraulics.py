import numpy as np
import pytest
from tests.flow.meshes import cylinder_in_square

from vasculo import measure
from vasculo.errors import InputError
from vasculo.flow.boundary import Periodic, Pressure, Slip
from vasculo.flow.stokes import solve_stokes
from vasculo.geometry.domain import Domain
from vasculo.measure.hydraulics import permeability_tensor
from vasculo.mesh.generate import generate_mesh
from vasculo.mesh.triangulation import Triangulation
from vasculo.plexus.voronoi import disk_domain, voronoi_plexus

MIRRORS = {"top": Slip(), "bottom": Slip()}


def ellipse(degrees, centre, long=1.2, short=0.6, nodes=40):
    t = 2.0 * np.pi * np.arange(nodes) / nodes
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    flat = np.stack([long * np.cos(t), short * np.sin(t)], axis=1)
    return flat @ np.array([[c, s], [-s, c]]) + centre


def solved(domain, high=2.0, low=0.0, viscosity=1.0, spacing=0.5, **sides):
    mesh = generate_mesh(domain, spacing, 0.5 * spacing)
    conditions = {"left": Pressure(high), "right": Pressure(low)} | (sides or MIRRORS)
    return solve_stokes(mesh, conditions, viscosity)


@pytest.fixture(scope="module")
def disk():
    domain = disk_domain()
    return domain, solved(domain, viscosity=3.0)


@pytest.fixture(scope="module")
def block():
    domain = voronoi_plexus(9, channel=0.7, pad=1.0, seed=3)
    return domain, solved(domain, spacing=0.4)


def test_permeability_of_an_empty_channel():
    domain = Domain.rectangle(4.0, 1.0)
    mesh = generate_mesh(domain, 0.08)
    flow = solve_stokes(mesh, {"left": Pressure(5.0), "right": Pressure(1.0)}, 2.0)
    assert measure.permeability(domain, flow) == pytest.approx(1.0 / 12.0, rel=0.02)


def test_permeability_is_that_of_the_prescribed_drop(disk):
    domain, flow = disk
    expected = flow.flow_rate("right") * 3.0 * 12.0 / (8.0 * 2.0)
    assert measure.permeability(domain, flow) == pytest.approx(expected, rel=3e-3)


def test_permeability_knows_no_units_of_the_flow(block):
    domain, flow = block
    other = solved(domain, high=-1.0, low=6.0, viscosity=5.0, spacing=0.4)
    assert measure.permeability(domain, other) == pytest.approx(measure.permeability(domain, flow), rel=1e-6)
    assert measure.shear_ratio(other) == pytest.approx(measure.shear_ratio(flow), rel=1e-6)
    assert measure.alignment(domain, other) == pytest.approx(measure.alignment(domain, flow), abs=1e-6)
    assert measure.mean_wall_shear(other) == pytest.approx(3.5 * measure.mean_wall_shear(flow), rel=1e-6)


def test_drag_balances_the_pressure(disk, block):
    for domain, flow in (disk, block):
        height = domain.bounds[3]
        total = measure.pillar_drag(domain, flow).sum(axis=0)
        assert total[0] == pytest.approx(2.0 * height, rel=0.01)  # mirror walls carry no shear
        assert abs(total[1]) < 0.1 * total[0]


def test_alignment_is_against_the_drag_and_not_x():
    # one pillar in a channel along y
    outer = [(0, 0), (4, 0), (4, 8), (0, 8)]
    for degrees, expected in ((90.0, 1.0), (0.0, -1.0)):
        domain = Domain(outer, [ellipse(degrees, (2.0, 4.0))], ("low", "right", "high", "left"))
        mesh = generate_mesh(domain, 0.35, 0.15)
        conditions = {"low": Pressure(1.0), "high": Pressure(0.0), "left": Slip(), "right": Slip()}
        flow = solve_stokes(mesh, conditions)
        assert measure.alignment(domain, flow) == pytest.approx(expected, abs=0.02)
        assert measure.order(domain) == pytest.approx(-expected, abs=1e-6)
        assert measure.permeability(domain, flow, "low", "high") > 0.0


def test_shear_of_one_and_of_unlike_pillars(disk):
    _, flow = disk
    assert measure.shear_ratio(flow) == 1.0
    uneven = Domain.rectangle(10.0, 6.0, [ellipse(0.0, (3.0, 1.1), 0.8, 0.6), ellipse(0.0, (7.0, 3.4), 1.5, 1.5)])
    assert measure.shear_ratio(solved(uneven)) > 1.05


def test_nothing_to_measure():
    empty = Domain.rectangle(3.0, 1.0)
    flow = solve_stokes(generate_mesh(empty, 0.3), {"left": Pressure(1.0), "right": Pressure(0.0)})
    for function in (measure.mean_wall_shear, measure.shear_ratio):
        with pytest.raises(InputError, match="no pillar has a wall"):
            function(flow)
    with pytest.raises(InputError, match="none of 0"):
        measure.alignment(empty, flow)
    with pytest.raises(InputError, match="no pressure drop"):
        measure.permeability(empty, flow, "left", "left")


def test_drag_of_a_pillar_without_walls_is_nothing(disk):
    domain, _ = disk
    flow = solved(domain, pillars=Slip(), **MIRRORS)
    np.testing.assert_array_equal(measure.pillar_drag(domain, flow), np.zeros((1, 2)))


@pytest.mark.parametrize(("fraction", "drag"), [(0.05, 15.557822), (0.3, 102.881304)])
def test_permeability_tensor_of_the_square_array(fraction, drag):
    # L^2 viscosity U / F, isotropic (multipole series)
    found = permeability_tensor(cylinder_in_square(fraction, around=96, exact_area=False))
    np.testing.assert_allclose(found * drag, np.eye(2), atol=1e-3)


def oblique(around=48, turn=0.35):
    """Square cell with a long ellipse that lies across."""
    mesh = cylinder_in_square(0.1, around)
    at = mesh.points - 0.5
    c, s = np.cos(turn), np.sin(turn)
    along = at @ np.array([[c, -s], [s, c]])
    # fades out towards the sides
    fade = np.clip(1.0 - 2.0 * np.abs(at).max(axis=1), 0.0, None) / (1.0 - 2.0 * np.sqrt(0.1 / np.pi))
    stretched = along * (1.0 + np.minimum(fade, 1.0)[:, None] * np.array([0.45, -0.45]))
    points = 0.5 + stretched @ np.array([[c, s], [-s, c]])
    return Triangulation(points, mesh.triangles, mesh.boundary_edges, mesh.boundary_tags, mesh.side_names)


def test_permeability_tensor_of_an_oblique_array():
    away = []
    for around in (24, 48, 96):
        found = permeability_tensor(oblique(around))
        low, high = np.linalg.eigvalsh(0.5 * (found + found.T))
        assert 0.0 < low < 0.9 * high
        away.append(abs(found[0, 1] - found[1, 0]) / high)
        assert found[0, 1] > 0.02 * high
    assert away[2] < min(1e-3, 0.3 * away[1])
    # against a turn of the whole by a right angle
    turned = permeability_tensor(oblique(96, 0.35 + 0.5 * np.pi))
    np.testing.assert_allclose(turned, [[found[1, 1], -found[1, 0]], [-found[0, 1], found[0, 0]]], atol=2e-3 * high)


def test_permeability_tensor_of_a_turned_cell():
    mesh = oblique(24)
    c, s = np.cos(0.7), np.sin(0.7)
    turn = np.array([[c, -s], [s, c]])
    turned = Triangulation(
        mesh.points @ turn.T + 3.0, mesh.triangles, mesh.boundary_edges, mesh.boundary_tags, mesh.side_names
    )
    straight = permeability_tensor(mesh)
    np.testing.assert_allclose(permeability_tensor(turned), turn @ straight @ turn.T, atol=1e-9 * straight[0, 0])


def test_permeability_tensor_of_a_parallelogram_gives_the_mean_velocity():
    mesh = cylinder_in_square(0.1, 96)
    sheared = Triangulation(
        mesh.points @ [[1.0, 0.0], [0.5, 1.0]], mesh.triangles, mesh.boundary_edges, mesh.boundary_tags, mesh.side_names
    )
    found = permeability_tensor(sheared)
    flow = solve_stokes(sheared, {"left": Periodic("right", 1.0), "bottom": Periodic("top", -0.5)}, viscosity=2.0)
    mean = sheared.areas @ flow.velocity
    # drops over the sides (1, 0) and (0.5, 1)
    np.testing.assert_allclose(2.0 * mean, found @ [1.0, -1.0], rtol=2e-3)
    assert found[0, 1] == pytest.approx(found[1, 0], rel=1e-2)


def test_faults_of_the_tensor():
    with pytest.raises(InputError, match="not four different"):
        permeability_tensor(cylinder_in_square(0.1, 24), ("left", "right"), ("left", "top"))
    with pytest.raises(InputError, match="no side is called 'up'"):
        permeability_tensor(cylinder_in_square(0.1, 24), ("left", "right"), ("bottom", "up"))


def test_resistance_is_pressure_over_flow(disk):
    domain, flow = disk
    found = measure.resistance(flow)
    assert found == pytest.approx(2.0 / flow.flow_rate("right"), rel=1e-12)
    _, y0, x1, y1 = domain.bounds
    assert measure.permeability(domain, flow) == pytest.approx(3.0 * x1 / ((y1 - y0) * found), rel=1e-12)
    assert measure.resistance(flow, "right", "left") == pytest.approx(found)
    double = solved(domain, viscosity=6.0)
    assert measure.resistance(double) == pytest.approx(2.0 * found, rel=1e-6)


def test_resistance_of_a_blocked_domain_is_infinite():
    two = [generate_mesh(Domain.rectangle(2.0, 1.0), 0.4) for _ in range(2)]
    points = np.concatenate((two[0].points, two[1].points + np.array([3.0, 0.0])))
    count = len(two[0].points)
    left, right = (np.array(mesh.side_names)[-1 - mesh.boundary_tags] for mesh in two)
    left[left == "right"], right[right == "left"] = "stop", "stop"
    names = ("bottom", "left", "right", "stop", "top")
    tags = np.array([-1 - names.index(name) for name in (*left, *right)])
    edges = np.concatenate((two[0].boundary_edges, two[1].boundary_edges + count))
    mesh = Triangulation(points, np.concatenate((two[0].triangles, two[1].triangles + count)), edges, tags, names)
    flow = solve_stokes(mesh, {"left": Pressure(1.0), "right": Pressure(0.0)})
    domain = Domain.rectangle(5.0, 1.0)
    assert measure.resistance(flow) == np.inf
    assert measure.permeability(domain, flow) == 0.0
    with pytest.raises(InputError, match="nothing flows"):
        measure.corridors(domain, flow)


def test_the_direction_of_the_mean_flow():
    domain = Domain.rectangle(4.0, 2.0)
    assert measure.flow_direction(domain) == 0.0
    assert measure.flow_direction(domain, "right", "left") == 180.0
    assert measure.flow_direction(domain, "bottom", "top") == 90.0
    assert measure.flow_direction(domain, "left", "top") == pytest.approx(np.degrees(np.arctan2(1.0, 2.0)))
    split = Domain([(0, 0), (4, 0), (4, 2), (0, 2), (0, 0.5)], (), ("down", "out", "up", "in", "in"))
    assert measure.flow_direction(split, "in", "out") == pytest.approx(0.0)
    with pytest.raises(InputError, match="no side is called 'right'"):
        measure.flow_direction(split)
    with pytest.raises(InputError, match="same middle"):
        measure.flow_direction(domain, "left", "left")
