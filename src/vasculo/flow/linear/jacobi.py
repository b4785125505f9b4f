"""A block-Jacobi step: what a coarser solver leaves of a residual, over the 3 x 3 diagonal blocks."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from vasculo.springs.threads import run_team

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy import sparse

BLOCK = 2048  # cells that a thread takes at a time
FEW = 4 * BLOCK  # cells a thread; fewer are not worth another one


@njit(cache=True, error_model="numpy", nogil=True)
def add_step(
    rank: int,
    threads: int,
    inverse: NDArray[np.float32],
    weight: float,
    right: NDArray[np.float64],
    product: NDArray[np.float64],
    found: NDArray[np.float64],
) -> int:
    """Add `weight` times inverse (right - product) to `found`; `inverse` (t, 3, 3), the vectors (3 t,)."""
    for block in range(rank * BLOCK, len(inverse), threads * BLOCK):
        for c in range(block, min(block + BLOCK, len(inverse))):
            x = weight * (right[3 * c] - product[3 * c])
            y = weight * (right[3 * c + 1] - product[3 * c + 1])
            z = weight * (right[3 * c + 2] - product[3 * c + 2])
            for i in range(3):
                found[3 * c + i] += inverse[c, i, 0] * x + inverse[c, i, 1] * y + inverse[c, i, 2] * z
    return 0


def add_step_plain(
    inverse: NDArray[np.float32],
    weight: float,
    right: NDArray[np.float64],
    product: NDArray[np.float64],
    found: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return what `add_step` leaves in `found`; its reference."""
    blocks = np.asarray(inverse, dtype=np.float64)
    return found + weight * np.einsum("cij,cj->ci", blocks, (right - product).reshape(-1, 3)).ravel()


def jacobi_step(
    inverse: NDArray[np.float32],
    weight: float,
    right: NDArray[np.float64],
    product: NDArray[np.float64],
    found: NDArray[np.float64],
) -> None:
    """Add a step of block Jacobi to `found` (3 t,), in place.

    Parameters
    ----------
    inverse : (t, 3, 3) float32
        Inverses of the diagonal blocks, see `inverse_diagonal`.
    weight : float
        Relaxation.
    right, product : (3 t,) float64
        Right-hand side r and A times `found`.
    """
    run_team(add_step, len(inverse) // FEW, inverse, weight, right, product, found)


def inverse_diagonal(matrix: sparse.bsr_array) -> NDArray[np.float32]:
    """Inverses of the diagonal 3 x 3 blocks of a matrix, float32 (t, 3, 3); every row has one."""
    rows = np.repeat(np.arange(len(matrix.indptr) - 1, dtype=np.int32), np.diff(matrix.indptr))
    return np.asarray(np.linalg.inv(matrix.data[rows == matrix.indices]), dtype=np.float32)
