"""Influence zones: who is nearest, and the border lines between the zones of different bodies.

The borders of the influence zones are the SKIZ of mathematical morphology (Lantuejoul 1978; Serra, Image Analysis and
Mathematical Morphology, 1982). Here they come from the Voronoi diagram of points sampled on the outlines: a Voronoi
ridge between samples of two bodies is a piece of border, a Voronoi vertex between three bodies is a junction.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from vasculo.mesh.triangulate.delaunay import delaunay

if TYPE_CHECKING:
    from vasculo.geometry.arrays import Flags, Floats, Longs

INSET = 0.05
"""Samples lie this many spacings inside their outline, so that outlines that touch stay apart."""
COINCIDENT = 1e-9
"""Segments shorter than this many spacings are left out."""
FAR = 8.0
"""Four helper points stand this many extents away and close the diagram."""
RING = -2
"""End of a border line that closes on itself."""
BORDER = -1
"""End of a border line at the frame."""


@dataclass(frozen=True, eq=False)
class Samples:
    """Points along outlines, evenly within each segment, and the segments themselves.

    Attributes
    ----------
    points : ndarray of float64, shape (s, 2)
        Samples (model length), `INSET` spacings to the left of their segment.
    body : ndarray of int64, shape (s,)
        Outline of each sample.
    segment : ndarray of int64, shape (s,)
        Segment of each sample.
    starts, steps : ndarray of float64, shape (e, 2)
        First node of each segment, and the way from there to its second one.
    before, after : ndarray of int64, shape (e,)
        Segment before and after each one on its outline.
    """

    points: Floats
    body: Longs
    segment: Longs
    starts: Floats
    steps: Floats
    before: Longs
    after: Longs

    def distances(self, sample: Longs, points: Floats) -> Floats:
        """Distances (p,) of points (p, 2) to the outline near samples (p,): to the segment there and its neighbours."""
        own = self.segment[sample]
        shortest = np.full(len(own), np.inf)
        for segment in (self.before[own], own, self.after[own]):
            step = self.steps[segment]
            away = points - self.starts[segment]
            along = np.clip(np.sum(away * step, axis=1) / np.sum(step * step, axis=1), 0.0, 1.0)
            away -= along[:, None] * step
            np.minimum(shortest, np.sqrt(np.sum(away * away, axis=1)), out=shortest)
        return shortest


@dataclass(frozen=True, eq=False)
class BorderLines:
    """The borders of the influence zones as a graph of junctions and lines.

    Attributes
    ----------
    junctions : ndarray of float64, shape (v, 2)
        Points where three zones meet (model length).
    ends : ndarray of int64, shape (c, 2)
        Junction at both ends of each line; `BORDER` at the frame, `RING` for a line that closes on itself.
    bodies : ndarray of int64, shape (c, 2)
        Bodies on both sides.
    first : ndarray of int64, shape (c + 1,)
        Points of line i are rows first[i] to first[i + 1], at least three.
    points : ndarray of float64, shape (p, 2)
        Points of the lines in order, both ends among them (model length).
    samples : ndarray of int64, shape (p, 2)
        The two samples that are nearest to each point, one of each body.
    """

    junctions: Floats
    ends: Longs
    bodies: Longs
    first: Longs
    points: Floats
    samples: Longs


def sample_outlines(outlines: list[Floats], spacing: float) -> Samples:
    """Sample outlines: equal pieces of each segment, at most `spacing` long, and a sample in front of each middle.

    Parameters
    ----------
    outlines : list of ndarray of float64, shape (k, 2)
        Counter-clockwise, simple, with an area (model length); repeated nodes are passed over.
    spacing : float
        Longest piece (model length).

    Returns
    -------
    Samples
    """
    starts = np.concatenate(outlines)
    owner = np.repeat(np.arange(len(outlines)), [len(outline) for outline in outlines])
    apart = np.abs(starts - np.concatenate([np.roll(outline, -1, axis=0) for outline in outlines])).max(axis=1)
    real = apart > COINCIDENT * spacing
    starts, owner = starts[real], owner[real]
    sizes = np.bincount(owner, minlength=len(outlines))
    last = np.cumsum(sizes)
    after = np.arange(1, len(starts) + 1)
    after[last - 1] = last - sizes
    before = np.empty_like(after)
    before[after] = np.arange(len(after))
    steps = starts[after] - starts
    lengths = np.hypot(steps[:, 0], steps[:, 1])
    pieces = np.maximum(np.ceil(lengths / spacing * (1.0 - 1e-9)), 1.0).astype(np.int64)
    segment = np.repeat(np.arange(len(starts)), pieces)
    number = np.arange(len(segment)) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    place = (number + 0.5) / pieces[segment]
    inward = np.stack([-steps[:, 1], steps[:, 0]], axis=1) * (INSET * spacing / lengths)[:, None]
    points = starts[segment] + place[:, None] * steps[segment] + inward[segment]
    return Samples(points, owner[segment], segment, starts, steps, before, after)


def border_lines(points: Floats, body: Longs, frame: Floats, whole: Flags) -> BorderLines:
    """Find the border lines between the influence zones of sampled bodies, inside a convex frame.

    Parameters
    ----------
    points : ndarray of float64, shape (s, 2)
        Samples (model length), at least one.
    body : ndarray of int64, shape (s,)
        Body of each sample, >= 0.
    frame : ndarray of float64, shape (k, 2)
        Convex polygon, counter-clockwise (model length). Lines are clipped at it.
    whole : ndarray of bool, shape (k,)
        Sides of the frame where a junction counts as inside only with its whole empty circle, so that more samples
        beyond that side could not change it.

    Returns
    -------
    BorderLines
    """
    # Strategy: work on half-edges of the Delaunay triangulation, h = 3 t + k for the edge opposite to corner k of
    # triangle t. A crossing edge (two bodies) is dual to a piece of border, and a triangle has none, two or three of
    # them: passed by, passed through, or a junction. So `after` makes directed lists of crossing half-edges that end
    # at junctions and at the frame, each line once in both directions.
    # A line goes through the point of each ridge nearest to the middle of its two samples: where outlines are closer
    # to each other than the samples, the Voronoi vertices zigzag far to both sides, and these points do not.
    middle, extent = points.mean(axis=0), float(np.ptp(np.concatenate([points, frame]), axis=0).max())
    helpers = middle + FAR * extent * np.array([(1.0, 0.1), (-0.1, 1.0), (-1.0, -0.1), (0.1, -1.0)])
    spots = np.concatenate([points, helpers])
    label = np.concatenate([body, np.full(4, -1)])
    distinct = _distinct(spots)
    triangles, neighbours = delaunay(spots[distinct])
    nodes = distinct[triangles]
    corner_label = label[nodes]
    one, two = corner_label[:, [1, 2, 0]], corner_label[:, [2, 0, 1]]
    crossing = (one != two) & (one >= 0) & (two >= 0)
    kept = np.flatnonzero(crossing.any(axis=1))
    if not len(kept):
        return _nothing()
    number = np.full(len(crossing) + 1, -1)
    number[kept] = np.arange(len(kept))
    corners, crossing = nodes[kept], crossing[kept]
    beside = number[neighbours[kept]]
    centres, radii = circumcircles(spots, corners)
    normals, offsets = _half_planes(frame)
    inside = np.all(centres @ normals.T - offsets + radii[:, None] * whole <= 0.0, axis=1)

    half = np.flatnonzero(crossing.ravel() & (beside.ravel() >= 0))
    triangle, over = half // 3, beside.ravel()[half]
    slot = np.argmax(beside[over] == triangle[:, None], axis=1)
    samples = np.stack([corners[triangle, (half + 1) % 3], corners[triangle, (half + 2) % 3]], axis=1)
    low, high = _clip(centres[triangle], centres[over], normals, offsets)
    alive = low < high
    half, triangle, over, slot = half[alive], triangle[alive], over[alive], slot[alive]
    samples, low, high = samples[alive], low[alive], high[alive]
    place = np.full(3 * len(kept), -1)
    place[half] = np.arange(len(half))
    twin = place[3 * over + slot]
    step = centres[over] - centres[triangle]
    towards = 0.5 * (spots[samples[:, 0]] + spots[samples[:, 1]]) - centres[triangle]
    square = np.sum(step * step, axis=1)
    share = np.clip(np.sum(towards * step, axis=1) / np.where(square > 0.0, square, 1.0), low, high)
    passed = centres[triangle] + share[:, None] * step

    ways = crossing.sum(axis=1)
    other = 3 * over + np.argmax(crossing[over] & (np.arange(3) != slot[:, None]), axis=1)
    after = np.where(inside[over] & (ways[over] == 2), place[other], -1)
    order, first, ring = chains(after, twin)
    head, tail = order[first[:-1]], order[first[1:] - 1]
    junction = np.full(len(kept), BORDER)
    meeting = np.flatnonzero(inside & (ways == 3))
    junction[meeting] = np.arange(len(meeting))
    ends = np.stack([junction[triangle[head]], junction[over[tail]]], axis=1)
    ends[ring] = RING
    start = centres[triangle[head]] + low[head, None] * step[head]
    end = centres[triangle[tail]] + high[tail, None] * step[tail]
    start[ring] = end[ring] = passed[head[ring]]
    rows = np.arange(len(order)) + 1 + 2 * np.repeat(np.arange(len(head)), np.diff(first))
    first = first + 2 * np.arange(len(first))
    path, near = np.empty((first[-1], 2)), np.empty((first[-1], 2), dtype=np.int64)
    path[rows], near[rows] = passed[order], samples[order]
    path[first[:-1]], near[first[:-1]] = start, samples[head]
    path[first[1:] - 1], near[first[1:] - 1] = end, samples[tail]
    return BorderLines(centres[meeting], ends, label[samples[head]], first, path, near)


def _distinct(points: Floats) -> Longs:
    """Numbers of the points, ascending, without those that are where an earlier one is already."""
    order = np.lexsort(points.T)
    again = (points[order[1:]] == points[order[:-1]]).all(axis=1)
    return np.sort(np.delete(order, np.flatnonzero(again) + 1))


def _nothing() -> BorderLines:
    """No line at all."""
    pairs, floats = np.empty((0, 2), dtype=np.int64), np.empty((0, 2))
    return BorderLines(floats, pairs, pairs, np.zeros(1, dtype=np.int64), floats, pairs)


def circumcircles(points: Floats, corners: Longs) -> tuple[Floats, Floats]:
    """Centre (t, 2) and radius (t,) of the circle through the corners (t, 3), the centroid of flat ones."""
    a = points[corners[:, 0]]
    b, c = points[corners[:, 1]] - a, points[corners[:, 2]] - a
    twice = 2.0 * (b[:, 0] * c[:, 1] - b[:, 1] * c[:, 0])
    bb, cc = np.sum(b * b, axis=1), np.sum(c * c, axis=1)
    flat = np.abs(twice) <= 1e-14 * (bb + cc)
    twice = np.where(flat, 1.0, twice)
    centre = np.stack([c[:, 1] * bb - b[:, 1] * cc, b[:, 0] * cc - c[:, 0] * bb], axis=1) / twice[:, None]
    centre = np.where(flat[:, None], (b + c) / 3.0, centre)
    return a + centre, np.hypot(centre[:, 0], centre[:, 1])


def _half_planes(frame: Floats) -> tuple[Floats, Floats]:
    """Return normals (k, 2) and offsets (k,): a point p is in the convex frame where normals @ p <= offsets."""
    step = np.roll(frame, -1, axis=0) - frame
    normals = np.stack([step[:, 1], -step[:, 0]], axis=1) / np.hypot(step[:, 0], step[:, 1])[:, None]
    return normals, np.sum(normals * frame, axis=1)


def _clip(start: Floats, end: Floats, normals: Floats, offsets: Floats) -> tuple[Floats, Floats]:
    """Shares between which segments are inside half planes (Cyrus & Beck 1978); low >= high where they are not."""
    low, high = np.zeros(len(start)), np.ones(len(start))
    for normal, offset in zip(normals, offsets, strict=True):
        here, there = start @ normal - offset, end @ normal - offset
        share = here / np.where(here == there, 1.0, here - there)
        low = np.where((here > 0.0) & (there <= 0.0), np.maximum(low, share), low)
        high = np.where((here <= 0.0) & (there > 0.0), np.minimum(high, share), high)
        low = np.where((here > 0.0) & (there > 0.0), 2.0, low)
    return low, high


def chains(after: Longs, twin: Longs) -> tuple[Longs, Longs, Longs]:
    """Put linked items in order: each chain once, of the two directions it is given in.

    Parameters
    ----------
    after : ndarray of int64, shape (h,)
        Next item of each item, -1 at the end of a chain; no two items have the same next one.
    twin : ndarray of int64, shape (h,)
        The same item in the opposite direction: after[i] = j exactly when after[twin[j]] = twin[i].

    Returns
    -------
    order : ndarray of int64
        Items, chain after chain; half of all.
    first : ndarray of int64, shape (c + 1,)
        Chain i is order[first[i]:first[i + 1]].
    rings : ndarray of int64
        Chains that close on themselves.
    """
    # Strategy: list ranking by pointer doubling, log2 of the longest chain passes over whole arrays. What still runs
    # after that is a ring; it is cut before its smallest item (in one direction) and ranked again.
    last, steps, running = _ranked(after)
    cut = np.empty(0, dtype=np.int64)
    if len(running):
        graph = coo_array((np.ones(len(running)), (running, after[running])), shape=(len(after), len(after)))
        _, part = connected_components(graph, directed=False)
        cut = running[np.unique(part[running], return_index=True)[1]]
        after = after.copy()
        after[np.isin(after, cut)] = -1
        last, steps, _ = _ranked(after)
    begins = np.ones(len(after), dtype=bool)
    begins[after[after >= 0]] = False
    heads = np.flatnonzero(begins)
    ring = np.isin(heads, cut)
    partner = twin[last[heads]]
    # A ring and its twin are cut at unrelated places: keep the one that holds the smaller item.
    partner[ring] = _smallest(last, twin[heads[ring]], cut)
    keep = heads < partner
    heads, ring = heads[keep], ring[keep]
    chain = np.full(len(after), -1)
    chain[last[heads]] = np.arange(len(heads))
    member = chain[last]
    mine = np.flatnonzero(member >= 0)
    order = mine[np.lexsort((-steps[mine], member[mine]))]
    first = np.concatenate([[0], np.cumsum(steps[heads] + 1)])
    return order, first, np.flatnonzero(ring)


def _ranked(after: Longs) -> tuple[Longs, Longs, Longs]:
    """Last item of the chain from each item on, the steps to it, and the items that never end."""
    last = np.where(after >= 0, after, np.arange(len(after)))
    steps = (after >= 0).astype(np.int64)
    ended = after < 0
    running = np.flatnonzero(~ended[last])
    for _ in range(len(after).bit_length() + 1):
        if not len(running):
            break
        steps[running] += steps[last[running]]
        last[running] = last[last[running]]
        running = running[~ended[last[running]]]
    return last, steps, running


def _smallest(last: Longs, items: Longs, heads: Longs) -> Longs:
    """Return the head among `heads` of the chain that each item is in."""
    order = np.argsort(last[heads])
    return heads[order][np.searchsorted(last[heads][order], last[items])]


def weighted_medians(values: Floats, weights: Floats, first: Longs) -> Floats:
    """Weighted median of each group first[i]:first[i + 1] of values: where half of the weight is reached."""
    group = np.repeat(np.arange(len(first) - 1), np.diff(first))
    order = np.lexsort((values, group))
    total = np.cumsum(weights[order])
    base = np.concatenate([[0.0], total])[first[:-1]]
    half = 0.5 * (base + total[first[1:] - 1])
    return np.asarray(values[order][np.searchsorted(total, half * (1.0 - 1e-12))])
