"""The matrix of the system by 3 x 3 blocks, for the solvers that factor it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from vasculo.flow.balance import carried
from vasculo.flow.faces import INNER, OPEN

if TYPE_CHECKING:
    from numpy.typing import NDArray

BLOCK = 256  # cells that a thread takes at a time


@njit(cache=True, error_model="numpy", nogil=True)
def count_columns(
    rank: int,
    threads: int,
    cell_faces: NDArray[np.int32],
    start: NDArray[np.int64],
    stop: NDArray[np.int64],
    cell: NDArray[np.int32],
    columns: NDArray[np.int32],
) -> int:
    """Count the cells that enter the balance of each cell, into `columns` (t,); arguments as in `fill_blocks`."""
    stamp = np.full(len(cell_faces), -1, np.int32)
    for block in range(rank * BLOCK, len(cell_faces), threads * BLOCK):
        for c in range(block, min(block + BLOCK, len(cell_faces))):
            number = 0
            for side in range(3):
                f = cell_faces[c, side]
                f = f if f >= 0 else ~f
                for k in range(start[f], stop[f]):
                    if stamp[cell[k]] != c:
                        stamp[cell[k]] = c
                        number += 1
            columns[c] = number
    return 0


@njit(cache=True, error_model="numpy", nogil=True)
def fill_blocks(
    rank: int,
    threads: int,
    cell_faces: NDArray[np.int32],
    kind: NDArray[np.int32],
    length: NDArray[np.float64],
    normal: NDArray[np.float64],
    smoothing: NDArray[np.float64],
    scale: float,
    start: NDArray[np.int64],
    stop: NDArray[np.int64],
    cell: NDArray[np.int32],
    weight: NDArray[np.float64],
    row_start: NDArray[np.int32],
    columns: NDArray[np.int32],
    data: NDArray[np.floating],
) -> int:
    """Fill the block rows: `columns` (k,) sorted in each row, and `data` (k, 3, 3).

    Names as in `Tables` and `fluxes_of_sums`; `row_start` (t + 1,) from `count_columns`.
    """
    place = np.full(len(cell_faces), -1, np.int32)  # of a cell in this row, valid if it lies within it
    for block in range(rank * BLOCK, len(cell_faces), threads * BLOCK):
        for c in range(block, min(block + BLOCK, len(cell_faces))):
            first, last = row_start[c], row_start[c]
            # The columns of this row, put in order as they come.
            for side in range(3):
                f = cell_faces[c, side]
                f = f if f >= 0 else ~f
                for k in range(start[f], stop[f]):
                    j = cell[k]
                    if place[j] < first:
                        place[j] = first
                        i = last
                        while i > first and columns[i - 1] > j:
                            columns[i] = columns[i - 1]
                            i -= 1
                        columns[i] = j
                        last += 1
            for i in range(first, last):
                place[columns[i]] = i
                for entry in range(9):
                    data[i, entry // 3, entry % 3] = 0.0
            for side in range(3):
                f = cell_faces[c, side]
                sign = 1.0 if f >= 0 else -1.0
                f = f if f >= 0 else ~f
                nx, ny, area = sign * normal[f, 0], sign * normal[f, 1], sign * length[f]
                xx, xy, yy = carried(kind[f], nx, ny)
                xx, xy, yy = area * xx, area * xy, area * yy
                px, py = length[f] / scale * nx, length[f] / scale * ny
                mx = my = rest = 0.0
                if kind[f] == INNER or kind[f] == OPEN:
                    mx, my, rest = px, py, sign * smoothing[f]
                for k in range(start[f], stop[f]):
                    i = place[cell[k]]
                    data[i, 0, 0] -= xx * weight[k, 0]
                    data[i, 0, 1] -= xy * weight[k, 0]
                    data[i, 1, 0] -= xy * weight[k, 0]
                    data[i, 1, 1] -= yy * weight[k, 0]
                    data[i, 2, 0] += mx * weight[k, 1]
                    data[i, 2, 1] += my * weight[k, 1]
                    data[i, 2, 2] -= rest * weight[k, 2]
                    data[i, 0, 2] += px * weight[k, 3]
                    data[i, 1, 2] += py * weight[k, 3]
    return 0
