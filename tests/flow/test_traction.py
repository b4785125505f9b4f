"""Tractions of flows whose stress is known everywhere."""

import numpy as np
import pytest
from tests.flow.meshes import annulus, cylinder_in_square

from vasculo.flow.assemble import assemble
from vasculo.flow.boundary import Periodic, Pressure, Slip, Velocity
from vasculo.flow.faces import build_faces
from vasculo.flow.read.traction import edge_forces, edge_tractions
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


def forces_of(flow, conditions, force=(0.0, 0.0)):
    """Forces through the boundary edges from the fluxes of the system, for a flow with a prescribed pressure."""
    mesh, faces = flow.mesh, build_faces(flow.mesh, conditions)
    system = assemble(mesh, faces, flow.viscosity, np.broadcast_to(force, (len(mesh.triangles), 2)) + faces.gradient)
    even = (flow.pressure - faces.level + mesh.centroids @ faces.gradient) * system.scale / flow.viscosity
    fluxes = system.fluxes(np.column_stack([flow.velocity, even]).ravel())
    momentum = flow.viscosity * fluxes[:, :2]
    return faces, edge_forces(mesh, faces, momentum, np.full(len(mesh.triangles), -faces.level))


@pytest.mark.parametrize("inlet", [Pressure(3.0), Velocity(1.0)])
def test_tractions_are_the_flux_of_momentum(inlet):
    mesh = cylinder_in_square(0.2, 32)
    conditions = {
        "left": inlet,
        "right": Pressure(1.0),
        "top": Slip(),
        "pillars": Velocity(lambda x, y: (y - 0.5, 0.5 - x)),
    }
    flow = solve_stokes(mesh, conditions, 2.0, force=(0.5, -0.2))
    faces, force = forces_of(flow, conditions, (0.5, -0.2))
    np.testing.assert_allclose(force.sum(axis=0), mesh.areas.sum() * np.array([0.5, -0.2]), atol=1e-11)
    walls = np.flatnonzero(faces.is_wall)
    found = edge_tractions(faces, force, walls, 2.0)
    np.testing.assert_allclose(found.shear, flow.wall_shear, atol=1e-11)
    np.testing.assert_allclose(found.viscous, flow.wall_traction, atol=1e-11)
    np.testing.assert_allclose(found.pressure, flow.wall_pressure, atol=1e-11)
    # The whole traction around a closed wall is the flux of momentum, moving or not.
    mine = walls[flow.wall_pillar == 0]
    whole = found.viscous + found.pressure[:, None] * faces.normal[faces.edge_face[walls]]
    total = faces.length[faces.edge_face[mine]] @ whole[flow.wall_pillar == 0]
    np.testing.assert_allclose(total, force[mine].sum(axis=0), atol=1e-12)


def test_seams_carry_the_pressure_drop():
    mesh = cylinder_in_square(0.2, 32)
    conditions = {"left": Periodic("right", 2.0), "bottom": Slip(), "top": Slip()}
    flow = solve_stokes(mesh, conditions)
    _, force = forces_of(flow, conditions)
    seams = force[mesh.edge_of("left")].sum(axis=0) + force[mesh.edge_of("right")].sum(axis=0)
    np.testing.assert_allclose(seams, [-2.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(force.sum(axis=0), 0.0, atol=1e-11)
