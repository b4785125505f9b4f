"""NumPy twin of the tables of `vasculo.springs.layout`: the same lists, patch by patch and node by node."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.springs.layout import PATCH, SLICE

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Ints = NDArray[np.int32]


def tables_plain(ends: Ints, seen: Ints, slice_start: Ints) -> dict[str, NDArray[np.integer]]:
    """Tables of a network by name, as `count_rows`, `fill_rows` and `number_within` make them.

    Parameters
    ----------
    ends : ndarray of int32, shape (m, 2)
        Places of the two ends of each spring.
    seen : ndarray of int32, shape (m,)
        Place at which the second end is seen.
    slice_start : ndarray of int32
        As in `Layout`.
    """
    places = SLICE * (len(slice_start) - 1)
    found: dict[str, list[NDArray[np.integer]]] = {name: [] for name in ("first", "second", "spring", "halo")}
    slots = np.empty(int(slice_start[-1]), dtype=np.int64)
    for begin in range(0, places, PATCH):
        mine = (ends >= begin) & (ends < min(begin + PATCH, places))
        spring = np.flatnonzero(mine.any(axis=1))
        both = np.column_stack([ends[spring, 0], seen[spring]])
        outside = (both < begin) | (both >= min(begin + PATCH, places))
        halo, at = np.unique(both[outside], return_index=True)
        halo = halo[np.argsort(at)]  # in the order in which they are met
        local = both - begin
        local[outside] = PATCH + np.argsort(halo)[np.searchsorted(np.sort(halo), both[outside])]
        found["first"].append(local[:, 0])
        found["second"].append(local[:, 1])
        found["spring"].append(spring)
        found["halo"].append(halo)
        for place in range(begin, min(begin + PATCH, places)):
            row, end = np.nonzero(ends[spring] == place)
            start, stop = slice_start[place // SLICE : place // SLICE + 2]
            column = np.full((stop - start) // SLICE, 2 * len(spring))
            column[: len(row)] = row + end * len(spring)
            slots[start + place % SLICE : stop : SLICE] = column
    tables = {name: np.concatenate(parts) for name, parts in found.items()}
    return tables | {
        "slots": slots,
        "patch_start": np.cumsum([0, *map(len, found["spring"])]),
        "halo_start": np.cumsum([0, *map(len, found["halo"])]),
    }
