"""Hooke forces of a spring network (eq. 1), node by node.

Springs are stored as half-springs, sorted by node: node i owns the rows start[i] to start[i + 1], one for each spring
that ends there. Each spring is computed from both of its ends. That doubles the arithmetic and leaves no write
conflict: every node sums its own force, always in the same order.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numba import njit

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Ints = NDArray[np.int32]
    Floats = NDArray[np.float64]


class Adjacency(NamedTuple):
    """Half-springs sorted by node, within a node by spring number.

    Attributes
    ----------
    start : ndarray of int32, shape (n + 1,)
        Node i owns the rows start[i] to start[i + 1].
    neighbour : ndarray of int32, shape (2 m,)
        Node at the other end of each half-spring.
    spring : ndarray of int32, shape (2 m,)
        Spring of each half-spring: `stiffness[spring]` spreads a value a spring to its two halves.
    """

    start: Ints
    neighbour: Ints
    spring: Ints


def build_adjacency(springs: Ints, nodes: int) -> Adjacency:
    """Sort the ends of the springs by node.

    Parameters
    ----------
    springs : ndarray of int32, shape (m, 2)
        Node indices of each spring, from 0 to nodes - 1; not checked here.
    nodes : int
        Number of nodes n.

    Returns
    -------
    Adjacency
        Rows of a node stand in the order of the spring numbers.
    """
    pairs = np.ascontiguousarray(springs, dtype=np.int32).reshape(-1, 2)
    table = Adjacency(
        np.zeros(nodes + 1, dtype=np.int32), np.empty(pairs.size, dtype=np.int32), np.empty(pairs.size, dtype=np.int32)
    )
    sort_half_springs(pairs, *table)
    return table


@njit(cache=True, error_model="numpy")
def sort_half_springs(springs, start, neighbour, spring):  # type: ignore[no-untyped-def]
    """Sort spring ends by node, counting them; overwrites start (zeros at entry), neighbour and spring."""
    for s in range(springs.shape[0]):
        start[springs[s, 0]] += 1
        start[springs[s, 1]] += 1
    # Strategy: turn counts into row ends, then fill each row from its end while the springs run backwards; the
    # row ends move down to the row starts.
    for i in range(1, start.size):
        start[i] += start[i - 1]
    for s in range(springs.shape[0] - 1, -1, -1):
        for end in range(2):
            i = springs[s, end]
            start[i] -= 1
            neighbour[start[i]] = springs[s, 1 - end]
            spring[start[i]] = s


def sort_half_springs_plain(springs: Ints, start: Ints, neighbour: Ints, spring: Ints) -> None:
    """NumPy twin of `sort_half_springs`."""
    ends = springs.ravel()
    order = np.argsort(ends, kind="stable")
    start[:] = np.searchsorted(ends[order], np.arange(start.size))
    neighbour[:] = springs[:, ::-1].ravel()[order]
    spring[:] = order // 2


@njit(cache=True, error_model="numpy")
def hooke_forces(points, start, neighbour, stiffness, rest, out):  # type: ignore[no-untyped-def]
    """Sum of the spring forces on each node, stiffness (length - rest) along the spring; overwrites out.

    Parameters
    ----------
    points : ndarray of float64, shape (n, 2)
        Positions (model length).
    start : ndarray of int32, shape (n + 1,)
        Rows of each node.
    neighbour : ndarray of int32, shape (h,)
        Node at the other end of each half-spring.
    stiffness, rest : ndarray of float64, shape (h,)
        Stiffness (force a length) and rest length (model length) of each half-spring.
    out : ndarray of float64, shape (n, 2)
        Overwritten with the forces. A spring of zero length has no direction and pulls nowhere.

    Notes
    -----
    The elastic term of Szczerba & Szekely 2005, eq. (1), with a rest length (theirs is written without one).
    """
    for i in range(start.size - 1):
        x = points[i, 0]
        y = points[i, 1]
        fx = 0.0
        fy = 0.0
        for h in range(start[i], start[i + 1]):
            j = neighbour[h]
            dx = points[j, 0] - x
            dy = points[j, 1] - y
            length = np.sqrt(dx * dx + dy * dy)
            pull = stiffness[h] * (length - rest[h]) / length if length > 0.0 else 0.0
            fx += pull * dx
            fy += pull * dy
        out[i, 0] = fx
        out[i, 1] = fy


def hooke_forces_plain(
    points: Floats, start: Ints, neighbour: Ints, stiffness: Floats, rest: Floats, out: Floats
) -> None:
    """NumPy twin of `hooke_forces`."""
    node = np.repeat(np.arange(start.size - 1), np.diff(start))
    arms = points[neighbour] - points[node]
    length = np.hypot(arms[:, 0], arms[:, 1])
    pull = stiffness * (length - rest) / np.where(length > 0.0, length, 1.0)
    for axis in range(2):
        out[:, axis] = np.bincount(node, weights=pull * arms[:, axis], minlength=start.size - 1)
