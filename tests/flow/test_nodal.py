"""Node velocities: exact for linear fields, second order, and true to the walls."""

import numpy as np
import pytest
from scipy import sparse
from tests.flow.meshes import annulus, rectangle

from vasculo.flow.boundary import Periodic, Pressure, Slip, Velocity
from vasculo.flow.faces import build_faces
from vasculo.flow.read.nodal import _chebyshev, project_to_nodes
from vasculo.flow.stokes import solve_stokes


@pytest.mark.parametrize("make", [lambda: rectangle(1.3, 1.0, 7, seed=2), annulus])
def test_linear_fields_are_exact(make):
    def field(x, y):
        return 1.0 + 2.0 * x - 3.0 * y, 0.5 - x + 0.7 * y

    mesh = make()
    named = {name: Velocity(field) for name in (*mesh.side_names, "pillars")}
    at_cells = np.column_stack(field(*mesh.centroids.T))
    found = project_to_nodes(mesh, build_faces(mesh, named), at_cells)
    np.testing.assert_allclose(found, np.column_stack(field(*mesh.points.T)), atol=1e-12)


def test_openings_need_no_values():
    mesh = rectangle(1.0, 1.0, 8, seed=4)
    openings = {name: Pressure(0.0) for name in ("left", "right", "top")}
    at_cells = np.column_stack([mesh.centroids[:, 1], 0.0 * mesh.areas])
    found = project_to_nodes(mesh, build_faces(mesh, openings), at_cells)
    np.testing.assert_allclose(found[:, 0], mesh.points[:, 1], atol=0.02)
    assert np.sqrt(np.mean((found[:, 0] - mesh.points[:, 1]) ** 2)) < 4e-3


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


def test_prescribed_nodes_take_the_mean_of_their_edges():
    mesh = rectangle(1.0, 1.0, 6)
    flow = solve_stokes(mesh, {"top": Velocity(1.0)})
    nodes = flow.node_velocity()
    x, y = mesh.points.T
    np.testing.assert_array_equal(nodes[(y == 1.0) & (x > 0) & (x < 1), 0], 1.0)
    np.testing.assert_array_equal(nodes[(y == 1.0) & ((x == 0) | (x == 1)), 0], 0.5)


def test_chebyshev_reaches_round_off():
    # Eigenvalues over the diagonal anywhere in [1/2, 2].
    rng = np.random.default_rng(0)
    spectrum = np.concatenate([[0.5, 2.0], rng.uniform(0.5, 2.0, 38)])
    basis = np.linalg.qr(rng.normal(size=(40, 40)))[0]
    matrix = basis @ np.diag(spectrum) @ basis.T
    right = rng.normal(size=(40, 2))
    found = _chebyshev(sparse.csr_array(matrix), np.ones(40), right)
    np.testing.assert_allclose(found, np.linalg.solve(matrix, right), atol=1e-13 * np.abs(right).max() * 10)
