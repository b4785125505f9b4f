"""The connected parts of the fluid: what holds in each, and the fluxes that are prescribed."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numba import njit
from scipy import sparse

from vasculo.flow.faces import MOVING, OPEN

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.flow.faces import Faces


@dataclass(frozen=True, eq=False)
class Parts:
    """Connected parts of the fluid, numbered by their lowest cells.

    Parameters
    ----------
    label : (t,) int32
        Part of each cell.
    first : (k,) int64
        Lowest cell of each part.
    size : (k,) int64
        Number of its cells.
    is_open : (k,) bool
        It has a prescribed pressure.
    is_held : (k,) bool
        It has a prescribed velocity somewhere, zero at walls included.
    is_moved : (k,) bool
        It has a prescribed velocity that is not zero.
    is_glued : (k,) bool
        It has a periodic side.
    """

    label: NDArray[np.int32]
    first: NDArray[np.int64]
    size: NDArray[np.int64]
    is_open: NDArray[np.bool_]
    is_held: NDArray[np.bool_]
    is_moved: NDArray[np.bool_]
    is_glued: NDArray[np.bool_]

    @property
    def closed(self) -> NDArray[np.int32]:
        """Parts without a prescribed pressure; theirs is known up to a constant."""
        return np.flatnonzero(~self.is_open).astype(np.int32)

    @property
    def pins(self) -> NDArray[np.int64]:
        """Lowest cell of each closed part: its continuity follows from that of the others."""
        return self.first[self.closed]

    def pockets(self, force: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Parts that nothing drives and no opening or periodic side touches; (k,) bool. `force` is (t, 2)."""
        pushed = np.zeros(len(self.first), dtype=bool)
        pushed[self.label[force.any(axis=1)]] = True
        return ~(self.is_open | self.is_moved | self.is_glued | pushed)


def find_parts(faces: Faces, cells: int) -> Parts:
    """Find the connected parts of a fluid of so many cells."""
    label = np.empty(cells, dtype=np.int32)
    count = label_parts(faces.cells[: faces.inner], label)
    first = np.flatnonzero(np.diff(np.maximum.accumulate(label), prepend=-1))

    def has(cells: NDArray[np.int32]) -> NDArray[np.bool_]:
        return np.bincount(label[cells], minlength=count) > 0

    kind, outside = faces.kind[faces.inner :], faces.cells[faces.inner :, 0]
    moved = faces.profile.any(axis=(1, 2))
    return Parts(
        label=label,
        first=first,
        size=np.bincount(label, minlength=count),
        is_open=has(outside[kind == OPEN]),
        is_held=has(outside[kind == MOVING]),
        is_moved=has(outside[moved]),
        is_glued=has(faces.cells[faces.edge_face[faces.edge_sign < 0.0], 0]),
    )


def prescribed_flux(faces: Faces) -> NDArray[np.float64]:
    """Volume flux out through each boundary face that its prescribed velocity makes; (b,) float64, zero elsewhere."""
    inner = faces.inner
    mean = (faces.profile[:, 0] + 4.0 * faces.profile[:, 1] + faces.profile[:, 2]) / 6.0
    return np.asarray(faces.length[inner:] * np.einsum("fi,fi->f", mean, faces.normal[inner:]))


def balanced_flux(faces: Faces, parts: Parts) -> NDArray[np.float64]:
    """Prescribed flux as in `prescribed_flux`, but with the sum zero in each closed part.

    What is missing is shared out in proportion to the fluxes; `check_problem` has seen to it that this is little.
    """
    flux = prescribed_flux(faces)
    part = parts.label[faces.cells[faces.inner :, 0]]
    count = len(parts.first)
    missing = np.bincount(part, weights=flux, minlength=count)
    passing = np.bincount(part, weights=np.abs(flux), minlength=count)
    share = np.where(parts.is_open | (passing == 0.0), 0.0, missing / np.where(passing > 0.0, passing, 1.0))
    return np.asarray(flux - share[part] * np.abs(flux))


@njit(cache=True, error_model="numpy", nogil=True)
def label_parts(pairs: NDArray[np.int32], label: NDArray[np.int32]) -> int:
    """Write the number of its connected part, by lowest cells, into `label` of each cell; return how many there are."""
    # Strategy: every cell points to a lower one of its part, the lowest to itself. To join two cells go down from the
    # higher of them, shortening the way, until a cell points to itself: it then points to the other. A sweep numbers.
    for c in range(len(label)):
        label[c] = c
    for f in range(len(pairs)):
        a, b = pairs[f, 0], pairs[f, 1]
        while a != b:
            if a < b:
                a, b = b, a
            up = label[a]
            if up == a:
                label[a] = b
                break
            label[a] = label[up]
            a = up
    count = 0
    for c in range(len(label)):
        if label[c] == c:
            label[c] = count
            count += 1
        else:
            label[c] = label[label[c]]
    return count


def label_parts_plain(pairs: NDArray[np.int32], cells: int) -> NDArray[np.int64]:
    """Part of each cell, numbered by lowest cells; the reference of `label_parts`."""
    graph = sparse.coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(cells, cells))
    _, label = sparse.csgraph.connected_components(graph, directed=False)
    _, first, which = np.unique(label, return_index=True, return_inverse=True)
    return np.asarray(np.argsort(np.argsort(first))[which])
