"""Solve A x = b: a factor in single precision, of A or of a matrix near it, made exact by Krylov steps in double."""

from __future__ import annotations

from contextlib import contextmanager
from math import isfinite
from time import perf_counter
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from vasculo.errors import ComputationError, InputError
from vasculo.flow.linear.choose import COMPACT, advice, candidates, left_for_factors
from vasculo.flow.linear.compact import compact_matrix
from vasculo.flow.linear.jacobi import inverse_diagonal, jacobi_step
from vasculo.flow.linear.krylov import refine
from vasculo.flow.linear.memory import TooLargeError, available_memory
from vasculo.flow.linear.pardiso import BlockFactor
from vasculo.flow.linear.partition import partition
from vasculo.flow.linear.schwarz import SchwarzFactor
from vasculo.flow.linear.superlu import ScipyFactor
from vasculo.flow.linear.vectors import norm

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray
    from scipy import sparse

    from vasculo.flow.assemble import System
    from vasculo.flow.linear.kept import KeptAnalysis
    from vasculo.mesh.triangulation import Triangulation

GOAL = 1e-13  # relative residual with a factor of A itself
GOOD = 1e-12  # with this one a refinement that stands still may end too
COMPACT_GOAL = 1e-11  # with a factor of the compact matrix: mass then balances to 1e-8 and far better
LIMIT = 1e-9  # worse than this is no solution, unless a looser tolerance was asked for
WEIGHT = 0.4  # of the block-Jacobi step; from 0.8 on rough modes grow
STEPS, COMPACT_STEPS = 10, 40  # Krylov vectors a cycle
MOST, COMPACT_MOST = 40, 150  # steps in all


class Solution(NamedTuple):
    """What `solve` returns.

    Parameters
    ----------
    unknowns : (n,) float64
    residual : float
        Norm of b - A x over the norm of b.
    solver : str
        "direct", "compact", "splu", "splu-compact", "schwarz", or "none" if there was nothing to solve.
    iterations : int
        Solves with the factor.
    analysis_seconds, factor_seconds, krylov_seconds : float
        By the clock: ordering and symbolic work, the numbers of the factor, the steps.
    factor_bytes : int
    analysis : {"anew", "kept", "none"}
        Whether the analysis was made for this matrix or kept from one before.
    why : str
        Why this solver, in one line.
    note : str
        Advice for next time, in one line; mostly empty.
    """

    unknowns: NDArray[np.float64]
    residual: float
    solver: str
    iterations: int
    analysis_seconds: float = 0.0
    factor_seconds: float = 0.0
    krylov_seconds: float = 0.0
    factor_bytes: int = 0
    analysis: str = "none"
    why: str = ""
    note: str = ""


def solve(
    system: System,
    mesh: Triangulation,
    *,
    solver: str = "auto",
    tolerance: float | None = None,
    memory: float | None = None,
    kept: KeptAnalysis | None = None,
) -> Solution:
    """Solve the system of a flow.

    Parameters
    ----------
    system : System
    mesh : Triangulation
    solver : str
        "direct": PARDISO on A. "compact": PARDISO on the compact matrix, for less memory. "splu", "splu-compact": the
        same with SciPy's SuperLU. "schwarz": parts of the compact matrix, see `SchwarzFactor`. "auto": the quickest of
        the first four that is at hand and fits the memory.
    tolerance : float, optional
        Relative residual that must be reached. Without it 1e-13, or as near as rounding allows, with a factor of A, and
        1e-11 with one of the compact matrix; 1e-9 will do.
    memory : float, optional
        Bytes that the solution may take, with its factors; without it what is free.
    kept : KeptAnalysis, optional
        Use its analysis where the pattern of the matrix is the same, and leave the one of this matrix in it.

    Raises
    ------
    InputError
        An unknown or missing solver, a tolerance that cannot be, too little memory (`TooLargeError`).
    ComputationError
        The right-hand side is not finite, or the residual stays too large.
    """
    _check(tolerance, memory)
    right, cells = system.right, system.cells
    names = candidates(solver, cells)
    size = norm(right)
    if not isfinite(size):
        raise ComputationError(
            f"{np.count_nonzero(~np.isfinite(right))} of the {len(right)} right-hand sides of the flow are not finite"
        )
    if size == 0.0:
        return Solution(np.zeros_like(right), 0.0, "none", 0, why="nothing drives the flow")
    allowed = available_memory() if memory is None else memory
    failures: list[ComputationError | InputError] = []
    for name in names:
        try:
            found = _solve(system, mesh, name, tolerance, left_for_factors(name, cells, allowed), kept)
        except TooLargeError as error:
            failures.append(error)
        except ComputationError as error:
            if name not in COMPACT:
                raise
            failures.append(error)
        else:
            choice = "the first choice" if solver == "auto" else "asked for"
            reason = f"since {failures[-1]}" if failures else choice
            free = "" if allowed is None else f" with {allowed / 1e9:.3g} GB free"
            return found._replace(why=f"{name} for {cells} triangles{free}: {reason}", note=advice(name, cells))
    raise failures[-1]


def _check(tolerance: float | None, memory: float | None) -> None:
    """Refuse what cannot be reached or makes no sense."""
    if tolerance is not None and not GOAL <= tolerance <= 0.1:
        raise InputError(f"tolerance is {tolerance!r}: give a relative residual from {GOAL:.0e} to 0.1")
    if memory is not None and not memory > 0:
        raise InputError(f"memory is {memory!r}: give bytes, more than 0")


def _solve(
    system: System,
    mesh: Triangulation,
    name: str,
    tolerance: float | None,
    memory: float | None,
    kept: KeptAnalysis | None,
) -> Solution:
    """Solve by one of the solvers."""
    near = name in COMPACT
    inverse = inverse_diagonal(system.blocks()) if near else None
    matrix = compact_matrix(mesh, system) if near else system.blocks()
    with _factor(name, matrix, mesh, memory, kept) as factor:
        del matrix

        def precondition(right: NDArray[np.float64]) -> NDArray[np.float64]:
            found = factor.solve(right)
            if inverse is not None:
                jacobi_step(inverse, WEIGHT, right, system.apply(found), found)
            return found

        began = perf_counter()
        found = refine(
            system.apply, system.right, precondition, goal=tolerance or (COMPACT_GOAL if near else GOAL),
            good=tolerance or GOOD, steps=COMPACT_STEPS if near else STEPS, most=COMPACT_MOST if near else MOST,
        )  # fmt: skip
        seconds = factor.analysis_seconds, factor.factor_seconds, perf_counter() - began
    limit = tolerance or LIMIT
    if not found.residual <= limit:
        raise ComputationError(
            f"the flow system of {len(system.right)} unknowns was solved to a residual of {found.residual:.2e} only, "
            f"{limit:.0e} is needed ({name}, {found.iterations} iterations): look for degenerate triangles, or a flow "
            "that no wall holds back"
        )
    return Solution(found.unknowns, found.residual, name, found.iterations, *seconds, factor.bytes, factor.analysis)


class _Factor(NamedTuple):
    """What is known of a factor: its solve function, seconds of its two phases, bytes, where the analysis is from."""

    solve: Callable[[NDArray[np.float64]], NDArray[np.float64]]
    analysis_seconds: float
    factor_seconds: float
    bytes: int
    analysis: str = "anew"


@contextmanager
def _factor(
    name: str, matrix: sparse.bsr_array, mesh: Triangulation, memory: float | None, kept: KeptAnalysis | None
) -> Iterator[_Factor]:
    """Factor a matrix in the way of a solver."""
    if name == "schwarz":
        began = perf_counter()
        part = partition(matrix.indptr, matrix.indices)
        between = perf_counter()
        with SchwarzFactor(matrix, part) as parts:
            yield _Factor(parts.solve, between - began, perf_counter() - between, parts.bytes)
        return
    if name.startswith("splu"):
        with ScipyFactor(matrix, mesh.centroids, memory) as scipy_factor:
            del matrix
            yield _Factor(
                scipy_factor.solve, scipy_factor.analysis_seconds, scipy_factor.factor_seconds, scipy_factor.bytes
            )
        return
    make = BlockFactor(matrix, memory, kept)
    del matrix
    with make as factor:
        where = "kept" if factor.is_kept else "anew"
        yield _Factor(factor.solve, factor.analysis_seconds, factor.factor_seconds, factor.bytes, where)
