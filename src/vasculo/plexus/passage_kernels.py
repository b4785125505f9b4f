"""Kernels of the passages: whose a triangle is, the narrowest way between two bodies, and the expected mesh.

The expected mesh follows the size field of `vasculo.mesh.size`: at every place the smallest of the plain edge length,
the wall edges and the widths of the passages over their layers, each growing with the distance.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from vasculo.mesh.size import LAYER
from vasculo.mesh.subdivide import SLACK

if TYPE_CHECKING:
    from vasculo.geometry.arrays import Flags, Floats, Ints, Longs

PLAIN_FACTOR = 1.02
"""Triangles of a real mesh over those that its size field asks for, measured (`benchmarks/extract_whole.py`)."""
NARROW_FACTOR = 1.14
"""The same where a passage asks for shorter edges than its walls have: whole layers have to fit."""
EQUILATERAL = np.sqrt(3.0) / 4.0
"""Area of an equilateral triangle over its edge length squared."""
FINEST = 8
"""Most parts along the edge of a triangle over which the size field is averaged."""


@njit(cache=True, error_model="numpy")
def sort_triangles(triangles: Ints, neighbours: Ints, label: Ints) -> tuple[Ints, Ints, Ints]:
    """Bodies on both sides of each triangle between wall nodes.

    Parameters
    ----------
    triangles, neighbours : (t, 3) int32
        Counter-clockwise; the triangle across the edge opposite to each corner, -1 at a wall.
    label : (n,) int32
        Body of the wall edge that starts at each node, fluid on its left.

    Returns
    -------
    one, two : (t,) int32
        The two bodies, one < two; -1 where there are one or three of them.
    apex : (t,) int32
        Corner that stands alone against the other two, -1 where there is none.
    """
    count = len(triangles)
    one = np.full(count, -1, dtype=np.int32)
    two = np.full(count, -1, dtype=np.int32)
    apex = np.full(count, -1, dtype=np.int32)
    mine = np.empty(3, dtype=np.int32)
    for t in range(count):
        for k in range(3):
            mine[k] = label[triangles[t, k]]
        for k in range(3):  # where two sides meet, the wall says which of them it is
            if neighbours[t, k] < 0:
                mine[(k + 1) % 3] = label[triangles[t, (k + 1) % 3]]
                mine[(k + 2) % 3] = mine[(k + 1) % 3]
        for k in range(3):
            other = mine[(k + 1) % 3]
            if other == mine[(k + 2) % 3] and mine[k] != other:
                one[t], two[t], apex[t] = min(mine[k], other), max(mine[k], other), k
    return one, two, apex


@njit(cache=True, error_model="numpy")
def nearest_on(x: float, y: float, ax: float, ay: float, bx: float, by: float) -> tuple[float, float, float]:
    """Place on the segment from a to b that is nearest to a point (0 to 1), and the way there."""
    dx, dy = bx - ax, by - ay
    square = dx * dx + dy * dy
    along = 0.0
    if square > 0.0:
        along = min(1.0, max(0.0, ((x - ax) * dx + (y - ay) * dy) / square))
    return along, ax + along * dx - x, ay + along * dy - y


@njit(cache=True, error_model="numpy")
def narrowest_ways(pairs: Ints, segments: Floats, first: Longs) -> Floats:
    """Shortest way between the two bodies of each pair.

    Parameters
    ----------
    pairs : (k, 2) int32
        Two bodies that do not touch.
    segments : (m, 4) float64
        Start and end of the segments of all bodies, one body after the other (model length).
    first : (bodies + 1,) int64
        Segments first[i] to first[i + 1] are those of body i.

    Returns
    -------
    (k, 2, 2) float64
        The two ends of the way, on the first and on the second body (model length).
    """
    # Strategy: between bodies that do not cross the shortest way starts at a node of one of them, so every node of one
    # is held against every segment of the other; nodes farther from the other's bounding box than the best way so far
    # are passed over.
    ways = np.empty((len(pairs), 2, 2))
    for row in range(len(pairs)):
        best = np.inf
        for turn in range(2):
            own, other = pairs[row, turn], pairs[row, 1 - turn]
            low_x = low_y = np.inf
            high_x = high_y = -np.inf
            for s in range(first[other], first[other + 1]):
                low_x = min(low_x, segments[s, 0], segments[s, 2])
                low_y = min(low_y, segments[s, 1], segments[s, 3])
                high_x = max(high_x, segments[s, 0], segments[s, 2])
                high_y = max(high_y, segments[s, 1], segments[s, 3])
            for n in range(first[own], first[own + 1]):
                last = (
                    n + 1 == first[own + 1]
                    or segments[n, 2] != segments[n + 1, 0]
                    or segments[n, 3] != segments[n + 1, 1]
                )
                for end in range(0, 4 if last else 2, 2):
                    x, y = segments[n, end], segments[n, end + 1]
                    away_x = max(low_x - x, x - high_x, 0.0)
                    away_y = max(low_y - y, y - high_y, 0.0)
                    if away_x * away_x + away_y * away_y >= best:
                        continue
                    for s in range(first[other], first[other + 1]):
                        _, wx, wy = nearest_on(x, y, segments[s, 0], segments[s, 1], segments[s, 2], segments[s, 3])
                        square = wx * wx + wy * wy
                        if square < best:
                            best = square
                            ways[row, turn, 0], ways[row, turn, 1] = x, y
                            ways[row, 1 - turn, 0], ways[row, 1 - turn, 1] = x + wx, y + wy
    return ways


@njit(cache=True, error_model="numpy")
def wall_sizes(
    points: Floats,
    after: Longs,
    triangles: Ints,
    neighbours: Ints,
    apex: Ints,
    own: Floats,
    whole: Flags,
    largest: float,
    layers: float,
    slope: float,
) -> tuple[Floats, Floats]:
    """Edge lengths that a mesh gets at wall nodes and on the wall edges that start there (arguments as below)."""
    node = np.minimum(own, largest)
    middle = np.full(len(points), np.inf)
    for i in range(len(points)):
        node[after[i]] = min(node[after[i]], own[i])
    for t in range(len(triangles)):
        k = apex[t]
        if k < 0:
            continue
        a, b, c = triangles[t, k], triangles[t, (k + 1) % 3], triangles[t, (k + 2) % 3]
        along, wx, wy = nearest_on(points[a, 0], points[a, 1], points[b, 0], points[b, 1], points[c, 0], points[c, 1])
        size = LAYER * np.hypot(wx, wy) / layers
        base = slope * np.hypot(points[c, 0] - points[b, 0], points[c, 1] - points[b, 1])
        node[a] = min(node[a], size)
        node[b] = min(node[b], size + along * base)
        node[c] = min(node[c], size + (1.0 - along) * base)
        if neighbours[t, k] < 0:
            middle[b] = min(middle[b], size)
    changed = True
    while changed:
        changed = False
        for t in range(len(triangles)):
            for k in range(3):
                i, j = triangles[t, k], triangles[t, (k + 1) % 3]
                step = slope * np.hypot(points[j, 0] - points[i, 0], points[j, 1] - points[i, 1])
                if node[i] > node[j] + step:
                    node[i] = node[j] + step
                    changed = True
                elif node[j] > node[i] + step:
                    node[j] = node[i] + step
                    changed = True
    edge = np.empty(len(points))
    for i in range(len(points)):
        j = after[i]
        length = np.hypot(points[j, 0] - points[i, 0], points[j, 1] - points[i, 1])
        inner = min(middle[i], 0.5 * (node[i] + node[j]))
        cuts = length * (0.25 / node[i] + 0.25 / node[j] + 0.5 / inner)
        if whole[i]:
            cuts = max(1.0, np.ceil(cuts - SLACK - 1e-9))
        edge[i] = min(largest, length / cuts)
    node[:] = np.inf
    for i in range(len(points)):
        node[i] = min(node[i], edge[i])
        node[after[i]] = min(node[after[i]], edge[i])
    return node, edge


@njit(cache=True, error_model="numpy")
def expected_triangles(
    points: Floats,
    after: Longs,
    triangles: Ints,
    neighbours: Ints,
    apex: Ints,
    own: Floats,
    whole: Flags,
    largest: float,
    layers: float,
    slope: float,
) -> Floats:
    """Triangles that a mesh would have in each triangle between wall nodes.

    A measured factor times the integral of dA / (EQUILATERAL h^2) over the edge length h.

    Parameters
    ----------
    points : (n, 2) float64
        Wall nodes (model length).
    after : (n,) int64
        Next node on the outline, fluid on the left.
    triangles, neighbours, apex
        As in `sort_triangles`.
    own : (n,) float64
        Length of the outline segment that starts at each node, or that it is a cut of (model length).
    whole : (n,) bool
        Whether that segment is not cut: then a whole number of mesh edges goes into it.
    largest : float
        Plain edge length (model length).
    layers : float
        Triangles across a passage.
    slope : float
        Largest gradient of the edge length.

    Returns
    -------
    (t,) float64
    """
    # Strategy: sizes at the walls first; then each triangle is divided into equal parts about as large as its smallest
    # size, and 1 / h^2 is averaged over their middles. h grows from the corners, from walls among the edges, and from
    # the line half way across a passage.
    node, edge = wall_sizes(points, after, triangles, neighbours, apex, own, whole, largest, layers, slope)
    expected = np.empty(len(triangles))
    px, py, size, wall = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    for t in range(len(triangles)):
        plain, smallest = largest, largest
        for k in range(3):
            i = triangles[t, k]
            px[k], py[k], size[k] = points[i, 0], points[i, 1], node[i]
            wall[k] = edge[triangles[t, (k + 1) % 3]] if neighbours[t, k] < 0 else largest
            plain, smallest = min(plain, own[i]), min(smallest, node[i])
        x1, y1, x2, y2 = px[1] - px[0], py[1] - py[0], px[2] - px[0], py[2] - py[0]
        longest = np.sqrt(max(x1 * x1 + y1 * y1, x2 * x2 + y2 * y2, (x2 - x1) ** 2 + (y2 - y1) ** 2))
        parts = int(min(float(FINEST), max(2.0, np.ceil(longest / smallest - 1e-9))))
        tip, width, half = apex[t], 0.0, np.inf
        if tip >= 0:
            b, c = (tip + 1) % 3, (tip + 2) % 3
            _, wx, wy = nearest_on(px[tip], py[tip], px[b], py[b], px[c], py[c])
            width = np.sqrt(wx * wx + wy * wy)
            half = LAYER * width / layers
        summed = 0.0
        for u in range(parts):
            for v in range(parts - u):
                for flip in range(1 + (v < parts - u - 1)):
                    one, two = (u + (1.0 + flip) / 3.0) / parts, (v + (1.0 + flip) / 3.0) / parts
                    x, y = px[0] + one * x1 + two * x2, py[0] + one * y1 + two * y2
                    h = largest
                    for k in range(3):
                        dx, dy = px[k] - x, py[k] - y
                        h = min(h, size[k] + slope * np.sqrt(dx * dx + dy * dy))
                        if wall[k] < h or k == tip:
                            b, c = (k + 1) % 3, (k + 2) % 3
                            _, wx, wy = nearest_on(x, y, px[b], py[b], px[c], py[c])
                            away = np.sqrt(wx * wx + wy * wy)
                            h = min(h, wall[k] + slope * away)
                            if k == tip:
                                h = min(h, half + slope * abs(away - 0.5 * width))
                    summed += 1.0 / (h * h)
        factor = NARROW_FACTOR if half < plain else PLAIN_FACTOR
        expected[t] = 0.5 * factor * (x1 * y2 - y1 * x2) * summed / (parts * parts) / EQUILATERAL
    return expected
