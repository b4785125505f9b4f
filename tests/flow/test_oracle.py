"""The whole method against another one: Taylor-Hood elements on the same mesh, and on finer ones of the same fluid."""

import numpy as np
import pytest
from tests.flow.meshes import rectangle
from tests.flow.taylor_hood import taylor_hood
from tests.flow.test_arrays import polygon, small_array

from vasculo.flow.boundary import Pressure, Slip, Velocity, Wall
from vasculo.flow.read.forces import drag
from vasculo.flow.stokes import solve_stokes
from vasculo.geometry.domain import Domain
from vasculo.mesh.generate import generate_mesh

DROP = {"left": Pressure(1.0), "right": Pressure(0.0)}
CELL = {**DROP, "top": Slip(), "bottom": Slip()}
JET = {"left": Velocity(lambda x, y: y * (2.0 - y) + 0.0 * x), "right": Pressure(0.0)}
CONDITIONS = {
    "walls": DROP,
    "mirrors": CELL,
    "inlet": JET,
    "upwards": {"bottom": Pressure(2.0), "top": Pressure(0.5), "left": Slip()},
    "lid": {"top": Velocity(lambda x, y: x * (4.0 - x) + 0.0 * y), "right": Wall()},
    "moving pillars": {**CELL, "pillars": Velocity(0.01, -0.02)},
}
PEBBLES = [
    [(0.55, 0.3), (1.2, 0.2), (1.45, 0.6), (1.05, 1.0), (0.6, 0.8)],
    [(1.75, 0.35), (2.3, 0.15), (2.5, 0.7), (1.9, 0.95)],
    [(0.8, 1.2), (1.3, 1.1), (1.7, 1.5), (1.3, 1.85), (0.7, 1.7)],
    [(2.0, 1.1), (2.6, 0.95), (2.45, 1.75), (1.9, 1.8), (1.8, 1.45)],
]


def shear_of_pillars(flow):
    """Mean size of the wall shear of each pillar, and over all of them."""
    owner = flow.wall_pillar
    mine = owner >= 0
    length = np.hypot(*np.diff(flow.mesh.points[flow.wall_edges[mine]], axis=1)[:, 0].T)
    sums = np.bincount(owner[mine], length * np.abs(flow.wall_shear[mine]))
    return sums / np.bincount(owner[mine], length), sums.sum() / length.sum()


def mean_shear(oracle):
    edges = oracle.mesh.edge_of("pillars")
    length = np.hypot(*np.diff(oracle.mesh.points[oracle.mesh.boundary_edges[edges]], axis=1)[:, 0].T)
    return np.average(oracle.wall_shear(edges, np.abs), weights=length)


@pytest.mark.parametrize("degree", [2, 3])
def test_the_oracle_knows_poiseuille_flow(degree):
    mesh = rectangle(2.0, 1.0, 6)
    oracle = taylor_hood(mesh, {"left": Pressure(1.0), "right": Pressure(-1.0)}, viscosity=0.5, degree=degree)
    assert oracle.flow_rate("right") == pytest.approx(1.0 / 6.0, rel=1e-12)
    at = np.array([[0.3, 0.2], [1.7, 0.5]])
    np.testing.assert_allclose(oracle.velocity_at(at), [[0.16, 0.0], [0.25, 0.0]], atol=1e-12)
    np.testing.assert_allclose(oracle.pressure_at(at), [0.7, -0.7], atol=1e-11)
    np.testing.assert_allclose(oracle.wall_shear(mesh.edge_of("top")), 0.5, atol=1e-11)
    velocity, pressure = oracle.at_centroids()
    y = mesh.centroids[:, 1]
    np.testing.assert_allclose(pressure, 1.0 - mesh.centroids[:, 0], atol=1e-11)
    np.testing.assert_allclose(velocity[:, 0], y * (1.0 - y), atol=1e-12)


def test_the_drag_of_the_oracle_balances_the_pressure_drop():
    oracle = taylor_hood(generate_mesh(small_array(2.0), 0.3, 0.15), CELL)
    assert oracle.drag().sum(axis=0)[0] == pytest.approx(2.0, rel=1e-11)
    assert oracle.flow_rate("left") == pytest.approx(-oracle.flow_rate("right"), rel=1e-11)


@pytest.mark.parametrize("name", CONDITIONS)
def test_both_on_the_same_mesh(name):
    conditions = CONDITIONS[name]
    mesh = generate_mesh(small_array(2.0), 0.12, 0.04)
    flow, oracle = solve_stokes(mesh, conditions, 3.0), taylor_hood(mesh, conditions, 3.0)
    velocity, pressure = oracle.at_centroids()
    weight = mesh.areas[:, None]
    off = np.sqrt(np.sum(weight * (flow.velocity - velocity) ** 2) / np.sum(weight * velocity**2))
    assert off < 0.006
    spread = pressure - np.average(pressure, weights=mesh.areas)
    assert np.sqrt(np.average((flow.pressure - pressure) ** 2, weights=mesh.areas) / np.mean(spread**2)) < 0.01
    for side in mesh.side_names:
        assert flow.flow_rate(side) == pytest.approx(oracle.flow_rate(side), abs=0.005 * np.abs(flow.face_flux).sum())
    walls = np.flatnonzero(np.isin(mesh.boundary_tags, np.arange(6)))
    if name != "moving pillars":
        theirs = oracle.wall_shear(walls)
        ours = flow.wall_shear[flow.wall_pillar >= 0]
        np.testing.assert_array_equal(flow.wall_edges[flow.wall_pillar >= 0], mesh.boundary_edges[walls])
        assert np.sqrt(np.mean((ours - theirs) ** 2) / np.mean(theirs**2)) < 0.02
    forces = oracle.drag()
    assert np.abs(drag(flow) - forces).max() < 0.004 * np.abs(forces).max()


def test_the_flow_of_an_array_converges_to_that_of_cubic_elements():
    domain = small_array(2.0)
    oracle = taylor_hood(generate_mesh(domain, 0.14, 0.022, grading=0.4), CELL, degree=3)
    coarser = taylor_hood(generate_mesh(domain, 0.16, 0.045), CELL, degree=3)
    best, mean = oracle.flow_rate("right"), mean_shear(oracle)
    assert coarser.flow_rate("right") == pytest.approx(best, rel=5e-4)
    assert mean_shear(coarser) == pytest.approx(mean, rel=5e-3)
    away = []
    for size in (0.16, 0.08, 0.04):
        flow = solve_stokes(generate_mesh(domain, size, 0.5 * size), CELL)
        away.append([flow.flow_rate("right") / best - 1.0, shear_of_pillars(flow)[1] / mean - 1.0])
    away = np.abs(away)
    assert (away < [[0.03, 0.01], [0.005, 0.005], [0.002, 0.005]]).all(), away


def test_round_pillars_with_two_edges_a_side():
    rng = np.random.default_rng(4)
    pillars = [
        polygon(1.0 + i + 0.08 * rng.uniform(-1, 1), 0.5 + j, rng.uniform(0.28, 0.38), 30, rng.uniform(0, 6))
        for i in range(3)
        for j in range(2)
    ]
    domain = Domain.rectangle(4.0, 2.0, pillars)
    oracle = taylor_hood(generate_mesh(domain, 0.15, 0.028), CELL, degree=3)
    flow = solve_stokes(generate_mesh(domain, 0.15, 0.04, grading=0.35), CELL)
    each, mean = shear_of_pillars(flow)
    assert flow.flow_rate("right") == pytest.approx(oracle.flow_rate("right"), rel=5e-3)
    assert mean == pytest.approx(mean_shear(oracle), rel=5e-3)
    np.testing.assert_allclose(each, oracle.pillar_shear(), rtol=0.01)


def test_sharp_pillars_with_a_mesh_graded_into_their_corners():
    domain = Domain.rectangle(3.2, 2.0, PEBBLES)
    oracle = taylor_hood(generate_mesh(domain, 0.2, curvature=10_000, grading=0.5, across=4), CELL, degree=3)
    flow = solve_stokes(generate_mesh(domain, 0.1, curvature=1000, grading=0.5), CELL)
    assert flow.flow_rate("right") == pytest.approx(oracle.flow_rate("right"), rel=0.01)
    each, mean = shear_of_pillars(flow)
    assert mean == pytest.approx(mean_shear(oracle), rel=0.03)
    np.testing.assert_allclose(each, oracle.pillar_shear(), rtol=0.03)
    rough = solve_stokes(generate_mesh(domain, 0.1), CELL)
    assert rough.flow_rate("right") / oracle.flow_rate("right") - 1.0 > 0.02
