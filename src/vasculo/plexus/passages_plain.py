"""Plain twins of the kernels of the passages: triangle by triangle and pair by pair; the reference in the tests."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
import shapely

from vasculo.mesh.size import LAYER
from vasculo.mesh.subdivide import SLACK
from vasculo.plexus.passage_kernels import EQUILATERAL, FINEST, NARROW_FACTOR, PLAIN_FACTOR

if TYPE_CHECKING:
    from vasculo.geometry.arrays import Flags, Floats, Ints, Longs


def sort_triangles_plain(triangles: Ints, neighbours: Ints, label: Ints) -> tuple[Ints, Ints, Ints]:
    """Twin of `sort_triangles`."""
    mine = label[triangles]
    for k in range(3):
        wall = neighbours[:, k] < 0
        mine[wall, (k + 1) % 3] = mine[wall, (k + 2) % 3] = label[triangles[wall, (k + 1) % 3]]
    alone = (np.roll(mine, -1, axis=1) == np.roll(mine, -2, axis=1)) & (mine != np.roll(mine, -1, axis=1))
    two_bodies = alone.any(axis=1)
    low = np.where(two_bodies, mine.min(axis=1), -1)
    high = np.where(two_bodies, mine.max(axis=1), -1)
    apex = np.where(two_bodies, alone.argmax(axis=1), -1)
    return low.astype(np.int32), high.astype(np.int32), apex.astype(np.int32)


def narrowest_widths_plain(pairs: Ints, segments: Floats, first: Longs) -> Floats:
    """Lengths (k,) of the ways of `narrowest_ways`."""
    lines = [shapely.multilinestrings(segments[one:two].reshape(-1, 2, 2)) for one, two in pairwise(first)]
    return np.array([shapely.distance(lines[one], lines[other]) for one, other in pairs.tolist()])


def wall_sizes_plain(
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
    """Twin of `wall_sizes`."""
    node = np.minimum(own, largest)
    np.minimum.at(node, after, own)
    middle = np.full(len(points), np.inf)
    for corners, beside, k in zip(triangles, neighbours, apex, strict=True):
        if k < 0:
            continue
        a, b, c = np.roll(corners, -k)
        base = points[c] - points[b]
        along = np.clip((points[a] - points[b]) @ base / (base @ base), 0.0, 1.0)
        size = LAYER * np.linalg.norm(points[b] + along * base - points[a]) / layers
        rise = slope * np.linalg.norm(base)
        node[[a, b, c]] = np.minimum(node[[a, b, c]], (size, size + along * rise, size + (1.0 - along) * rise))
        if beside[k] < 0:
            middle[b] = min(middle[b], size)
    one = triangles.ravel()
    two = np.roll(triangles, -1, axis=1).ravel()
    rise = slope * np.linalg.norm(points[one] - points[two], axis=1)
    for _ in range(len(points)):
        before = node.copy()
        np.minimum.at(node, one, before[two] + rise)
        np.minimum.at(node, two, before[one] + rise)
        if np.array_equal(before, node):
            break
    length = np.linalg.norm(points[after] - points, axis=1)
    inner = np.minimum(middle, 0.5 * (node + node[after]))
    cuts = length * (0.25 / node + 0.25 / node[after] + 0.5 / inner)
    cuts = np.where(whole, np.maximum(1.0, np.ceil(cuts - SLACK - 1e-9)), cuts)
    edge = np.minimum(largest, length / cuts)
    node = edge.copy()
    np.minimum.at(node, after, edge)
    return node, edge


def expected_triangles_plain(
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
    """Twin of `expected_triangles`."""
    node, edge = wall_sizes_plain(points, after, triangles, neighbours, apex, own, whole, largest, layers, slope)
    expected = np.empty(len(triangles))
    for t, (corners, beside, k) in enumerate(zip(triangles, neighbours, apex, strict=True)):
        at = points[corners]
        longest = np.linalg.norm(at - np.roll(at, 1, axis=0), axis=1).max()
        parts = int(np.clip(np.ceil(longest / min(largest, node[corners].min()) - 1e-9), 2, FINEST))
        spots = middles(parts) @ at
        sizes, factor = [np.full(len(spots), largest)], PLAIN_FACTOR
        for j, corner in enumerate(corners):
            sizes.append(node[corner] + slope * np.linalg.norm(spots - points[corner], axis=1))
            wall = shapely.linestrings([at[(j + 1) % 3], at[(j + 2) % 3]])
            away = shapely.distance(shapely.points(spots), wall)
            if beside[j] < 0:
                sizes.append(edge[corners[(j + 1) % 3]] + slope * away)
            if j == k:
                width = shapely.distance(shapely.points(points[corner]), wall)
                half = LAYER * width / layers
                sizes.append(half + slope * np.abs(away - 0.5 * width))
                factor = NARROW_FACTOR if half < min(largest, own[corners].min()) else PLAIN_FACTOR
        area = 0.5 * np.linalg.det(at[1:] - at[0])
        expected[t] = factor * area * np.mean(np.min(sizes, axis=0) ** -2.0) / EQUILATERAL
    return expected


def middles(parts: int) -> Floats:
    """Middles of the equal parts of a triangle cut so often along each edge: (parts^2, 3) weights of its corners."""
    thirds = [(3 * u + 1 + flip, 3 * v + 1 + flip) for u in range(parts) for v in range(parts - u) for flip in (0, 1)]
    weights = np.array([(one, two, 3 * parts - one - two) for one, two in thirds if one + two < 3 * parts])
    return weights / (3.0 * parts)
