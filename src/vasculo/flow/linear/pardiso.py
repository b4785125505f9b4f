"""A direct solver by blocks in single precision: PARDISO of the optional `mkl` package, through its C interface."""

from __future__ import annotations

import ctypes
import weakref
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

    from vasculo.flow.linear.kept import KeptAnalysis

CBWR_AUTO = 2  # conditional numerical reproducibility on the best branch of this processor
REAL_UNSYMMETRIC = 11
ANALYSE, FACTOR, SOLVE, RELEASE, RELEASE_FACTORS = 11, 22, 33, -1, 0
HELD = 1.65  # times what the library says an analysis takes, once it has led to factors; measured
NOTHING, NO_COLUMNS = np.zeros(1, dtype=np.float32), np.zeros(1, dtype=np.int32)


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


class Analysis:
    """Order of elimination and symbolic factors of a block pattern, and the factors of one matrix that has it.

    They lie in the library's memory until `close`, or until nothing refers to this any more.

    Parameters
    ----------
    start, columns : (t + 1,), (k,) int32
        The pattern by rows of 3 x 3 blocks, columns sorted.

    Raises
    ------
    ComputationError
        The library is not there, or reports an error.
    """

    def __init__(self, start: NDArray[np.int32], columns: NDArray[np.int32]) -> None:
        self.start = np.ascontiguousarray(start, dtype=np.int32)
        self.columns = np.ascontiguousarray(columns, dtype=np.int32)
        self.settings = np.zeros(64, dtype=np.int32)
        # One-based numbers in the library's manual: 1 own settings, 2 nested dissection (of the cells), 10 pivots below
        # 1e-13 are moved (none is), 28 single precision, 35 zero-based indices, 37 blocks of three. Scaling (11) and
        # matching (13) stay off: entries are of order one already, and the analysis goes by the pattern alone.
        for number, setting in ((1, 1), (2, 2), (10, 13), (28, 1), (35, 1), (37, 3)):
            self.settings[number - 1] = setting
        self._handle = np.zeros(64, dtype=np.int64)
        self._end = weakref.finalize(
            self, _call, self._handle, self.settings, len(self.start) - 1, RELEASE, NO_COLUMNS, NO_COLUMNS
        )
        self._end.atexit = False
        began = perf_counter()
        try:
            self.call(ANALYSE)
        except ComputationError:
            self.close()
            raise
        self.seconds = perf_counter() - began
        before, kept, factors = (1024 * int(size) for size in self.settings[14:17])
        self.bytes = int(HELD * kept) + self.columns.nbytes + self.start.nbytes
        self.needed = max(before, kept + factors)  # bytes, work space of the threads included

    def fits(self, start: NDArray[np.int32], columns: NDArray[np.int32]) -> bool:
        """Whether this is the analysis of a pattern."""
        return np.array_equal(self.start, start) and np.array_equal(self.columns, columns)

    def call(self, phase: int, *arrays: NDArray[np.float32]) -> None:
        """Call the library: with the entries of the matrix, and the right-hand side and room for the solution."""
        _call(self._handle, self.settings, len(self.start) - 1, phase, self.start, self.columns, *arrays)

    def close(self) -> None:
        """Give all memory back; the analysis is of no use afterwards."""
        self._end()


class BlockFactor:
    """LU factors of a matrix of 3 x 3 blocks, in single precision; a context manager, because the factors are not ours.

    Parameters
    ----------
    matrix : bsr_array, 3 x 3 blocks, sorted int32 indices
        Copied unless it is float32. It is let go of when the factors are there.
    memory : float, optional
        Bytes that may be used; without it any number.
    kept : KeptAnalysis, optional
        Where the analysis comes from, if the pattern is the same, and where it goes afterwards. The factors are the
        same to the last bit.

    Raises
    ------
    TooLargeError
        The analysis says that the factors need more memory.
    ComputationError
        The library reports an error.
    """

    def __init__(self, matrix: sparse.bsr_array, memory: float | None = None, kept: KeptAnalysis | None = None) -> None:
        if library() is None:
            raise ComputationError("the library of the mkl package is not there: install vasculo[fast]")
        self._data = np.ascontiguousarray(matrix.data, dtype=np.float32)
        self._start = np.ascontiguousarray(matrix.indptr, dtype=np.int32)
        self._columns = np.ascontiguousarray(matrix.indices, dtype=np.int32)
        self._memory, self._kept = memory, kept

    def __enter__(self) -> Self:
        found = None if self._kept is None else self._kept.take(self._start, self._columns)
        self._analysis = found or Analysis(self._start, self._columns)
        self.is_kept = found is not None
        self.analysis_seconds = 0.0 if found else self._analysis.seconds
        self.needed = self._analysis.needed
        try:
            check_memory(self.needed, self._memory, f"PARDISO on {3 * (len(self._start) - 1)} unknowns")
            began = perf_counter()
            self._analysis.call(FACTOR, self._data)
            self.factor_seconds = perf_counter() - began
        except (ComputationError, InputError):
            self._analysis.close()
            raise
        self._columns = NO_COLUMNS
        if not self.moved_pivots:  # with moved pivots the library refines, for which it reads the matrix again
            self._data = NOTHING
            if self._kept is None:
                self._analysis.columns = NO_COLUMNS
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._kept is None or error is not None:
            self._analysis.close()
        else:
            self._analysis.call(RELEASE_FACTORS)
            self._kept.keep(self._analysis)

    @property
    def bytes(self) -> int:
        """Bytes of the factors."""
        return 1024 * int(self._analysis.settings[16])

    @property
    def moved_pivots(self) -> int:
        """Pivots that were too small and had to be moved."""
        return int(self._analysis.settings[13])

    def solve(self, right: NDArray[np.float64]) -> NDArray[np.float64]:
        """Solve for one right-hand side; float64 (n,) in and out, accurate to single precision only."""
        given = np.ascontiguousarray(right, dtype=np.float32)
        found = np.empty_like(given)
        self._analysis.call(SOLVE, self._data, given, found)
        return found.astype(np.float64)


def _call(
    handle: NDArray[np.int64],
    settings: NDArray[np.int32],
    rows: int,
    phase: int,
    start: NDArray[np.int32],
    columns: NDArray[np.int32],
    data: NDArray[np.float32] = NOTHING,
    right: NDArray[np.float32] = NOTHING,
    found: NDArray[np.float32] = NOTHING,
) -> None:
    """Call the library; what a phase does not read may be left out."""

    def number(value: int) -> ctypes._CArgObject:
        return ctypes.byref(ctypes.c_int32(value))

    def array(values: np.ndarray) -> ctypes.c_void_p:
        return values.ctypes.data_as(ctypes.c_void_p)

    mkl = library()
    if mkl is None:
        raise ComputationError("the library of the mkl package is not there: install vasculo[fast]")
    error = ctypes.c_int32(0)
    mkl.pardiso(
        array(handle), number(1), number(1), number(REAL_UNSYMMETRIC), number(phase), number(rows), array(data),
        array(start), array(columns), array(NO_COLUMNS), number(1), array(settings), number(0), array(right),
        array(found), ctypes.byref(error),
    )  # fmt: skip
    if error.value:
        raise ComputationError(
            f"PARDISO stopped with error {error.value} in phase {phase} on {3 * rows} unknowns"
            + (": not enough memory, use fewer triangles" if error.value == -2 else "")
        )
