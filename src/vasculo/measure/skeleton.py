"""The skeleton of the cords: border lines between voids, measured, with the pieces that are too short contracted."""

from __future__ import annotations

import heapq
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import KDTree

from vasculo.measure.influence import BORDER, border_lines, weighted_medians
from vasculo.springs.box import wrapped

if TYPE_CHECKING:
    from vasculo.geometry.arrays import Flags, Floats, Longs
    from vasculo.measure.influence import Samples

SHORTEST = 0.5
"""Two junctions are one when the line between them is shorter than this many widths of the cords around it."""
TOUCHING = 1e-6
"""A line shorter than this many spacings of samples is the trace of four zones that meet in one point."""
SAME = 1e-6
"""Images of a junction are this close to each other, in periods, and ends at the border to the border."""


@dataclass(frozen=True, eq=False)
class Skeleton:
    """Border lines between voids, or cords, named as in `Cords`.

    Attributes
    ----------
    junctions, degrees, ends, voids, first, points, point_widths
        As in `vasculo.measure.cords.Cords`. In a periodic tissue a line ends at an image of its junction.
    beyond : ndarray of float64, shape (c, 2)
        Way from the image of the void on the first side to that on the second.
    count : int
        Number of voids.
    """

    junctions: Floats
    degrees: Longs
    ends: Longs
    voids: Longs
    beyond: Floats
    first: Longs
    points: Floats
    point_widths: Floats
    count: int

    def shares(self) -> Floats:
        """Length of line (p,) that each point stands for: half of the pieces before and behind it."""
        return shares(self.points, self.first)

    def only(self, kept: Flags) -> Skeleton:
        """Return the skeleton with some of the lines."""
        rows = np.repeat(kept, np.diff(self.first))
        return replace(
            self,
            ends=self.ends[kept],
            voids=self.voids[kept],
            beyond=self.beyond[kept],
            first=np.concatenate([[0], np.cumsum(np.diff(self.first)[kept])]),
            points=self.points[rows],
            point_widths=self.point_widths[rows],
        )


def skeleton_of(samples: Samples, spacing: float, shifts: Floats, region: Floats, whole: Flags) -> Skeleton:
    """Find the cords between sampled outlines and their images.

    Parameters
    ----------
    samples : Samples
        Of the outlines (any length unit).
    spacing : float
        Their spacing.
    shifts : ndarray of float64, shape (i, 2)
        Where the images lie; (0, 0) among them.
    region : ndarray of float64, shape (k, 2)
        Convex polygon, counter-clockwise; all images in it are given.
    whole : ndarray of bool, shape (k,)
        Sides of the region beyond which there are more images; junctions they might change count as outside.

    Returns
    -------
    Skeleton
    """
    count, size = int(samples.body.max()) + 1, len(samples.points)
    image, tile = np.tile(np.arange(size), len(shifts)), np.repeat(np.arange(len(shifts)), size)
    spots = samples.points[image] + shifts[tile]
    if whole.any():
        sides = np.array([region.min(axis=0), region.max(axis=0)])
        near = ((spots >= sides[0]) & (spots <= sides[1]))[:, [whole[[1, 3]].any(), whole[[0, 2]].any()]]
        kept = near.all(axis=1)
        image, tile, spots = image[kept], tile[kept], spots[kept]
    lines = border_lines(spots, samples.body[image] + count * tile, region, whole)
    widths = np.zeros(len(lines.points))
    for side in lines.samples.T:
        widths += samples.distances(image[side], lines.points - shifts[tile[side]])
    found = Skeleton(
        lines.junctions,
        np.bincount(lines.ends[lines.ends >= 0], minlength=len(lines.junctions)),
        lines.ends,
        lines.bodies % count,
        shifts[lines.bodies[:, 1] // count] - shifts[lines.bodies[:, 0] // count],
        lines.first,
        lines.points,
        widths,
        count,
    )
    return contracted(found, np.full(len(lines.ends), TOUCHING * spacing))


def least_lengths(skeleton: Skeleton, spacing: float) -> Floats:
    """Length (c,) below which a line is no cord: half of the mean width of the other lines at both its junctions.

    Never less than half of the spacing of the samples, which is how well a junction is placed where cords are thin.
    """
    if not len(skeleton.junctions):
        return np.zeros(len(skeleton.ends))
    widths = weighted_medians(skeleton.point_widths, skeleton.shares(), skeleton.first)
    met = skeleton.ends >= 0
    around = np.bincount(skeleton.ends[met], np.repeat(widths, 2)[met.ravel()], len(skeleton.junctions))
    both = np.maximum(skeleton.ends, 0)
    others = np.maximum(skeleton.degrees[both].sum(axis=1) - 2, 1)
    return np.maximum(SHORTEST * (around[both].sum(axis=1) - 2.0 * widths) / others, SHORTEST * spacing)


def contracted(skeleton: Skeleton, limits: Floats) -> Skeleton:
    """Take out the lines between junctions that are too short, and join the junctions at both their ends.

    Parameters
    ----------
    skeleton : Skeleton
    limits : ndarray of float64, shape (c,)
        Lines shorter than this go.

    Returns
    -------
    Skeleton
        Joined junctions lie in the middle of their members, and lines lead there.
    """
    if not len(skeleton.junctions):
        return skeleton
    share, starts, stops = skeleton.shares(), skeleton.first[:-1], skeleton.first[1:] - 1
    lengths, points = np.add.reduceat(share, starts), skeleton.points.copy()
    short = np.flatnonzero((lengths < limits) & (skeleton.ends >= 0).all(axis=1))
    # Strategy: over the short lines only, shortest first, put the smaller group of junctions into the larger one. Each
    # junction keeps its way from the first of its group, since in a periodic tissue places alone do not tell it. A
    # line that has grown meanwhile, since its ends went to the middles of their groups, waits for its turn or stays.
    # So does a line within a group: to take it out would close a loop around a void.
    group = list(range(len(skeleton.junctions)))
    members = {junction: [junction] for junction in np.unique(skeleton.ends[short]).tolist()}
    away = np.zeros((len(group), 2))
    kept = np.ones(len(lengths), dtype=bool)
    queue = list(zip(lengths[short].tolist(), short.tolist(), strict=True))
    heapq.heapify(queue)
    while queue:
        before, line = heapq.heappop(queue)
        a, b = skeleton.ends[line].tolist()
        into, gone = group[a], group[b]
        if into == gone:
            continue
        path = points[starts[line] : stops[line] + 1].copy()
        way = path[-1] - path[0]
        for end, junction in ((0, a), (-1, b)):
            path[end] += away[members[group[junction]]].mean(axis=0) - away[junction]
        now = float(np.hypot(*np.diff(path, axis=0).T).sum())
        if now > before * (1.0 + SAME):
            if now < limits[line]:
                heapq.heappush(queue, (now, line))
            continue
        kept[line] = False
        shift = away[a] + way - away[b]
        if len(members[gone]) > len(members[into]):
            into, gone, shift = gone, into, -shift
        away[members[gone]] += shift
        for junction in members[gone]:
            group[junction] = into
        members[into] += members.pop(gone)
    first, number = np.unique(group, return_inverse=True)
    size = np.bincount(number)
    middle = np.stack([np.bincount(number, weights=axis) / size for axis in away.T], axis=1)
    moves = middle[number] - away
    for side, row in ((0, starts), (1, stops)):
        joined = np.flatnonzero(skeleton.ends[:, side] >= 0)
        points[row[joined]] += moves[skeleton.ends[joined, side]]
    ends = np.where(skeleton.ends >= 0, number[np.maximum(skeleton.ends, 0)], skeleton.ends)
    degrees = np.bincount(ends[kept][ends[kept] >= 0], minlength=len(first))
    junctions = skeleton.junctions[first] + middle
    return replace(skeleton, junctions=junctions, degrees=degrees, ends=ends, points=points).only(kept)


def one_image(skeleton: Skeleton, box: Floats, border: Floats) -> Skeleton | None:
    """Keep one image of each line and junction of a periodic skeleton.

    Parameters
    ----------
    skeleton : Skeleton
    box : ndarray of float64, shape (2,)
        Periods, infinite in a direction without.
    border : ndarray of float64, shape (2, 2)
        Lowest and highest x and y; in a direction without period lines end there.

    Returns
    -------
    Skeleton or None
        None when a line that is wanted is not complete.
    """
    if not len(skeleton.ends):
        return skeleton
    share, starts = skeleton.shares(), skeleton.first[:-1]
    share[starts] += 1e-12 * np.ptp(border)  # so that a line without length has a middle
    moments = np.add.reduceat(share[:, None] * skeleton.points, starts, axis=0)
    middles = moments / np.add.reduceat(share, starts)[:, None]
    reach = 0.5 * float(np.sqrt(np.ptp(border, axis=0).prod() / skeleton.count))
    found, here = skeleton.only(in_cut(middles, box, reach)), in_cut(skeleton.junctions, box, reach)
    framed = np.isinf(box)
    for side, row in ((0, found.first[:-1]), (1, found.first[1:] - 1)):
        tips: Floats = found.points[row[found.ends[:, side] == BORDER]]
        away: Floats = np.abs(tips[:, None] - border).min(axis=1)
        if (away[:, framed] > SAME * np.ptp(border)).all(axis=1).any():
            return None
    inner = found.ends >= 0
    if here.any() != inner.any():
        return None
    ends = found.ends.copy()
    if here.any():
        places = wrapped(skeleton.junctions, box)
        tree = KDTree(places[here], boxsize=np.where(framed, 0.0, box))  # a tree takes 0 for no period
        far, same = (np.atleast_1d(part) for part in tree.query(places[found.ends[inner]]))
        if (far > SAME * box.min()).any():
            return None
        ends[inner] = same
    degrees = np.bincount(ends[inner], minlength=int(here.sum()))
    if not np.array_equal(degrees, skeleton.degrees[here]):
        return None
    return replace(found, junctions=skeleton.junctions[here], degrees=degrees, ends=ends)


def in_cut(places: Floats, box: Floats, reach: float) -> Flags:
    """Places within one box, which begins in the widest gap between all places (modulo the box) within `reach` of 0."""
    inside = np.ones(len(places), dtype=bool)
    for axis, period in enumerate(box.tolist()):
        if not len(places) or period == np.inf:
            continue
        values = np.sort(wrapped(places, box)[:, axis])
        gaps = np.diff(values, append=values[0] + period)
        starts = values + 0.5 * gaps
        starts -= period * np.rint(starts / period)
        wide = gaps > SAME * period  # the others lie between images of one place
        starts, gaps = starts[wide], gaps[wide]
        near = np.abs(starts) <= max(reach, float(np.abs(starts).min()))
        start = starts[near][np.argmax(gaps[near])]
        inside &= (places[:, axis] >= start) & (places[:, axis] < start + period)
    return inside


def shares(points: Floats, first: Longs) -> Floats:
    """Length of line that each point stands for: half of the pieces before and behind it."""
    pieces = np.zeros(len(points) + 1)
    step = np.diff(points, axis=0)
    pieces[1:-1] = np.hypot(step[:, 0], step[:, 1])
    pieces[first] = 0.0
    return 0.5 * (pieces[1:] + pieces[:-1])
