"""The neighbourhood of a face: the cells and boundary faces whose values enter its fits."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.flow.faces import Faces
    from vasculo.mesh.triangulation import Triangulation

MAX_CELLS = 192
MAX_RIM = 96
TOP_LEVEL = 3


@njit(cache=True, error_model="numpy", nogil=True)
def grow(
    level: int,
    face: int,
    ex: float,
    ey: float,
    points: NDArray[np.float64],
    triangles: NDArray[np.int32],
    centroids: NDArray[np.float64],
    ends: NDArray[np.int32],
    own_cells: NDArray[np.int32],
    rim_ends: NDArray[np.int32],
    same: NDArray[np.int32],
    corner_start: NDArray[np.int32],
    corners: NDArray[np.int32],
    rim_start: NDArray[np.int32],
    rim: NDArray[np.int32],
    cell_stamp: NDArray[np.int32],
    rim_stamp: NDArray[np.int32],
    cells: NDArray[np.int32],
    cell_at: NDArray[np.float64],
    near: NDArray[np.int32],
    near_at: NDArray[np.float64],
    count: NDArray[np.int64],
) -> None:
    """Add the cells and boundary faces that one level more brings into the neighbourhood of a face.

    Level 0: what touches an end of the face, its own cells first. Level 1: what touches a vertex of its own cells.
    Above: what touches a vertex of any cell found so far. Positions are in face axes: xi along the tangent, zeta along
    the normal, from the middle, over the face length; (ex, ey) is the tangent over the length.

    Overwrites `cell_stamp`, `rim_stamp`, `cells`, `cell_at` (centroids), `near`, `near_at` (both ends of boundary
    faces) and `count` (cells, boundary faces), which is zero before level 0.
    """
    # Strategy: a cell found at a vertex is placed as that cell sees the vertex, so glued vertices carry the
    # neighbourhood across a periodic side and no shift is ever needed.
    own = 2 if own_cells[face, 1] >= 0 else 1
    visits = 2 if level == 0 else 3 * own if level == 1 else 3 * count[0]
    for q in range(visits):
        if level == 0:
            r, xi, zeta = same[ends[face, q]], q - 0.5, 0.0
        else:
            k = q // 3
            vertex = triangles[cells[k], q % 3]
            dx, dy = points[vertex, 0] - centroids[cells[k], 0], points[vertex, 1] - centroids[cells[k], 1]
            r, xi, zeta = same[vertex], cell_at[k, 0] + dx * ex + dy * ey, cell_at[k, 1] + dx * ey - dy * ex
        for c in range(corner_start[r], corner_start[r + 1]):
            cell = corners[c] // 3
            if cell_stamp[cell] != face and count[0] < MAX_CELLS:
                cell_stamp[cell] = face
                vertex = triangles[cell, corners[c] % 3]
                dx, dy = centroids[cell, 0] - points[vertex, 0], centroids[cell, 1] - points[vertex, 1]
                cells[count[0]] = cell
                cell_at[count[0], 0] = xi + dx * ex + dy * ey
                cell_at[count[0], 1] = zeta + dx * ey - dy * ex
                count[0] += 1
        for c in range(rim_start[r], rim_start[r + 1]):
            found = rim[c] // 2
            if rim_stamp[found] != face and count[1] < MAX_RIM:
                rim_stamp[found] = face
                vertex = rim_ends[found, rim[c] % 2]
                near[count[1]] = found
                for end in range(2):
                    dx = points[rim_ends[found, end], 0] - points[vertex, 0]
                    dy = points[rim_ends[found, end], 1] - points[vertex, 1]
                    near_at[count[1], 2 * end] = xi + dx * ex + dy * ey
                    near_at[count[1], 2 * end + 1] = zeta + dx * ey - dy * ex
                count[1] += 1
    if level == 0:
        for side in range(own):
            k = side
            while cells[k] != own_cells[face, side]:
                k += 1
            cells[side], cells[k] = cells[k], cells[side]
            for axis in range(2):
                cell_at[side, axis], cell_at[k, axis] = cell_at[k, axis], cell_at[side, axis]


def stencil_plain(
    mesh: Triangulation, faces: Faces, face: int, level: int
) -> tuple[list[int], NDArray[np.float64], list[int], NDArray[np.float64]]:
    """Cells and boundary faces of one face at a level, on meshes without periodic sides; the reference of `visit`.

    Returns
    -------
    cells : list of int
        Sorted; level 0 touches an end of the face, level 1 a vertex of its own cells, and so on.
    cell_at : (cells, 2) float64
        Their centroids in face axes.
    near : list of int
        Boundary faces, counted from the first, sorted.
    near_at : (near, 2, 2) float64
        Their ends in face axes.
    """
    own = [int(c) for c in faces.cells[face] if c >= 0]
    vertices = {int(v) for v in faces.ends[face]}
    for step in range(level):
        touched = own if step == 0 else np.flatnonzero(np.isin(mesh.triangles, list(vertices)).any(axis=1))
        vertices |= {int(v) for v in mesh.triangles[touched].ravel()}
    cells = np.flatnonzero(np.isin(mesh.triangles, list(vertices)).any(axis=1))
    rim_ends = faces.ends[faces.inner :]
    near = np.flatnonzero(np.isin(rim_ends, list(vertices)).any(axis=1))
    axes = np.column_stack([faces.tangent[face], faces.normal[face]]) / faces.length[face]
    middle = mesh.points[faces.ends[face]].mean(axis=0)
    cell_at = (mesh.centroids[cells] - middle) @ axes
    near_at = (mesh.points[rim_ends[near]] - middle) @ axes
    return cells.tolist(), cell_at, near.tolist(), near_at
