"""What the flow costs: dissipation in the fluid, and the power that drives it."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from vasculo.flow.faces import INNER, MOVING, OPEN
from vasculo.flow.read.gradients import cell_gradients
from vasculo.flow.read.traction import edge_tractions

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.flow.solution import Flow


class Power(NamedTuple):
    """Power that drives a flow, per unit depth (force per time).

    Parameters
    ----------
    pressure : float
        Of the pressures at openings and of the pressure drops of periodic sides.
    moving : float
        Of prescribed velocities: moving walls, and inlets by their whole traction.
    force : float
        Of the body force.
    """

    pressure: float
    moving: float
    force: float

    @property
    def total(self) -> float:
        """Sum of the three: what is dissipated."""
        return self.pressure + self.moving + self.force


def dissipation(flow: Flow) -> NDArray[np.float64]:
    """Viscous dissipation in each triangle: the mean of 2 viscosity e : e, with a strain rate e that is linear in it.

    Its integral is the power that drives the flow, to second order in the edge length.

    Parameters
    ----------
    flow : Flow

    Returns
    -------
    (t,) float64
        Power per area and unit depth.
    """
    # Strategy: the gradient of each cell, and the gradient of that. A strain rate e + d(x) with d linear and zero at
    # the centroid has the mean square e : e + the sum of d : d over the three corners / 12.
    mesh, faces = flow.mesh, flow.faces
    moving = faces.kind[faces.inner :] == MOVING
    gradient = cell_gradients(mesh, faces, flow.velocity, moving, faces.profile[:, 1])
    free, nothing = np.zeros(len(moving), dtype=np.bool_), np.zeros((len(moving), 4))
    second = cell_gradients(mesh, faces, gradient.reshape(-1, 4), free, nothing).reshape(-1, 2, 2, 2)
    mean = _square(gradient)
    for corner in mesh.triangles.T:
        mean += _square(np.einsum("tijk,tk->tij", second, mesh.points[corner] - mesh.centroids)) / 12.0
    return 2.0 * flow.viscosity * mean


def power(flow: Flow) -> Power:
    """Power that drives the flow: pressure times inflow, traction times velocity, body force times velocity.

    Parameters
    ----------
    flow : Flow

    Returns
    -------
    Power
    """
    mesh, faces, inner = flow.mesh, flow.faces, flow.faces.inner
    rim = flow.face_flux[inner:]
    is_open = faces.kind[inner:] == OPEN
    pressure = -float(np.sum((faces.opening[is_open] + faces.level) * rim[is_open]))
    # At a seam the pressure here is greater than beyond by the mean gradient times the way around.
    seams = np.flatnonzero(faces.kind[faces.edge_face] == INNER)
    middle = mesh.points[mesh.boundary_edges[seams]].mean(axis=1)
    outflow = flow.face_flux[faces.edge_face[seams]] * faces.edge_sign[seams]
    pressure += float(np.sum(middle @ faces.gradient * outflow))

    edges = np.flatnonzero(faces.kind[faces.edge_face] == MOVING)
    chosen = faces.edge_face[edges]
    traction = edge_tractions(faces, flow.edge_force, edges, flow.viscosity)
    force = traction.viscous + traction.pressure[:, None] * faces.normal[chosen]
    profile = faces.profile[chosen - inner]
    mean = (profile[:, 0] + 4.0 * profile[:, 1] + profile[:, 2]) / 6.0
    moving = -float(np.sum(faces.length[chosen] * np.einsum("ei,ei->e", force, mean)))
    return Power(pressure, moving, float(mesh.areas @ np.sum(flow.body_force * flow.velocity, axis=1)))


def _square(gradient: NDArray[np.float64]) -> NDArray[np.float64]:
    """E : e of the symmetric part of gradients (t, 2, 2); (t,)."""
    xy = gradient[:, 0, 1] + gradient[:, 1, 0]
    return np.asarray(gradient[:, 0, 0] ** 2 + gradient[:, 1, 1] ** 2 + 0.5 * xy * xy)
