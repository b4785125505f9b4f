"""Which triangle a point lies in, through a grid of cells."""

from __future__ import annotations

from math import ceil, sqrt
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numba import njit

from vasculo.errors import InputError
from vasculo.springs.threads import run_team

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from vasculo.geometry.arrays import Floats, Ints, Longs

SLACK = 1e-12  # a point this far outside, in barycentric coordinates, is still inside
FEWEST = 4096  # points that are worth a thread


class Triangles(Protocol):
    """Points (n, 2) float64 and the triangles (t, 3) int32 between them."""

    @property
    def points(self) -> NDArray[np.float64]:
        """Model length."""

    @property
    def triangles(self) -> NDArray[np.int32]:
        """Counter-clockwise."""


class Locator:
    """Find the triangles of points; made once for many questions.

    Parameters
    ----------
    mesh : Triangulation
        Or anything else with points and triangles.
    """

    # Strategy: each cell of a regular grid lists the triangles whose bounding boxes touch it, in ascending order; there
    # are about as many cells as triangles. A point asks the triangles of its cell. This needs no way through the fluid,
    # which has holes.
    def __init__(self, mesh: Triangles) -> None:
        self.mesh = mesh
        self.low = mesh.points.min(axis=0)
        width, height = np.maximum(mesh.points.max(axis=0) - self.low, 1e-300)
        self.size = sqrt(width * height / len(mesh.triangles))
        self.shape = ceil(width / self.size) + 1, ceil(height / self.size) + 1
        self.start, self.listed = list_boxes(mesh.points, mesh.triangles, self.low, self.size, *self.shape)

    def find(self, points: ArrayLike) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
        """Find triangles and barycentric coordinates.

        Parameters
        ----------
        points : (k, 2) array_like, model length

        Returns
        -------
        triangle : (k,) int32
            -1 outside the fluid; on an edge the triangle that holds the point best, the lowest if several do.
        shares : (k, 3) float64
            Of its corners; none negative, they sum to one. NaN outside.

        Raises
        ------
        InputError
            Not (k, 2), or not finite.
        """
        places = np.ascontiguousarray(points, dtype=np.float64)
        if places.ndim != 2 or places.shape[1] != 2:
            raise InputError(f"points have shape {places.shape}: give one row (x, y) a point")
        bad = np.count_nonzero(~np.isfinite(places).all(axis=1))
        if bad:
            raise InputError(f"{bad} of {len(places)} points are not finite")
        triangle, shares = np.empty(len(places), dtype=np.int32), np.empty((len(places), 3))
        run_team(
            find_triangles, len(places) // FEWEST + 1, places, self.mesh.points, self.mesh.triangles, self.low,
            self.size, *self.shape, self.start, self.listed, triangle, shares,
        )  # fmt: skip
        return triangle, shares


@njit(cache=True, error_model="numpy")
def list_boxes(
    points: Floats, triangles: Ints, low: Floats, size: float, columns: int, rows: int
) -> tuple[Longs, Ints]:
    """Start (cells + 1,) and triangles of each grid cell, row by row: those whose bounding boxes touch it."""
    start = np.zeros(columns * rows + 1, dtype=np.int64)
    listed = np.empty(0, dtype=np.int32)
    place = start
    for fill in range(2):
        if fill:
            for cell in range(columns * rows):
                start[cell + 1] += start[cell]
            listed = np.empty(start[columns * rows], dtype=np.int32)
            place = start[:-1].copy()
        for t in range(len(triangles)):
            a, b, c = triangles[t]
            left = int((min(points[a, 0], points[b, 0], points[c, 0]) - low[0]) / size)
            right = int((max(points[a, 0], points[b, 0], points[c, 0]) - low[0]) / size)
            bottom = int((min(points[a, 1], points[b, 1], points[c, 1]) - low[1]) / size)
            top = int((max(points[a, 1], points[b, 1], points[c, 1]) - low[1]) / size)
            for row in range(bottom, top + 1):
                for column in range(left, right + 1):
                    cell = row * columns + column
                    if fill:
                        listed[place[cell]] = t
                        place[cell] += 1
                    else:
                        start[cell + 1] += 1
    return start, listed


@njit(cache=True, error_model="numpy", nogil=True)
def find_triangles(
    rank: int,
    threads: int,
    places: Floats,
    points: Floats,
    triangles: Ints,
    low: Floats,
    size: float,
    columns: int,
    rows: int,
    start: Longs,
    listed: Ints,
    found: Ints,
    shares: Floats,
) -> int:
    """Find the triangles of this thread's share of the places; overwrites `found` (k,) and `shares` (k, 3)."""
    for p in range(rank * len(places) // threads, (rank + 1) * len(places) // threads):
        found[p] = -1
        shares[p] = np.nan
        x, y = places[p]
        column, row = np.floor((x - low[0]) / size), np.floor((y - low[1]) / size)
        if not (0 <= column < columns and 0 <= row < rows):
            continue
        cell = int(row) * columns + int(column)
        best = -SLACK
        for place in range(start[cell], start[cell + 1]):
            t = listed[place]
            a, b, c = triangles[t]
            ax, ay = points[a, 0] - x, points[a, 1] - y
            bx, by = points[b, 0] - x, points[b, 1] - y
            cx, cy = points[c, 0] - x, points[c, 1] - y
            one, two, three = bx * cy - by * cx, cx * ay - cy * ax, ax * by - ay * bx
            least = min(one, two, three) / (one + two + three)
            if least > best or (least == best and found[p] < 0):
                best = least
                found[p] = t
                one, two, three = max(one, 0.0), max(two, 0.0), max(three, 0.0)
                total = one + two + three
                shares[p, 0], shares[p, 1], shares[p, 2] = one / total, two / total, three / total
    return 0


def find_triangles_plain(places: Floats, points: Floats, triangles: Ints) -> tuple[NDArray[np.int64], Floats]:
    """Twin of `find_triangles`: every triangle against every place; found (k,) and shares (k, 3)."""
    arm = points[triangles][None] - places[:, None, None]
    nxt, after = arm[:, :, [1, 2, 0]], arm[:, :, [2, 0, 1]]
    part = nxt[..., 0] * after[..., 1] - nxt[..., 1] * after[..., 0]
    least = (part / part.sum(axis=2, keepdims=True)).min(axis=2)
    found = np.argmax(least, axis=1)
    row = np.arange(len(places))
    shares = np.maximum(part[row, found], 0.0)
    shares /= shares.sum(axis=1, keepdims=True)
    outside = least[row, found] < -SLACK
    shares[outside] = np.nan
    return np.where(outside, -1, found), shares
