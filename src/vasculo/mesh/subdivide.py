"""Wall nodes: every outline segment cut evenly to the local size."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from vasculo.geometry.boxtree import STACK, distance_to, least
from vasculo.springs.threads import run_team

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.geometry.arrays import Floats, Longs
    from vasculo.mesh.size import SizeField
    from vasculo.mesh.walls import Walls

SLACK = 0.35
"""A segment may be this much longer (in local sizes) than its pieces should be before it gets one more piece."""

FINEST = 1e-15
"""Shortest step along a segment, in its lengths: shorter ones are lost in rounding."""

FEWEST = 500
"""Fewest segments of one thread."""


def wall_nodes(
    walls: Walls, field: SizeField, whole: NDArray[np.bool_] | None = None
) -> tuple[NDArray[np.float64], NDArray[np.int32], NDArray[np.int32]]:
    """Nodes and edges on all outlines.

    Parameters
    ----------
    walls : Walls
    field : SizeField
    whole : (m,) bool, optional
        Segments that are not cut.

    Returns
    -------
    points : (n, 2) float64, model length
        All outline nodes in the order of `walls.nodes`, then the new ones.
    edges : (e, 2) int32
        Directed wall edges, fluid on the left.
    segment : (e,) int32
        Outline segment that each edge is a piece of.
    """
    tree = field.sources
    segments = walls.segments
    cuttable = np.ones(len(segments), dtype=bool) if whole is None else ~whole
    pieces = np.ones(len(segments), dtype=np.int64)
    cut = np.ascontiguousarray(segments[cuttable])
    counts, first, sums = np.ones(len(cut), dtype=np.int64), np.zeros(len(cut), dtype=np.int64), np.zeros(len(cut))
    places = np.empty(0)
    for fill in range(2):
        run_team(
            cut_evenly, len(cut) // FEWEST + 1,
            cut, tree.segments, tree.weights, tree.boxes, tree.lowest, field.slope, field.largest,
            fill, counts, sums, first, places,
        )  # fmt: skip
        if fill == 0:
            counts = np.maximum(1, np.ceil(sums - SLACK)).astype(np.int64)
            first = np.cumsum(counts - 1) - (counts - 1)
            places = np.empty(int((counts - 1).sum()))
    pieces[cuttable] = counts
    # Strategy: the pieces of segment s are start, new nodes of s in order, end; their edges are consecutive pairs.
    owner = np.repeat(np.arange(len(segments)), pieces - 1)
    fresh = segments[owner, :2] + places[:, None] * (segments[owner, 2:] - segments[owner, :2])
    points = np.concatenate((walls.nodes, fresh))
    segment = np.repeat(np.arange(len(segments), dtype=np.int32), pieces)
    last = np.cumsum(pieces) - 1
    first = last - pieces + 1
    start = np.empty(len(segment), dtype=np.int32)
    end = np.empty(len(segment), dtype=np.int32)
    start[first], end[last] = walls.edges[:, 0], walls.edges[:, 1]
    inner = np.ones(len(segment), dtype=bool)
    inner[last] = False
    number = len(walls.nodes) + np.arange(len(fresh), dtype=np.int32)
    end[inner] = number
    start[np.flatnonzero(inner) + 1] = number
    return points, np.column_stack((start, end)), segment


@njit(cache=True, error_model="numpy", nogil=True)
def cut_evenly(
    rank: int,
    threads: int,
    walls: Floats,
    segments: Floats,
    weights: Floats,
    boxes: Floats,
    lowest: Floats,
    slope: float,
    largest: float,
    fill: int,
    pieces: Longs,
    sums: Floats,
    first: Longs,
    places: Floats,
) -> int:
    """Integrate ds / h along this thread's segments into `sums`; with `fill`, put cuts (0 to 1) into `places` instead.

    The cuts divide each segment into `pieces` with equal integrals; those of segment s begin at first[s].
    """
    # Strategy: march along each segment in steps of half the local size, summing ds / h (trapezoid in 1 / h); when
    # filling, walk the same way again and drop a cut at each equal share of the sum.
    stack = np.empty(STACK, dtype=np.int64)
    for s in range(rank * len(walls) // threads, (rank + 1) * len(walls) // threads):
        if fill == 1 and pieces[s] == 1:
            continue
        dx = walls[s, 2] - walls[s, 0]
        dy = walls[s, 3] - walls[s, 1]
        length = np.sqrt(dx * dx + dy * dy)
        share = sums[s] / pieces[s]
        done = first[s]
        reached = 0.0
        summed = 0.0
        cut = 1
        item = np.int64(-1)
        h, item = least(segments, weights, boxes, lowest, stack, slope, walls[s, 0], walls[s, 1], largest, item)
        while reached < length:
            step = min(0.5 * h, length - reached)
            step = max(step, FINEST * length)
            if length - reached - step < 1e-3 * step:
                step = length - reached
            t = (reached + step) / length
            x = walls[s, 0] + t * dx
            y = walls[s, 1] + t * dy
            bound = largest
            if item >= 0:
                bound = min(bound, weights[item] + slope * distance_to(segments, item, x, y)[0])
            new, item = least(segments, weights, boxes, lowest, stack, slope, x, y, bound, item)
            rise = 0.5 * step * (1.0 / h + 1.0 / new)
            while fill == 1 and cut < pieces[s] and summed + rise >= cut * share:
                places[done] = (reached + step * (cut * share - summed) / rise) / length
                done += 1
                cut += 1
            summed += rise
            reached += step
            h = new
        if fill == 0:
            sums[s] = summed
    return 0
