"""Interior nodes: placed layer after layer from the walls, spaced by the size field."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numba import njit

from vasculo.geometry.boxtree import STACK, distance_to, least
from vasculo.mesh.nearby import CLEAR, NodeGrid, is_cut, level_of, markers_on, slot, surroundings
from vasculo.mesh.tight import mark_tight
from vasculo.springs.threads import run_team

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.geometry.arrays import Bytes, Floats, Longs
    from vasculo.mesh.size import SizeField

STRIP = 20_000
"""Expected nodes from which on a domain is cut into strips, one for so many."""

MOST_STRIPS = 16

NARROWEST = 20.0
"""A strip is at least this many largest sizes wide."""

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
    smallest = float(min(sizes.min(), marked.min()))
    tight, fineness = mark_tight(field, low, high)
    axis = int(np.argmax(high - low))
    scene = _Scene(
        field, points, sizes, ends, markers, marked, owner, tight, fineness, low, smallest,
        int((high[0] - low[0]) / smallest) + 3, level_of(field.largest, smallest) + 1, axis, most,
    )  # fmt: skip
    # Strategy: a large domain is cut into strips that are filled side by side, nearly up to the cuts; then the seams
    # are filled, from the nodes beside them. Strips depend on the sizes alone: the number of threads changes no bit.
    reach = field.largest
    strips = int(min(expected // STRIP, MOST_STRIPS, (high[axis] - low[axis]) // (NARROWEST * reach)))
    cuts = low[axis] + (high[axis] - low[axis]) * np.arange(1, strips) / max(strips, 1)
    ends_of = np.concatenate(([-np.inf], cuts, [np.inf]))
    none = np.empty((0, 2)), np.empty((0, 3))
    inner = [
        _Strip((a, b), (a + 0.5 * reach, b - 0.5 * reach), *none, 1.2 * expected / max(strips, 1))
        for a, b in pairwise(ends_of)
    ]
    filled = _fill(scene, inner)
    if filled is None or not len(cuts):
        return None if filled is None else (filled[0], filled[1][:, 0].copy())
    places, facts = filled
    seams = []
    for cut in cuts:
        away = np.abs(places[:, axis] - cut)
        near = np.flatnonzero(away < 3.5 * reach)
        near = near[np.argsort(away[near] < 1.5 * reach, kind="stable")]  # those beside the cut last: they are parents
        seam = _Strip(
            (cut - 1.5 * reach, cut + 1.5 * reach), (cut - 2.5 * reach, cut + 2.5 * reach),
            places[near], facts[near], 500.0 + 10.0 * len(near), int(np.count_nonzero(away[near] < 1.5 * reach)),
        )  # fmt: skip
        seams.append(seam)
    closed = _fill(scene, seams)
    if closed is None or len(points) + len(places) + len(closed[0]) > most:
        return None
    return np.concatenate((places, closed[0])), np.concatenate((facts[:, 0], closed[1][:, 0]))


class _Scene(NamedTuple):
    """What all strips share."""

    field: SizeField
    points: NDArray[np.float64]
    sizes: NDArray[np.float64]
    ends: NDArray[np.float64]
    markers: NDArray[np.float64]
    marked: NDArray[np.float64]
    owner: NDArray[np.int32]
    tight: NDArray[np.uint8]
    fineness: float
    low: NDArray[np.float64]
    smallest: float
    columns: int
    levels: int
    axis: int
    most: int


class _Strip(NamedTuple):
    """A part of the domain between two lines, with nodes that stand there; the last `parents` of them offer places."""

    seeds: tuple[float, float]
    limits: tuple[float, float]
    places: NDArray[np.float64]
    facts: NDArray[np.float64]
    expected: float
    parents: int = 0


def _fill(scene: _Scene, strips: list[_Strip]) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
    """Fill strips side by side; new nodes (k, 2) and their facts (k, 3), or None when there are too many."""
    found: list[tuple[NDArray[np.float64], NDArray[np.float64]] | None] = [None] * len(strips)

    def work(rank: int, threads: int) -> int:
        for k in range(rank, len(strips), threads):
            found[k] = _fill_one(scene, strips[k])
        return 0

    run_team(work, len(strips))
    done = [part for part in found if part is not None]
    if len(done) < len(strips) or len(scene.points) + sum(len(part[0]) for part in done) > scene.most:
        return None
    return np.concatenate([part[0] for part in done]), np.concatenate([part[1] for part in done])


def _fill_one(scene: _Scene, strip: _Strip) -> tuple[NDArray[np.float64], NDArray[np.float64]] | None:
    """Fill one strip."""
    field, tree = scene.field, scene.field.sources
    reach = 2.0 * field.largest
    near, by = (
        np.flatnonzero((at > strip.limits[0] - reach) & (at < strip.limits[1] + reach))
        for at in (scene.points[:, scene.axis], scene.markers[:, scene.axis])
    )
    given, first = len(near), len(near) + len(by)
    begin = first + len(strip.places)
    room = begin + int(max(strip.expected, 200.0))
    while True:
        # Strategy: room for so many nodes; when they do not fit, twice as much room and once again from the start.
        places, facts = np.empty((room, 2)), np.empty((room, 3))
        places[:given], places[given:first], places[first:begin] = scene.points[near], scene.markers[by], strip.places
        facts[:given, 0], facts[given:first, 0], facts[first:begin] = scene.sizes[near], scene.marked[by], strip.facts
        links = np.full((room, 2), -1, dtype=np.int32)
        table = np.full(1 << int(2 * room).bit_length(), -1, dtype=np.int32)
        grid = NodeGrid(
            places, given, first, links, table, scene.ends, scene.owner[by],
            scene.low[0], scene.low[1], scene.smallest, scene.columns, scene.levels, field.slope,
        )  # fmt: skip
        count = advance_layers(
            grid, facts, scene.tight, scene.fineness, tree.segments, tree.weights, tree.boxes, tree.lowest,
            np.empty(STACK, dtype=np.int64), field.largest, begin, begin - strip.parents, scene.axis,
            *strip.seeds, *strip.limits,
        )  # fmt: skip
        if count < room:
            return places[begin:count].copy(), facts[begin:count].copy()
        if room > first + 2 * scene.most:
            return None
        room *= 2


@njit(cache=True, error_model="numpy", nogil=True)
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
    begin: int,
    parent: int,
    axis: int,
    seed_low: float,
    seed_high: float,
    limit_low: float,
    limit_high: float,
) -> int:
    """Place interior nodes behind the `begin` entries given; returns the number of entries, at most the room.

    Overwrites `facts` (size and heading of each entry; given: sizes of wall nodes and markers, all of interior nodes),
    the arrays of the grid and `stack`. Where `tight` is 0 the size is the largest. Given nodes from `parent` on offer
    places too. Wall edges with their middle between the seed lines have a candidate; nodes stay between the limits.
    """
    # Strategy: one candidate in front of each wall edge, at the height of an equilateral triangle; then each accepted
    # node, first in first out, offers six places around itself, turned so that the first layer, which is a row along
    # the wall, is a row of its lattice. A place is taken when no node and no wall is too near. Near nodes are found
    # through grids with cells of 2^level times the smallest size, hashed into one table; a node sits in the grid of its
    # own size, and since sizes vary slowly few grids can hold a conflict. Two cells that share a slot only cost time.
    points, links, table, ends = grid.points, grid.links, grid.table, grid.ends
    slope = grid.slope
    for k in range(begin):
        s = slot(grid, level_of(facts[k, 0], grid.smallest), points[k, 0], points[k, 1])
        links[k, 0] = table[s]
        table[s] = k
    count = begin
    seeds = begin
    tried = 0
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
            tried += 1
            middle = x if axis == 0 else y
            if middle < seed_low or middle >= seed_high:
                continue
            length = np.sqrt(ex * ex + ey * ey)
            ux = -ey / length
            uy = ex / length
            size, item = least(sources, sizes, boxes, lowest, stack, slope, x, y, largest, np.int64(-1))
            reach = HEIGHT * size
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
        at = cx if axis == 0 else cy
        if at < limit_low or at >= limit_high:
            continue
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
                at = cx if axis == 0 else cy
                if at < limit_low or at >= limit_high:
                    continue
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
