"""Tractions of flows whose stress is known everywhere."""

import numpy as np
import pytest
from tests.flow.meshes import annulus

from vasculo.flow.boundary import Velocity
from vasculo.flow.stokes import solve_stokes


@pytest.mark.parametrize("gradient", [[[1.0, 0.0], [0.0, -1.0]], [[0.0, 2.0], [0.0, 0.0]], [[0.3, -1.0], [0.5, -0.3]]])
def test_uniform_stress_on_moving_walls(gradient):
    # v = gradient . x: the traction on the solid is -viscosity (gradient + its transpose) n, without pressure.
    gradient = np.array(gradient)

    def velocity(x, y):
        return gradient[0, 0] * x + gradient[0, 1] * y, gradient[1, 0] * x + gradient[1, 1] * y

    mesh = annulus(across=4, around=24, seed=2)
    flow = solve_stokes(mesh, {"pillars": Velocity(velocity), "rim": Velocity(velocity)}, viscosity=2.0)
    np.testing.assert_allclose(flow.velocity, mesh.centroids @ gradient.T, atol=1e-11)
    np.testing.assert_allclose(flow.pressure, 0.0, atol=1e-10)
    along = np.diff(mesh.points[flow.wall_edges], axis=1)[:, 0]
    tangent = along / np.hypot(*along.T)[:, None]
    normal = np.column_stack([tangent[:, 1], -tangent[:, 0]])
    assert (np.einsum("wi,wi->w", normal, mesh.points[flow.wall_edges].mean(axis=1)) < 0).all()
    np.testing.assert_allclose(flow.wall_traction, -2.0 * normal @ (gradient + gradient.T), atol=1e-9)
    np.testing.assert_allclose(flow.wall_shear, 2.0 * np.einsum("wi,ij,wj->w", tangent, gradient, normal), atol=1e-9)
    np.testing.assert_allclose(flow.wall_pressure, 0.0, atol=1e-9)
