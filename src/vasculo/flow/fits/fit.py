"""Least squares at a face: weights of the data in a linear functional of the fitted polynomial."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

if TYPE_CHECKING:
    from numpy.typing import NDArray

# Polynomials in the face axes (xi along the face, zeta along its normal, both over the face length, origin at the
# middle): exponents of xi and zeta of each term.
QUADRATIC, AT_REST, OUTFLOW, LINEAR, SHEAR = range(5)
TERMS = (
    ((0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)),  # QUADRATIC: velocity at an inner face
    ((0, 1), (1, 1), (0, 2)),  # AT_REST: what is left when the values on the face are given
    ((0, 0), (1, 0), (2, 0), (0, 2)),  # OUTFLOW: normal velocity where its normal derivative is zero
    ((0, 0), (1, 0), (0, 1)),  # LINEAR: pressure, and velocity as the first fallback
    ((0, 1),),  # SHEAR: the first fallback beside AT_REST
)
SIZES = np.array([len(terms) for terms in TERMS], dtype=np.int64)
POWERS = np.zeros((5, 6, 2), dtype=np.int64)
for _k, _terms in enumerate(TERMS):
    POWERS[_k, : len(_terms)] = _terms

DEPENDENT = 1e-14  # a column this short after scaling and clearing is dependent on the others
DEGENERATE = 1e30  # condition then reported


@njit(cache=True, error_model="numpy", nogil=True)
def term(family: int, k: int, xi: float, zeta: float) -> float:
    """Value of term `k` of a family of polynomials."""
    value = 1.0
    for _ in range(POWERS[family, k, 0]):
        value *= xi
    for _ in range(POWERS[family, k, 1]):
        value *= zeta
    return value


@njit(cache=True, error_model="numpy", nogil=True)
def make_unit(work: NDArray[np.float64], rows: int, k: int) -> float:
    """Scale column `k` (a row of `work`, overwritten) to length one over its first `rows`; return its old length."""
    total = 0.0
    for j in range(rows):
        total += work[k, j] ** 2
    length = np.sqrt(total)
    for j in range(rows + 2):
        work[k, j] /= length
    return length


@njit(cache=True, error_model="numpy", nogil=True)
def clear(work: NDArray[np.float64], rows: int, k: int, unit: int) -> None:
    """Make column `k` (overwritten) orthogonal to the column `unit` of length one."""
    dot = 0.0
    for j in range(rows):
        dot += work[k, j] * work[unit, j]
    for j in range(rows + 2):
        work[k, j] -= dot * work[unit, j]


@njit(cache=True, error_model="numpy", nogil=True)
def fit_weights(
    family: int,
    rows: int,
    at: NDArray[np.float64],
    weight: NDArray[np.float64],
    goals: NDArray[np.float64],
    work: NDArray[np.float64],
) -> float:
    """Weights of the data in two functionals of a weighted least-squares polynomial.

    Parameters
    ----------
    family : int
        Which polynomial.
    rows : int
        Number of data.
    at : (>= rows, 2) float64
        Where they are, xi and zeta.
    weight : (>= rows,) float64
        Factor of each equation.
    goals : (2, 6) float64
        The functionals: factors of the polynomial's coefficients.
    work : (8, >= rows + 2) float64
        Overwritten. The result is in rows 6 and 7: ``goals[g] . coefficients == sum(work[6 + g] * data)``.

    Returns
    -------
    float
        Condition estimate of the column-scaled system; DEGENERATE if it cannot be solved (then `work` has no result).
    """
    # Strategy: modified Gram-Schmidt on the columns of the weighted matrix W M, scaled to length one, the longest
    # remaining one next, each made orthogonal a second time when its turn comes. The functionals ride along as two more
    # rows that take part in every column operation but in no product: when the columns have become Q they have become
    # goal R^-1, and goal . c = (goal R^-1) . Q^T W data. No R is kept and no triangular system solved.
    columns = SIZES[family]
    if rows < columns:
        return DEGENERATE
    for k in range(columns):
        for j in range(rows):
            work[k, j] = weight[j] * term(family, k, at[j, 0], at[j, 1])
        work[k, rows], work[k, rows + 1] = goals[0, k], goals[1, k]
        if not make_unit(work, rows, k) > 0.0:
            return DEGENERATE
    smallest = 1.0
    done = 0
    for _ in range(columns):
        pivot, longest = 0, -1.0
        for k in range(columns):
            if not done >> k & 1:
                total = 0.0
                for j in range(rows):
                    total += work[k, j] ** 2
                if total > longest:
                    pivot, longest = k, total
        for k in range(columns):
            if done >> k & 1:
                clear(work, rows, pivot, k)
        smallest = min(smallest, make_unit(work, rows, pivot))
        if not smallest > DEPENDENT:
            return DEGENERATE
        done |= 1 << pivot
        for k in range(columns):
            if not done >> k & 1:
                clear(work, rows, k, pivot)
    for goal in range(2):
        for j in range(rows):
            value = 0.0
            for k in range(columns):
                value += work[k, rows + goal] * work[k, j]
            work[6 + goal, j] = value * weight[j]
    return 1.0 / smallest


def fit_weights_plain(
    family: int, at: NDArray[np.float64], weight: NDArray[np.float64], goals: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Compute the same weights by ``np.linalg.lstsq``; the reference of `fit_weights`.

    Parameters
    ----------
    family : int
        Which polynomial.
    at : (rows, 2) float64
        Where the data are.
    weight : (rows,) float64
        Factor of each equation.
    goals : (2, terms) float64
        The functionals.

    Returns
    -------
    (2, rows) float64
    """
    matrix = np.column_stack([at[:, 0] ** p * at[:, 1] ** q for p, q in TERMS[family]])
    inverse, _, _, _ = np.linalg.lstsq(matrix * weight[:, None], np.diag(weight), rcond=None)
    return np.asarray(goals @ inverse)
