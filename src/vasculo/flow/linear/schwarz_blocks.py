"""Pieces of a matrix of 3 x 3 blocks: rows and columns of some cells, factored by themselves."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from vasculo.errors import ComputationError
from vasculo.flow.linear.pardiso import BlockFactor, library

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Ints = NDArray[np.integer]

ENTRY = 6.5  # bytes an entry of SuperLU's factors, measured


def cut_blocks(matrix: sparse.bsr_array, rows: Ints, columns: Ints) -> sparse.bsr_array:
    """Blocks of a matrix in the rows and columns of some cells, both in rising order."""
    number = np.diff(matrix.indptr)[rows]
    first = np.repeat(matrix.indptr[rows] - (np.cumsum(number) - number), number)
    entry = first + np.arange(len(first))
    place = np.full(matrix.shape[1] // 3, -1, dtype=np.int32)
    place[columns] = np.arange(len(columns))
    where = place[matrix.indices[entry]]
    kept = where >= 0
    start = np.zeros(len(rows) + 1, dtype=np.int32)
    np.cumsum(np.bincount(np.repeat(np.arange(len(rows)), number)[kept], minlength=len(rows)), out=start[1:])
    shape = (3 * len(rows), 3 * len(columns))
    return sparse.bsr_array((matrix.data[entry[kept]], where[kept], start), shape=shape)


def cell_pattern(matrix: sparse.bsr_array) -> sparse.csr_array:
    """Which cells a matrix couples, either way: symmetric by cells (t, t), sorted int32 indices."""
    cells = len(matrix.indptr) - 1
    ones = np.ones(len(matrix.indices), dtype=np.int8)
    pattern = sparse.csr_array((ones, matrix.indices, matrix.indptr), shape=(cells, cells))
    both = sparse.csr_array(pattern.astype(bool) + pattern.T.astype(bool))
    both.sort_indices()
    return both


class LocalFactor(NamedTuple):
    """A solve function, float64 (n,) in and out, and the bytes that it keeps."""

    solve: Callable[[Floats], Floats]
    bytes: int


@contextmanager
def local_factor(matrix: sparse.bsr_array) -> Iterator[LocalFactor]:
    """Factor a matrix in single precision, by PARDISO or else by SuperLU.

    Raises
    ------
    ComputationError
        The matrix is singular.
    """
    if library() is not None:
        with BlockFactor(matrix) as factor:
            del matrix  # this frame lives as long as the factor
            yield LocalFactor(factor.solve, factor.bytes)
        return
    columns = matrix.tocsc().astype(np.float32)
    columns.eliminate_zeros()
    try:
        direct = splu(columns, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except RuntimeError as error:
        raise ComputationError(f"a part of {matrix.shape[0] // 3} cells is singular ({error})") from error
    del matrix, columns
    yield LocalFactor(lambda right: direct.solve(right.astype(np.float32)).astype(np.float64), int(ENTRY * direct.nnz))
