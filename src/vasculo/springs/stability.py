"""How long a time step may be.

A mode of stiffness k, mass m and damping D stays bounded under eqs. (2) and (3), with the new velocity in (3), when
k dt^2 < 4 m + 2 D dt. That is dt w < sqrt(4 + 2 D dt / m) with w^2 = k / m, or

    dt < (D + sqrt(D^2 + 4 m k)) / k.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import coo_array, diags_array, eye_array
from scipy.sparse.linalg import eigsh

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csr_array

    Ints = NDArray[np.int32]
    Floats = NDArray[np.float64]

ITERATIONS = 30
"""Most improvements of the sharp limit; with equal masses two are enough."""


def longest_step(stiffness: Floats, mass: Floats, damping: float) -> Floats:
    """Longest stable time step of single modes, from their stiffness, mass and damping; infinite without stiffness."""
    root = damping + np.hypot(damping, 2.0 * np.sqrt(mass * stiffness))
    return np.asarray(np.where(stiffness > 0.0, root / np.where(stiffness > 0.0, stiffness, 1.0), np.inf))


STEP_SHARE = 0.5
"""Share of the safe limit that a time step takes by itself: it keeps the error of the motion small."""


def chosen_step(limit: float) -> float:
    """Time step to take below a safe limit: half of it, rounded down so that round times are whole numbers of steps."""
    return rounded_down(STEP_SHARE * limit)


def rounded_down(value: float) -> float:
    """Largest of 1, 2, 5 times a power of ten that is not above a value > 0."""
    power = 10.0 ** np.floor(np.log10(value))
    digit = max(digit for digit in (1.0, 2.0, 5.0) if digit <= max(1.0, value / power * (1.0 + 1e-12)))
    return float(f"{digit * power:.0e}")


def node_stiffness(springs: Ints, stiffness: Floats, nodes: int, tether: float = 0.0) -> Floats:
    """Bound of the stiffness that a node can feel: twice the sum of its springs', and the tether (force a length).

    The matrix of all springs is below the diagonal matrix of these numbers, whatever the shape of the network, because
    (u_i - u_j)^2 <= 2 u_i^2 + 2 u_j^2 for each spring.

    Returns
    -------
    ndarray of float64, shape (n,)
    """
    felt = np.bincount(springs[:, 0], stiffness, nodes) + np.bincount(springs[:, 1], stiffness, nodes)
    return np.asarray(2.0 * felt + tether)


def sharp_limit(
    arms: Floats,
    springs: Ints,
    rest: Floats,
    stiffness: Floats,
    mass: Floats,
    damping: float,
    free: NDArray[np.bool_],
    tether: float,
) -> float:
    """Longest stable time step of small motions about the present shape.

    Compressed springs, which push nodes sideways, count as having no sideways stiffness: they never lower the limit.

    Returns
    -------
    float
        Model time; infinite when nothing pulls on a free node.
    """
    # Strategy: the limit is the dt at which 4 M + 2 D dt - K dt^2 loses its positive sign. For a given dt the worst
    # mode u is the top eigenvector of K against 4 M + 2 D dt; the limit of that one mode is the next dt.
    matrix = _stiffness_matrix(2 * len(mass), arms, springs, rest, stiffness, tether)
    keep = np.flatnonzero(np.repeat(free, 2))
    matrix = matrix[keep][:, keep]
    weights = np.repeat(mass, 2)[keep]
    if keep.size == 0 or matrix.diagonal().max() <= 0.0:
        return float("inf")
    dt = float(longest_step(2.0 * matrix.diagonal(), weights, damping).min())
    for _ in range(ITERATIONS):
        scale = 1.0 / np.sqrt(4.0 * weights + 2.0 * damping * dt)
        mode = scale * _top_mode((diags_array(scale) @ matrix @ diags_array(scale)).tocsr())
        stretch, inertia = mode @ (matrix @ mode), mode @ (weights * mode)
        last, dt = dt, float(longest_step(stretch, inertia, damping * float(mode @ mode)))
        if abs(dt - last) <= 1e-12 * dt:
            break
    return dt


def _stiffness_matrix(
    size: int, arms: Floats, springs: Ints, rest: Floats, stiffness: Floats, tether: float
) -> csr_array:
    """Sparse tangent stiffness (2 n, 2 n), sideways stiffness of compressed springs left out."""
    length = np.hypot(arms[:, 0], arms[:, 1])
    safe = np.where(length > 0.0, length, 1.0)
    along = np.where(length[:, None] > 0.0, arms / safe[:, None], np.array([1.0, 0.0]))
    sideways = np.where(length > 0.0, np.maximum(0.0, 1.0 - rest / safe), rest == 0.0)
    blocks = along[:, :, None] * along[:, None, :]
    blocks = stiffness[:, None, None] * (blocks + sideways[:, None, None] * (np.eye(2) - blocks))
    first, second = springs.T
    x_and_y = np.arange(2)
    entries = [
        (
            (sign * blocks).ravel(),
            np.broadcast_to(2 * row[:, None, None] + x_and_y[:, None], blocks.shape).ravel(),
            np.broadcast_to(2 * column[:, None, None] + x_and_y, blocks.shape).ravel(),
        )
        for row, column, sign in ((first, first, 1), (second, second, 1), (first, second, -1), (second, first, -1))
    ]
    values, rows, columns = (np.concatenate(parts) for parts in zip(*entries, strict=True))
    springs_only = coo_array((values, (rows, columns)), shape=(size, size)).tocsr()
    return (springs_only + tether * eye_array(size)).tocsr()


def _top_mode(matrix: csr_array) -> Floats:
    """Eigenvector of the largest eigenvalue of a symmetric sparse matrix; the same on every call."""
    size = matrix.shape[0]
    if size <= 64:
        return np.asarray(np.linalg.eigh(matrix.toarray())[1][:, -1])
    return np.asarray(eigsh(matrix, k=1, which="LA", v0=np.random.default_rng(0).standard_normal(size))[1][:, 0])
