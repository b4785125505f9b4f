"""Wall nodes: every outline segment cut evenly to the local size."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from vasculo.geometry.boxtree import least

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.mesh.size import SizeField
    from vasculo.mesh.walls import Walls

SLACK = 0.15
"""A segment may be this much longer (in local sizes) than its pieces should be before it gets one more piece."""


def wall_nodes(
    walls: Walls, field: SizeField
) -> tuple[NDArray[np.float64], NDArray[np.int32], NDArray[np.int32]]:
    """Nodes and edges on all outlines.

    Parameters
    ----------
    walls : Walls
    field : SizeField

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
    pieces, places = cut_evenly(
        segments, tree.segments, tree.weights, tree.boxes, tree.lowest, field.slope, field.largest, SLACK
    )
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


@njit(cache=True, error_model="numpy")
def cut_evenly(walls, segments, weights, boxes, lowest, slope, largest, slack):  # type: ignore[no-untyped-def]
    """Number of pieces of each wall segment, and the places (0 to 1) of the cuts, segment after segment.

    The pieces have equal integrals of ds / h.
    """
    pieces = np.ones(len(walls), dtype=np.int64)
    places = np.empty(0)
    sums = np.zeros(len(walls))
    total = 0
    # Strategy: march along each segment in steps of half the local size, summing ds / h (trapezoid in 1 / h);
    # the first round counts, the second walks again and drops a cut at each equal share of the sum.
    for fill in range(2):
        if fill == 1:
            places = np.empty(total)
        done = 0
        for s in range(len(walls)):
            dx = walls[s, 2] - walls[s, 0]
            dy = walls[s, 3] - walls[s, 1]
            length = np.sqrt(dx * dx + dy * dy)
            if fill == 1 and pieces[s] == 1:
                continue
            reached = 0.0
            summed = 0.0
            cut = 1
            share = sums[s] / pieces[s]
            h = least(segments, weights, boxes, lowest, slope, walls[s, 0], walls[s, 1], largest, -1)[0]
            while reached < length:
                step = min(0.5 * h, length - reached)
                if length - reached - step < 1e-9 * length:
                    step = length - reached
                t = (reached + step) / length
                x = walls[s, 0] + t * dx
                y = walls[s, 1] + t * dy
                new = least(segments, weights, boxes, lowest, slope, x, y, largest, -1)[0]
                rise = 0.5 * step * (1.0 / h + 1.0 / new)
                if fill == 1:
                    while cut < pieces[s] and summed + rise >= cut * share:
                        places[done] = (reached + step * (cut * share - summed) / rise) / length
                        done += 1
                        cut += 1
                summed += rise
                reached += step
                h = new
            if fill == 0:
                sums[s] = summed
                pieces[s] = max(1, int(np.ceil(summed - slack)))
                total += pieces[s] - 1
    return pieces, places
