"""A compact matrix near the full one: a cell and its three neighbours, first order, for cheap factors."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit
from scipy import sparse

from vasculo.flow.assemble import smoothing_factor
from vasculo.flow.balance import carried
from vasculo.flow.faces import INNER, MIRROR, OPEN
from vasculo.springs.threads import run_team

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from vasculo.flow.assemble import System
    from vasculo.flow.faces import Faces
    from vasculo.mesh.triangulation import Triangulation

BLOCK = 256  # cells that a thread takes at a time
FEW = 8000  # cells a thread; fewer are not worth another one
SMOOTHING = 1.0 / 3.0  # of the smoothing in the full system (kappa 1): plain differences of the pressure need less


@njit(cache=True, error_model="numpy", nogil=True)
def fill_compact(
    rank: int,
    threads: int,
    cell_faces: NDArray[np.int32],
    cells: NDArray[np.int32],
    kind: NDArray[np.int32],
    length: NDArray[np.float64],
    normal: NDArray[np.float64],
    distance: NDArray[np.float64],
    smoothing: NDArray[np.float64],
    areas: NDArray[np.float64],
    scale: float,
    columns: NDArray[np.int32],
    data: NDArray[np.floating],
    number: NDArray[np.int32],
) -> int:
    """Fill up to four blocks a cell, as many as `number` (t,) then says: `columns` (t, 4) sorted, `data` (t, 4, 3, 3).

    `cells` (m, 2) and the arrays after it as in `Faces`; `cell_faces`, `scale` as in `System`; `smoothing` (m,) is the
    factor of the pressure difference in the mass flux.
    """
    # Strategy: at an inner face the derivative is the difference of the two cells, mean and pressure lie between them
    # by distance (a centroid's distance is the area over 1.5 lengths); at walls the cell's own value over its distance;
    # prescribed values play no part in a matrix.
    for block in range(rank * BLOCK, len(cell_faces), threads * BLOCK):
        for c in range(block, min(block + BLOCK, len(cell_faces))):
            columns[c, 0] = c
            count = 1
            for side in range(3):
                f = cell_faces[c, side]
                other = cells[f, 1] if f >= 0 else cells[~f, 0]
                known = other < 0
                for i in range(count):
                    known = known or columns[c, i] == other
                if not known:
                    i = count
                    while i > 0 and columns[c, i - 1] > other:
                        columns[c, i] = columns[c, i - 1]
                        i -= 1
                    columns[c, i] = other
                    count += 1
            number[c] = count
            data[c] = 0.0
            own = 0
            while columns[c, own] != c:
                own += 1
            for side in range(3):
                f = cell_faces[c, side]
                other = cells[f, 1] if f >= 0 else cells[~f, 0]
                sign = 1.0 if f >= 0 else -1.0
                f = f if f >= 0 else ~f
                nx, ny, over = sign * normal[f, 0], sign * normal[f, 1], length[f] / scale
                xx, xy, yy = carried(kind[f], nx, ny)
                stress = length[f] / distance[f]
                share = areas[other] / (areas[c] + areas[other]) if kind[f] == INNER else 1.0
                data[c, own, 0, 0] += stress * xx
                data[c, own, 0, 1] += stress * xy
                data[c, own, 1, 0] += stress * xy
                data[c, own, 1, 1] += stress * yy
                if kind[f] != OPEN:
                    data[c, own, 0, 2] += over * share * nx
                    data[c, own, 1, 2] += over * share * ny
                if kind[f] == INNER or kind[f] == OPEN:
                    data[c, own, 2, 0] += over * share * nx
                    data[c, own, 2, 1] += over * share * ny
                    data[c, own, 2, 2] += SMOOTHING * smoothing[f]
                if kind[f] == INNER:
                    i = 0
                    while columns[c, i] != other:
                        i += 1
                    data[c, i, 0, 0] -= stress
                    data[c, i, 1, 1] -= stress
                    data[c, i, 0, 2] += over * (1.0 - share) * nx
                    data[c, i, 1, 2] += over * (1.0 - share) * ny
                    data[c, i, 2, 0] += over * (1.0 - share) * nx
                    data[c, i, 2, 1] += over * (1.0 - share) * ny
                    data[c, i, 2, 2] -= SMOOTHING * smoothing[f]
    return 0


def compact_matrix(mesh: Triangulation, system: System) -> sparse.bsr_array:
    """Compact matrix of a flow, in the unknowns and the scaling of its `System`.

    Parameters
    ----------
    mesh : Triangulation
    system : System

    Returns
    -------
    bsr_array (3 t, 3 t), float32, 3 x 3 blocks, sorted int32 indices
        Nine entries a row. As a preconditioner it is as good for a thousand pillars as for ten.
    """
    cells, faces = system.cells, system.faces
    columns, data = np.empty((cells, 4), dtype=np.int32), np.empty((cells, 4, 3, 3), dtype=np.float32)
    number = np.empty(cells, dtype=np.int32)
    run_team(
        fill_compact, cells // FEW, system.cell_faces, faces.cells, faces.kind, faces.length, faces.normal,
        faces.distance, system.smoothing, mesh.areas, system.scale, columns, data, number,
    )  # fmt: skip
    kept = np.arange(4) < number[:, None]
    start = np.zeros(cells + 1, dtype=np.int32)
    np.cumsum(number, out=start[1:])
    columns, data = columns[kept], data[kept]
    for cell in system.pins:
        row = slice(start[cell], start[cell + 1])
        data[row, 2, :] = 0.0
        data[row, 2, 2] = columns[row] == cell
    return sparse.bsr_array((data, columns, start), shape=(3 * cells, 3 * cells))


def compact_matrix_plain(mesh: Triangulation, faces: Faces, pins: ArrayLike, scale: float) -> NDArray[np.float64]:
    """Dense compact matrix, face by face from the formulas; the reference of `compact_matrix`."""
    cells = len(mesh.triangles)
    blocks = np.zeros((cells, cells, 3, 3))
    smoothing = SMOOTHING * faces.length / scale**2 * smoothing_factor(mesh, faces)
    for f, ((first, second), kind) in enumerate(zip(faces.cells, faces.kind, strict=True)):
        normal, stress = faces.normal[f], faces.length[f] / faces.distance[f]
        pressure_part = np.zeros((3, 3))  # momentum from the pressure on the face
        pressure_part[:2, 2] = faces.length[f] / scale * normal
        flux_part = pressure_part.T  # mass from the velocity on the face
        differences = np.diag([stress, stress, smoothing[f]])
        if kind == INNER:
            near = mesh.areas[second] / (mesh.areas[first] + mesh.areas[second])
            for cell, sign in ((first, 1.0), (second, -1.0)):
                blocks[cell, first] += sign * (differences + near * (pressure_part + flux_part))
                blocks[cell, second] += sign * ((1.0 - near) * (pressure_part + flux_part) - differences)
            continue
        across = np.outer(normal, normal)
        differences[:2, :2] = stress * (across if kind == MIRROR else np.eye(2) - across if kind == OPEN else np.eye(2))
        if kind == OPEN:
            blocks[first, first] += differences + flux_part
        else:
            differences[2, 2] = 0.0
            blocks[first, first] += differences + pressure_part
    matrix = blocks.transpose(0, 2, 1, 3).reshape(3 * cells, 3 * cells)
    for cell in np.asarray(pins):
        matrix[3 * cell + 2] = 0.0
        matrix[3 * cell + 2, 3 * cell + 2] = 1.0
    return matrix
