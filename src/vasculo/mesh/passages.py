"""Passages: how wide the fluid is in front of each piece of wall."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from vasculo.geometry.boxtree import LEAF, STACK, box_tree, distance_to, reach
from vasculo.springs.threads import run_team

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.geometry.arrays import Floats, Ints, Longs
    from vasculo.geometry.boxtree import BoxTree
    from vasculo.mesh.walls import Walls

FACING = 0.5
"""Smallest cosine between a wall's normal and the way across, for a passage inside one outline."""

DETOUR = 2.5
"""The way along the outline is at least this many times the way across, for a passage inside one outline."""

TOUCHING = 1e-9
"""Segments that meet are this close along the outline, in outline lengths; they do not face each other."""

EVEN = 0.5
"""A piece of wall reaches this many of its least possible gaps from the place that it is looked at from."""

HALVINGS = 40
"""How often a piece may be halved."""

MOST_PIECES = 1_000_000
"""Most pieces that are looked at together: so many narrow ones would make a mesh that is refused anyway."""

FEWEST = 1000
"""Fewest samples of one thread."""


@dataclass(frozen=True, eq=False)
class WallSamples:
    """Wall points with the nearest wall in front of them.

    Parameters
    ----------
    points, across : (s, 2) float64, model length
        Wall point, and the nearest point of another outline (or of a facing part of its own).
    pieces : (s, 4) float64, model length
        Piece of wall that the point stands for, its start and its end.
    gap : (s,) float64, model length
        Distance between the two.
    share : (s,) float64, model length
        Length of wall that the point stands for.
    segment : (s,) int64
        Wall segment of the point.
    body, other : (s,) int32
        Outlines on both sides, numbered as in `Walls`.
    """

    points: NDArray[np.float64]
    across: NDArray[np.float64]
    pieces: NDArray[np.float64]
    gap: NDArray[np.float64]
    share: NDArray[np.float64]
    segment: NDArray[np.int64]
    body: NDArray[np.int32]
    other: NDArray[np.int32]


def passages_of(walls: Walls, widest: float) -> WallSamples:
    """Measure all passages up to a width.

    Parameters
    ----------
    walls : Walls
    widest : float, model length
        Wider passages are left out.

    Returns
    -------
    WallSamples
        Samples where something lies in front within `widest`.
    """
    # Strategy: pieces of wall, each looked at from one place on it. Gaps change along a wall no faster than the place,
    # so a piece that reaches far from its place, compared with the gap there, is halved; one that no gap below `widest`
    # can lie on is dropped. The first piece of a segment is looked at from its node, where outlines come nearest.
    tree = box_tree(walls.segments)
    count, bodies, facts = len(walls.edges), walls.body[tree.order], walls.facts[tree.order]
    segment = np.repeat(np.arange(count), 2)
    low, high = np.tile([0.0, 0.25], count), np.tile([0.25, 1.0], count)
    whole: list[NDArray[np.int64]] = []
    parts: list[NDArray[np.float64]] = []
    for depth in range(HALVINGS + 1):
        place = np.where(low > 0.0, 0.5 * (low + high), 0.0)
        far = (high - place) * walls.lengths[segment]
        gap, hit, along = _measure(walls, tree, bodies, facts, segment, place, widest + far)
        near = (hit >= 0) & (gap - far < widest)
        split = near & (far > EVEN * np.maximum(gap - far, 0.0)) & (depth < HALVINGS)
        if 2 * np.count_nonzero(split) > MOST_PIECES:
            split[:] = False
        kept = np.flatnonzero(near & ~split & (gap < widest))
        whole.append(np.column_stack((segment, tree.order[hit]))[kept])
        parts.append(np.column_stack((place, low, high, gap, along))[kept])
        if not split.any():
            break
        middle = 0.5 * (low + high)[split]
        segment = np.repeat(segment[split], 2)
        low = np.column_stack((low[split], middle)).ravel()
        high = np.column_stack((middle, high[split])).ravel()
    segment, opposite = np.concatenate(whole).T
    place, low, high, gap, along = np.concatenate(parts).T
    order = np.lexsort((place, segment))
    segment, opposite = segment[order], opposite[order]
    place, low, high, gap, along = (part[order] for part in (place, low, high, gap, along))
    lines = walls.segments
    start, step = lines[segment, :2], lines[segment, 2:] - lines[segment, :2]
    beyond, way = lines[opposite, :2], lines[opposite, 2:] - lines[opposite, :2]
    return WallSamples(
        points=start + place[:, None] * step,
        across=beyond + along[:, None] * way,
        pieces=np.hstack((start + low[:, None] * step, start + high[:, None] * step)),
        gap=gap,
        share=(high - low) * walls.lengths[segment],
        segment=segment,
        body=walls.body[segment],
        other=walls.body[opposite],
    )


def _measure(
    walls: Walls,
    tree: BoxTree,
    bodies: NDArray[np.int32],
    facts: NDArray[np.float64],
    segment: NDArray[np.int64],
    place: NDArray[np.float64],
    widest: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.float64]]:
    """Gap in front of each sample, the segment of the tree found there (-1: none within `widest`), and where on it."""
    gap, hit, along = widest.copy(), np.full(len(segment), -1), np.zeros(len(segment))
    run_team(
        nearest_facing, len(segment) // FEWEST + 1, tree.segments, bodies, facts, tree.boxes, tree.lowest,
        walls.segments[segment], place, walls.body[segment], walls.arc[segment], gap, hit, along,
    )  # fmt: skip
    return gap, hit, along


@njit(cache=True, error_model="numpy", nogil=True)
def nearest_facing(
    rank: int,
    threads: int,
    segments: Floats,
    bodies: Ints,
    facts: Floats,
    boxes: Floats,
    lowest: Floats,
    own: Floats,
    place: Floats,
    body: Ints,
    arc: Floats,
    gap: Floats,
    hit: Longs,
    along: Floats,
) -> int:
    """Distance to the nearest other outline, or facing part of the same one, in front of this thread's wall samples.

    `facts` holds arc, length and outline length of the tree's segments; `own` the sample's segment, `place` where on it
    the sample lies (0 to 1). Overwrites `gap` (given: the largest distance looked for), `hit` (the segment found;
    given: -1) and `along` (the place on it).
    """
    stack = np.empty(STACK, dtype=np.int64)
    leaves = len(lowest) // 2
    for i in range(rank * len(place) // threads, (rank + 1) * len(place) // threads):
        dx = own[i, 2] - own[i, 0]
        dy = own[i, 3] - own[i, 1]
        length = np.sqrt(dx * dx + dy * dy)
        x = own[i, 0] + place[i] * dx
        y = own[i, 1] + place[i] * dy
        here = arc[i] + place[i] * length
        stack[0] = 1
        top = 1
        while top > 0:
            top -= 1
            box = stack[top]
            if reach(boxes, lowest, 1.0, box, x, y) >= gap[i]:
                continue
            if box < leaves:
                near = 2 * box
                if reach(boxes, lowest, 1.0, near, x, y) > reach(boxes, lowest, 1.0, near + 1, x, y):
                    near += 1
                stack[top] = near ^ 1
                stack[top + 1] = near
                top += 2
                continue
            first = (box - leaves) * LEAF
            for k in range(first, min(first + LEAF, len(bodies))):
                distance, t = distance_to(segments, k, x, y)
                if distance >= gap[i]:
                    continue
                if bodies[k] == body[i]:
                    ex = segments[k, 2] - segments[k, 0]
                    ey = segments[k, 3] - segments[k, 1]
                    wx = segments[k, 0] + t * ex - x
                    wy = segments[k, 1] + t * ey - y
                    if (
                        dx * wy - dy * wx < FACING * distance * length
                        or ey * wx - ex * wy < FACING * distance * facts[k, 1]
                    ):
                        continue
                    away = abs(facts[k, 0] + t * facts[k, 1] - here)
                    away = min(away, facts[k, 2] - away)
                    before = abs(facts[k, 0] + facts[k, 1] - arc[i])
                    after = abs(arc[i] + length - facts[k, 0])
                    touch = min(before, abs(before - facts[k, 2]), after, abs(after - facts[k, 2]))
                    if min(away - DETOUR * distance, touch) <= TOUCHING * facts[k, 2]:
                        continue
                gap[i] = distance
                hit[i] = k
                along[i] = t
    return 0
