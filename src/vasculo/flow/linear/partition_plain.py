"""Plain twin of the partition: pieces as lists, distances by sets, least cuts by SciPy's largest flow."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from scipy import sparse

from vasculo.flow.linear.partition import END

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Ints = NDArray[np.int32]


def partition_plain(start: Ints, columns: Ints, most: int) -> NDArray[np.int64]:
    """Part of each cell; the reference of `partition`."""
    near = [columns[a:b].tolist() for a, b in pairwise(start)]
    label = np.full(len(near), -1)

    def cut(seed: int, piece: set[int]) -> None:
        line = list(distances(near, piece, seed))
        if len(line) <= most:
            label[line] = label.max() + 1
            return
        away = distances(near, piece, line[-1])
        line = list(away)
        ends = ends_plain(line, away, distances(near, piece, line[-1]))
        beyond = beyond_cut(near, line, *ends)
        cut(line[0], piece - beyond)
        cut(line[-1], beyond)

    while (label < 0).any():
        seed = int(np.argmax(label < 0))
        cut(seed, set(distances(near, set(np.flatnonzero(label < 0).tolist()), seed)))
    _, first, which = np.unique(label, return_index=True, return_inverse=True)
    return np.asarray(np.argsort(np.argsort(first))[which])


def distances(near: list[list[int]], piece: set[int], seed: int) -> dict[int, int]:
    """Distance of every cell of a piece that can be reached from one, in the order in which they are."""
    found = {seed: 0}
    for cell in (line := [seed]):
        new = [j for j in near[cell] if j in piece and j not in found]
        found.update(dict.fromkeys(new, found[cell] + 1))
        line.extend(new)
    return found


def ends_plain(line: list[int], away: dict[int, int], beyond: dict[int, int]) -> tuple[set[int], set[int]]:
    """Cells near the first cell of a line, and those near its last; the reference of `mark_ends`."""
    difference = {c: away[c] - beyond[c] for c in line}
    size = max(1, int(END * len(line)))
    first = sorted(line, key=lambda c: (difference[c], away[c]))[:size]
    other = sorted(line, key=lambda c: (-difference[c], beyond[c]))
    last = [c for c in other if difference[c] > difference[first[-1]]][:size]
    return set(first), set(last)


def beyond_cut(near: list[list[int]], line: list[int], first: set[int], last: set[int]) -> set[int]:
    """Cells on the side of `last` of the least cut nearest to it; the reference of `cut_between`."""
    place = {c: i for i, c in enumerate(line)}
    source, sink = len(line), len(line) + 1
    links = [(place[c], place[j], 1) for c in line for j in near[c] if j in place and j != c]
    links += [(source, place[c], 3 * len(line)) for c in first]
    links += [(place[c], sink, 3 * len(line)) for c in last]
    rows, columns, most = np.array(links, dtype=np.int32).T
    room = sparse.csr_array((most, (rows, columns)), shape=(len(line) + 2, len(line) + 2))
    left = (room - sparse.csgraph.maximum_flow(room, source, sink).flow).tocoo()
    free = left.data > 0
    into: list[list[int]] = [[] for _ in range(len(line) + 2)]
    for i, j in zip(left.coords[0][free].tolist(), left.coords[1][free].tolist(), strict=True):
        into[j].append(i)
    reached = distances(into, set(range(len(line) + 2)), sink)
    return {c for c in line if place[c] in reached}
