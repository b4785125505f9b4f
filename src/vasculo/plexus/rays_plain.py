"""Plain twins of the rays: every ray against every spring, and the walk around a void with dictionaries."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.plexus.rays import SHORT_PATH

if TYPE_CHECKING:
    from vasculo.geometry.arrays import Floats, Ints


def ray_distances_plain(points: Floats, springs: Ints, centres: Floats, directions: Floats) -> tuple[Floats, Ints]:
    """NumPy twin of `vasculo.plexus.raycast.ray_distances`, for given unit vectors (r, 2)."""
    distances = np.full((len(centres), len(directions)), np.inf)
    hits = np.full(distances.shape, -1, dtype=np.int32)
    if not len(springs):
        return distances, hits
    x, y = directions[:, :1], directions[:, 1:]
    for index, centre in enumerate(centres):
        a, b = points[springs[:, 0]] - centre, points[springs[:, 1]] - centre
        side_a, side_b = x * a[:, 1] - y * a[:, 0], x * b[:, 1] - y * b[:, 0]
        along_a, along_b = x * a[:, 0] + y * a[:, 1], x * b[:, 0] + y * b[:, 1]
        with np.errstate(invalid="ignore", divide="ignore"):
            along = along_a + side_a / (side_a - side_b) * (along_b - along_a)
        along = np.where(side_b == 0.0, along_b, np.where(side_a == 0.0, along_a, along))
        nearer = np.minimum(along_a, along_b)
        through = (nearer < 0.0) & (np.maximum(along_a, along_b) >= 0.0)
        along = np.where((side_a == 0.0) & (side_b == 0.0), np.where(through, 0.0, nearer), along)
        apart = ((side_a > 0.0) & (side_b > 0.0)) | ((side_a < 0.0) & (side_b < 0.0)) | (along < 0.0)
        along = np.where(apart, np.inf, along)
        distances[index] = along.min(axis=1)
        hits[index] = np.where(np.isfinite(distances[index]), along.argmin(axis=1), -1)
    return distances, hits


def inspect_plain(
    points: Floats, springs: Ints, centre: Floats, hits: Ints, longest: int
) -> tuple[list[int], bool, list[int]]:
    """Twin of `vasculo.plexus.rays._inspect` for one centre: nodes of the loop, whether it closes, and its links.

    Parameters as there; `springs` between merged nodes, `hits` (r,) of this centre.
    """
    around: dict[int, list[tuple[int, int, int]]] = {}
    for number, (p, q) in enumerate(springs.tolist()):
        if p != q:
            around.setdefault(p, []).append((number, p, q))
            around.setdefault(q, []).append((number, q, p))

    def turn_on(edge: tuple[int, int, int]) -> tuple[int, int, int]:
        number, tail, node = edge
        back = complex(*(points[tail] - points[node]))
        others = [other for other in around[node] if other[0] != number]
        angles = [-np.angle(complex(*(points[other[2]] - points[node])) / back) for other in others]
        turns = [angle if angle > 0.0 else angle + 2.0 * np.pi for angle in angles]
        return others[int(np.argmin(turns))] if others else (number, node, tail)

    met: list[tuple[int, int, int]] = []
    for number in hits.tolist():
        if number >= 0 and springs[number, 0] != springs[number, 1]:
            p, q = springs[number].tolist()
            arm, way = points[q] - points[p], centre - points[p]
            left = arm[0] * way[1] - arm[1] * way[0]
            edge = (number, p, q) if left > 0.0 else (number, q, p)
            if left != 0.0 and edge not in met:
                met.append(edge)
    passed = set()
    for begin in met:
        if begin in passed:
            continue
        loop, gap, kinds = [begin], 0, [0, 0, 0]
        edge = turn_on(begin)
        while edge != begin and gap <= longest:
            if edge in met:
                passed.add(edge)
                kinds[0 if gap == 0 else 1 if gap <= SHORT_PATH else 2] += 1
                gap = -1
            gap += 1
            loop.append(edge)
            edge = turn_on(edge)
        if edge != begin or gap > longest:
            continue
        kinds[0 if gap == 0 else 1 if gap <= SHORT_PATH else 2] += 1
        while len(loop) > 1 and (spike := [k for k in range(len(loop)) if loop[k][0] == loop[k - 1][0]]):
            k = spike[0]
            loop = [edge for i, edge in enumerate(loop) if i not in {k, (k - 1) % len(loop)}]
        nodes = [tail for _, tail, _ in loop]
        x, y = (points[nodes] - centre).T
        if len(nodes) > 2 and np.dot(x, np.roll(y, -1)) > np.dot(np.roll(x, -1), y):
            return nodes, True, kinds
    return [tail for _, tail, _ in met], False, [0, 0, 0]
