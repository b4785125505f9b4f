"""Gradients of cell values against their twin and linear fields."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.flow.meshes import annulus, cylinder_in_square, rectangle

from vasculo.flow.boundary import Periodic, Pressure, Velocity
from vasculo.flow.faces import MOVING, build_faces
from vasculo.flow.read.gradients import cell_gradients, fit_gradients, fit_gradients_plain
from vasculo.mesh.triangulation import Triangulation


def arguments(mesh, faces, values):
    known = faces.kind[faces.inner :] == MOVING
    given = np.ascontiguousarray(faces.profile[:, 1])
    return (
        mesh.points, mesh.triangles, mesh.centroids, faces.same, faces.ends, faces.cells, faces.inner, values, known,
        given,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("mesh", "conditions"),
    [
        (rectangle(1.2, 1.0, 6, seed=1), {"top": Velocity(1.0, 2.0), "left": Pressure(0.0)}),
        (cylinder_in_square(0.2, 24), {"left": Periodic("right"), "bottom": Periodic("top"), "pillars": Pressure(1.0)}),
        (annulus(3, 20), {}),
    ],
)
def test_kernel_and_twin(mesh, conditions):
    faces = build_faces(mesh, conditions)
    values = np.random.default_rng(1).normal(size=(len(mesh.triangles), 2))
    given = arguments(mesh, faces, values)
    np.testing.assert_allclose(fit_gradients(*given), fit_gradients_plain(*given), atol=1e-10)


@settings(deadline=None, max_examples=20)
@given(st.integers(0, 1000), st.integers(3, 8))
def test_linear_fields_have_their_gradient(seed, across):
    mesh = rectangle(1.0, 1.0, across, seed=seed)
    faces = build_faces(mesh, dict.fromkeys(mesh.side_names, Pressure(0.0)))
    table = np.random.default_rng(seed).normal(size=(3, 2))
    none = np.zeros(len(faces.profile), dtype=bool)
    found = cell_gradients(mesh, faces, mesh.centroids @ table.T, none, np.zeros((len(none), 3)))
    np.testing.assert_allclose(found, np.broadcast_to(table, found.shape), atol=1e-9)


def test_a_cell_with_one_neighbour_has_no_gradient_across_its_view():
    points = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    triangles = np.array([[0, 1, 2], [0, 2, 3]])
    edges = np.array([[0, 1], [1, 2], [2, 3], [3, 0]])
    mesh = Triangulation(points, triangles, edges, np.full(4, -1), ("rim",))
    faces = build_faces(mesh, {"rim": Pressure(0.0)})
    step = mesh.centroids[1] - mesh.centroids[0]
    found = cell_gradients(mesh, faces, np.array([[0.0], [2.0]]), np.zeros(4, dtype=bool), np.zeros((4, 1)))
    np.testing.assert_allclose(found[:, 0], np.tile(2.0 * step / (step @ step), (2, 1)), atol=1e-14)
