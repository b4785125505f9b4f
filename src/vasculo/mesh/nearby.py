"""Near nodes and walls, found through hashed grids while nodes are being placed."""

from __future__ import annotations

from math import frexp
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numba import njit

from vasculo.geometry.boxtree import distance_to
from vasculo.geometry.predicates import orient2d

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.geometry.arrays import Floats

CLEAR = 0.75
"""No two interior nodes are nearer than this many local sizes."""

MARK = 0.75
"""Every point of a wall is within half of this many local sizes of a marker of its wall edge."""

SPREAD = 1.0 + CLEAR
"""The size is known one size away, and nodes are searched CLEAR sizes around: sizes differ by slope times this."""

LEVEL = 7919
"""Distance in the hash table between the grids of neighbouring levels."""


class NodeGrid(NamedTuple):
    """Grids that find near nodes and walls, hashed into one table.

    Parameters
    ----------
    points : (room, 2) float64, model length
        Wall nodes, then markers on the walls, then interior nodes.
    given, first : int
        Entries at which the markers and the interior nodes begin.
    links : (room, 2) int32
        Next entry in the same slot; source of the size.
    table : (2^k,) int32
        First entry of each slot, -1 for none.
    ends : (e, 4) float64, model length
        Wall edges.
    owner : (m,) int32
        Wall edge of each marker.
    left, bottom, smallest : float, model length
        Corner of the grids, and the smallest size of all.
    columns, levels : int
        Columns of the finest grid; grids that hold anything.
    slope : float
        Largest gradient of the sizes.
    """

    points: NDArray[np.float64]
    given: int
    first: int
    links: NDArray[np.int32]
    table: NDArray[np.int32]
    ends: NDArray[np.float64]
    owner: NDArray[np.int32]
    left: float
    bottom: float
    smallest: float
    columns: int
    levels: int
    slope: float


def markers_on(ends: NDArray[np.float64], sizes: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Points along wall edges, dense enough that whoever comes near an edge finds one.

    Parameters
    ----------
    ends : (e, 4) float64, model length
        Start and end of each wall edge.
    sizes : (e,) float64, model length
        Smallest size on each of them.

    Returns
    -------
    points : (m, 2) float64, model length
    owner : (m,) int32
        Wall edge of each marker.
    """
    lengths = np.hypot(ends[:, 2] - ends[:, 0], ends[:, 3] - ends[:, 1])
    pieces = np.maximum(np.ceil(lengths / (MARK * sizes)), 1.0).astype(np.int64)
    owner = np.repeat(np.arange(len(ends), dtype=np.int32), pieces)
    number = np.arange(len(owner)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    place = ((number + 0.5) / pieces[owner])[:, None]
    return ends[owner, :2] * (1.0 - place) + ends[owner, 2:] * place, owner


@njit(cache=True, error_model="numpy")
def level_of(size: float, smallest: float) -> int:
    """Level of the grid for a size: cells of level k are 2^k times the smallest size wide, at most one size."""
    return max(0, frexp(size / smallest)[1] - 1)


@njit(cache=True, error_model="numpy")
def slot(grid: NodeGrid, level: int, x: float, y: float) -> int:
    """Place in the hash table of the grid cell that holds a point; cells of one row lie side by side."""
    cell = 1.0 / (grid.smallest * (1 << level))
    row = int((y - grid.bottom) * cell + 1.0)
    return (row * grid.columns + int((x - grid.left) * cell + 1.0) + level * LEVEL) & (len(grid.table) - 1)


@njit(cache=True, error_model="numpy")
def surroundings(
    grid: NodeGrid,
    x: float,
    y: float,
    size: float,
    near: float,
) -> tuple[float, float]:
    """Distances from a place to the nearest node and to the nearest wall, as far as they are below CLEAR sizes.

    The search ends early at a node nearer than `near`. Entries from `grid.given` to `grid.first` are markers on walls.
    """
    mask = len(grid.table) - 1
    low = level_of(size * (1.0 - SPREAD * grid.slope), grid.smallest)
    high = level_of(size * (1.0 + SPREAD * grid.slope), grid.smallest)
    # most places that are refused have a node in the very cell they fall into
    k = grid.table[slot(grid, low, x, y)]
    while k >= 0:
        if (grid.points[k, 0] - x) ** 2 + (
            grid.points[k, 1] - y
        ) ** 2 < near * near and not grid.given <= k < grid.first:
            return 0.0, 0.0
        k = grid.links[k, 0]
    radius = CLEAR * size
    square = radius * radius
    wall = radius
    for level in range(low, min(high + 1, grid.levels)):
        cell = 1.0 / (grid.smallest * (1 << level))
        left_column = int((x - radius - grid.left) * cell + 1.0)
        right_column = int((x + radius - grid.left) * cell + 1.0)
        top = int((y + radius - grid.bottom) * cell + 1.0)
        for row in range(int((y - radius - grid.bottom) * cell + 1.0), top + 1):
            base = row * grid.columns + level * LEVEL
            for column in range(left_column, right_column + 1):
                k = grid.table[(base + column) & mask]
                while k >= 0:
                    away = (grid.points[k, 0] - x) ** 2 + (grid.points[k, 1] - y) ** 2
                    if away < radius * radius:
                        if grid.given <= k < grid.first:
                            wall = min(wall, distance_to(grid.ends, grid.owner[k - grid.given], x, y)[0])
                        elif away < square:
                            square = away
                            if away < near * near:
                                return 0.0, 0.0
                    k = grid.links[k, 0]
    return np.sqrt(square), wall


@njit(cache=True, error_model="numpy")
def meet(ax: float, ay: float, bx: float, by: float, cx: float, cy: float, dx: float, dy: float) -> bool:
    """Whether the segments a-b and c-d have a point in common."""
    one = orient2d(ax, ay, bx, by, cx, cy) * orient2d(ax, ay, bx, by, dx, dy)
    return one <= 0.0 and orient2d(cx, cy, dx, dy, ax, ay) * orient2d(cx, cy, dx, dy, bx, by) <= 0.0


@njit(cache=True, error_model="numpy")
def cuts(segments: Floats, item: int, ax: float, ay: float, bx: float, by: float, cx: float, cy: float) -> bool:
    """Whether a wall edge reaches into the triangle of wall edge a-b and a place c in front of it."""
    px = segments[item, 0]
    py = segments[item, 1]
    qx = segments[item, 2]
    qy = segments[item, 3]
    if px == bx and py == by:
        return orient2d(ax, ay, bx, by, qx, qy) > 0.0 and orient2d(bx, by, cx, cy, qx, qy) > 0.0
    if qx == ax and qy == ay:
        return orient2d(ax, ay, bx, by, px, py) > 0.0 and orient2d(cx, cy, ax, ay, px, py) > 0.0
    if meet(px, py, qx, qy, ax, ay, cx, cy) or meet(px, py, qx, qy, bx, by, cx, cy):
        return True
    inside = orient2d(ax, ay, bx, by, px, py) > 0.0 and orient2d(bx, by, cx, cy, px, py) > 0.0
    return inside and orient2d(cx, cy, ax, ay, px, py) > 0.0


@njit(cache=True, error_model="numpy")
def is_cut(grid: NodeGrid, own: int, x: float, y: float, size: float) -> bool:
    """Whether another wall edge reaches into the triangle of wall edge `own` and the place (x, y) in front of it."""
    mask = len(grid.table) - 1
    ax = grid.ends[own, 0]
    ay = grid.ends[own, 1]
    bx = grid.ends[own, 2]
    by = grid.ends[own, 3]
    mx = 0.25 * (ax + bx) + 0.5 * x
    my = 0.25 * (ay + by) + 0.5 * y
    # no point of the triangle is farther from there, and half of the distance between markers
    reach = max((ax - mx) ** 2 + (ay - my) ** 2, (x - mx) ** 2 + (y - my) ** 2)
    radius = np.sqrt(reach) + 0.5 * MARK * size * (1.0 + grid.slope)
    low = level_of(size * (1.0 - SPREAD * grid.slope), grid.smallest)
    high = level_of(size * (1.0 + SPREAD * grid.slope), grid.smallest)
    for level in range(low, min(high + 1, grid.levels)):
        cell = 1.0 / (grid.smallest * (1 << level))
        left_column = int((mx - radius - grid.left) * cell + 1.0)
        right_column = int((mx + radius - grid.left) * cell + 1.0)
        top = int((my + radius - grid.bottom) * cell + 1.0)
        for row in range(int((my - radius - grid.bottom) * cell + 1.0), top + 1):
            for column in range(left_column, right_column + 1):
                k = grid.table[(row * grid.columns + column + level * LEVEL) & mask]
                while k >= 0:
                    if grid.given <= k < grid.first:
                        e = grid.owner[k - grid.given]
                        if e != own and cuts(grid.ends, e, ax, ay, bx, by, x, y):
                            return True
                    k = grid.links[k, 0]
    return False
