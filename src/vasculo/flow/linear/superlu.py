"""LU factors without any extra: SciPy's SuperLU in single precision, in an order of our own."""

from __future__ import annotations

from time import perf_counter
from typing import TYPE_CHECKING, Self

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from vasculo.errors import ComputationError
from vasculo.flow.linear.dissection import elimination_order
from vasculo.flow.linear.fill import count_fill
from vasculo.flow.linear.memory import check_memory

if TYPE_CHECKING:
    from numpy.typing import NDArray

ENTRY = 6.5  # bytes an entry of the factors, measured
PEAK = 1.3  # times the factors: what SuperLU holds while they grow, measured
BESIDE = 900  # bytes a cell of the matrix and its permuted copies, measured


class ScipyFactor:
    """LU factors of a matrix of 3 x 3 blocks, in single precision; a context manager like `BlockFactor`.

    Parameters
    ----------
    matrix : bsr_array, 3 x 3 blocks, float32, int32 indices
    points : (t, 2) float64
        Places of its cells, for nested dissection.
    memory : float, optional
        Bytes that may be used; without it any number.

    Raises
    ------
    TooLargeError
        The factors need more memory.
    ComputationError
        The matrix is singular.
    """

    def __init__(self, matrix: sparse.bsr_array, points: NDArray[np.float64], memory: float | None = None) -> None:
        # Strategy: cells are ordered as a graph, three times smaller than that of the unknowns; the pivots stay on the
        # diagonal, which has blocks of order one, and what single precision loses is left to the Krylov steps.
        began = perf_counter()
        cells = len(points)
        ones = np.ones(len(matrix.indices), dtype=np.int8)
        graph = sparse.csr_array((ones, matrix.indices, matrix.indptr), shape=(cells, cells))
        graph = (graph + graph.T).tocsr()
        order = elimination_order(points, graph.indptr, graph.indices)
        entries = 9 * (2 * count_fill(order, graph.indptr, graph.indices) + cells)
        self.needed = PEAK * ENTRY * entries + BESIDE * cells
        check_memory(self.needed, memory, f"SuperLU on {3 * cells} unknowns")
        self._order = (3 * order.astype(np.int64)[:, None] + np.arange(3)).ravel()
        columns = matrix.tocsc()[self._order][:, self._order]
        columns.eliminate_zeros()
        self.analysis_seconds = perf_counter() - began
        try:
            self._factor = splu(
                columns, permc_spec="NATURAL", diag_pivot_thresh=0.0, options={"SymmetricMode": True}
            )  # fmt: skip
        except RuntimeError as error:
            raise ComputationError(f"the flow system of {3 * cells} unknowns is singular ({error})") from error
        self.factor_seconds = perf_counter() - began - self.analysis_seconds
        self.bytes = int(ENTRY * self._factor.nnz)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        del self._factor

    def solve(self, right: NDArray[np.float64]) -> NDArray[np.float64]:
        """Solve for one right-hand side; float64 (n,) in and out, accurate to single precision only."""
        found = np.empty(len(right))
        found[self._order] = self._factor.solve(right[self._order].astype(np.float32))
        return found
