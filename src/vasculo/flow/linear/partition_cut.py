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

    `level` (t,), -1 in the piece before, is -1 afterwards in all cells on the side of the first set, and not in the
    others; of all least cuts it is the one nearest the second set. `flow` (k,) is zero before and after; `place` (t,)
    is overwritten in the piece.
    """
    # Strategy: every face carries one way, either direction. Levels count the faces to the second set along which
    # another way could go; then all ways that go down level by level are taken, and levels are made anew, until the
    # second set is out of reach. Only what lies between the sets is looked at, with their edges.
    number = len(piece)
    queue, trail = np.empty(number, np.int32), np.empty(number, np.int32)
    middle, sources, sinks = np.empty(number, np.int32), np.empty(number, np.int32), np.empty(number, np.int32)
    between = outs = ins = total = 0
    for i in range(number):
        c = piece[i]
        if side[c] == 0:
            middle[between] = c
            between += 1
            continue
        if side[c] == 2:
            level[c] = 0
        for k in range(start[c], start[c + 1]):
            if part[columns[k]] == part[c] and side[columns[k]] != side[c]:
                if side[c] == 1:
                    sources[outs] = c
                    outs += 1
                else:
                    sinks[ins] = c
                    ins += 1
                break
    while True:
        for i in range(between):
            level[middle[i]] = -1
            place[middle[i]] = start[middle[i]]
        for i in range(outs):
            level[sources[i]] = -1
            place[sources[i]] = start[sources[i]]
        queue[:ins] = sinks[:ins]
        count, head, most = ins, 0, number
        while head < count and level[queue[head]] < most:
            c = queue[head]
            head += 1
            for k in range(start[c], start[c + 1]):
                j = columns[k]
                if level[j] < 0 and part[j] == part[c] and flow[back[k]] < 1:
                    level[j] = level[c] + 1
                    if side[j] == 1:
                        most = level[j]
                    else:
                        queue[count] = j
                        count += 1
        if most == number:
            break
        for i in range(outs):
            c, length = sources[i], 0
            while level[sources[i]] > 0:
                if side[c] == 2:  # a way was found: take it, and look for the next from the same cell
                    for n in range(length):
                        flow[trail[n]] += 1
                        flow[back[trail[n]]] -= 1
                    total += 1
                    c, length = sources[i], 0
                    continue
                while place[c] < start[c + 1]:
                    k = place[c]
                    j = columns[k]
                    if part[j] == part[c] and flow[k] < 1 and level[j] == level[c] - 1:
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
