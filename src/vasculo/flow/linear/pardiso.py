"""A direct solver by blocks in single precision: PARDISO of the optional `mkl` package, through its C interface."""

from __future__ import annotations

import ctypes
from functools import cache
from importlib.metadata import PackageNotFoundError, files
from time import perf_counter
from typing import TYPE_CHECKING, Self

import numpy as np

from vasculo.errors import ComputationError, InputError
from vasculo.flow.linear.memory import check_memory

if TYPE_CHECKING:
    from types import TracebackType

    from numpy.typing import NDArray
    from scipy import sparse

CBWR_AUTO = 2  # conditional numerical reproducibility on the best branch of this processor
REAL_UNSYMMETRIC = 11
ANALYSE, FACTOR, SOLVE, RELEASE = 11, 22, 33, -1


@cache
def library() -> ctypes.CDLL | None:
    """Find the runtime library through the installed package's metadata; None without the package.

    The first call switches conditional numerical reproducibility on, unless ``MKL_CBWR`` asks for something itself, so
    that results do not change with the number of threads.
    """
    try:
        found = [f for f in files("mkl") or () if f.name.startswith(("libmkl_rt.so", "mkl_rt.", "libmkl_rt.dylib"))]
        mkl = ctypes.CDLL(str(found[0].locate())) if found else None
    except (PackageNotFoundError, OSError):
        return None
    if mkl is not None and mkl.MKL_CBWR_Get(-1) in {0, 1}:
        mkl.MKL_CBWR_Set(CBWR_AUTO)
    return mkl


class BlockFactor:
    """LU factors of a matrix of 3 x 3 blocks, in single precision; a context manager, because the factors are not ours.

    Parameters
    ----------
    matrix : bsr_array, 3 x 3 blocks, sorted int32 indices
        Copied unless it is float32. It is let go of when the factors are there.
    memory : float, optional
        Bytes that may be used; without it any number.

    Raises
    ------
    TooLargeError
        The analysis says that the factors need more memory.
    ComputationError
        The library reports an error.
    """

    def __init__(self, matrix: sparse.bsr_array, memory: float | None = None) -> None:
        mkl = library()
        if mkl is None:
            raise ComputationError("the library of the mkl package is not there: install vasculo[fast]")
        self._mkl = mkl
        self._rows = matrix.shape[0] // 3
        self._memory = memory
        self._data = np.ascontiguousarray(matrix.data, dtype=np.float32)
        self._start = np.ascontiguousarray(matrix.indptr, dtype=np.int32)
        self._columns = np.ascontiguousarray(matrix.indices, dtype=np.int32)
        self._handle = np.zeros(64, dtype=np.int64)
        self._settings = np.zeros(64, dtype=np.int32)
        # One-based numbers in the library's manual: 1 own settings, 2 nested dissection (of the cells), 10 pivots below
        # 1e-13 are moved (none is), 28 single precision, 35 zero-based indices, 37 blocks of three. Scaling (11) and
        # matching (13) stay off: entries are of order one already.
        for number, setting in ((1, 1), (2, 2), (10, 13), (28, 1), (35, 1), (37, 3)):
            self._settings[number - 1] = setting

    def __enter__(self) -> Self:
        nothing = np.zeros(1, dtype=np.float32)
        try:
            began = perf_counter()
            self._call(ANALYSE, nothing, nothing)
            before, kept, factors = (1024 * int(size) for size in self._settings[14:17])
            self.needed = max(before, kept + factors)  # bytes, work space of the threads included
            self.analysis_seconds = perf_counter() - began
            check_memory(self.needed, self._memory, f"PARDISO on {3 * self._rows} unknowns")
            self._call(FACTOR, nothing, nothing)
            self.factor_seconds = perf_counter() - began - self.analysis_seconds
        except (ComputationError, InputError):
            self._call(RELEASE, nothing, nothing)
            raise
        if not self.moved_pivots:  # with moved pivots the library refines, for which it reads the matrix again
            self._data, self._columns = nothing, np.zeros(1, dtype=np.int32)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        nothing = np.zeros(1, dtype=np.float32)
        self._call(RELEASE, nothing, nothing)

    @property
    def bytes(self) -> int:
        """Bytes of the factors."""
        return 1024 * int(self._settings[16])

    @property
    def moved_pivots(self) -> int:
        """Pivots that were too small and had to be moved."""
        return int(self._settings[13])

    def solve(self, right: NDArray[np.float64]) -> NDArray[np.float64]:
        """Solve for one right-hand side; float64 (n,) in and out, accurate to single precision only."""
        given = np.ascontiguousarray(right, dtype=np.float32)
        found = np.empty_like(given)
        self._call(SOLVE, given, found)
        return found.astype(np.float64)

    def _call(self, phase: int, right: NDArray[np.float32], found: NDArray[np.float32]) -> None:
        def number(value: int) -> ctypes._CArgObject:
            return ctypes.byref(ctypes.c_int32(value))

        def array(values: np.ndarray) -> ctypes.c_void_p:
            return values.ctypes.data_as(ctypes.c_void_p)

        error = ctypes.c_int32(0)
        unused = np.zeros(1, dtype=np.int32)
        self._mkl.pardiso(
            array(self._handle), number(1), number(1), number(REAL_UNSYMMETRIC), number(phase), number(self._rows),
            array(self._data), array(self._start), array(self._columns), array(unused), number(1),
            array(self._settings), number(0), array(right), array(found), ctypes.byref(error),
        )  # fmt: skip
        if error.value:
            raise ComputationError(
                f"PARDISO stopped with error {error.value} in phase {phase} on {3 * self._rows} unknowns"
                + (": not enough memory, use fewer triangles" if error.value == -2 else "")
            )
