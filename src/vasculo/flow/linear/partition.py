"""Connected parts of about equal size of a graph of cells, cut where few faces lie: across narrow channels."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from vasculo.errors import InputError
from vasculo.flow.linear.partition_cut import cut_between, spread

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Ints = NDArray[np.int32]

END = 0.35  # share of a piece that is kept together at either end of it


def partition(start: Ints, columns: Ints, most: int = 10_000) -> Ints:
    """Divide a graph of cells into connected parts.

    Parameters
    ----------
    start, columns : (t + 1,), (k,) int32
        Neighbours of each cell by rows, sorted and symmetric, such as the pattern of the compact matrix; the cell
        itself may be among them.
    most : int
        Most cells of a part. Parts of a connected graph mostly have more than a third of this.

    Returns
    -------
    (t,) int32
        Part of each cell, numbered by their lowest cells.

    Raises
    ------
    InputError
        `most` is below 1.

    Notes
    -----
    Recursive bisection by least cuts between the two far ends of a piece; the time grows like t log(t / most).
    """
    if most < 1:
        raise InputError(f"most is {most} cells a part, expected 1 or more")
    part = np.empty(len(start) - 1, dtype=np.int32)
    cut_graph(start, columns, mirror_entries(start, columns), most, part)
    return part


@njit(cache=True, error_model="numpy", nogil=True)
def mirror_entries(start: Ints, columns: Ints) -> Ints:
    """Where the entry (j, i) stands, for each entry (i, j) of a symmetric pattern by sorted rows; (k,) int32."""
    # Strategy: going through the rows in order, the entries of each column come in the order of its own row.
    back = np.empty(len(columns), np.int32)
    place = start[:-1].copy()
    for i in range(len(start) - 1):
        for k in range(start[i], start[i + 1]):
            back[k] = place[columns[k]]
            place[columns[k]] += 1
    return back


@njit(cache=True, error_model="numpy", nogil=True)
def cut_graph(start: Ints, columns: Ints, back: Ints, most: int, part: Ints) -> int:
    """Fill `part` (t,) and return how many parts there are; `back` as from `mirror_entries`."""
    # Strategy: of a piece that is too large, two cells far from each other are found. The third nearest the one and the
    # third nearest the other are ends that stay together; between them as few faces as possible are cut. Both ends are
    # connected, so both sides of a least cut are: cells cut off from their end would change sides and shorten the cut.
    cells = len(start) - 1
    part[:] = 0
    queue, other = np.empty(cells, np.int32), np.empty(cells, np.int32)
    away, level = np.full(cells, -1, np.int32), np.full(cells, -1, np.int32)
    side = np.zeros(cells, np.int8)
    flow = np.zeros(len(columns), np.int8)
    stack = [np.int32(c) for c in range(0)]
    pieces = 0
    for c in range(cells):
        if part[c] == 0:
            pieces += 1
            stack.append(np.int32(c))
            number = spread(start, columns, part, c, queue, away)
            for i in range(number):
                part[queue[i]], away[queue[i]] = pieces, -1
    while len(stack) > 0:
        seed = stack.pop()
        number = spread(start, columns, part, seed, queue, away)
        one = queue[number - 1]
        for i in range(number):
            away[queue[i]] = -1
        if number <= most:
            continue
        spread(start, columns, part, one, queue, away)
        two = queue[number - 1]
        spread(start, columns, part, two, other, level)
        piece = queue[:number].copy()
        mark_ends(piece, away, level, side)
        for i in range(number):
            level[piece[i]] = -1
        cut_between(start, columns, back, part, piece, side, flow, level, away)
        pieces += 1
        for i in range(number):
            if level[piece[i]] < 0:
                part[piece[i]] = pieces
        for i in range(number):
            level[piece[i]], away[piece[i]], side[piece[i]] = -1, -1, 0
        stack.append(one)
        stack.append(two)
    # numbers in the order of the lowest cells
    name = np.full(pieces + 1, -1, np.int32)
    count = 0
    for c in range(cells):
        if name[part[c]] < 0:
            name[part[c]] = count
            count += 1
        part[c] = name[part[c]]
    return count


@njit(cache=True, error_model="numpy", nogil=True)
def mark_ends(piece: Ints, away: Ints, beyond: Ints, side: NDArray[np.int8]) -> None:
    """Mark the cells near the first cell of a piece, 1 in `side`, and those near its last, 2; both sets are connected.

    `away` and `beyond` are the distances from the first and from the last.
    """
    # Strategy: on the shortest way to the first cell the difference of the two distances never grows, and the distance
    # itself falls. So the first cells in the order of difference and then distance are connected; and from the other
    # end all of larger differences, then those of the same difference nearest the end.
    number = len(piece)
    key = np.empty(number, np.int64)
    for i in range(number):
        key[i] = np.int64(away[piece[i]] - beyond[piece[i]]) * number + away[piece[i]]
    line = piece[np.argsort(key, kind="mergesort")]
    size = max(1, int(END * number))
    for i in range(size):
        side[line[i]] = 1
    last = away[line[size - 1]] - beyond[line[size - 1]]
    stop, left = number, size
    while left > 0:
        rank = stop - 1
        here = away[line[rank]] - beyond[line[rank]]
        if here <= last:
            break
        while away[line[rank - 1]] - beyond[line[rank - 1]] == here:
            rank -= 1
        for i in range(rank, min(stop, rank + left)):
            side[line[i]] = 2
        left -= stop - rank
        stop = rank
