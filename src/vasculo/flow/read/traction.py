"""What the flow does to its boundary: the force through every edge; shear, viscous traction and pressure at walls."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.flow.faces import Faces
    from vasculo.mesh.triangulation import Triangulation


class Traction(NamedTuple):
    """On `w` wall edges, per length of wall.

    Parameters
    ----------
    shear : (w,) float64
        Signed tangential traction of the walls on the fluid's side, along the edge: viscosity du_t/dn.
    viscous : (w, 2) float64
        Viscous traction on the solid.
    pressure : (w,) float64
        Pressure on the face, in the unit of the unknowns times viscosity / h.
    """

    shear: NDArray[np.float64]
    viscous: NDArray[np.float64]
    pressure: NDArray[np.float64]


def edge_forces(
    mesh: Triangulation, faces: Faces, momentum: NDArray[np.float64], level: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Force of the fluid through each boundary edge on what lies beyond: the flux of momentum, with the whole pressure.

    Their sum is the body force of the whole fluid, to round-off.

    Parameters
    ----------
    mesh : Triangulation
    faces : Faces
    momentum : (m, 2) float64
        Flux of momentum through each face, out of its first cell, with the pressure as the unknowns have it.
    level : (t,) float64
        What is taken off the pressure of each cell, periodic drop apart.

    Returns
    -------
    (e, 2) float64
        In the order of the boundary edges of the mesh, seams of periodic sides included.
    """
    ends = mesh.points[mesh.boundary_edges]
    along = ends[:, 1] - ends[:, 0]
    more = -(0.5 * (ends[:, 0] + ends[:, 1]) @ faces.gradient) - level[mesh.boundary_triangles]
    force = faces.edge_sign[:, None] * momentum[faces.edge_face]
    force[:, 0] += more * along[:, 1]
    force[:, 1] -= more * along[:, 0]
    return force


def edge_tractions(faces: Faces, force: NDArray[np.float64], edges: NDArray[np.int64], viscosity: float) -> Traction:
    """Traction on boundary edges where the velocity is prescribed, from the force through them.

    With the outward normal n and the velocity's own gradient G along the edge, the viscous stress is
    ``(tau + eta G.n) t - 2 eta (G.t) n``: the normal part comes from continuity, not from a fit. At rest this is the
    shear alone. Summed over closed walls it balances the momentum of all cells to round-off.

    Parameters
    ----------
    faces : Faces
    force : (e, 2) float64
        As given by `edge_forces`.
    edges : (w,) int64
        Boundary edges; their faces are MOVING.
    viscosity : float

    Returns
    -------
    Traction
        With the whole pressure.
    """
    chosen = faces.edge_face[edges]
    tangent, normal, length = faces.tangent[chosen], faces.normal[chosen], faces.length[chosen]
    profile = faces.profile[chosen - faces.inner]
    along = (profile[:, 2] - profile[:, 0]) / length[:, None]
    stress = force[edges] / length[:, None]
    stretch = viscosity * np.einsum("fi,fi->f", along, tangent)
    shear = -np.einsum("fi,fi->f", stress, tangent)
    tangential = shear + viscosity * np.einsum("fi,fi->f", along, normal)
    viscous = 2.0 * stretch[:, None] * normal - tangential[:, None] * tangent
    return Traction(shear, viscous, np.einsum("fi,fi->f", stress, normal) - stretch)
