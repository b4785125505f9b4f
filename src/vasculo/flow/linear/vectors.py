"""Sums over long vectors by threads, always in the same order."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from vasculo.springs.threads import run_team

if TYPE_CHECKING:
    from numpy.typing import NDArray

BLOCK = 4096  # entries summed in one go
FEW = 8  # blocks a thread; fewer are not worth another one


@njit(cache=True, error_model="numpy", nogil=True, fastmath={"reassoc", "contract"})
def block_products(
    rank: int,
    threads: int,
    vectors: NDArray[np.float64],
    count: int,
    other: NDArray[np.float64],
    out: NDArray[np.float64],
) -> int:
    """Inner products of the first `count` rows of `vectors` with `other`, by blocks, into `out` (blocks, count)."""
    for b in range(rank, len(out), threads):
        first, last = b * BLOCK, min((b + 1) * BLOCK, len(other))
        for k in range(count):
            total = 0.0
            for i in range(first, last):
                total += vectors[k, i] * other[i]
            out[b, k] = total
    return 0


@njit(cache=True, error_model="numpy", nogil=True)
def block_sums(
    rank: int,
    threads: int,
    vectors: NDArray[np.floating],
    factors: NDArray[np.float64],
    other: NDArray[np.float64],
) -> int:
    """Add to `other` the first rows of `vectors`, each times its factor."""
    for b in range(rank, (len(other) + BLOCK - 1) // BLOCK, threads):
        first, last = b * BLOCK, min((b + 1) * BLOCK, len(other))
        for k in range(len(factors)):
            for i in range(first, last):
                other[i] += factors[k] * vectors[k, i]
    return 0


def products(vectors: NDArray[np.float64], count: int, other: NDArray[np.float64]) -> NDArray[np.float64]:
    """Inner products of the first `count` rows of `vectors` (m, n) with `other` (n,); float64 (count,).

    The plain form is ``vectors[:count] @ other``, whose last bits may change with the number of threads; these do not.
    """
    blocks = (len(other) + BLOCK - 1) // BLOCK
    out = np.empty((blocks, count))
    run_team(block_products, blocks // FEW, vectors, count, other, out)
    return np.asarray(out.sum(axis=0))


def add_multiples(vectors: NDArray[np.floating], factors: NDArray[np.float64], other: NDArray[np.float64]) -> None:
    """Add to `other` (n,) the first rows of `vectors` (m, n), each times its factor (k,).

    The plain form is ``other += factors @ vectors[: len(factors)]``.
    """
    run_team(block_sums, len(other) // (BLOCK * FEW), vectors, factors, other)


def norm(vector: NDArray[np.float64]) -> float:
    """Euclidean norm of a contiguous vector."""
    return float(np.sqrt(products(vector[None], 1, vector)[0]))
