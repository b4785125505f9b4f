"""Middle lines of pillars, from tip to tip, and how straight they are."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from vasculo.geometry.outline import following
from vasculo.mesh.triangulate.delaunay import fluid_triangles

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from vasculo.geometry.arrays import Floats, Ints, Longs

POINTS = 65
"""Points of each middle line."""

CUT = 0.75
"""Part of the mean width that is left out at both ends: there the shape of the tip decides how the line runs."""

SHORT = 2.0
"""A middle line shorter than this many mean widths is too short to be bent."""


@dataclass(frozen=True, eq=False)
class MiddleLines:
    """Middle lines of outlines; lengths in the unit of the outlines.

    The tips of an outline are the two nodes between which the way through its chordal axis (Prasad 1997) is longest:
    the outline is filled with Delaunay triangles between its nodes, and a way crosses their edges in the middle. The
    tips part the outline into two banks; the middle line halves the distance between places at equal shares of the
    length of both.

    Attributes
    ----------
    tips : ndarray of int64, shape (p, 2)
        Nodes of each outline.
    points : ndarray of float64, shape (p, 65, 2)
        The line from the first tip to the second.
    lengths : ndarray of float64, shape (p,)
        Length of each line.
    widths : ndarray of float64, shape (p,)
        Mean width: the area over this length.
    straightness : ndarray of float64, shape (p,)
        Without three quarters of a mean width at both ends: the distance between the ends over the length of the line.
        1 for a straight bar, sin(a/2)/(a/2) for one bent to an arc of the angle a. NaN where the line is shorter than
        two mean widths.

    Examples
    --------
    >>> import vasculo as vc
    >>> from vasculo.plexus.voronoi import voronoi_plexus
    >>> domain = voronoi_plexus(4, seed=1)
    >>> vc.measure.middle_lines(domain.pillars).points.shape
    (4, 65, 2)
    """

    tips: Longs
    points: Floats
    lengths: Floats
    widths: Floats
    straightness: Floats


def middle_lines(outlines: Sequence[Floats]) -> MiddleLines:
    """Find the middle lines of outlines.

    Parameters
    ----------
    outlines : sequence of (k, 2) float64
        At least one; counter-clockwise, simple and disjoint.

    Returns
    -------
    MiddleLines

    Raises
    ------
    ComputationError
        When outlines cross.

    Examples
    --------
    >>> import numpy as np
    >>> import vasculo as vc
    >>> along = np.linspace(0.0, 4.0, 9)
    >>> bar = np.array([*((x, 0.0) for x in along), *((x, 0.5) for x in along[::-1])])
    >>> line = vc.measure.middle_lines([bar])
    >>> line.straightness.round(2).tolist(), line.widths.round(1).tolist()
    ([1.0], [0.5])
    """
    counts = np.array([len(outline) for outline in outlines], dtype=np.int64)
    start = np.cumsum(counts) - counts
    nodes, after = np.concatenate(outlines), following(counts)
    edges = np.column_stack((np.arange(len(nodes)), after)).astype(np.int32)
    triangles, neighbours = fluid_triangles(nodes, edges)
    # Strategy: an outline of n nodes has n - 2 triangles, which form a tree; put them behind one another.
    order = np.argsort(np.repeat(np.arange(len(counts)), counts)[triangles[:, 0]], kind="stable")
    place = np.full(len(order) + 1, -1, dtype=np.int32)
    place[order] = np.arange(len(order))
    tips = np.sort(find_tips(nodes, triangles[order], place[neighbours[order]], np.cumsum(counts - 2))[0], axis=1)
    points = halved(nodes, start, counts, tips)

    pieces = np.hypot(*np.moveaxis(np.diff(points, axis=1), 2, 0))
    lengths = pieces.sum(axis=1)
    x, y = (nodes - np.repeat(nodes[start], counts, axis=0)).T
    widths = np.add.reduceat(0.5 * (x * y[after] - x[after] * y), start) / lengths
    straightness = np.full(len(counts), np.nan)
    long = lengths >= SHORT * widths
    straightness[long] = straightness_of(points[long], pieces[long], CUT * widths[long])
    return MiddleLines(tips - start[:, None], points, lengths, widths, straightness)


def halved(nodes: Floats, start: Longs, counts: Longs, tips: Longs) -> Floats:
    """Lines that halve the distance between the two banks of each outline; (p, 65, 2) float64.

    Parameters
    ----------
    nodes : (n, 2) float64
        Outline after outline.
    start, counts : (p,) int64
        First node of each outline, and how many it has.
    tips : (p, 2) int64
        Two nodes of each, the one with the lower number first.
    """
    step = nodes[following(counts)] - nodes
    arc = np.concatenate(([0.0], np.cumsum(np.hypot(step[:, 0], step[:, 1]))))
    share = np.linspace(0.0, 1.0, POINTS)
    low, high = arc[tips.T]
    begin, end = arc[start], arc[start + counts]
    one = low[:, None] + share * (high - low)[:, None]
    other = low[:, None] - share * (end - begin - high + low)[:, None]
    other = np.where(other < begin[:, None], other + (end - begin)[:, None], other)

    def point_at(place: Floats) -> Floats:
        first, last = start[:, None], (start + counts - 1)[:, None]
        segment = np.clip(np.searchsorted(arc, place, side="right") - 1, first, last)
        part = (place - arc[segment]) / (arc[segment + 1] - arc[segment])
        return np.asarray(nodes[segment] + part[:, :, None] * step[segment])

    return 0.5 * (point_at(one) + point_at(other))


def straightness_of(points: Floats, pieces: Floats, cuts: Floats) -> Floats:
    """End-to-end distance over length of lines without a piece at both ends; (p,) float64.

    Parameters
    ----------
    points : (p, m, 2) float64
    pieces : (p, m - 1) float64
        Distances between the points of each line.
    cuts : (p,) float64
        Length that is left out at each end, less than half of the line.
    """
    ends = []
    row = np.arange(len(points))
    for line, way in ((points, pieces), (points[:, ::-1], pieces[:, ::-1])):
        passed = np.cumsum(way, axis=1)
        piece = np.argmax(passed >= cuts[:, None], axis=1)
        back = (passed[row, piece] - cuts) / way[row, piece]
        ends.append(line[row, piece + 1] + back[:, None] * (line[row, piece] - line[row, piece + 1]))
    return np.asarray(np.hypot(*(ends[1] - ends[0]).T) / (pieces.sum(axis=1) - 2.0 * cuts))


@njit(cache=True, error_model="numpy")
def find_tips(nodes: Floats, triangles: Ints, neighbours: Ints, last: Longs) -> tuple[Longs, Floats]:
    """Nodes between which the way through the triangles of each outline, by the middles of their edges, is longest.

    Parameters
    ----------
    nodes : (n, 2) float64
    triangles, neighbours : (t, 3) int32
        Outline after outline; the triangle across the edge opposite to each corner, -1 at the outline.
    last : (p,) int64
        Triangles of all outlines up to and with each.

    Returns
    -------
    tips : (p, 2) int64
    ways : (p,) float64
        Length of the way between them.
    """
    # Strategy: the triangles are a tree; the tip farthest from any tip is one end of the longest way, and the tip
    # farthest from that one is the other.
    entry, far = np.empty((len(triangles), 2)), np.empty(len(triangles))
    came, stack = np.empty(len(triangles), dtype=np.int64), np.empty(len(triangles), dtype=np.int64)
    tips, ways = np.empty((len(last), 2), dtype=np.int64), np.empty(len(last))
    for p in range(len(last)):
        t = 0 if p == 0 else last[p - 1]
        if last[p] - t == 1:
            tips[p, 0], tips[p, 1], ways[p] = longest_side(nodes, triangles[t])
            continue
        while only_way(neighbours, t) < 0:
            t += 1
        for side in range(2):
            t, ways[p] = farthest_tip(nodes, triangles, neighbours, t, entry, far, came, stack)
            tips[p, side] = triangles[t, only_way(neighbours, t)]
    return tips, ways


@njit(cache=True, error_model="numpy")
def only_way(neighbours: Ints, t: int) -> int:
    """Corner opposite to the only inner edge of a triangle, -1 if it has more of them."""
    found = -1
    for k in range(3):
        if neighbours[t, k] >= 0:
            if found >= 0:
                return -1
            found = k
    return found


@njit(cache=True, error_model="numpy")
def farthest_tip(
    nodes: Floats,
    triangles: Ints,
    neighbours: Ints,
    start: int,
    entry: Floats,
    far: Floats,
    came: Longs,
    stack: Longs,
) -> tuple[int, float]:
    """Triangle with the tip that is farthest from that of `start`, and how far; the last four are overwritten."""
    entry[start] = nodes[triangles[start, only_way(neighbours, start)]]
    far[start], came[start] = 0.0, -1
    stack[0] = start
    top, best, end = 1, -1.0, start
    while top > 0:
        top -= 1
        t = stack[top]
        for k in range(3):
            u = neighbours[t, k]
            if u < 0 or u == came[t]:
                continue
            entry[u] = 0.5 * (nodes[triangles[t, (k + 1) % 3]] + nodes[triangles[t, (k + 2) % 3]])
            far[u] = far[t] + np.hypot(entry[u, 0] - entry[t, 0], entry[u, 1] - entry[t, 1])
            came[u] = t
            stack[top] = u
            top += 1
            tip = only_way(neighbours, u)
            if tip >= 0:
                c = triangles[u, tip]
                way = far[u] + np.hypot(nodes[c, 0] - entry[u, 0], nodes[c, 1] - entry[u, 1])
                if way > best:
                    best, end = way, u
    return end, best


@njit(cache=True, error_model="numpy")
def longest_side(nodes: Floats, triangle: Ints) -> tuple[int, int, float]:
    """Both ends of the longest side of a triangle, and its length."""
    one, two, best = triangle[0], triangle[0], -1.0
    for k in range(3):
        a, b = triangle[k], triangle[(k + 1) % 3]
        length = np.hypot(nodes[b, 0] - nodes[a, 0], nodes[b, 1] - nodes[a, 1])
        if length > best:
            one, two, best = a, b, length
    return one, two, best


def find_tips_plain(nodes: Floats, triangles: Ints, neighbours: Ints, last: Longs) -> tuple[Longs, Floats]:
    """Twin of `find_tips`: every way between two tips, and the longest of them."""
    tips, ways = [], []
    for begin, end in pairwise([0, *last.tolist()]):
        links = {t: [(int(u), k) for k, u in enumerate(neighbours[t]) if u >= 0] for t in range(begin, end)}
        sides = [tuple(np.delete(triangles[begin], k).tolist()) for k in range(3)]
        way, pair = max(
            list(_all_ways(nodes, triangles, links))
            or [(float(np.hypot(*(nodes[one] - nodes[two]))), (one, two)) for one, two in sides]
        )
        ways.append(way)
        tips.append(pair)
    return np.array(tips), np.array(ways)


def _all_ways(
    nodes: Floats, triangles: Ints, links: dict[int, list[tuple[int, int]]]
) -> Iterator[tuple[float, tuple[int, int]]]:
    """Length and tips of every way between two tips of one outline."""
    tip = {t: int(triangles[t, ways[0][1]]) for t, ways in links.items() if len(ways) == 1}
    waiting: list[tuple[tuple[int, ...], list[Floats]]] = [((t,), [nodes[node]]) for t, node in tip.items()]
    while waiting:
        path, line = waiting.pop()
        if len(path) > 1 and path[-1] in tip:
            whole = np.array([*line, nodes[tip[path[-1]]]])
            yield float(np.hypot(*np.diff(whole, axis=0).T).sum()), (tip[path[0]], tip[path[-1]])
        for u, k in links[path[-1]]:
            if u not in path:
                middle = nodes[np.delete(triangles[path[-1]], k)].mean(axis=0)
                waiting.append(((*path, u), [*line, middle]))
