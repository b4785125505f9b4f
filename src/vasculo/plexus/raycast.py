"""Rays from points to the nearest springs, through a grid of cells."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numba import njit

from vasculo.errors import InputError

if TYPE_CHECKING:
    from vasculo.geometry.arrays import Floats, Ints

MARGIN = 1e-9
"""By how many cells a spring reaches beyond itself when it is listed: far more than rounding, too little to cost."""


class SpringGrid(NamedTuple):
    """Springs listed by the square cells that they cross.

    Attributes
    ----------
    origin : ndarray of float64, shape (2,)
        Lower left corner (model length).
    side : float
        Side of a cell (model length).
    columns, rows : int
        Cells in x and y.
    start : ndarray of int32, shape (rows columns + 1,)
        Cell (x, y) owns the entries start[columns y + x] to start[columns y + x + 1].
    spring : ndarray of int32, shape (k,)
        Spring of each entry, ascending within a cell.
    """

    origin: Floats
    side: float
    columns: int
    rows: int
    start: Ints
    spring: Ints


def spring_grid(points: Floats, springs: Ints) -> SpringGrid:
    """List the springs (m, 2) between points (n, 2) by cells, about one spring a cell."""
    ends = points[springs]
    low, extent = np.zeros(2), np.zeros(2)
    length = 1.0
    if len(springs):
        low = np.array([ends[:, :, axis].min() for axis in range(2)])
        extent = np.array([ends[:, :, axis].max() for axis in range(2)]) - low
        length = float(np.abs(ends[:, 1] - ends[:, 0]).sum() / len(springs))
    count = max(len(springs), 1)
    side = max(np.sqrt(extent[0] * extent[1] / count), float(extent.max()) / count, 0.5 * length)
    side = side if side > 0.0 else 1.0
    columns, rows = (int(cells) + 1 for cells in extent / side)
    start, spring = _list_by_cell(ends, low, side, columns, rows)
    return SpringGrid(low, side, columns, rows, start, spring)


def ray_directions(rays: int) -> Floats:
    """Make unit vectors (rays, 2), evenly spread, the first along x, counter-clockwise, exact along x and y."""
    angle = 2.0 * np.pi * np.arange(rays) / rays
    directions = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    directions[np.abs(directions) < 1e-14] = 0.0
    return directions


def ray_distances(
    points: Floats, springs: Ints, centres: Floats, rays: int = 64, grid: SpringGrid | None = None
) -> tuple[Floats, Ints]:
    """Distance along each ray from each centre to the nearest spring it meets.

    A spring is met anywhere from end to end, one seen end on at its nearer end, one through the centre at no distance.
    Of springs met at the same distance the one with the lowest number counts.

    Parameters
    ----------
    points : ndarray of float64, shape (n, 2)
        Node positions (model length).
    springs : ndarray of int32, shape (m, 2)
        Living springs, all of them candidates.
    centres : ndarray of float64, shape (c, 2)
        Where the rays start (model length).
    rays : int
        Rays a centre, evenly spread, the first along x.
    grid : SpringGrid, optional
        `spring_grid(points, springs)`, for repeated calls.

    Returns
    -------
    distances : ndarray of float64, shape (c, rays)
        Model length; infinite where a ray meets no spring.
    hits : ndarray of int32, shape (c, rays)
        The spring met, -1 for none.

    Raises
    ------
    InputError
        When there are fewer than 3 rays.
    """
    if rays < 3:
        raise InputError(f"at least 3 rays are needed, got {rays}")
    table = spring_grid(points, springs) if grid is None else grid
    distances = np.full((len(centres), rays), np.inf)
    hits = np.full((len(centres), rays), -1, dtype=np.int32)
    _cast(points, springs, np.ascontiguousarray(centres), ray_directions(rays), *table, distances, hits)
    return distances, hits


@njit(cache=True, error_model="numpy")
def _list_by_cell(ends, origin, side, columns, rows):  # type: ignore[no-untyped-def]
    """List segments (m, 2, 2) by the cells that they cross; returns start and spring of `SpringGrid`.

    Strategy: cut a segment into the rows that it crosses and list it in the columns of each piece; once to count, once
    to fill.
    """
    start = np.zeros(rows * columns + 1, dtype=np.int32)
    spring = np.empty(0, dtype=np.int32)
    place = start[:0]
    for fill in range(2):
        for s in range(ends.shape[0]):
            lower = 0 if ends[s, 0, 1] <= ends[s, 1, 1] else 1
            x0, y0 = (ends[s, lower, 0] - origin[0]) / side, (ends[s, lower, 1] - origin[1]) / side
            x1, y1 = (ends[s, 1 - lower, 0] - origin[0]) / side, (ends[s, 1 - lower, 1] - origin[1]) / side
            first_row, last_row = max(int(y0 - MARGIN), 0), min(int(y1 + MARGIN), rows - 1)
            for row in range(first_row, last_row + 1):
                left, right = x0, x1
                if y1 - y0 > 4.0 * MARGIN:
                    left = x0 + min(max((row - MARGIN - y0) / (y1 - y0), 0.0), 1.0) * (x1 - x0)
                    right = x0 + min(max((row + 1 + MARGIN - y0) / (y1 - y0), 0.0), 1.0) * (x1 - x0)
                first = max(int(min(left, right) - MARGIN), 0)
                last = min(int(max(left, right) + MARGIN), columns - 1)
                for column in range(first, last + 1):
                    cell = columns * row + column
                    if fill == 0:
                        start[cell + 1] += 1
                    else:
                        spring[place[cell]] = s
                        place[cell] += 1
        if fill == 0:
            for cell in range(rows * columns):
                start[cell + 1] += start[cell]
            spring = np.empty(start[-1], dtype=np.int32)
            place = start[:-1].copy()
    return start, spring


@njit(cache=True, error_model="numpy")
def _meet(ax, ay, bx, by, dx, dy):  # type: ignore[no-untyped-def]
    """Distance from the origin along the unit vector d to the segment from a to b, infinite where they do not meet.

    Segments that share an end are on the same side of it for every ray, so no ray slips between them, and at the end
    itself their distances are equal.
    """
    side_a, side_b = dx * ay - dy * ax, dx * by - dy * bx
    if (side_a > 0.0 and side_b > 0.0) or (side_a < 0.0 and side_b < 0.0):
        return np.inf
    along_a, along_b = dx * ax + dy * ay, dx * bx + dy * by
    if side_a == 0.0 and side_b == 0.0:
        if min(along_a, along_b) < 0.0 <= max(along_a, along_b):
            return 0.0
        along = min(along_a, along_b)
    elif side_a == 0.0:
        along = along_a
    elif side_b == 0.0:
        along = along_b
    else:
        along = along_a + side_a / (side_a - side_b) * (along_b - along_a)
    return along if along >= 0.0 else np.inf


@njit(cache=True, error_model="numpy")
def _cast(points, springs, centres, directions, origin, side, columns, rows, start, spring, distances, hits):  # type: ignore[no-untyped-def]
    """Cast the rays; overwrites distances and hits (c, rays), which start as infinite and -1.

    Strategy: walk from cell to cell along a ray (Amanatides & Woo 1987) and test the springs of each cell, until the
    nearest one met lies no further than the end of the cell.
    """
    for c in range(centres.shape[0]):
        x, y = centres[c, 0], centres[c, 1]
        u, v = (x - origin[0]) / side, (y - origin[1]) / side
        for k in range(directions.shape[0]):
            dx, dy = directions[k, 0], directions[k, 1]
            # Where the ray enters the grid (cell units), if it starts outside.
            enter, leave = 0.0, np.inf
            for place, step, cells in ((u, dx, columns), (v, dy, rows)):
                if step == 0.0:
                    if place < 0.0 or place > cells:
                        leave = -1.0
                else:
                    one, two = -place / step, (cells - place) / step
                    enter, leave = max(enter, min(one, two)), min(leave, max(one, two))
            if enter > leave:
                continue
            column = min(max(int(u + enter * dx), 0), columns - 1)
            row = min(max(int(v + enter * dy), 0), rows - 1)
            next_x = ((column + 1 if dx > 0.0 else column) - u) / dx * side if dx != 0.0 else np.inf
            next_y = ((row + 1 if dy > 0.0 else row) - v) / dy * side if dy != 0.0 else np.inf
            wide = side / abs(dx) if dx != 0.0 else np.inf
            high = side / abs(dy) if dy != 0.0 else np.inf
            best, hit = np.inf, -1
            while 0 <= column < columns and 0 <= row < rows:
                cell = columns * row + column
                for entry in range(start[cell], start[cell + 1]):
                    s = spring[entry]
                    a, b = springs[s, 0], springs[s, 1]
                    away = _meet(points[a, 0] - x, points[a, 1] - y, points[b, 0] - x, points[b, 1] - y, dx, dy)
                    if away < best or (away == best and s < hit):
                        best, hit = away, s
                if best <= min(next_x, next_y):
                    break
                if next_x < next_y:
                    next_x += wide
                    column += 1 if dx > 0.0 else -1
                else:
                    next_y += high
                    row += 1 if dy > 0.0 else -1
            distances[c, k], hits[c, k] = best, hit
