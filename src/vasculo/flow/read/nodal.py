"""Node velocities from cell velocities: the paper's linear problem, here a consistent-mass projection."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy import sparse

from vasculo.flow.faces import MIRROR, MOVING

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.flow.faces import Faces
    from vasculo.mesh.triangulation import Triangulation

RIDGE = 1e-9  # against normal matrices of order one
STEPS = 34  # the error falls threefold a step: 2 / 3**34 is round-off


def project_to_nodes(mesh: Triangulation, faces: Faces, velocity: NDArray[np.float64]) -> NDArray[np.float64]:
    """Velocity at the nodes, second order in the edge length.

    Continuous and linear in each triangle, with the prescribed values at walls and inlets and the least squared
    distance to the cells' linear fields elsewhere; on mirror lines the component across is removed.

    Parameters
    ----------
    mesh : Triangulation
    faces : Faces
    velocity : (t, 2) float64

    Returns
    -------
    (n, 2) float64
    """
    # Strategy: M x = r with the mass matrix M of linear elements, and r from the field that is linear in each triangle
    # (the cell values alone would lose an order where the triangles around a node are uneven). Scaled by its diagonal,
    # the eigenvalues of M lie in [1/2, 2] on every mesh of triangles (Wathen 1987), so a fixed number of Chebyshev
    # steps solves it to round-off: no factor, no inner products.
    nodes = len(mesh.points)
    corner = faces.same[mesh.triangles]
    rows, columns = np.repeat(corner, 3, axis=1).ravel(), np.tile(corner, (1, 3)).ravel()
    entries = np.repeat(mesh.areas / 12.0, 9) * np.tile(1.0 + np.eye(3).ravel(), len(corner))
    mass = sparse.coo_array((entries, (rows, columns)), shape=(nodes, nodes)).tocsr()
    right = np.empty((nodes, 2))
    gradient = _cell_gradients(mesh, faces, velocity)
    arm = mesh.points[mesh.triangles] - mesh.centroids[:, None]
    for axis in range(2):
        slope = np.einsum("tki,ti->tk", arm, gradient[:, axis])
        share = (mesh.areas[:, None] * (velocity[:, axis, None] / 3.0 + slope / 12.0)).ravel()
        right[:, axis] = np.bincount(corner.ravel(), weights=share, minlength=nodes)

    fixed, given = _prescribed(faces, nodes)
    free = (faces.same == np.arange(nodes)) & ~fixed
    free &= mass.diagonal() > 0.0
    inside = mass[free][:, free]
    values = given.copy()
    values[free] = _chebyshev(inside, inside.diagonal(), right[free] - mass[free][:, fixed] @ given[fixed])
    values = values[faces.same]
    _remove_across(faces, fixed[faces.same], values)
    return values


def _cell_gradients(mesh: Triangulation, faces: Faces, velocity: NDArray[np.float64]) -> NDArray[np.float64]:
    """Velocity gradient of each cell from its neighbours and the prescribed values beside it; (t, component, 2)."""
    # Strategy: least squares, each equation over its distance. A cell with one neighbour only gets the smallest
    # gradient that explains it, through a ridge far below any other cell's normal matrix.
    inner, cells = faces.inner, len(mesh.triangles)
    left, right = faces.cells[:inner].T
    start = faces.ends[:inner, 0]
    corner = np.argmax(faces.same[mesh.triangles[right]] == faces.same[start][:, None], axis=1)
    seen = mesh.points[mesh.triangles[right, corner]]
    across = (mesh.points[start] - mesh.centroids[left]) + (mesh.centroids[right] - seen)
    rim = np.flatnonzero(faces.kind[inner:] == MOVING)
    beside = faces.cells[inner + rim, 0]
    middle = mesh.points[faces.ends[inner + rim]].mean(axis=1)
    step = np.concatenate([across, across, middle - mesh.centroids[beside]])
    owner = np.concatenate([left, right, beside])
    change = velocity[right] - velocity[left]
    change = np.concatenate([change, change, faces.profile[rim, 1] - velocity[beside]])
    weight = 1.0 / np.einsum("ki,ki->k", step, step)

    def total(entries: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(np.bincount(owner, weights=weight * entries, minlength=cells), dtype=np.float64)

    x, y = step.T
    xx, xy, yy = total(x * x) + RIDGE, total(x * y), total(y * y) + RIDGE
    determinant = xx * yy - xy * xy
    gradient = np.empty((cells, 2, 2))
    for axis in range(2):
        one, two = total(x * change[:, axis]), total(y * change[:, axis])
        gradient[:, axis, 0] = (yy * one - xy * two) / determinant
        gradient[:, axis, 1] = (xx * two - xy * one) / determinant
    return gradient


def _chebyshev(
    matrix: sparse.csr_array, diagonal: NDArray[np.float64], right: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Chebyshev iteration for a matrix whose eigenvalues over its diagonal lie in [1/2, 2]."""
    centre, radius = 1.25, 0.75
    scaled = right / diagonal[:, None]
    x = scaled / centre
    step = x.copy()
    rho = radius / centre
    for _ in range(STEPS):
        after = 1.0 / (2.0 * centre / radius - rho)
        rest = scaled - (matrix @ x) / diagonal[:, None]
        step = after * rho * step + (2.0 * after / radius) * rest
        x, rho = x + step, after
    return x


def _prescribed(faces: Faces, nodes: int) -> tuple[NDArray[np.bool_], NDArray[np.float64]]:
    """Nodes with a prescribed velocity, and its value: the mean of what the edges at the node say."""
    rim = np.flatnonzero(faces.kind[faces.inner :] == MOVING)
    at = faces.same[faces.ends[faces.inner + rim]].T.ravel()
    number = np.bincount(at, minlength=nodes)
    given = np.empty((nodes, 2))
    for axis in range(2):
        ends = np.concatenate([faces.profile[rim, 0, axis], faces.profile[rim, 2, axis]])
        given[:, axis] = np.bincount(at, weights=ends, minlength=nodes) / np.maximum(number, 1)
    return number > 0, given


def _remove_across(faces: Faces, fixed: NDArray[np.bool_], values: NDArray[np.float64]) -> None:
    """Remove the velocity across mirror lines, at their nodes that are not prescribed; changes `values`."""
    for face in np.flatnonzero(faces.kind == MIRROR):
        for node in faces.ends[face]:
            if not fixed[node]:
                values[node] -= float(values[node] @ faces.normal[face]) * faces.normal[face]
