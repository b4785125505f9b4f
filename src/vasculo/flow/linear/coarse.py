"""The coarse space of a divided flow: one pressure for every channel that the division cuts, more where it is wide."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numba import njit
from scipy import sparse
from scipy.sparse.linalg import splu

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Ints = NDArray[np.integer]
    Solve = Callable[[Floats], Floats]

NARROW = 16  # most cells of a component; larger ones are divided, and their pieces have velocities too


class Components(NamedTuple):
    """Labels of the interface.

    Parameters
    ----------
    label : (t,) int32
        Component of each cell of the interface, -1 inside a part.
    wide : (t,) bool
        It is a piece of a component that was too large.
    """

    label: NDArray[np.int32]
    wide: NDArray[np.bool_]

    def modes(self) -> NDArray[np.int32]:
        """Column of the coarse space of each unknown (u, v, p) of the cells, (t, 3), -1 for none."""
        count = int(self.label.max(initial=-1)) + 1
        on = self.label >= 0
        wide = np.zeros(count, dtype=bool)
        wide[self.label[on]] = self.wide[on]
        first = np.cumsum(1 + 2 * wide) - (1 + 2 * wide)
        modes = np.full((len(self.label), 3), -1, dtype=np.int32)
        modes[on, 2] = first[self.label[on]]
        for field in (0, 1):
            modes[self.wide, field] = first[self.label[self.wide]] + 1 + field
        return modes


def interface_components(start: Ints, columns: Ints, part: Ints) -> Components:
    """Label the interface: the cells that the matrix couples to another part.

    Cells of a component see the same parts and hang together, each at most one cell apart from the next; mostly there
    is one for every channel that is cut. Those with more than `NARROW` cells are divided along their length.

    Parameters
    ----------
    start, columns : (t + 1,), (k,) int32
        Which cells are coupled, by sorted rows, symmetric.
    part : (t,) int32
        Part of each cell.
    """
    row = np.repeat(np.arange(len(part)), np.diff(start))
    cross = part[row] != part[columns]
    seen = np.unique(np.column_stack([row[cross], part[columns[cross]]]), axis=0)
    cells, first, number = np.unique(seen[:, 0], return_index=True, return_counts=True)
    sets = np.full((len(cells), 1 + int(number.max(initial=0))), -1)
    sets[np.repeat(np.arange(len(cells)), number), 1 + np.arange(len(seen)) - np.repeat(first, number)] = seen[:, 1]
    sets[:, 0] = part[cells]
    sets.sort(axis=1)
    label, wide = np.full(len(part), -1, dtype=np.int32), np.zeros(len(part), dtype=bool)
    kind = np.full(len(part), -1, dtype=np.int64)
    if len(cells):
        kind[cells] = np.unique(sets, axis=0, return_inverse=True)[1].ravel()
        label_components(start, columns, kind, NARROW, label, wide)
    return Components(label, wide)


@njit(cache=True, error_model="numpy", nogil=True)
def label_components(
    start: Ints, columns: Ints, kind: Ints, most: int, label: NDArray[np.int32], wide: NDArray[np.bool_]
) -> int:
    """Label the sets of cells of one `kind` (t,) two steps apart, divided into pieces of at most so many cells.

    `label` (t,), -1 before, and `wide` (t,), False before, are filled; the number of pieces is returned.
    """
    # Strategy: a set is gone through twice, the second time from the cell that came last, which is at an end of it; in
    # the order of distance from there, pieces are slices across it.
    queue = np.empty(len(kind), np.int32)
    count = 0
    for seed in range(len(kind)):
        if kind[seed] < 0 or label[seed] >= 0:
            continue
        number = 0
        for again in range(2):
            mark = count if again == 0 else len(kind) + count
            queue[0] = seed if again == 0 else queue[number - 1]
            label[queue[0]] = mark
            head, number = 0, 1
            while head < number:
                c = queue[head]
                head += 1
                for k in range(start[c], start[c + 1]):
                    middle = columns[k]
                    for n in range(start[middle], start[middle + 1]):
                        j = columns[n]
                        if kind[j] == kind[c] and (label[j] < 0 if again == 0 else label[j] == count):
                            label[j] = mark
                            queue[number] = j
                            number += 1
        pieces = (number + most - 1) // most
        for i in range(number):
            label[queue[i]] = count + i * pieces // number
            wide[queue[i]] = pieces > 1
        count += pieces
    return count


def interface_components_plain(start: Ints, columns: Ints, part: Ints) -> Components:
    """Components from sets of cells; the reference of `interface_components`."""
    near = [sorted({c, *columns[a:b].tolist()}) for c, (a, b) in enumerate(pairwise(start))]
    seen = [frozenset(part[cells].tolist()) for cells in near]
    label, wide = np.full(len(part), -1, dtype=np.int32), np.zeros(len(part), dtype=bool)

    def together(seed: int) -> list[int]:
        line = [seed]
        for cell in line:
            reached = (j for middle in near[cell] for j in near[middle])
            line += [j for j in dict.fromkeys(reached) if seen[j] == seen[seed] and j not in line]
        return line

    count = 0
    for seed in range(len(part)):
        if len(seen[seed]) > 1 and label[seed] < 0:
            line = together(together(seed)[-1])
            pieces = -(-len(line) // NARROW)
            label[line] = [count + i * pieces // len(line) for i in range(len(line))]
            wide[line] = pieces > 1
            count += pieces
    return Components(label, wide)


def selection(modes: Ints, size: int) -> sparse.csr_array:
    """Matrix (n, size) with a one in row i and column `modes[i]` (n,), where that is not -1."""
    rows = np.flatnonzero(modes >= 0)
    return sparse.csr_array((np.ones(len(rows)), (rows, modes[rows])), shape=(len(modes), size))


def driven_flow(solve: Solve, inward: sparse.csr_array, chosen: sparse.csr_array) -> NDArray[np.float32]:
    """Flow inside a part that unit pressures or velocities of the components beside it drive.

    Parameters
    ----------
    solve : callable
        Solves with A_II, the matrix of the inside.
    inward : csr_array (3 i, 3 b)
        A_IB, what the inside feels of the interface cells beside it.
    chosen : csr_array (3 b, k)
        Z_B, the unknowns of these cells that each column of the coarse space sets to one.

    Returns
    -------
    (k, 3 i) float32
        Z_I = -A_II^-1 A_IB Z_B, transposed.
    """
    felt = (inward @ chosen).tocsc()
    basis = np.empty((felt.shape[1], felt.shape[0]), dtype=np.float32)
    for k in range(len(basis)):
        basis[k] = solve(felt[:, [k]].toarray().ravel())
    return np.negative(basis, out=basis)


def own_matrix(outward: sparse.csr_array, chosen: sparse.csr_array, basis: NDArray[np.float32]) -> Floats:
    """Z_B^T A_BI Z_I, what the flow inside a part does to the components beside it; (k, k) float64.

    Parameters
    ----------
    outward : csr_array (3 b, 3 i)
        A_BI, what the interface cells beside a part feel of its inside.
    chosen, basis
        As in `driven_flow`, and what it returns.
    """
    return np.asarray((chosen.T @ outward) @ basis.T)


def coarse_factor(
    matrices: Sequence[Floats], columns: Sequence[Ints], chosen: sparse.csr_array, interface: sparse.bsr_array
) -> Solve:
    """Factor Z^T A Z and return the function that solves with it; Z is the basis on all cells.

    A Z is zero inside all parts, so only rows of the interface count: what each part adds, and Z_B^T A_BB Z_B.

    Parameters
    ----------
    matrices, columns
        Of each part, its (k, k) `own_matrix` and the (k,) columns of the coarse space that these are.
    chosen : csr_array (3 b, m)
        Z_B on the whole interface.
    interface : bsr_array (3 b, 3 b)
        A_BB.
    """
    own = (chosen.T @ (interface.astype(np.float64).tocsr() @ chosen)).tocoo()
    rows = [own.coords[0], *(np.repeat(c, len(c)) for c in columns)]
    across = [own.coords[1], *(np.tile(c, len(c)) for c in columns)]
    values = np.concatenate([own.data, *(m.ravel() for m in matrices)])
    return splu(
        sparse.coo_array((values, (np.concatenate(rows), np.concatenate(across))), shape=own.shape).tocsc()
    ).solve
