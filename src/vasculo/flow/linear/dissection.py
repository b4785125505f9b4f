"""Nested dissection (George 1973) of a graph whose nodes have places in the plane: an order with little fill."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numba import njit

if TYPE_CHECKING:
    from numpy.typing import NDArray

LEAF = 12  # so few nodes are not cut any more
MIDDLE = 0.35  # each side of a cut gets at least this share


@njit(cache=True, error_model="numpy", nogil=True)
def dissect(
    points: NDArray[np.float64],
    start: NDArray[np.int32],
    columns: NDArray[np.int32],
    order: NDArray[np.int32],
) -> int:
    """Fill `order` (t,): the nodes in the order of elimination; return how many cuts were made.

    `points` (t, 2) are their places; `start` (t + 1,), `columns` a symmetric pattern by rows.
    """
    # Strategy: nodes are sorted along x and along y. Of all straight cuts near the middle the one that crosses fewest
    # edges is taken: in a network it runs through pillars. The nodes beside it, on the side where they are fewer, come
    # last, and both sides are cut in the same way.
    nodes = len(points)
    order[:] = np.arange(nodes)
    owner = np.zeros(nodes, np.int32)  # piece of each node, -1 if it lies beside a cut
    rank = np.empty(nodes, np.int32)
    stack = [(0, nodes)]
    pieces = 0
    while len(stack) > 0:
        first, last = stack.pop()
        number = last - first
        if number <= LEAF:
            continue
        piece = order[first:last].copy()
        best, cut = -1, 0
        ranked = piece
        for axis in range(2):
            line = piece[np.argsort(points[piece, axis], kind="mergesort")]
            for i in range(number):
                rank[line[i]] = i
            change = np.zeros(number + 1, np.int32)
            for i in range(number):
                for k in range(start[line[i]], start[line[i] + 1]):
                    j = columns[k]
                    if owner[j] == owner[line[i]] and rank[j] > i:
                        change[i] += 1
                        change[rank[j]] -= 1
            crossed = 0
            for i in range(int((1.0 - MIDDLE) * number)):
                crossed += change[i]
                if i + 1 >= MIDDLE * number and (best < 0 or crossed < best):
                    best, cut, ranked = crossed, i + 1, line
        for i in range(number):
            rank[ranked[i]] = i
        beside = np.zeros(number, np.bool_)
        lower = upper = 0
        for i in range(number):
            for k in range(start[ranked[i]], start[ranked[i] + 1]):
                j = columns[k]
                if owner[j] == owner[ranked[i]] and (rank[j] < cut) != (i < cut):
                    beside[i] = True
            if beside[i] and i < cut:
                lower += 1
            elif beside[i]:
                upper += 1
        pieces += 2
        below, above, end = first, first, last
        for i in range(cut):
            above += not (beside[i] and lower <= upper)
        middle = above
        for i in range(number):
            c = ranked[i]
            if beside[i] and (i < cut) == (lower <= upper):
                end -= 1
                order[end], owner[c] = c, -1
            elif i < cut:
                order[below], owner[c] = c, pieces - 1
                below += 1
            else:
                order[above], owner[c] = c, pieces
                above += 1
        stack.append((first, middle))
        stack.append((middle, end))
    return pieces // 2


def dissect_plain(
    points: NDArray[np.float64], start: NDArray[np.int32], columns: NDArray[np.int32]
) -> NDArray[np.int32]:
    """Order of elimination with sets and recursion; the reference of `dissect`."""
    near = [set(columns[a:b].tolist()) for a, b in pairwise(start)]

    def ordered(piece: list[int]) -> list[int]:
        number = len(piece)
        if number <= LEAF:
            return piece
        cuts = []
        for axis in range(2):
            line = sorted(piece, key=lambda c: points[c, axis])
            for cut in range(int(np.ceil(MIDDLE * number)), int((1.0 - MIDDLE) * number) + 1):
                after = set(line[cut:])
                cuts.append((sum(len(near[c] & after) for c in line[:cut]), axis, cut, line))
        _, _, cut, line = min(cuts)
        low, high = line[:cut], line[cut:]
        lower = [c for c in low if near[c] & set(high)]
        upper = [c for c in high if near[c] & set(low)]
        beside = lower if len(lower) <= len(upper) else upper
        return [
            *ordered([c for c in low if c not in set(beside)]),
            *ordered([c for c in high if c not in set(beside)]),
            *reversed(beside),
        ]

    return np.array(ordered(list(range(len(points)))), dtype=np.int32)


def elimination_order(
    points: NDArray[np.float64], start: NDArray[np.int32], columns: NDArray[np.int32]
) -> NDArray[np.int32]:
    """Nodes of a planar graph in an order whose elimination fills little.

    Parameters
    ----------
    points : (t, 2) float64
        Places of the nodes, such as the centroids of cells.
    start, columns : (t + 1,), (k,) int32
        Neighbours of each node by rows, symmetric, sorted or not.

    Returns
    -------
    (t,) int32
    """
    order = np.empty(len(points), dtype=np.int32)
    dissect(points, start, columns, order)
    return order
