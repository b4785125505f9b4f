"""Passages: how wide the fluid is in front of each piece of wall."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from vasculo.geometry.boxtree import LEAF, STACK, box_tree, distance_to, reach

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.geometry.arrays import Floats, Ints, Longs
    from vasculo.mesh.walls import Walls

FACING = 0.5
"""Smallest cosine between a wall's normal and the way across, for a passage inside one outline."""

DETOUR = 2.5
"""The way along the outline is at least this many times the way across, for a passage inside one outline."""

TOUCHING = 1e-9
"""Segments that meet are this close along the outline, in outline lengths; they do not face each other."""

PIECES = 64
"""Most samples on one wall segment."""


@dataclass(frozen=True, eq=False)
class Passages:
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


def passages_of(walls: Walls, widest: float) -> Passages:
    """Measure all passages up to a width.

    Parameters
    ----------
    walls : Walls
    widest : float, model length
        Wider passages are left out.

    Returns
    -------
    Passages
        Samples where something lies in front within `widest`.
    """
    tree = box_tree(walls.segments)
    order = tree.order
    facts = np.column_stack((walls.arc, walls.lengths, walls.around))[order]
    bodies = np.ascontiguousarray(walls.body[order])
    # Strategy: sample ends and middles; then sample each segment again at half of the gap found on it.
    pieces = np.full(len(walls.edges), 2)
    for _ in range(2):
        segment = np.repeat(np.arange(len(pieces)), pieces)
        first = np.cumsum(pieces) - pieces
        place = (np.arange(len(segment)) - first[segment]) / pieces[segment]
        gap = np.full(len(segment), float(widest))
        hit = np.full(len(segment), -1, dtype=np.int64)
        along = np.zeros(len(segment))
        nearest_facing(
            tree.segments, bodies, facts, tree.boxes, tree.lowest, np.empty(STACK, dtype=np.int64),
            walls.segments[segment], place, walls.body[segment], walls.arc[segment], gap, hit, along,
        )  # fmt: skip
        narrowest = np.minimum.reduceat(gap, first)
        used, pieces = pieces, np.clip(np.ceil(2.0 * walls.lengths / narrowest), 2, PIECES).astype(np.int64)
    share = (walls.lengths / used)[segment]
    near = np.flatnonzero(hit >= 0)
    segment, place, hit, along = segment[near], place[near], hit[near], along[near]
    start, step = walls.segments[segment, :2], np.diff(walls.segments.reshape(-1, 2, 2), axis=1)[segment, 0]
    half = 0.5 / used[segment]
    low, high = np.maximum(place - half, 0.0), np.where(place + 2.5 * half > 1.0, 1.0, place + half)
    opposite = tree.segments[hit]
    return Passages(
        points=start + place[:, None] * step,
        across=opposite[:, :2] + along[:, None] * (opposite[:, 2:] - opposite[:, :2]),
        pieces=np.hstack((start + low[:, None] * step, start + high[:, None] * step)),
        gap=gap[near],
        share=share[near],
        segment=segment,
        body=walls.body[segment],
        other=bodies[hit],
    )


@njit(cache=True, error_model="numpy")
def nearest_facing(
    segments: Floats,
    bodies: Ints,
    facts: Floats,
    boxes: Floats,
    lowest: Floats,
    stack: Longs,
    own: Floats,
    place: Floats,
    body: Ints,
    arc: Floats,
    gap: Floats,
    hit: Longs,
    along: Floats,
) -> None:
    """Distance to the nearest other outline, or facing part of the same one, in front of each wall sample.

    `facts` holds arc, length and outline length of the tree's segments; `own` the sample's segment, `place` where on it
    the sample lies (0 to 1). Overwrites `gap` (given: the largest distance looked for), `hit` (the segment found;
    given: -1), `along` (the place on it) and the buffer `stack`.
    """
    leaves = len(lowest) // 2
    for i in range(len(place)):
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
                    away = abs(facts[k, 0] + t * facts[k, 1] - here)
                    away = min(away, facts[k, 2] - away)
                    before = abs(facts[k, 0] + facts[k, 1] - arc[i])
                    after = abs(arc[i] + length - facts[k, 0])
                    touch = min(before, abs(before - facts[k, 2]), after, abs(after - facts[k, 2]))
                    if (
                        min(away - DETOUR * distance, touch) <= TOUCHING * facts[k, 2]
                        or dx * wy - dy * wx < FACING * distance * length
                        or ey * wx - ex * wy < FACING * distance * facts[k, 1]
                    ):
                        continue
                gap[i] = distance
                hit[i] = k
                along[i] = t
