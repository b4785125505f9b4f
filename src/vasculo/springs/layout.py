"""Where the nodes and springs of a network stand in memory while it moves.

Nodes that are near in the plane are near in memory (Hilbert's curve), and every 512 of them are a patch. A patch lists
all springs that end in it and computes each of them once, also those that it shares with another patch, which computes
them again. So no patch writes to another, and threads need no locks. Within a patch the nodes stand by falling number
of springs, in slices of 64 whose lists of springs are stored column by column (the format SELL-C-sigma of sparse
matrices, Kreutzer et al. 2014): a slice sums its forces in straight loops over 64 lanes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numba import njit

from vasculo.geometry.curve import curve_order

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Ints = NDArray[np.int32]
    Floats = NDArray[np.float64]
    Locals = NDArray[Any]  # uint16 or uint32

PATCH = 512
"""Nodes a patch; a multiple of the slice. Its springs stay in the nearest cache."""

SLICE = 64
"""Nodes a slice."""


class Layout(NamedTuple):
    """Tables of a network for `damped_steps`. Places are node numbers in memory order.

    Attributes
    ----------
    order : ndarray of int32, shape (n,)
        Node at each place.
    patch_start : ndarray of int32, shape (patches + 1,)
        Patch p owns the rows patch_start[p] to patch_start[p + 1] of the next three tables.
    halo_start : ndarray of int32, shape (patches + 1,)
        Patch p sees, beside its own nodes, the places halo[halo_start[p] : halo_start[p + 1]].
    halo : ndarray of int32
        Places of nodes of other patches, and images.
    first, second : ndarray of uint16 (uint32 where that does not do), shape (r,)
        The two ends of the spring in each row, as numbers within the patch: its own nodes from 0, its halo from 512 on.
    spring : ndarray of int32, shape (r,)
        Spring in each row, ascending within a patch.
    slice_start : ndarray of int32, shape (slices + 1,)
        Slice s owns slots[slice_start[s] : slice_start[s + 1]], 64 of them for each spring of its fullest node.
    slots : ndarray of uint16 or uint32
        Which pull of the patch each node adds: row for a first end, rows of the patch + row for a second end, and twice
        the rows of the patch for nothing.
    image_start : ndarray of int32, shape (patches + 1,)
        Patch p owns the images image_start[p] to image_start[p + 1].
    image_of : ndarray of int32, shape (g,)
        Place of the node that each image repeats; the images stand behind the slices.
    image_shift : ndarray of float64, shape (g, 2)
        What is added to its position (model length).
    """

    order: Ints
    patch_start: Ints
    halo_start: Ints
    halo: Ints
    first: Locals
    second: Locals
    spring: Ints
    slice_start: Ints
    slots: Locals
    image_start: Ints
    image_of: Ints
    image_shift: Floats

    @property
    def places(self) -> int:
        """Places of nodes: the nodes, filled up to whole slices."""
        return SLICE * (len(self.slice_start) - 1)


def build_layout(springs: Ints, positions: Floats, shifts: Floats | None = None) -> Layout:
    """Lay out a network.

    Parameters
    ----------
    springs : ndarray of int32, shape (m, 2)
        Node indices; not checked here.
    positions : ndarray of float64, shape (n, 2)
        Where the nodes are, roughly; decides on the order only.
    shifts : ndarray of float64, shape (m, 2), optional
        What is taken from the position of each second end: the periods a spring crosses (model length).

    Returns
    -------
    Layout
    """
    nodes = len(positions)
    degree = np.bincount(springs.ravel(), minlength=nodes)
    patch = np.empty(nodes, dtype=np.int64)
    patch[curve_order(positions)] = np.arange(nodes) // PATCH
    order = np.lexsort((-degree, patch)).astype(np.int32)
    place = np.empty(nodes, dtype=np.int32)
    place[order] = np.arange(nodes, dtype=np.int32)
    slices, patches = -(-nodes // SLICE), -(-nodes // PATCH)
    ends = place[springs]
    seen, image_of, image_shift = _images(ends[:, 1], shifts, SLICE * slices)
    patch_start = np.zeros(patches + 1, dtype=np.int32)
    width = np.zeros(slices, dtype=np.int32)
    np.maximum.at(width, np.arange(nodes) // SLICE, degree[order])
    slice_start = np.concatenate([[0], np.cumsum(SLICE * width)]).astype(np.int32)
    count_rows(ends, patch_start)
    rows = int(patch_start[-1])
    first, second, spring = (np.empty(rows, dtype=np.int32) for _ in range(3))
    slots = np.empty(int(slice_start[-1]), dtype=np.int32)
    fill_rows(ends, seen, patch_start, slice_start, first, second, spring, slots)
    halo_start, halo = np.zeros(patches + 1, dtype=np.int32), np.empty(2 * rows, dtype=np.int32)
    number = np.zeros(SLICE * slices + len(image_of), dtype=np.int32)
    number_within(patch_start, SLICE * slices, first, second, number, halo_start, halo)
    image_start = np.searchsorted(image_of // PATCH, np.arange(patches + 1)).astype(np.int32)
    local = np.uint16 if max(first.max(initial=0), second.max(initial=0), slots.max(initial=0)) < 2**16 else np.uint32
    return Layout(
        order,
        patch_start,
        halo_start,
        halo[: halo_start[-1]].copy(),
        first.astype(local),
        second.astype(local),
        spring,
        slice_start,
        slots.astype(local),
        image_start,
        image_of,
        image_shift,
    )


def _images(second: Ints, shifts: Floats | None, places: int) -> tuple[Ints, Ints, Floats]:
    """Where each second end is seen, and the images (node and shift) needed for that, by place of their nodes."""
    none = np.empty(0, dtype=np.int32), np.empty((0, 2))
    if shifts is None or not shifts.any():
        return second, *none
    across = np.flatnonzero(shifts.any(axis=1))
    keys = np.column_stack([second[across], -shifts[across]])
    unique, which = np.unique(keys, axis=0, return_inverse=True)
    seen = second.copy()
    seen[across] = places + which.ravel()
    return seen, unique[:, 0].astype(np.int32), np.ascontiguousarray(unique[:, 1:])


@njit(cache=True, error_model="numpy")
def count_rows(ends, patch_start):  # type: ignore[no-untyped-def]
    """Count the springs of each patch; overwrites patch_start (zeros at entry) with the first row of each."""
    for s in range(ends.shape[0]):
        one, other = ends[s, 0] // PATCH, ends[s, 1] // PATCH
        patch_start[one + 1] += 1
        if other != one:
            patch_start[other + 1] += 1
    for p in range(1, patch_start.size):
        patch_start[p] += patch_start[p - 1]


@njit(cache=True, error_model="numpy")
def fill_rows(ends, seen, patch_start, slice_start, first, second, spring, slots):  # type: ignore[no-untyped-def]
    """List the springs of each patch and the pulls of each node; overwrites the last four.

    Parameters
    ----------
    ends : ndarray of int32, shape (m, 2)
        Places of the two ends of each spring.
    seen : ndarray of int32, shape (m,)
        Place at which the second end is seen: its own or that of an image.
    patch_start, slice_start : ndarray of int32
        As in `Layout`.
    first, second, spring, slots : ndarray of int32
        As in `Layout`.
    """
    # Strategy: the springs come in the order of their numbers, so the rows of a patch and the pulls of a node do too,
    # and forces are always added in that order, wherever the nodes stand.
    patches = patch_start.size - 1
    for p in range(patches):
        nothing = 2 * (patch_start[p + 1] - patch_start[p])
        last = min((p + 1) * (PATCH // SLICE), slice_start.size - 1)
        for slot in range(slice_start[p * (PATCH // SLICE)], slice_start[last]):
            slots[slot] = nothing
    rows = patch_start[:-1].copy()
    pulls = np.zeros(SLICE * (slice_start.size - 1), dtype=np.int32)
    for s in range(ends.shape[0]):
        for end in range(2):
            place = ends[s, end]
            p = place // PATCH
            if end == 0 or p != ends[s, 0] // PATCH:
                row = rows[p]
                rows[p] += 1
                first[row], second[row], spring[row] = ends[s, 0], seen[s], s
            pull = rows[p] - 1 - patch_start[p] + end * (patch_start[p + 1] - patch_start[p])
            slots[slice_start[place // SLICE] + SLICE * pulls[place] + place % SLICE] = pull
            pulls[place] += 1


@njit(cache=True, error_model="numpy")
def number_within(patch_start, places, first, second, number, halo_start, halo):  # type: ignore[no-untyped-def]
    """Turn the places of both ends into numbers within their patch, and list what it sees of others.

    Overwrites first, second, number (zeros at entry, one a place or image), halo_start (zeros) and halo (two a row).
    """
    # Strategy: a place that a patch has met before has a number above those of all earlier patches: numbers go up
    # through all halos, and the first of a patch is known.
    met = 0
    for p in range(patch_start.size - 1):
        for row in range(patch_start[p], patch_start[p + 1]):
            for ends in (first, second):
                place = ends[row]
                if place // PATCH == p and place < places:
                    ends[row] = place - PATCH * p
                else:
                    if number[place] <= halo_start[p]:
                        halo[met] = place
                        met += 1
                        number[place] = met
                    ends[row] = PATCH + number[place] - 1 - halo_start[p]
        halo_start[p + 1] = met


@njit(cache=True, error_model="numpy")
def bring(values, order, image_of, image_shift, x, y):  # type: ignore[no-untyped-def]
    """Bring node vectors (n, 2) to memory order, a component an array, images behind them; overwrites x and y."""
    places = x.size - image_of.size
    for place in range(order.size):
        x[place], y[place] = values[order[place], 0], values[order[place], 1]
    for place in range(order.size, places):
        x[place] = y[place] = 0.0
    for image in range(image_of.size):
        x[places + image] = x[image_of[image]] + image_shift[image, 0]
        y[places + image] = y[image_of[image]] + image_shift[image, 1]


@njit(cache=True, error_model="numpy")
def take_back(x, y, order, values):  # type: ignore[no-untyped-def]
    """Bring components in memory order back to node vectors; overwrites values (n, 2)."""
    for place in range(order.size):
        values[order[place], 0], values[order[place], 1] = x[place], y[place]


@njit(cache=True, error_model="numpy")
def spread(values, spring, number, gone, rows):  # type: ignore[no-untyped-def]
    """Spread values of springs (m,) to rows (r,), `gone` for springs of negative number; overwrites rows."""
    for row in range(spring.size):
        now = number[spring[row]]
        rows[row] = values[now] if now >= 0 else gone
