"""Plain twin of the projection to the nodes: the mass matrix as SciPy has it, solved directly."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import spsolve

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.flow.faces import Faces
    from vasculo.mesh.triangulation import Triangulation


def project_plain(
    mesh: Triangulation,
    faces: Faces,
    values: NDArray[np.float64],
    gradient: NDArray[np.float64],
    known: NDArray[np.bool_],
    profile: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Twin of `vasculo.flow.read.nodal._project` and of the prescribed values at the ends of `known` faces; (n, k)."""
    nodes, count = len(mesh.points), values.shape[1]
    corner = faces.same[mesh.triangles]
    rows, columns = np.repeat(corner, 3, axis=1).ravel(), np.tile(corner, (1, 3)).ravel()
    entries = np.repeat(mesh.areas / 12.0, 9) * np.tile(1.0 + np.eye(3).ravel(), len(corner))
    mass = sparse.coo_array((entries, (rows, columns)), shape=(nodes, nodes)).tocsr()
    arm = mesh.points[mesh.triangles] - mesh.centroids[:, None]
    slope = np.einsum("tci,tki->tck", arm, gradient)
    right = np.zeros((nodes, count))
    np.add.at(right, corner, mesh.areas[:, None, None] * (values[:, None] / 3.0 + slope / 12.0))

    result, number = np.zeros((nodes, count)), np.zeros(nodes)
    at = faces.same[faces.ends[faces.inner :][known]]
    np.add.at(number, at, 1.0)
    np.add.at(result, at, profile[known][:, ::2])
    fixed = number > 0.0
    result[fixed] /= number[fixed, None]
    free = ~fixed & (mass.diagonal() > 0.0)
    rest = right - mass @ result
    result[free] = spsolve(mass[free][:, free].tocsc(), rest[free]).reshape(-1, count)
    return result
