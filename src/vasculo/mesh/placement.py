"""Interior nodes: placed layer after layer from the walls, spaced by the size field."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from vasculo.geometry.boxtree import STACK, box_tree, distance_to, least

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.geometry.arrays import Floats, Longs
    from vasculo.mesh.size import SizeField
    from vasculo.mesh.walls import Walls

CLEAR = 0.75
"""No two interior nodes are nearer than this many local sizes."""

OFF_WALL = 0.6
"""No interior node is nearer to a wall than this many local sizes."""


def interior_nodes(
    walls: Walls,
    field: SizeField,
    points: NDArray[np.float64],
    edges: NDArray[np.int32],
    most: int,
) -> NDArray[np.float64] | None:
    """Place nodes strictly inside the fluid.

    Parameters
    ----------
    walls : Walls
    field : SizeField
    points : (n, 2) float64, model length
        Wall nodes.
    edges : (e, 2) int32
        Wall edges, fluid on the left.
    most : int
        Largest number of nodes, wall nodes included.

    Returns
    -------
    (k, 2) float64, model length, or None
        Interior nodes; None when there would be more than `most`.
    """
    tree, size = box_tree(walls.segments), field.sources
    normals = _wall_normals(walls)[tree.order]
    step = points[edges[:, 1]] - points[edges[:, 0]]
    middle = 0.5 * (points[edges[:, 0]] + points[edges[:, 1]])
    across = np.column_stack((-step[:, 1], step[:, 0])) / np.hypot(step[:, 0], step[:, 1])[:, None]
    at_points = field.at(points)
    room = 4 * len(points)
    while True:
        # Strategy: room for so many nodes; when they do not fit, twice as much room and once again from the start.
        table = np.full(1 << int(room).bit_length(), -1, dtype=np.int64)
        placed, index, real = np.empty((room, 2)), np.empty((room, 2), dtype=np.int64), np.empty((room, 2))
        placed[: len(points)], real[: len(points), 0] = points, at_points
        count = advance_layers(
            placed, index, real, table, len(points), np.hstack((middle, across)),
            tree.segments, np.ascontiguousarray(normals), tree.weights, tree.boxes, tree.lowest,
            size.segments, size.weights, size.boxes, size.lowest, np.empty(STACK, dtype=np.int64),
            field.slope, field.largest, float(at_points.min()), CLEAR, OFF_WALL,
        )  # fmt: skip
        if count > most:
            return None
        if count < room:
            return placed[len(points) : count].copy()
        room = min(4 * room, most + 2)


def _wall_normals(walls: Walls) -> NDArray[np.float64]:
    """Point into the fluid: normals at the start, on, and at the end of each segment; (m, 6) float64."""
    step = walls.segments[:, 2:] - walls.segments[:, :2]
    normal = np.column_stack((-step[:, 1], step[:, 0])) / walls.lengths[:, None]
    at_node = np.zeros((len(walls.nodes), 2))
    np.add.at(at_node, walls.edges[:, 0], normal)
    np.add.at(at_node, walls.edges[:, 1], normal)
    return np.hstack((at_node[walls.edges[:, 0]], normal, at_node[walls.edges[:, 1]]))


@njit(cache=True, error_model="numpy")
def slot(level: int, column: int, row: int, mask: int) -> int:
    """Place of a grid cell in the hash table."""
    return (level * 83492791 ^ column * 73856093 ^ row * 19349663) & mask


@njit(cache=True, error_model="numpy")
def crowded(
    points: Floats, index: Longs, table: Longs, smallest: float, cx: float, cy: float, ch: float, radius: float
) -> bool:
    """Whether a node lies within a radius of a place where the wanted size is about ch."""
    level = int(np.log2(max(1.0, ch / smallest)))
    for near in range(max(0, level - 1), level + 2):
        cell = smallest * 2.0**near
        last_row = int(np.floor((cy + radius) / cell))
        for column in range(int(np.floor((cx - radius) / cell)), int(np.floor((cx + radius) / cell)) + 1):
            for row in range(int(np.floor((cy - radius) / cell)), last_row + 1):
                k = table[slot(near, column, row, len(table) - 1)]
                while k >= 0:
                    if (points[k, 0] - cx) ** 2 + (points[k, 1] - cy) ** 2 < radius * radius:
                        return True
                    k = index[k, 0]
    return False


@njit(cache=True, error_model="numpy")
def advance_layers(
    points: Floats,
    index: Longs,
    real: Floats,
    table: Longs,
    given: int,
    fronts: Floats,
    walls: Floats,
    normals: Floats,
    zeros: Floats,
    wall_boxes: Floats,
    wall_lowest: Floats,
    sources: Floats,
    sizes: Floats,
    boxes: Floats,
    lowest: Floats,
    stack: Longs,
    slope: float,
    largest: float,
    smallest: float,
    clear: float,
    off_wall: float,
) -> int:
    """Place interior nodes behind the `given` ones; returns the number of nodes, at most the room in `points`.

    Overwrites `points`, `index` (next node in the same slot, source of the size), `real` (size and heading),
    the hash `table` (a power of two long, given: -1) and `stack`. `fronts` holds middle and normal of each wall edge.
    """
    # Strategy: first one candidate on the fluid side of each wall edge; then, first in first out, each accepted node
    # offers six candidates around itself, its own direction first. A candidate is taken when no node and no wall is too
    # near. Near nodes are found through grids of cell 2^level times the smallest size, hashed into one table; a node
    # sits in the grid of its own size, and since sizes vary slowly only three grids can hold a conflict. Two cells that
    # share a slot only cost time: every node found there is measured.
    count = 0
    tried = 0
    turn = 0
    parent = given
    while count < len(points):
        item = np.int64(-1)
        angle = 0.0
        if count < given:
            cx = points[count, 0]
            cy = points[count, 1]
            ch = real[count, 0]
        else:
            seed = tried < len(fronts)
            if seed:
                bx = fronts[tried, 0]
                by = fronts[tried, 1]
                angle = np.arctan2(fronts[tried, 3], fronts[tried, 2])
                bh, item = least(sources, sizes, boxes, lowest, stack, slope, bx, by, largest, item)
                bh *= 0.8660254037844386
                tried += 1
            else:
                if turn == 6:
                    turn = 0
                    parent += 1
                if parent >= count:
                    break
                bx = points[parent, 0]
                by = points[parent, 1]
                angle = real[parent, 1] + turn * 1.0471975511965976
                bh = real[parent, 0]
                item = index[parent, 1]
                turn += 1
            ux = np.cos(angle)
            uy = np.sin(angle)
            cx = bx + ux * bh
            cy = by + uy * bh
            # a node this near would be too near whatever the size here, as sizes vary slowly
            if not seed and crowded(points, index, table, smallest, cx, cy, bh, clear * (1.0 - slope) * bh):
                continue
            ch = largest
            if item >= 0:
                ch = min(largest, sizes[item] + slope * distance_to(sources, item, cx, cy)[0])
            ch, item = least(sources, sizes, boxes, lowest, stack, slope, cx, cy, ch, item)
            if seed:
                ch = min(ch, bh / 0.8660254037844386)
            else:
                cx = bx + 0.5 * ux * (bh + ch)
                cy = by + 0.5 * uy * (bh + ch)
            if crowded(points, index, table, smallest, cx, cy, ch, clear * ch):
                continue
            near, wall = least(walls, zeros, wall_boxes, wall_lowest, stack, 1.0, cx, cy, ch, np.int64(-1))
            if wall >= 0:
                t = distance_to(walls, wall, cx, cy)[1]
                side = 0 if t == 0.0 else (4 if t == 1.0 else 2)
                wx = cx - walls[wall, 0] - t * (walls[wall, 2] - walls[wall, 0])
                wy = cy - walls[wall, 1] - t * (walls[wall, 3] - walls[wall, 1])
                if near < off_wall * ch or wx * normals[wall, side] + wy * normals[wall, side + 1] <= 0.0:
                    continue
        points[count, 0] = cx
        points[count, 1] = cy
        real[count, 0] = ch
        real[count, 1] = angle
        level = int(np.log2(max(1.0, ch / smallest)))
        cell = smallest * 2.0**level
        s = slot(level, int(np.floor(cx / cell)), int(np.floor(cy / cell)), len(table) - 1)
        index[count, 0] = table[s]
        index[count, 1] = item
        table[s] = count
        count += 1
    return count
