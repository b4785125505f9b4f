"""The coarse space of a divided flow: one pressure for every channel that the division cuts."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numba import njit
from scipy import sparse
from scipy.sparse.linalg import splu

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Ints = NDArray[np.integer]


def interface_components(start: Ints, columns: Ints, part: Ints) -> NDArray[np.int32]:
    """Label the interface: the cells that the matrix couples to another part.

    Parameters
    ----------
    start, columns : (t + 1,), (k,) int32
        Which cells are coupled, by rows, symmetric.
    part : (t,) int32
        Part of each cell.

    Returns
    -------
    (t,) int32
        -1 inside a part; else the component: interface cells that see the same parts and hang together, each at most
        one cell apart from the next. Mostly one for every channel that is cut; numbered by lowest cells.
    """
    row = np.repeat(np.arange(len(part)), np.diff(start))
    cross = part[row] != part[columns]
    seen = np.unique(np.column_stack([row[cross], part[columns[cross]]]), axis=0)
    cells, first, number = np.unique(seen[:, 0], return_index=True, return_counts=True)
    sets = np.full((len(cells), 1 + int(number.max(initial=0))), -1)
    sets[np.repeat(np.arange(len(cells)), number), 1 + np.arange(len(seen)) - np.repeat(first, number)] = seen[:, 1]
    sets[:, 0] = part[cells]
    sets.sort(axis=1)
    label = np.full(len(part), -1, dtype=np.int32)
    kind = np.full(len(part), -1, dtype=np.int64)
    if len(cells):
        kind[cells] = np.unique(sets, axis=0, return_inverse=True)[1].ravel()
        label_components(start, columns, kind, label)
    return label


@njit(cache=True, error_model="numpy", nogil=True)
def label_components(start: Ints, columns: Ints, kind: Ints, label: Ints) -> int:
    """Write into `label` (t,), -1 before, the sets of cells of one `kind` (t,) two steps apart; return their number."""
    queue = np.empty(len(kind), np.int32)
    count = 0
    for seed in range(len(kind)):
        if kind[seed] < 0 or label[seed] >= 0:
            continue
        label[seed] = count
        queue[0] = seed
        head, number = 0, 1
        while head < number:
            c = queue[head]
            head += 1
            for k in range(start[c], start[c + 1]):
                middle = columns[k]
                for n in range(start[middle], start[middle + 1]):
                    j = columns[n]
                    if kind[j] == kind[c] and label[j] < 0:
                        label[j] = count
                        queue[number] = j
                        number += 1
        count += 1
    return count


def interface_components_plain(start: Ints, columns: Ints, part: Ints) -> Ints:
    """Components from sets of cells; the reference of `interface_components`."""
    near = [set(columns[a:b].tolist()) | {c} for c, (a, b) in enumerate(pairwise(start))]
    seen = [frozenset(part[list(cells)].tolist()) for cells in near]
    label = np.full(len(part), -1, dtype=np.int32)
    count = 0
    for seed in range(len(part)):
        if len(seen[seed]) == 1 or label[seed] >= 0:
            continue
        ring = {seed}
        while ring:
            label[list(ring)] = count
            reached = set().union(*(near[middle] for c in ring for middle in near[c]))
            ring = {c for c in reached if seen[c] == seen[seed] and label[c] < 0}
        count += 1
    return label


def pressure_basis(solve: Callable[[Floats], Floats], inward: sparse.csr_array, which: Ints) -> NDArray[np.float32]:
    """Flow inside a part that unit pressures of the components beside it drive.

    Parameters
    ----------
    solve : callable
        Solves with A_II, the matrix of the inside.
    inward : csr_array (3 i, 3 b)
        A_IB, what the inside feels of the interface cells beside it.
    which : (b,) int
        Component of each of those, numbered from 0 without gaps.

    Returns
    -------
    (k, 3 i) float32
        -A_II^-1 A_IB 1_c for each component c, with 1_c the pressure 1 in its cells.
    """
    basis = np.empty((int(which.max(initial=-1)) + 1, inward.shape[0]), dtype=np.float32)
    for k in range(len(basis)):
        pressure = np.zeros(inward.shape[1])
        pressure[2::3] = which == k
        basis[k] = solve(inward @ pressure)
    return np.negative(basis, out=basis)


def own_matrix(outward: sparse.csr_array, which: Ints, basis: NDArray[np.float32]) -> Floats:
    """Mass that the flow inside a part takes from each component; (k, k) float64.

    Parameters
    ----------
    outward : csr_array (b, 3 i)
        Continuity rows of A_BI, what the interface cells beside a part feel of its inside.
    which, basis
        As in `pressure_basis`, and what it returns.
    """
    rows = sparse.csr_array((np.ones(len(which)), (which, np.arange(len(which)))), shape=(len(basis), len(which)))
    return np.asarray((rows @ outward) @ basis.T)


def coarse_factor(
    size: int, matrices: Sequence[Floats], components: Sequence[Ints], label: Ints, interface: sparse.bsr_array
) -> Callable[[Floats], Floats]:
    """Factor Z^T A Z and return the function that solves with it; Z is the basis on all cells.

    A Z is zero inside all parts, so only rows of the interface count: what each part adds, and 1^T A_BB 1.

    Parameters
    ----------
    size : int
        Number of components m.
    matrices, components
        Of each part, its (k, k) `own_matrix` and the (k,) components beside it.
    label : (b,) int32
        Component of each interface cell.
    interface : bsr_array (3 b, 3 b), 3 x 3 blocks
        A_BB.
    """
    row = np.repeat(np.arange(len(label)), np.diff(interface.indptr))
    rows = [label[row], *(np.repeat(c, len(c)) for c in components)]
    columns = [label[interface.indices], *(np.tile(c, len(c)) for c in components)]
    values = [interface.data[:, 2, 2], *(m.ravel() for m in matrices)]
    entries = (np.concatenate(rows), np.concatenate(columns))
    matrix = sparse.coo_array((np.concatenate(values), entries), shape=(size, size), dtype=np.float64)
    return splu(matrix.tocsc()).solve
