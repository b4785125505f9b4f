"""Nodes that lie on top of each other."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit
from scipy.spatial import KDTree

from vasculo.springs.box import wrapped

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.geometry.arrays import Flags, Floats

CELL = 25.0
"""Side of a cell over the distance within which nodes coincide: few such disks fit into a cell without overlap."""


def in_company(points: Floats, distance: float, box: Floats) -> Flags:
    """Which points have another one no further away than a distance.

    Parameters
    ----------
    points : ndarray of float64, shape (n, 2)
        Model length; in a periodic direction anywhere.
    distance : float
        Model length, below a third of any period.
    box : ndarray of float64, shape (2,)
        Periods in x and y, infinite in a direction without.

    Returns
    -------
    ndarray of bool, shape (n,)
    """
    if not distance > 0.0 or not len(points):
        return np.zeros(len(points), dtype=np.bool_)
    inside = wrapped(points, box) if np.isfinite(box).any() else points
    count = np.where(np.isfinite(box), np.maximum(np.floor(box / (CELL * distance)), 1.0), 0.0)
    side = np.where(count > 0.0, box, CELL * distance) / np.maximum(count, 1.0)
    origin = np.where(count == 0.0, [axis.min() for axis in inside.T], 0.0)
    cells = np.floor((inside - origin) / side).astype(np.int64)
    result = np.zeros(len(points), dtype=np.bool_)
    _find(inside, cells, count.astype(np.int64), origin, side, distance, box, result)
    return result


@njit(cache=True, error_model="numpy")
def _slot(x, y, mask):  # type: ignore[no-untyped-def]
    """Slot of a cell in a table of mask + 1 slots, a power of two."""
    return (x * 73856093 ^ y * 19349663) & mask


@njit(cache=True, error_model="numpy")
def _find(points, cells, count, origin, side, distance, box, result):  # type: ignore[no-untyped-def]
    """Mark points with another one within a distance; overwrites result (n,), which starts as zero.

    Strategy: sort the points by counting into a hashed table of cells, so that a stray node far away costs nothing, and
    compare each point with those of the cells that its disk reaches, until the first one is near. Points of another
    cell in the same slot are too far away to count.
    """
    nodes = points.shape[0]
    slots = 1
    while slots < nodes:
        slots *= 2
    start = np.zeros(slots + 1, dtype=np.int32)
    for node in range(nodes):
        start[_slot(cells[node, 0], cells[node, 1], slots - 1) + 1] += 1
    for slot in range(slots):
        start[slot + 1] += start[slot]
    place, order = start[:-1].copy(), np.empty(nodes, dtype=np.int32)
    for node in range(nodes):
        slot = _slot(cells[node, 0], cells[node, 1], slots - 1)
        order[place[slot]] = node
        place[slot] += 1
    for node in range(nodes):
        left = origin[0] + cells[node, 0] * side[0]
        down = origin[1] + cells[node, 1] * side[1]
        for right in range(-1, 2):
            if (right < 0 and points[node, 0] - distance > left) or (
                right > 0 and points[node, 0] + distance < left + side[0]
            ):
                continue
            for up in range(-1, 2):
                if (up < 0 and points[node, 1] - distance > down) or (
                    up > 0 and points[node, 1] + distance < down + side[1]
                ):
                    continue
                x, y = cells[node, 0] + right, cells[node, 1] + up
                x = x % count[0] if count[0] > 0 else x
                y = y % count[1] if count[1] > 0 else y
                slot = _slot(x, y, slots - 1)
                for row in range(start[slot], start[slot + 1]):
                    other = order[row]
                    if result[node] or other == node:
                        continue
                    dx, dy = points[other, 0] - points[node, 0], points[other, 1] - points[node, 1]
                    if count[0] > 0:
                        dx -= np.rint(dx / box[0]) * box[0]
                    if count[1] > 0:
                        dy -= np.rint(dy / box[1]) * box[1]
                    if dx * dx + dy * dy <= distance * distance:
                        result[node] = result[other] = True


def in_company_plain(points: Floats, distance: float, box: Floats) -> Flags:
    """SciPy twin of `in_company`."""
    period = np.where(np.isfinite(box), box, 0.0)  # a tree takes 0 for no period
    pairs: NDArray[np.intp] = KDTree(wrapped(points, box), boxsize=period).query_pairs(distance, output_type="ndarray")
    result = np.zeros(len(points), dtype=np.bool_)
    result[pairs.ravel()] = True
    return result
