"""Conditions that cannot be used are refused in one line that says what would be right."""

import numpy as np
import pytest
from tests.flow.meshes import annulus, rectangle

from vasculo.errors import InputError
from vasculo.flow.boundary import Periodic, Pressure, Slip, Velocity, Wall
from vasculo.flow.periodic import gradient_of_drops
from vasculo.flow.stokes import solve_stokes
from vasculo.mesh.triangulation import Triangulation

MESH = rectangle(1.5, 1.0, across=5)


@pytest.mark.parametrize(
    ("conditions", "words"),
    [
        ({"lefft": Pressure(1.0)}, "did you mean 'left'"),
        ({"pilars": Wall()}, "did you mean 'pillars'"),
        ({"left": 1.0}, r"Pressure\(value\)"),
        ({"left": Pressure}, "condition on 'left'"),
        ({"left": Pressure(float("nan"))}, "finite"),
        ({"left": Pressure("1")}, "give numbers"),
        ({"left": Velocity(float("inf"))}, "not finite"),
        ({"left": Velocity(lambda x, _y: x[:2])}, "shape"),
        ({"left": Velocity("fast")}, "numbers or arrays"),
        ({"left": Periodic("up")}, "two different sides"),
        ({"left": Periodic("left")}, "two different sides"),
        ({"pillars": Periodic("left")}, "two different sides"),
        ({"left": Periodic("right"), "right": Wall()}, "leave it out"),
        ({"left": Periodic("right"), "top": Periodic("right")}, "leave it out"),
        ({"left": Periodic("right", float("nan"))}, "finite"),
        ({"left": Periodic("top")}, "vertices"),
        ({"left": Velocity(1.0)}, "give one side a Pressure"),
        ({"left": Velocity(1.0), "right": Velocity(0.5)}, "bring in"),
    ],
)
def test_bad_conditions(conditions, words):
    with pytest.raises(InputError, match=words) as caught:
        solve_stokes(MESH, conditions)
    assert "\n" not in str(caught.value)


def test_conditions_must_be_a_mapping():
    with pytest.raises(InputError, match="give a mapping of names"):
        solve_stokes(MESH, [("left", Wall())])


@pytest.mark.parametrize("viscosity", [0.0, -1.0, float("nan"), float("inf"), "thick", None])
def test_bad_viscosity(viscosity):
    with pytest.raises(InputError, match="viscosity"):
        solve_stokes(MESH, {}, viscosity)


@pytest.mark.parametrize("force", [1.0, [1.0, 2.0, 3.0], [[1.0, 2.0]] * 3])
def test_bad_force(force):
    with pytest.raises(InputError, match="force has shape"):
        solve_stokes(MESH, {}, force=force)


def test_force_that_is_not_finite():
    with pytest.raises(InputError, match="1 components of the force"):
        solve_stokes(MESH, {}, force=(np.nan, 0.0))


def test_unknown_side_of_a_flow():
    flow = solve_stokes(MESH, {"left": Pressure(1.0), "right": Pressure(0.0)})
    with pytest.raises(InputError, match="upper"):
        flow.flow_rate("upper")


def test_periodic_sides_must_match_vertex_by_vertex():
    points = MESH.points.copy()
    moved = np.flatnonzero((points[:, 0] == 0.0) & (points[:, 1] > 0.3) & (points[:, 1] < 0.5))[0]
    points[moved, 1] += 0.01
    bent = Triangulation(points, MESH.triangles, MESH.boundary_edges, MESH.boundary_tags, MESH.side_names)
    with pytest.raises(InputError, match="no partner"):
        solve_stokes(bent, {"left": Periodic("right", 1.0)})


def test_periodic_sides_must_not_be_too_close():
    with pytest.raises(InputError, match="edge lengths apart"):
        solve_stokes(rectangle(1.0, 0.4, across=1, jitter=0.0), {"bottom": Periodic("top")})


def test_contradicting_pressure_drops():
    pairs = [("a", "b", 1.0), ("c", "d", 2.0)]
    with pytest.raises(InputError, match="contradict"):
        gradient_of_drops(pairs, np.array([[1.0, 0.0], [1.0, 0.0]]))
    np.testing.assert_allclose(gradient_of_drops(pairs, np.array([[1.0, 0.0], [1.0, 1.0]])), [1.0, 1.0])


def test_the_ways_to_give_a_velocity():
    at = np.array([[0.0, 1.0], [2.0, 3.0]])
    for velocity in (
        Velocity(1.0, 2.0),
        Velocity(lambda x, _y: 0 * x + 1.0, 2.0),
        Velocity(1.0, lambda x, _y: 0 * x + 2.0),
        Velocity(lambda _x, y: (1.0, 2.0 + 0 * y)),
        Velocity(lambda x, _y: 1.0 + 0 * x, lambda _x, y: 2.0 + 0 * y),
    ):
        np.testing.assert_array_equal(velocity.at(at, "left"), [[1.0, 2.0], [1.0, 2.0]])
    np.testing.assert_array_equal(Velocity(lambda x, y: x + y).at(at, "left"), [[1.0, 0.0], [5.0, 0.0]])
    np.testing.assert_array_equal(Velocity(3.0).at(at, "left"), [[3.0, 0.0], [3.0, 0.0]])


def test_what_is_not_named_is_a_wall():
    flow = solve_stokes(MESH, {"left": Pressure(1.0), "right": Pressure(0.0), "top": Slip()})
    bottom = MESH.edge_of("bottom")
    np.testing.assert_array_equal(flow.wall_edges, MESH.boundary_edges[bottom])
    ring = annulus()
    assert len(solve_stokes(ring, {}).wall_edges) == len(ring.boundary_edges)
    turning = solve_stokes(ring, {"rim": Velocity(lambda x, y: (-y, x))})
    assert (turning.wall_pillar == 0).all()


def test_nothing_drives_nothing_moves():
    flow = solve_stokes(MESH, {"left": Pressure(0.0)})
    assert not flow.velocity.any()
    assert not flow.pressure.any()
    assert (flow.residual, flow.mass_imbalance, flow.report["solver"]) == (0.0, 0.0, "none")
    level = solve_stokes(MESH, {"left": Pressure(2.0)})
    assert not level.velocity.any()
    assert (level.pressure == 2.0).all()
    heavy = solve_stokes(MESH, {"top": Pressure(2.0)}, force=(0.0, -3.0))
    np.testing.assert_allclose(heavy.velocity, 0.0, atol=1e-13)
    np.testing.assert_allclose(heavy.pressure, 2.0 + 3.0 * (1.0 - MESH.centroids[:, 1]), rtol=1e-10)
    assert heavy.mass_imbalance == 0.0


def test_small_imbalance_of_a_closed_box_is_shared_out():
    conditions = {
        "left": Velocity(lambda _x, y: 1.015 * 6 * y * (1 - y)),
        "right": Velocity(lambda _x, y: 6 * y * (1 - y)),
    }
    flow = solve_stokes(MESH, conditions)
    assert flow.flow_rate("right") == pytest.approx(-flow.flow_rate("left"), rel=1e-12)
    assert flow.flow_rate("right") == pytest.approx(1.0075, rel=1e-3)


def test_a_pocket_rests_and_is_counted():
    # Cut the channel in two: the right half has no opening left.
    mesh = rectangle(3.0, 1.0, across=8)
    keep = np.abs(mesh.centroids[:, 0] - 1.5) > 0.15
    triangles = mesh.triangles[keep]
    directed = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2).astype(np.int64)
    size = len(mesh.points)
    edges = directed[~np.isin(directed[:, 1] * size + directed[:, 0], directed[:, 0] * size + directed[:, 1])]
    known = {tuple(e): t for e, t in zip(mesh.boundary_edges.tolist(), mesh.boundary_tags.tolist(), strict=True)}
    tags = [known.get(tuple(e), 0) for e in edges.tolist()]
    split = Triangulation(mesh.points, triangles, edges, tags, mesh.side_names)
    with pytest.raises(InputError, match="1 of 2 parts of the fluid"):
        solve_stokes(split, {"left": Pressure(1.0)})
    flow = solve_stokes(split, {"left": Pressure(1.0)}, pockets="rest")
    right = split.centroids[:, 0] > 1.5
    assert flow.report["parts"] == 2
    assert flow.report["closed_parts"] == 1
    assert flow.report["pocket_triangles"] == np.count_nonzero(right)
    np.testing.assert_allclose(flow.pressure[~right], 1.0, rtol=1e-9)
    np.testing.assert_allclose(flow.pressure[right], 0.0, atol=1e-12)
    assert np.abs(flow.velocity[right]).max() < 1e-15
    assert np.isfinite(flow.node_velocity()).all()


def test_a_velocity_of_another_shape_is_refused():
    points = np.zeros((25, 3, 2))
    with pytest.raises(InputError, match=r"has shape \(3,\), its coordinates have \(25, 3\)"):
        Velocity(lambda *_: np.zeros(3), 0.0).at(points, "left")
