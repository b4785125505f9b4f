"""What the flow does to the walls: shear, viscous traction and pressure on every wall edge."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.flow.assemble import System
    from vasculo.flow.faces import Faces


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


def wall_traction(faces: Faces, system: System, unknowns: NDArray[np.float64], viscosity: float) -> Traction:
    """Traction on the wall edges, in their order in the mesh.

    With the outward normal n and the wall's own velocity gradient G along the edge, the viscous stress is
    ``(tau + eta G.n) t - 2 eta (G.t) n``: the normal part comes from continuity, not from the fit. At rest this
    is the shear alone. Summed over closed walls it balances the momentum of all cells to round-off.

    Parameters
    ----------
    faces : Faces
    system : System
    unknowns : (3 t,) float64
        The solution.
    viscosity : float
    """
    chosen = faces.edge_face[faces.is_wall]
    sums = system.tables.sums(unknowns)[chosen] + system.tables.constant[chosen]
    gradient, pressure = sums[:, :2], sums[:, 5]
    tangent, normal = faces.tangent[chosen], faces.normal[chosen]
    profile = faces.profile[chosen - faces.inner]
    along = (profile[:, 2] - profile[:, 0]) / faces.length[chosen, None]
    shear = viscosity * np.einsum("fi,fi->f", gradient, tangent)
    tangential = shear + viscosity * np.einsum("fi,fi->f", along, normal)
    stretch = 2.0 * viscosity * np.einsum("fi,fi->f", along, tangent)
    viscous = stretch[:, None] * normal - tangential[:, None] * tangent
    return Traction(shear, viscous, pressure * (viscosity / system.scale))
