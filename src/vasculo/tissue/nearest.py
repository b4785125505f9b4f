"""Searches among the nodes of a tissue on the unit square or torus, through a grid of cells of about one node."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numba import njit
from scipy.spatial import cKDTree

from vasculo.springs.threads import run_team

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Ints = NDArray[np.int32]
    Floats = NDArray[np.float64]


WORTH = 50_000
"""Samples that are worth a thread."""


class Cells(NamedTuple):
    """Points sorted into the cells of a grid over the unit square.

    Attributes
    ----------
    side : int
        Cells along a side.
    start : ndarray of int32, shape (side^2 + 1,)
        Cell (x, y) owns the rows start[side y + x] to start[side y + x + 1].
    point : ndarray of int32, shape (n,)
        Point in each row, ascending within a cell.
    wrap : bool
        Whether the square is a torus.
    """

    side: int
    start: Ints
    point: Ints
    wrap: bool


def sort_into_cells(points: Floats, wrap: bool, widest: float = 0.0) -> Cells:
    """Sort points (n, 2) of the unit square into cells of about one point, at least `widest` wide."""
    side = max(1, int(np.sqrt(len(points))))
    if widest > 0.0:
        side = max(1, min(side, int(1.0 / widest)))
    x, y = np.minimum((points * side).astype(np.int64), side - 1).T
    cell = side * y + x
    point = np.argsort(cell, kind="stable").astype(np.int32)
    start = np.searchsorted(cell[point], np.arange(side * side + 1)).astype(np.int32)
    return Cells(side, start, point, wrap)


def find_nearest(samples: Floats, points: Floats, cells: Cells) -> Ints:
    """Nearest point (s,) of each sample (s, 2), both in the unit square or torus."""
    nearest = np.empty(len(samples), dtype=np.int32)
    most = max(1, len(samples) // WORTH)
    run_team(nearest_points, most, samples, points[cells.point], *cells, nearest)
    return nearest


@njit(cache=True, error_model="numpy", nogil=True)
def nearest_points(rank, threads, samples, sorted_points, side, start, point, wrap, nearest):  # type: ignore[no-untyped-def]
    """Find the nearest point of each sample, one thread's share of them; returns how many; overwrites nearest (s,).

    Parameters
    ----------
    rank, threads : int
        Number of this thread, and how many there are.
    samples : ndarray of float64, shape (s, 2)
        In the unit square.
    sorted_points : ndarray of float64, shape (n, 2)
        The points in the order of their cells, in the unit square.
    side, start, point, wrap
        See `Cells`.
    """
    # Strategy: look through the nine cells around the sample, then through wider rings, until no nearer point can be
    # further out.
    width = 1.0 / side
    first, last = samples.shape[0] * rank // threads, samples.shape[0] * (rank + 1) // threads
    for s in range(first, last):
        x, y = samples[s, 0], samples[s, 1]
        own_x, own_y = min(int(x * side), side - 1), min(int(y * side), side - 1)
        margin = min(x - own_x * width, (own_x + 1) * width - x, y - own_y * width, (own_y + 1) * width - y)
        found, best = -1, np.inf
        for ring in range(1, side + 1):
            for down in range(-ring, ring + 1):
                inside = ring > 1 and -ring < down < ring
                for right in range(-ring, ring + 1, 2 * ring if inside else 1):
                    cell_x, cell_y = own_x + right, own_y + down
                    if wrap:
                        cell_x, cell_y = cell_x % side, cell_y % side
                    elif cell_x < 0 or cell_x >= side or cell_y < 0 or cell_y >= side:
                        continue
                    cell = side * cell_y + cell_x
                    for row in range(start[cell], start[cell + 1]):
                        dx, dy = x - sorted_points[row, 0], y - sorted_points[row, 1]
                        if wrap:
                            dx, dy = dx - np.round(dx), dy - np.round(dy)
                        away = dx * dx + dy * dy
                        if away < best:
                            found, best = row, away
            clear = margin + ring * width
            if best <= clear * clear:
                break
        nearest[s] = point[found]
    return last - first


def nearest_points_plain(samples: Floats, points: Floats, wrap: bool) -> Ints:
    """SciPy twin of `nearest_points`, for all samples."""
    return np.asarray(_tree(points, wrap).query(samples)[1], dtype=np.int32)


@njit(cache=True, error_model="numpy")
def add_to_nearest(samples, points, nearest, wrap, total, count):  # type: ignore[no-untyped-def]
    """Add each sample to its nearest point; overwrites total and count.

    Parameters
    ----------
    samples, points : ndarray of float64, shape (s, 2) and (n, 2)
    nearest : ndarray of int32, shape (s,)
        Point of each sample.
    wrap : bool
        Whether to add the image of the sample that is nearest to the point.
    total : ndarray of float64, shape (n, 2)
        Gets the sum of the samples of each point.
    count : ndarray of int64, shape (n,)
        Gets their number.
    """
    for s in range(nearest.size):
        p = nearest[s]
        for axis in range(2):
            value = samples[s, axis]
            total[p, axis] += value - np.round(value - points[p, axis]) if wrap else value
        count[p] += 1


def add_to_nearest_plain(
    samples: Floats, points: Floats, nearest: Ints, wrap: bool, total: Floats, count: NDArray[np.int64]
) -> None:
    """NumPy twin of `add_to_nearest`."""
    np.add.at(total, nearest, samples - np.round(samples - points[nearest]) * wrap)
    np.add.at(count, nearest, 1)


@njit(cache=True, error_model="numpy")
def close_pairs(sorted_points, side, start, point, wrap, distance, pairs):  # type: ignore[no-untyped-def]
    """Find the pairs i < j of points no further apart than a distance, at most a cell's width; returns their number.

    Overwrites pairs (k, 2) as far as they fit. For `sorted_points` see `nearest_points`, for the others `Cells`.
    """
    found = 0
    for cell in range(side * side):
        own_x, own_y = cell % side, cell // side
        for cell_y in range(own_y - 1, own_y + 2):
            for cell_x in range(own_x - 1, own_x + 2):
                if not wrap and (cell_x < 0 or cell_x >= side or cell_y < 0 or cell_y >= side):
                    continue
                near = side * (cell_y % side) + cell_x % side
                for one in range(start[cell], start[cell + 1]):
                    for other in range(start[near], start[near + 1]):
                        if point[other] > point[one]:
                            dx = sorted_points[other, 0] - sorted_points[one, 0]
                            dy = sorted_points[other, 1] - sorted_points[one, 1]
                            if wrap:
                                dx, dy = dx - np.round(dx), dy - np.round(dy)
                            if dx * dx + dy * dy <= distance * distance:
                                if found < pairs.shape[0]:
                                    pairs[found, 0], pairs[found, 1] = point[one], point[other]
                                found += 1
    return found


def find_close_pairs(points: Floats, distance: float, wrap: bool) -> Ints:
    """Pairs (k, 2) of points of the unit square no further apart than a distance, sorted."""
    cells = sort_into_cells(points, wrap, distance)
    if cells.side < 3:  # on so small a torus a cell would be its own neighbour
        pairs = _tree(points, wrap).query_pairs(distance, output_type="ndarray").astype(np.int32)
    else:
        pairs = np.empty((len(points), 2), dtype=np.int32)
        table = points[cells.point], *cells, distance
        found = close_pairs(*table, pairs)
        if found > len(pairs):
            pairs = np.empty((found, 2), dtype=np.int32)
            close_pairs(*table, pairs)
        pairs = pairs[:found]
    return pairs[np.lexsort(pairs.T[::-1])]


def _tree(points: Floats, wrap: bool) -> cKDTree:
    """SciPy's tree of the points, on the square or on the torus."""
    return cKDTree(points, boxsize=np.ones(2)) if wrap else cKDTree(points)
