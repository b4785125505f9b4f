"""Slopes of convergence against manufactured and exact solutions, on irregular triangles."""

import numpy as np
import pytest
from tests.flow.exact import ANNULUS, AT_REST, MOVING, errors
from tests.flow.meshes import annulus, rectangle

from vasculo.flow.boundary import Velocity
from vasculo.flow.stokes import solve_stokes


def slopes(rows):
    rows = np.array(rows)
    return np.log2(rows[:-1] / rows[1:])


@pytest.mark.parametrize("seed", [1, 3])
def test_second_order_with_velocity_all_around(seed):
    rows = []
    for across in (10, 20, 40):
        mesh = rectangle(1.0, 1.0, across, seed)
        velocity = Velocity(MOVING.u, MOVING.v)
        flow = solve_stokes(mesh, dict.fromkeys(mesh.side_names, velocity), force=MOVING.force(mesh))
        rows.append(errors(mesh, flow, MOVING)[:3])
    found = slopes(rows)
    assert (found[:, 0] > 2.1).all(), found  # velocity at centroids
    assert (found[:, 1] > 1.7).all(), found  # pressure
    assert (found[:, 2] > 1.75).all(), found  # velocity at nodes
    assert found[:, 0].mean() > 2.3
    assert found[:, 1].mean() > 1.85


@pytest.mark.parametrize("seed", [1, 3])
def test_second_order_with_walls_at_rest(seed):
    rows = []
    for across in (12, 24, 48):
        mesh = rectangle(1.0, 1.0, across, seed)
        flow = solve_stokes(mesh, {}, force=AT_REST.force(mesh))
        rows.append(errors(mesh, flow, AT_REST))
    found = slopes(rows)
    assert (found[:, 0] > 1.9).all(), found
    assert (found[:, 1] > 1.7).all(), found
    assert (found[:, 2] > 1.75).all(), found
    assert found[:, 3].mean() > 1.8, found  # wall shear


def test_exact_velocity_data_on_a_ring():
    rows = []
    for level in (1, 2, 4):
        mesh = annulus(across=5 * level, around=40 * level)
        flow = solve_stokes(mesh, {"pillars": Velocity(ANNULUS.u, ANNULUS.v), "rim": Velocity(ANNULUS.u, ANNULUS.v)})
        assert len(flow.wall_edges) == 40 * level
        lengths = np.hypot(*np.diff(mesh.points[flow.wall_edges], axis=1)[:, 0].T)
        middle = mesh.points[flow.wall_edges].mean(axis=1)
        arms = middle[:, 0] * flow.wall_traction[:, 1] - middle[:, 1] * flow.wall_traction[:, 0]
        torque = abs(float(np.sum(arms * lengths)) / ANNULUS.torque + 1.0)
        exact = np.column_stack([ANNULUS.u(*mesh.centroids.T), ANNULUS.v(*mesh.centroids.T)])
        away = np.sqrt(np.mean((flow.velocity - exact) ** 2))
        rows.append([away, torque, np.sqrt(np.mean(flow.pressure**2))])
    found = slopes(rows)
    assert found[:, 0].min() > 1.9, (rows, found)
    assert found[:, 1].mean() > 1.8, (rows, found)
    assert found[:, 2].min() > 1.6, (rows, found)
    assert rows[-1][1] < 1e-3


def test_torque_of_a_turning_polygon():
    # Rigid motion of the inner polygon, outer one at rest: the rest of the error is the polygons'.
    rows = []
    for level in (1, 2, 4):
        mesh = annulus(across=5 * level, around=40 * level)
        flow = solve_stokes(mesh, {"pillars": Velocity(lambda _x, y: -2.0 * y, lambda x, _y: 2.0 * x)})
        lengths = np.hypot(*np.diff(mesh.points[flow.wall_edges], axis=1)[:, 0].T)
        middle = mesh.points[flow.wall_edges].mean(axis=1)
        normal = np.diff(mesh.points[flow.wall_edges], axis=1)[:, 0][:, ::-1] * [1.0, -1.0] / lengths[:, None]
        force = flow.wall_traction + flow.wall_pressure[:, None] * normal
        arms = (middle[:, 0] * force[:, 1] - middle[:, 1] * force[:, 0]) * lengths
        inner, outer = (float(np.sum(arms[chosen])) for chosen in (flow.wall_pillar == 0, flow.wall_pillar == -1))
        rows.append([abs(inner / ANNULUS.torque + 1.0), abs(outer / ANNULUS.torque - 1.0)])
    found = slopes(rows)
    assert found.mean() > 1.7, (rows, found)
    assert max(rows[-1]) < 5e-3, rows
