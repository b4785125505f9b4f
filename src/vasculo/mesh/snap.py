"""Snapping: interior nodes that come close to a wall become wall nodes, for good."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.mesh.adjacency import adjacency, stars
from vasculo.mesh.quality import triangle_quality

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.mesh.draft import Draft

NEAR = 0.3
"""Nodes nearer to a wall edge than this many of their wanted lengths are snapped to it."""

MIDDLE = 0.25
"""The foot on the edge stays at least this share of the edge away from both ends."""


def snap_to_walls(draft: Draft, near: float = NEAR) -> int:
    """Snap nodes to walls; overwrites the draft, returns how many were snapped.

    Parameters
    ----------
    draft : Draft
    near : float, default NEAR
        Largest distance to the wall edge, in wanted lengths.

    Notes
    -----
    The triangle between the node and its wall edge collapses and is taken away, and the node cuts the wall edge in two.
    A node is left where it is when another triangle around it would become worse than the one that goes.
    """
    triangles, points = draft.triangles, draft.points
    rows, corner = np.nonzero(draft.neighbours < 0)
    apex = triangles[rows, corner]
    start, end = triangles[rows, (corner + 1) % 3], triangles[rows, (corner + 2) % 3]
    step = points[end] - points[start]
    length = np.hypot(step[:, 0], step[:, 1])
    away = points[apex] - points[start]
    height = (step[:, 0] * away[:, 1] - step[:, 1] * away[:, 0]) / length
    foot = (away * step).sum(axis=1) / length**2
    close = (height < near * draft.sizes[apex]) & (np.abs(foot - 0.5) < 0.5 - MIDDLE) & ~draft.fixed[apex]
    chosen = np.flatnonzero(close)
    # Strategy: nearest first; a node whose star shares a triangle with an earlier one waits for the next round.
    if not len(chosen):
        return 0
    first, corners = stars(triangles, len(points))
    gone, taken = [], np.zeros(len(points), dtype=bool)
    for e in chosen[np.argsort(height[chosen], kind="stable")]:
        node = apex[e]
        star = corners[first[node] : first[node + 1]] // 3
        around = triangles[star]
        if taken[around].any():
            continue
        old = points[node].copy()
        worst = triangle_quality(points, around).min()
        points[node] = points[start[e]] + foot[e] * step[e]
        others = around[star != rows[e]]
        p, q, r = (points[others[:, i]] for i in range(3))
        twice = (q[:, 0] - p[:, 0]) * (r[:, 1] - p[:, 1]) - (q[:, 1] - p[:, 1]) * (r[:, 0] - p[:, 0])
        if not (len(others) and twice.min() > 0.0 and triangle_quality(points, others).min() > worst):
            points[node] = old
            continue
        taken[around] = True
        gone.append(e)
    if not gone:
        return 0
    _cut_edges(draft, apex[gone], start[gone], end[gone])
    draft.triangles = np.ascontiguousarray(np.delete(triangles, rows[gone], axis=0))
    draft.neighbours = adjacency(draft.triangles, len(points))
    draft.fixed[apex[gone]] = True
    return len(gone)


def _cut_edges(draft: Draft, node: NDArray[np.int32], start: NDArray[np.int32], end: NDArray[np.int32]) -> None:
    """Replace each wall edge start-end by start-node and node-end."""
    key = draft.edges[:, 0].astype(np.int64) * len(draft.points) + draft.edges[:, 1]
    order = np.argsort(key)
    place = order[np.searchsorted(key[order], start.astype(np.int64) * len(draft.points) + end)]
    draft.edges[place, 1] = node
    draft.edges = np.concatenate((draft.edges, np.column_stack((node, end)).astype(np.int32)))
    draft.segment = np.concatenate((draft.segment, draft.segment[place]))
