"""Node values: exact for linear fields, second order, and true to what holds on the sides."""

import numpy as np
import pytest
from tests.flow.meshes import annulus, cylinder_in_square, rectangle

from vasculo.flow.boundary import Periodic, Pressure, Slip, Velocity
from vasculo.flow.faces import MOVING, build_faces
from vasculo.flow.read.gradients import cell_gradients
from vasculo.flow.read.nodal import STEPS, _project, prescribe, project_pressure, project_to_nodes
from vasculo.flow.read.nodal_plain import project_plain
from vasculo.flow.stokes import solve_stokes
from vasculo.springs.threads import get_threads, set_threads


@pytest.mark.parametrize("make", [lambda: rectangle(1.3, 1.0, 7, seed=2), annulus])
def test_linear_fields_are_exact(make):
    def field(x, y):
        return 1.0 + 2.0 * x - 3.0 * y, 0.5 - x + 0.7 * y

    mesh = make()
    named = {name: Velocity(field) for name in (*mesh.side_names, "pillars")}
    at_cells = np.column_stack(field(*mesh.centroids.T))
    found = project_to_nodes(mesh, build_faces(mesh, named), at_cells)
    np.testing.assert_allclose(found, np.column_stack(field(*mesh.points.T)), atol=1e-13)


def test_linear_fields_are_exact_without_any_prescribed_value():
    mesh = rectangle(1.3, 1.0, 7, seed=2)
    faces = build_faces(mesh, dict.fromkeys(mesh.side_names, Pressure(0.0)))
    found = project_to_nodes(mesh, faces, mesh.centroids @ [[2.0, -1.0], [-3.0, 0.7]] + 5.0)
    np.testing.assert_allclose(found, mesh.points @ [[2.0, -1.0], [-3.0, 0.7]] + 5.0, atol=1e-12)


def test_shear_between_a_wall_and_a_mirror_line_is_exact_across_a_seam():
    mesh = rectangle(2.0, 1.0, 8)
    faces = build_faces(mesh, {"left": Periodic("right"), "top": Slip()})
    found = project_to_nodes(mesh, faces, np.column_stack([3.0 * mesh.centroids[:, 1], np.zeros(len(mesh.areas))]))
    np.testing.assert_allclose(found[:, 0], 3.0 * mesh.points[:, 1], atol=1e-13)
    np.testing.assert_array_equal(found[:, 1], 0.0)


@pytest.mark.parametrize("sides", [{"left": Periodic("right", 2.0)}, {"left": Pressure(7.0), "right": Pressure(5.0)}])
def test_linear_pressures_are_exact(sides):
    mesh = rectangle(2.0, 1.0, 8, seed=5)
    exact = 7.0 - mesh.points[:, 0]
    found = project_pressure(mesh, build_faces(mesh, sides), 7.0 - mesh.centroids[:, 0])
    np.testing.assert_allclose(found, exact, atol=1e-13)


def test_openings_need_no_values():
    mesh = rectangle(1.0, 1.0, 8, seed=4)
    openings = {name: Pressure(0.0) for name in ("left", "right", "top")}
    at_cells = np.column_stack([mesh.centroids[:, 1], 0.0 * mesh.areas])
    found = project_to_nodes(mesh, build_faces(mesh, openings), at_cells)
    np.testing.assert_allclose(found[:, 0], mesh.points[:, 1], atol=1e-12)


def test_walls_mirror_lines_and_glued_nodes():
    mesh = rectangle(2.0, 1.0, 8)
    flow = solve_stokes(mesh, {"left": Periodic("right", 1.0), "top": Slip()})
    nodes = flow.node_velocity()
    x, y = mesh.points.T
    assert not nodes[y == 0.0].any()
    assert not nodes[y == 1.0, 1].any()
    left, right = (np.flatnonzero(x == side) for side in (0.0, 2.0))
    pair = right[np.argsort(y[right])]
    np.testing.assert_array_equal(nodes[left[np.argsort(y[left])]], nodes[pair])
    np.testing.assert_allclose(nodes[:, 0], 0.25 * y * (2.0 - y), atol=5e-3)


def test_turned_mirror_lines_let_nothing_through():
    turn = 0.4
    mesh = rectangle(2.0, 1.0, 6, turn=turn)
    flow = solve_stokes(mesh, {"left": Pressure(1.0), "right": Pressure(0.0), "top": Slip()})
    along, across = np.array([np.cos(turn), np.sin(turn)]), np.array([-np.sin(turn), np.cos(turn)])
    top = np.abs(mesh.points @ across - 1.0) < 1e-9
    nodes = flow.node_velocity()[top]
    np.testing.assert_allclose(nodes @ across, 0.0, atol=1e-15)
    assert (nodes @ along > 0.2).all()


def test_prescribed_nodes_take_the_mean_of_their_edges():
    mesh = rectangle(1.0, 1.0, 6)
    flow = solve_stokes(mesh, {"top": Velocity(1.0)})
    nodes = flow.node_velocity()
    x, y = mesh.points.T
    np.testing.assert_array_equal(nodes[(y == 1.0) & (x > 0) & (x < 1), 0], 1.0)
    np.testing.assert_array_equal(nodes[(y == 1.0) & ((x == 0) | (x == 1)), 0], 0.5)


CASES = {
    "walls": lambda: (rectangle(1.0, 1.0, 9, seed=3), {"top": Velocity(1.0), "left": Pressure(0.0)}),
    "periodic": lambda: (cylinder_in_square(0.2, 32), {"left": Periodic("right"), "bottom": Periodic("top")}),
    "open": lambda: (rectangle(1.0, 1.0, 9, seed=4), dict.fromkeys(("left", "right", "top", "bottom"), Pressure(0.0))),
}


@pytest.mark.parametrize("case", CASES)
def test_the_projection_is_that_of_its_twin(case):
    # The start is off by the second order; each Chebyshev step gains a factor of three (in the norm of the matrix).
    mesh, conditions = CASES[case]()
    faces = build_faces(mesh, conditions)
    values = np.random.default_rng(0).normal(size=(len(mesh.triangles), 2))
    known = faces.kind[faces.inner :] == MOVING
    gradient = cell_gradients(mesh, faces, values, known, faces.profile[:, 1])
    plain = project_plain(mesh, faces, values, gradient, known, faces.profile)
    own = np.unique(faces.same)
    fixed, given = np.zeros(len(mesh.points), dtype=bool), np.zeros((len(mesh.points), 2))
    prescribe(faces.ends[faces.inner :], faces.same, known, faces.profile, fixed, given)
    found = _project(mesh, faces, values, gradient, fixed, given)
    assert np.abs(found - plain)[own].max() < 30.0 * 3.0**-STEPS * np.abs(plain).max()


def test_threads_change_no_bit():
    mesh = rectangle(2.0, 1.0, 130)
    assert len(mesh.points) > 2 * 16_384
    faces = build_faces(mesh, {})
    values = np.random.default_rng(0).normal(size=(len(mesh.triangles), 2))
    before = get_threads()
    try:
        set_threads(1)
        one = project_to_nodes(mesh, faces, values)
        set_threads(2)
        np.testing.assert_array_equal(project_to_nodes(mesh, faces, values), one)
    finally:
        set_threads(before)
