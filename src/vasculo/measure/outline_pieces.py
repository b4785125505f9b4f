"""The outlines of a domain cut as fine as the passages are narrow, and the triangles between them."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numba import njit

from vasculo.geometry.outline import following
from vasculo.mesh.triangulate.delaunay import fluid_triangles
from vasculo.plexus.passage_kernels import nearest_on

if TYPE_CHECKING:
    from vasculo.geometry.arrays import Flags, Floats, Ints, Longs
    from vasculo.geometry.domain import Domain

LONGEST = 0.5
"""Longest piece of an outline over the width of the fluid in front of it."""


class Outlines(NamedTuple):
    """Segments of all outlines, fluid on the left: the pillars, then the outer outline.

    Parameters
    ----------
    starts, ends : (m, 2) float64, model length
    ring : (m,) int32
        Outline of each segment: the pillar, or the number of pillars.
    side : (m,) int32
        Side among the sorted names, -1 on pillars.
    stretch : (m,) int32
        The pillar, or the piece of the outer outline that has one name (numbered on after the pillars).
    run : (m,) int32
        The pillar, or the piece of the outer outline that is all open or all closed (numbered on after the pillars,
        counter-clockwise).
    closed : (bodies,) bool
        False for runs that are open.
    """

    starts: Floats
    ends: Floats
    ring: Ints
    side: Ints
    stretch: Ints
    run: Ints
    closed: Flags


class Pieces(NamedTuple):
    """Outlines cut into pieces, one from each node to the next, and the constrained Delaunay triangles between them.

    Parameters
    ----------
    points : (n, 2) float64, model length
    before, after : (n,) int64
        Node before and after it on its outline.
    segment : (n,) int64
        Segment of which the piece from each node on is a part.
    body : (n,) int32
        Pillar or run of each node; where an opening meets a wall, the wall.
    triangles, neighbours : (t, 3) int32
        Counter-clockwise; the triangle across the edge opposite to each corner, -1 at a wall.
    """

    points: Floats
    before: Longs
    after: Longs
    segment: Longs
    body: Ints
    triangles: Ints
    neighbours: Ints


def outlines_of(domain: Domain, is_open: Flags) -> Outlines:
    """List the segments of a domain; `is_open` (k,) says which segments of the outer outline are open."""
    rings = [pillar[::-1] for pillar in domain.pillars] + [domain.outer]
    counts = np.array([len(ring) for ring in rings])
    outer = slice(-counts[-1], None)
    ring = np.repeat(np.arange(len(rings), dtype=np.int32), counts)
    side = np.full(len(ring), -1, dtype=np.int32)
    side[outer] = np.searchsorted(domain.side_names, domain.sides)
    stretch, run = ring.copy(), ring.copy()
    stretch[outer] += _runs(side[outer])
    run[outer] += _runs(is_open)
    closed = np.ones(int(run.max()) + 1, dtype=np.bool_)
    closed[run[outer]] = ~is_open
    starts = np.concatenate(rings)
    return Outlines(starts, starts[following(counts)], ring, side, stretch, run, closed)


def cut_outlines(outlines: Outlines, longest: float) -> Pieces:
    """Cut the segments and triangulate, until no piece is longer than `longest` or half the width in front of it.

    Raises
    ------
    ComputationError
        When outlines are so close that they cannot be triangulated.
    """
    # Strategy: equal pieces first; then every piece that is too long for its passage is halved, and all is
    # triangulated anew. An opening has at least one node that belongs to no wall.
    step = outlines.ends - outlines.starts
    lengths = np.hypot(step[:, 0], step[:, 1])
    fewest = np.where(outlines.closed[outlines.run], 1.0, 2.0)
    pieces = np.maximum(np.ceil(lengths / longest - 1e-9), fewest).astype(np.int64)
    segment = np.repeat(np.arange(len(lengths)), pieces)
    share = (np.arange(len(segment)) - np.repeat(np.cumsum(pieces) - pieces, pieces)) / pieces[segment]
    while True:
        points = outlines.starts[segment] + share[:, None] * step[segment]
        after = following(np.bincount(outlines.ring[segment]))
        before = np.empty_like(after)
        before[after] = np.arange(len(after))
        walls = np.column_stack((np.arange(len(after)), after)).astype(np.int32)
        triangles, neighbours = fluid_triangles(points, walls)
        own = outlines.run[segment]
        body = np.where(outlines.closed[own] | ~outlines.closed[own[before]], own, own[before])
        widths = facing_widths(points, before, after, triangles, body, own, outlines.closed)
        part = np.where(segment[after] == segment, share[after], 1.0) - share
        cut = part * lengths[segment] > LONGEST * widths
        if not cut.any():
            return Pieces(points, before, after, segment, body, triangles, neighbours)
        second = np.flatnonzero(cut) + np.arange(1, np.count_nonzero(cut) + 1)
        share, segment = np.repeat(share, 1 + cut), np.repeat(segment, 1 + cut)
        share[second] += 0.5 * part[cut]


def _runs(values: Ints | Flags) -> Ints:
    """Count the runs of equal values around a closed outline, from that of the first one on."""
    new = values != np.roll(values, 1)
    new[0] = False
    number = np.cumsum(new).astype(np.int32)
    if values[0] == values[-1]:
        number[number == number[-1]] = 0
    return number


@njit(cache=True, error_model="numpy")
def facing_widths(
    points: Floats,
    before: Longs,
    after: Longs,
    triangles: Ints,
    body: Ints,
    segment_body: Ints,
    closed: Flags,
) -> Floats:
    """Distance of each outline piece to the nodes of other closed bodies that triangles join to its ends.

    Parameters
    ----------
    points, before, after, triangles, body
        As in `Pieces`.
    segment_body : (n,) int32
        Body of the piece that starts at each node.
    closed : (bodies,) bool
        As in `Outlines`.

    Returns
    -------
    (n,) float64
        For the piece that starts at each node (model length); infinite where there is none.
    """
    widths = np.full(len(points), np.inf)
    for t in range(len(triangles)):
        for k in range(3):
            for turn in range(2):
                a, b = triangles[t, (k + turn) % 3], triangles[t, (k + 1 - turn) % 3]
                if body[a] == body[b] or not (closed[body[a]] and closed[body[b]]):
                    continue
                for start in np.array([before[b], b]):
                    if segment_body[start] != body[b]:
                        continue
                    end = after[start]
                    _, wx, wy = nearest_on(
                        points[a, 0], points[a, 1], points[start, 0], points[start, 1], points[end, 0], points[end, 1]
                    )
                    widths[start] = min(widths[start], np.hypot(wx, wy))
    return widths


def facing_widths_plain(
    points: Floats,
    before: Longs,
    after: Longs,
    triangles: Ints,
    body: Ints,
    segment_body: Ints,
    closed: Flags,
) -> Floats:
    """Twin of `facing_widths`: the distances of all edges at once."""
    edges = np.concatenate([np.roll(triangles, -k, axis=1)[:, :2] for k in range(3)])
    edges = np.concatenate((edges, edges[:, ::-1]))
    edges = edges[(body[edges[:, 0]] != body[edges[:, 1]]) & closed[body[edges]].all(axis=1)]
    node, start = np.tile(edges[:, 0], 2), np.concatenate((before[edges[:, 1]], edges[:, 1]))
    same = segment_body[start] == np.tile(body[edges[:, 1]], 2)
    node, start = node[same], start[same]
    step, away = points[after[start]] - points[start], points[node] - points[start]
    along = np.clip(np.sum(step * away, axis=1) / np.sum(step**2, axis=1), 0.0, 1.0)
    widths = np.full(len(points), np.inf)
    np.minimum.at(widths, start, np.linalg.norm(away - along[:, None] * step, axis=1))
    return widths
