"""How many blocks a factor will have, from the pattern alone."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numba import njit

if TYPE_CHECKING:
    from numpy.typing import NDArray


@njit(cache=True, error_model="numpy", nogil=True)
def count_fill(order: NDArray[np.int32], start: NDArray[np.int32], columns: NDArray[np.int32]) -> int:
    """Count the entries below the diagonal of the factor L of a symmetric pattern, eliminated in this order.

    `order` (t,) lists the nodes; `start` (t + 1,), `columns` is the pattern by rows.
    """
    # Strategy (Liu 1990): row i of L is the part of the elimination tree between the nodes that row i of the pattern
    # names and i itself. The tree grows row by row, each walk stops where this row has been before, so the work is one
    # step an entry.
    nodes = len(order)
    place = np.empty(nodes, np.int32)
    for i in range(nodes):
        place[order[i]] = i
    above = np.full(nodes, -1, np.int32)
    visited = np.full(nodes, -1, np.int32)
    total = 0
    for i in range(nodes):
        visited[i] = i
        for k in range(start[order[i]], start[order[i] + 1]):
            j = place[columns[k]]
            while j < i and visited[j] != i:
                visited[j] = i
                total += 1
                if above[j] < 0:
                    above[j] = i
                j = above[j]
    return total


def count_fill_plain(order: NDArray[np.int32], start: NDArray[np.int32], columns: NDArray[np.int32]) -> int:
    """Count by eliminating node after node, joining all its later neighbours; the reference of `count_fill`."""
    near = [set(columns[a:b].tolist()) for a, b in pairwise(start)]
    total, left = 0, set(order.tolist())
    for node in order.tolist():
        left.remove(node)
        later = near[node] & left
        total += len(later)
        for other in later:
            near[other] |= later - {other}
    return total
