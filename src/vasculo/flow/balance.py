"""The balance of every cell: fluxes through the faces from the sums of their rows, and what goes out of each cell."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from vasculo.flow.faces import INNER, MIRROR, OPEN

if TYPE_CHECKING:
    from numpy.typing import NDArray

BLOCK = 512  # faces or cells that a thread takes at a time


@njit(cache=True, error_model="numpy", nogil=True)
def list_cell_faces(cells: NDArray[np.int32], cell_faces: NDArray[np.int32]) -> int:
    """List the faces of each cell into `cell_faces` (t, 3): f where the cell is the first one, ~f where the second."""
    cell_faces[:] = len(cells)
    for f in range(len(cells)):
        for side in range(2):
            c = cells[f, side]
            if c >= 0:
                k = 0
                while cell_faces[c, k] != len(cells):
                    k += 1
                cell_faces[c, k] = ~f if side else f
    return 0


@njit(cache=True, error_model="numpy", nogil=True)
def carried(kind: int, nx: float, ny: float) -> tuple[float, float, float]:
    """Which part of the normal derivative carries momentum through a face, as xx, xy, yy of a projection.

    All of it inside and at walls, the part along the face at openings, across it on mirror lines; the rest is zero.
    """
    if kind == MIRROR:
        return nx * nx, nx * ny, ny * ny
    if kind == OPEN:
        return ny * ny, -nx * ny, nx * nx
    return 1.0, 0.0, 1.0


@njit(cache=True, error_model="numpy", nogil=True)
def fluxes_of_sums(
    rank: int,
    threads: int,
    kind: NDArray[np.int32],
    length: NDArray[np.float64],
    normal: NDArray[np.float64],
    smoothing: NDArray[np.float64],
    scale: float,
    sums: NDArray[np.float64],
) -> int:
    """Turn the six sums of each face into its fluxes of momentum and mass out of its first cell: `sums[:, :3]`.

    Momentum is over the viscosity, mass over h = `scale`; `smoothing` (m,) is the factor of the pressure difference.
    """
    for block in range(rank * BLOCK, len(kind), threads * BLOCK):
        for f in range(block, min(block + BLOCK, len(kind))):
            nx, ny, area = normal[f, 0], normal[f, 1], length[f]
            xx, xy, yy = carried(kind[f], nx, ny)
            gx, gy, pressure = sums[f, 0], sums[f, 1], sums[f, 5] * area / scale
            mass = 0.0
            if kind[f] == INNER or kind[f] == OPEN:
                mass = area / scale * (sums[f, 2] * nx + sums[f, 3] * ny) - smoothing[f] * sums[f, 4]
            sums[f, 0] = pressure * nx - area * (xx * gx + xy * gy)
            sums[f, 1] = pressure * ny - area * (xy * gx + yy * gy)
            sums[f, 2] = mass
    return 0


@njit(cache=True, error_model="numpy", nogil=True)
def balance_cells(
    rank: int, threads: int, cell_faces: NDArray[np.int32], fluxes: NDArray[np.float64], out: NDArray[np.float64]
) -> int:
    """Sum the fluxes (m, >= 3) out of each cell into `out` (t, 3)."""
    for block in range(rank * BLOCK, len(cell_faces), threads * BLOCK):
        for c in range(block, min(block + BLOCK, len(cell_faces))):
            for i in range(3):
                total = 0.0
                for k in range(3):
                    f = cell_faces[c, k]
                    total += fluxes[f, i] if f >= 0 else -fluxes[~f, i]
                out[c, i] = total
    return 0


def balance_plain(cells: NDArray[np.int32], faces: NDArray[np.float64], number: int) -> NDArray[np.float64]:
    """Sum the fluxes `faces` (m, 3) out of each of `number` cells, face by face; the reference of `balance_cells`."""
    out = np.zeros((number, 3))
    for (first, second), flux in zip(cells, faces, strict=True):
        out[first] += flux
        if second >= 0:
            out[second] -= flux
    return out


def fluxes_plain(
    kind: int, length: float, normal: NDArray[np.float64], smoothing: float, scale: float, sums: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Fluxes of one face from its six sums; the reference of `fluxes_of_sums`."""
    projection = np.eye(2)
    if kind == MIRROR:
        projection = np.outer(normal, normal)
    elif kind == OPEN:
        projection = np.eye(2) - np.outer(normal, normal)
    momentum = length * (sums[5] / scale * normal - projection @ sums[:2])
    mass = length / scale * (sums[2:4] @ normal) - smoothing * sums[4] if kind in {INNER, OPEN} else 0.0
    return np.array([*momentum, mass])
