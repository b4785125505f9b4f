"""The least cut of a graph between two sets of cells: as many faces as ways that share none (Menger; Dinic 1970)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Ints = NDArray[np.int32]


@njit(cache=True, error_model="numpy", nogil=True)
def spread(start: Ints, columns: Ints, part: Ints, seed: int, queue: Ints, away: Ints) -> int:
    """Go through the part of a cell by distance: fill `queue` and, where it was -1, `away`; return how many cells."""
    queue[0] = seed
    away[seed] = 0
    number, head = 1, 0
    while head < number:
        c = queue[head]
        head += 1
        for k in range(start[c], start[c + 1]):
            j = columns[k]
            if away[j] < 0 and part[j] == part[seed]:
                away[j] = away[c] + 1
                queue[number] = j
                number += 1
    return number


@njit(cache=True, error_model="numpy", nogil=True)
def cut_between(
    start: Ints,
    columns: Ints,
    back: Ints,
    part: Ints,
    piece: Ints,
    side: NDArray[np.int8],
    flow: NDArray[np.int8],
    level: Ints,
    place: Ints,
) -> int:
    """Cut a piece between the cells with 1 and those with 2 in `side`; return how many faces are cut.

    `level` (t,), -1 in the piece before, is -1 afterwards in all cells beyond the cut; of all least cuts it is the one
    nearest the first set. `flow` (k,) is zero before and after; `place` (t,) is overwritten in the piece.
    """
    # Strategy: every face carries one way, either direction. Levels count the faces from the first set along which
    # another way could go; then all ways that climb level by level to the second set are taken, and levels are made
    # anew, until the second set is out of reach.
    number = len(piece)
    queue, trail = np.empty(number, np.int32), np.empty(number, np.int32)
    total = 0
    while True:
        count = 0
        for i in range(number):
            c = piece[i]
            place[c] = start[c]
            level[c] = -1
            if side[c] == 1:
                level[c] = 0
                queue[count] = c
                count += 1
        sources, head, reached = count, 0, False
        while head < count and not reached:
            c = queue[head]
            head += 1
            for k in range(start[c], start[c + 1]):
                j = columns[k]
                if level[j] < 0 and part[j] == part[c] and flow[k] < 1:
                    level[j] = level[c] + 1
                    queue[count] = j
                    count += 1
                    reached = reached or side[j] == 2
        if not reached:
            break
        for i in range(sources):
            c, length = queue[i], 0
            while True:
                if side[c] == 2:  # a way was found: take it, and look for the next from the same source
                    for n in range(length):
                        flow[trail[n]] += 1
                        flow[back[trail[n]]] -= 1
                    total += 1
                    c, length = queue[i], 0
                    continue
                while place[c] < start[c + 1]:
                    k = place[c]
                    j = columns[k]
                    if part[j] == part[c] and flow[k] < 1 and level[j] == level[c] + 1:
                        break
                    place[c] += 1
                if place[c] < start[c + 1]:
                    trail[length] = place[c]
                    length += 1
                    c = columns[place[c]]
                elif length == 0:
                    break
                else:  # nothing behind this cell: back, and past it
                    length -= 1
                    c = columns[back[trail[length]]]
                    place[c] += 1
    for i in range(number):
        for k in range(start[piece[i]], start[piece[i] + 1]):
            flow[k] = 0
    return total
