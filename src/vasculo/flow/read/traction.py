"""What the flow does to the walls: shear, viscous traction and pressure on every wall edge."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from vasculo.flow.fits.tables import GRADIENT, PRESSURE

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
    tables = system.tables
    start, stop = tables.start[chosen], tables.start[chosen + 1]
    counts = stop - start
    owner = np.repeat(np.arange(len(chosen)), counts)
    place = np.arange(int(counts.sum())) + np.repeat(start - np.cumsum(counts) + counts, counts)
    values = unknowns.reshape(-1, 3)[tables.cell[place]]
    gradient = tables.constant[chosen, :2].copy()
    pressure = tables.constant[chosen, 5].copy()
    for axis in range(2):
        gradient[:, axis] += np.bincount(
            owner, weights=tables.weight[place, GRADIENT] * values[:, axis], minlength=len(chosen)
        )
    pressure += np.bincount(owner, weights=tables.weight[place, PRESSURE] * values[:, 2], minlength=len(chosen))

    tangent, normal = faces.tangent[chosen], faces.normal[chosen]
    profile = faces.profile[chosen - faces.inner]
    along = (profile[:, 2] - profile[:, 0]) / faces.length[chosen, None]
    shear = viscosity * np.einsum("fi,fi->f", gradient, tangent)
    tangential = shear + viscosity * np.einsum("fi,fi->f", along, normal)
    stretch = 2.0 * viscosity * np.einsum("fi,fi->f", along, tangent)
    viscous = stretch[:, None] * normal - tangential[:, None] * tangent
    return Traction(shear, viscous, pressure * (viscosity / system.scale))
