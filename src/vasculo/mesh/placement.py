"""Interior nodes: placed layer after layer from the walls, spaced by the size field."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from vasculo.geometry.boxtree import STACK, distance_to, least
from vasculo.mesh.nearby import CLEAR, NodeGrid, is_cut, level_of, markers_on, slot, surroundings
from vasculo.mesh.tight import mark_tight

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.geometry.arrays import Bytes, Floats, Longs
    from vasculo.mesh.size import SizeField

OFF_WALL = 0.6
"""No interior node is nearer to a wall than this many local sizes: above 1/2, so that no step crosses a wall."""

HEIGHT = 0.8660254037844386
"""Height over side of an equilateral triangle."""


def interior_nodes(
    field: SizeField,
    points: NDArray[np.float64],
    sizes: NDArray[np.float64],
    edges: NDArray[np.int32],
    expected: float,
    most: int,
) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
    """Place nodes strictly inside the fluid.

    Parameters
    ----------
    field : SizeField
    points : (n, 2) float64, model length
        Wall nodes.
    sizes : (n,) float64, model length
        Wanted edge length at each of them.
    edges : (e, 2) int32
        Wall edges, fluid on the left.
    expected : float
        Guess of the number of interior nodes; a good one saves time.
    most : int
        Largest number of nodes, wall nodes included.

    Returns
    -------
    places : (k, 2) float64, model length
        Interior nodes in the order of their placing.
    wanted : (k,) float64, model length
        Edge length wanted at each. None instead of both when there would be more than `most` nodes.
    """
    ends = np.hstack((points[edges[:, 0]], points[edges[:, 1]]))
    markers, owner = markers_on(ends, np.minimum(sizes[edges[:, 0]], sizes[edges[:, 1]]))
    marked = field.at(markers)
    low, high = points.min(axis=0), points.max(axis=0)
    smallest, tree = float(min(sizes.min(), marked.min())), field.sources
    tight, fineness = mark_tight(field, low, high)
    given, first = len(points), len(points) + len(markers)
    room = first + int(1.2 * max(expected, 100.0))
    while True:
        # Strategy: room for so many nodes; when they do not fit, twice as much room and once again from the start.
        places, facts = np.empty((room, 2)), np.empty((room, 3))
        places[:given], places[given:first] = points, markers
        facts[:given, 0], facts[given:first, 0] = sizes, marked
        links = np.empty((room, 2), dtype=np.int32)
        table = np.full(1 << int(2 * room).bit_length(), -1, dtype=np.int32)
        columns, levels = int((high[0] - low[0]) / smallest) + 3, level_of(field.largest, smallest) + 1
        grid = NodeGrid(
            places, given, first, links, table, ends, owner, low[0], low[1], smallest, columns, levels, field.slope
        )
        stack = np.empty(STACK, dtype=np.int64)
        count = advance_layers(
            grid, facts, tight, fineness, tree.segments, tree.weights, tree.boxes, tree.lowest, stack, field.largest
        )
        if count - len(markers) > most:
            return None
        if count < room:
            return places[first:count].copy(), facts[first:count, 0].copy()
        room = min(2 * room, most + len(markers) + 2)


@njit(cache=True, error_model="numpy")
def advance_layers(
    grid: NodeGrid,
    facts: Floats,
    tight: Bytes,
    fineness: float,
    sources: Floats,
    sizes: Floats,
    boxes: Floats,
    lowest: Floats,
    stack: Longs,
    largest: float,
) -> int:
    """Place interior nodes behind the entries that the grid holds; returns the number of entries, at most the room.

    Overwrites `facts` (size and heading of each entry; given: the sizes of wall nodes and markers), the arrays of the
    grid (links and table need no content but -1 in the table) and `stack`. Where `tight` is 0 the size is the largest.
    """
    # Strategy: one candidate in front of each wall edge, at the height of an equilateral triangle; then each accepted
    # node, first in first out, offers six places around itself, turned so that the first layer, which is a row along
    # the wall, is a row of its lattice. A place is taken when no node and no wall is too near. Near nodes are found
    # through grids with cells of 2^level times the smallest size, hashed into one table; a node sits in the grid of its
    # own size, and since sizes vary slowly few grids can hold a conflict. Two cells that share a slot only cost time.
    points, first, links, table, ends = grid.points, grid.first, grid.links, grid.table, grid.ends
    slope = grid.slope
    for k in range(first):
        s = slot(grid, level_of(facts[k, 0], grid.smallest), points[k, 0], points[k, 1])
        links[k, 0] = table[s]
        table[s] = k
    count = first
    seeds = first
    tried = 0
    parent = first
    turn = 0
    x = 0.0
    y = 0.0
    size = 0.0
    ux = 0.0
    uy = 0.0
    while count < len(points):
        seed = tried < len(ends)
        if seed:
            x = 0.5 * (ends[tried, 0] + ends[tried, 2])
            y = 0.5 * (ends[tried, 1] + ends[tried, 3])
            ex = ends[tried, 2] - ends[tried, 0]
            ey = ends[tried, 3] - ends[tried, 1]
            length = np.sqrt(ex * ex + ey * ey)
            ux = -ey / length
            uy = ex / length
            size, item = least(sources, sizes, boxes, lowest, stack, slope, x, y, largest, np.int64(-1))
            reach = HEIGHT * size
            tried += 1
        else:
            if turn == 6:
                turn = 0
                parent += 1
            if parent >= count:
                break
            if turn == 0:
                x = points[parent, 0]
                y = points[parent, 1]
                size = facts[parent, 0]
                ux = facts[parent, 1]
                uy = facts[parent, 2]
            else:
                ux, uy = 0.5 * ux - HEIGHT * uy, HEIGHT * ux + 0.5 * uy
            turn += 1
            if turn == 4 and parent >= seeds:
                continue  # its own parent lies there
            item = np.int64(links[parent, 1])
            reach = size
        cx = x + reach * ux
        cy = y + reach * uy
        node = 0.0
        wall = 0.0
        if not seed:
            # a node this near would be too near whatever the size here, as sizes vary slowly
            near = CLEAR * (1.0 - slope) * size
            node, wall = surroundings(grid, cx, cy, size, near)
            if node < near or wall < OFF_WALL * (1.0 - slope) * size:
                continue
        row = min(max(int((cy - grid.bottom) * fineness), 0), tight.shape[0] - 1)
        column = min(max(int((cx - grid.left) * fineness), 0), tight.shape[1] - 1)
        wanted = largest
        if tight[row, column]:
            if item >= 0:
                wanted = min(wanted, sizes[item] + slope * distance_to(sources, item, cx, cy)[0])
            wanted, item = least(sources, sizes, boxes, lowest, stack, slope, cx, cy, wanted, item)
        else:
            item = np.int64(-1)
        if seed:
            wanted = min(wanted, size)
        if seed or wanted != size:
            if not seed:
                cx = x + 0.5 * (size + wanted) * ux
                cy = y + 0.5 * (size + wanted) * uy
            near = CLEAR * wanted
            node, wall = surroundings(grid, cx, cy, wanted, near)
        if node < CLEAR * wanted or wall < OFF_WALL * wanted:
            continue
        facts[count, 1] = ux
        facts[count, 2] = uy
        if seed:
            if is_cut(grid, tried - 1, cx, cy, size):
                continue
            facts[count, 1] = HEIGHT * ux - 0.5 * uy
            facts[count, 2] = 0.5 * ux + HEIGHT * uy
            seeds = count + 1
        points[count, 0] = cx
        points[count, 1] = cy
        facts[count, 0] = wanted
        s = slot(grid, level_of(wanted, grid.smallest), cx, cy)
        links[count, 0] = table[s]
        links[count, 1] = item
        table[s] = count
        count += 1
    return count
