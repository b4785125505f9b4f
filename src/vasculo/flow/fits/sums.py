"""The sums of the tables' rows: what the values in the cells make of each face's four functionals."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

if TYPE_CHECKING:
    from numpy.typing import NDArray

BLOCK = 512  # faces that a thread takes at a time


@njit(cache=True, error_model="numpy", nogil=True)
def sum_rows(
    rank: int,
    threads: int,
    cells: NDArray[np.float64],
    start: NDArray[np.int64],
    stop: NDArray[np.int64],
    cell: NDArray[np.int32],
    weight: NDArray[np.float64],
    sums: NDArray[np.float64],
) -> int:
    """Sum the weighted unknowns of each face into `sums` (m, 6): derivative x, y, mean x, y, difference, pressure.

    `cells` (t, 3) are the unknowns; the others as in `Tables`.
    """
    for block in range(rank * BLOCK, len(start), threads * BLOCK):
        for f in range(block, min(block + BLOCK, len(start))):
            gx = gy = mx = my = jump = pressure = 0.0
            for k in range(start[f], stop[f]):
                c = cell[k]
                u, v, p = cells[c, 0], cells[c, 1], cells[c, 2]
                gx += weight[k, 0] * u
                gy += weight[k, 0] * v
                mx += weight[k, 1] * u
                my += weight[k, 1] * v
                jump += weight[k, 2] * p
                pressure += weight[k, 3] * p
            sums[f, 0], sums[f, 1], sums[f, 2], sums[f, 3] = gx, gy, mx, my
            sums[f, 4], sums[f, 5] = jump, pressure
    return 0


def sum_rows_plain(
    cells: NDArray[np.float64],
    start: NDArray[np.int64],
    stop: NDArray[np.int64],
    cell: NDArray[np.int32],
    weight: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return the same sums, face by face; the reference of `sum_rows`."""
    sums = np.empty((len(start), 6))
    for f, row in enumerate(map(slice, start, stop)):
        gradient, mean, jump, pressure = weight[row].T @ cells[cell[row]]
        sums[f] = *gradient[:2], *mean[:2], jump[2], pressure[2]
    return sums
