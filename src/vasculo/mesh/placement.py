"""Interior nodes: placed layer after layer from the walls, spaced by the size field."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from vasculo.geometry.boxtree import box_tree, distance_to, least

if TYPE_CHECKING:
    from numpy.typing import NDArray

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
    found = advance_layers(
        points, np.hstack((middle, across)),
        tree.segments, np.ascontiguousarray(normals), tree.weights, tree.boxes, tree.lowest,
        size.segments, size.weights, size.boxes, size.lowest, field.slope, field.largest,
        field.at(points), CLEAR, OFF_WALL, int(most),
    )  # fmt: skip
    return None if len(found) > most else found[len(points) :]


def _wall_normals(walls: Walls) -> NDArray[np.float64]:
    """Normals into the fluid at the start, on, and at the end of each segment; (m, 6) float64."""
    step = walls.segments[:, 2:] - walls.segments[:, :2]
    normal = np.column_stack((-step[:, 1], step[:, 0])) / walls.lengths[:, None]
    at_node = np.zeros((len(walls.nodes), 2))
    np.add.at(at_node, walls.edges[:, 0], normal)
    np.add.at(at_node, walls.edges[:, 1], normal)
    return np.hstack((at_node[walls.edges[:, 0]], normal, at_node[walls.edges[:, 1]]))


@njit(cache=True, error_model="numpy")
def slot(level, column, row, mask):  # type: ignore[no-untyped-def]
    """Place of a grid cell in the hash table."""
    return (level * 83492791 ^ column * 73856093 ^ row * 19349663) & mask


@njit(cache=True, error_model="numpy")
def advance_layers(
    points, fronts, walls, normals, zeros, wall_boxes, wall_lowest, sources, sizes, boxes, lowest, slope, largest,
    at_points, clear, off_wall, most,
):  # type: ignore[no-untyped-def]  # fmt: skip
    """All nodes: the given ones, then the interior ones in the order in which they were placed.

    `fronts` holds middle and normal of each wall edge; `at_points` the sizes at the given nodes. One node more than `most`
    is returned when there would be more.
    """
    # Strategy: first one candidate on the fluid side of each wall edge; then, first in first out, each accepted node
    # offers six candidates around itself, its own direction first. A candidate is taken when no node and no wall is too
    # near. Near nodes are found through grids of cell 2^level times the smallest size, hashed into one table; a node sits
    # in the grid of its own size, and since sizes vary slowly only three grids can hold a conflict. Two cells that share
    # a slot only cost time: every node found there is measured.
    given = len(points)
    smallest = at_points.min()
    mask = 1
    while mask < 4 * given:
        mask *= 2
    head = np.full(mask, -1, dtype=np.int64)
    room = 2 * mask
    x = np.empty(room)
    y = np.empty(room)
    h = np.empty(room)
    heading = np.zeros(room)
    link = np.empty(room, dtype=np.int64)
    count = 0
    tried = 0
    turn = 0
    parent = 0
    while True:
        if count < given:
            cx = points[count, 0]
            cy = points[count, 1]
            ch = at_points[count]
            angle = 0.0
            taken = True
        else:
            if tried < len(fronts):
                bx = fronts[tried, 0]
                by = fronts[tried, 1]
                angle = np.arctan2(fronts[tried, 3], fronts[tried, 2])
                bh = least(sources, sizes, boxes, lowest, slope, bx, by, largest, -1)[0] * 0.8660254037844386
                tried += 1
            else:
                if turn == 6:
                    turn = 0
                    parent += 1
                if parent == 0:
                    parent = given
                if parent >= count:
                    break
                bx = x[parent]
                by = y[parent]
                angle = heading[parent] + turn * 1.0471975511965976
                bh = h[parent]
                turn += 1
            ux = np.cos(angle)
            uy = np.sin(angle)
            ch = least(sources, sizes, boxes, lowest, slope, bx + ux * bh, by + uy * bh, largest, -1)[0]
            taken = True
            cx = bx + ux * bh
            cy = by + uy * bh
            if parent >= given:
                away = 0.5 * (bh + ch)
                cx = bx + ux * away
                cy = by + uy * away
            near, item = least(walls, zeros, wall_boxes, wall_lowest, 1.0, cx, cy, ch, -1)
            if item >= 0:
                t = distance_to(walls, item, cx, cy)[1]
                side = 0 if t == 0.0 else (4 if t == 1.0 else 2)
                wx = cx - walls[item, 0] - t * (walls[item, 2] - walls[item, 0])
                wy = cy - walls[item, 1] - t * (walls[item, 3] - walls[item, 1])
                taken = near >= off_wall * ch and wx * normals[item, side] + wy * normals[item, side + 1] > 0.0
        level = int(np.floor(np.log2(max(1.0, ch / smallest))))
        if taken and count >= given:
            r = clear * ch
            for l in range(max(0, level - 1), level + 2):
                cell = smallest * 2.0**l
                for column in range(int(np.floor((cx - r) / cell)), int(np.floor((cx + r) / cell)) + 1):
                    for row in range(int(np.floor((cy - r) / cell)), int(np.floor((cy + r) / cell)) + 1):
                        k = head[slot(l, column, row, mask - 1)]
                        while k >= 0:
                            if (x[k] - cx) ** 2 + (y[k] - cy) ** 2 < r * r:
                                taken = False
                                break
                            k = link[k]
                        if not taken:
                            break
                    if not taken:
                        break
                if not taken:
                    break
        if not taken:
            continue
        if count == room:
            room *= 2
            x = np.concatenate((x, np.empty(count)))
            y = np.concatenate((y, np.empty(count)))
            h = np.concatenate((h, np.empty(count)))
            heading = np.concatenate((heading, np.empty(count)))
            link = np.concatenate((link, np.empty(count, dtype=np.int64)))
        x[count] = cx
        y[count] = cy
        h[count] = ch
        heading[count] = angle
        cell = smallest * 2.0**level
        s = slot(level, int(np.floor(cx / cell)), int(np.floor(cy / cell)), mask - 1)
        link[count] = head[s]
        head[s] = count
        count += 1
        if count > most:
            break
    placed = np.empty((count, 2))
    placed[:, 0] = x[:count]
    placed[:, 1] = y[:count]
    return placed
