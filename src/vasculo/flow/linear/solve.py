"""Solve A x = b: a direct factor, made exact by a few Krylov steps in double precision."""

from __future__ import annotations

from contextlib import contextmanager
from math import isfinite
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.sparse.linalg import splu

from vasculo.errors import ComputationError
from vasculo.flow.linear.pardiso import BlockFactor, library

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from numpy.typing import NDArray
    from scipy import sparse

    Solve = Callable[[NDArray[np.float64]], NDArray[np.float64]]

GOAL = 1e-13  # relative residual that ends the refinement
GOOD = 1e-12  # with this one a refinement that stands still may end too
LIMIT = 1e-9  # worse than this is no solution
CYCLES = 8
STEPS = 10  # Krylov vectors a cycle
STEP_GOAL = 1e-12  # a cycle cannot know its residual any better


class Solution(NamedTuple):
    """What `solve` returns.

    Parameters
    ----------
    unknowns : (n,) float64
    residual : float
        Norm of b - A x over the norm of b.
    solver : str
        "pardiso" or "splu".
    iterations : int
        Solves with the factor.
    """

    unknowns: NDArray[np.float64]
    residual: float
    solver: str
    iterations: int


def solve(matrix: sparse.bsr_array, right: NDArray[np.float64]) -> Solution:
    """Solve the system to a relative residual of 1e-13, or as near as rounding allows.

    Parameters
    ----------
    matrix : bsr_array, 3 x 3 blocks
    right : (n,) float64

    Raises
    ------
    ComputationError
        The residual stays above 1e-9 or is not finite.
    """
    size = norm(right)
    if not isfinite(size):
        raise ComputationError(
            f"{np.count_nonzero(~np.isfinite(right))} of the {len(right)} right-hand sides of the flow are not finite"
        )
    if size == 0.0:
        return Solution(np.zeros_like(right), 0.0, "none", 0)
    unknowns = np.zeros_like(right)
    residual, iterations = 1.0, 0
    left_over = right
    with _factor(matrix) as (solver, apply):
        for _ in range(CYCLES):
            change, steps = _krylov(matrix, left_over, apply, GOAL * size / norm(left_over))
            candidate = unknowns + change
            left_over_now = right - matrix @ candidate
            now = norm(left_over_now) / size
            iterations += steps
            if not now < residual:
                break
            slow = now > 0.5 * residual
            unknowns, residual, left_over = candidate, now, left_over_now
            if residual <= GOAL or (slow and residual <= GOOD):
                break
    if not residual <= LIMIT:
        raise ComputationError(
            f"the flow system of {len(right)} unknowns was solved to a residual of {residual:.2e} only, {LIMIT:.0e} is "
            f"needed ({solver}, {iterations} iterations): look for degenerate triangles, or a flow that no wall holds "
            "back"
        )
    return Solution(unknowns, float(residual), solver, iterations)


def norm(vector: NDArray[np.float64]) -> float:
    """Euclidean norm by NumPy's own sum, which does not depend on the number of threads."""
    return float(np.sqrt(np.sum(vector * vector)))


@contextmanager
def _factor(matrix: sparse.bsr_array) -> Iterator[tuple[str, Solve]]:
    """Name and solve function of the best factor at hand."""
    if library() is not None:
        with BlockFactor(matrix) as factor:
            yield "pardiso", factor.solve
    else:
        columns = matrix.tocsc()
        columns.eliminate_zeros()
        try:
            direct = splu(columns, permc_spec="COLAMD")
        except RuntimeError as error:
            raise ComputationError(f"the flow system of {matrix.shape[0]} unknowns is singular ({error})") from error
        yield "splu", direct.solve


def _krylov(
    matrix: sparse.bsr_array, right: NDArray[np.float64], apply: Solve, goal: float
) -> tuple[NDArray[np.float64], int]:
    """One cycle of flexible GMRES from zero, until the residual has fallen by `goal`; the change and its steps."""
    # Strategy: with a good factor each step is one of iterative refinement; the small least-squares problem only makes
    # sure that the residual never grows.
    size = norm(right)
    directions, images = [right / size], []
    upper = np.zeros((STEPS + 1, STEPS))
    weights: NDArray[np.float64] = np.zeros(0)
    for k in range(STEPS):
        images.append(apply(directions[k]))
        new = matrix @ images[k]
        for i in range(k + 1):
            upper[i, k] = np.sum(new * directions[i])
            new -= upper[i, k] * directions[i]
        upper[k + 1, k] = norm(new)
        if not isfinite(upper[k + 1, k]):
            images.pop()
            break
        first = np.zeros(k + 2)
        first[0] = size
        small = upper[: k + 2, : k + 1]
        weights = np.asarray(np.linalg.lstsq(small, first, rcond=None)[0], dtype=np.float64)
        left = norm(first - small @ weights) / size
        if not (left > max(goal, STEP_GOAL) and upper[k + 1, k] > 0.0):
            break
        directions.append(new / upper[k + 1, k])
    return sum((w * image for w, image in zip(weights, images, strict=True)), np.zeros_like(right)), len(images)
