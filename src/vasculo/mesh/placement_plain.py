"""Plain twin of the placement of interior nodes: every candidate against every node and every wall."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.geometry.predicates import orient2d_plain
from vasculo.mesh.nearby import CLEAR
from vasculo.mesh.placement import HEIGHT, OFF_WALL
from vasculo.mesh.size import sizes_at_plain

if TYPE_CHECKING:
    from fractions import Fraction

    from numpy.typing import NDArray

    from vasculo.mesh.size import SizeField


def interior_nodes_plain(
    field: SizeField, points: NDArray[np.float64], edges: NDArray[np.int32]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Interior nodes and their sizes, in the order of `interior_nodes`.

    Parameters
    ----------
    field : SizeField
    points : (n, 2) float64, model length
        Wall nodes.
    edges : (e, 2) int32
        Wall edges, fluid on the left.

    Returns
    -------
    places : (k, 2) float64, model length
    wanted : (k,) float64, model length
    """
    step = points[edges[:, 1]] - points[edges[:, 0]]
    middle = 0.5 * (points[edges[:, 0]] + points[edges[:, 1]])
    nodes = list(points)
    queue: list[tuple[NDArray[np.float64], float, float, bool]] = []

    def is_free(place: NDArray[np.float64], size: float) -> bool:
        away = np.array(nodes) - place
        if np.hypot(away[:, 0], away[:, 1]).min() < CLEAR * size:
            return False
        along = np.clip(((place - points[edges[:, 0]]) * step).sum(axis=1) / (step**2).sum(axis=1), 0.0, 1.0)
        way = place - points[edges[:, 0]] - along[:, None] * step
        return bool(np.hypot(way[:, 0], way[:, 1]).min() >= OFF_WALL * size)

    for row, (place, way) in enumerate(zip(middle, step, strict=True)):
        size = _size(field, place)
        normal = np.array([-way[1], way[0]]) / np.hypot(*way)
        there = place + HEIGHT * size * normal
        wanted = min(size, _size(field, there))
        if is_free(there, wanted) and not _is_cut(points[edges], row, there):
            nodes.append(there)
            queue.append((there, wanted, float(np.arctan2(normal[1], normal[0])) + np.pi / 6.0, True))
    for place, size, angle, is_seed in queue:
        for turn in range(6):
            if turn == 3 and not is_seed:
                continue
            heading = angle + turn * np.pi / 3.0
            unit = np.array([np.cos(heading), np.sin(heading)])
            if not is_free(place + size * unit, (1.0 - field.slope) * size):
                continue
            wanted = _size(field, place + size * unit)
            there = place + 0.5 * (size + wanted) * unit
            if is_free(there, wanted):
                nodes.append(there)
                queue.append((there, wanted, heading, False))
    return np.array(nodes[len(points) :]).reshape(-1, 2), np.array([size for _, size, _, _ in queue])


def _size(field: SizeField, place: NDArray[np.float64]) -> float:
    """Wanted edge length at one place."""
    tree = field.sources
    return float(sizes_at_plain(place[None], tree.segments, tree.weights, field.slope, field.largest)[0])


def _is_cut(walls: NDArray[np.float64], own: int, place: NDArray[np.float64]) -> bool:
    """Whether a wall edge (e, 2, 2) other than `own` reaches into the triangle of that edge and a place."""
    corners = [*walls[own], place]
    sides = list(zip(corners, [*corners[1:], corners[0]], strict=True))
    for start, end in np.delete(walls, own, axis=0):
        if np.array_equal(start, corners[1]):
            cut = _side(*sides[0], end) > 0 and _side(*sides[1], end) > 0
        elif np.array_equal(end, corners[0]):
            cut = _side(*sides[0], start) > 0 and _side(*sides[2], start) > 0
        else:
            crossed = [
                _side(start, end, a) * _side(start, end, b) <= 0 and _side(a, b, start) * _side(a, b, end) <= 0
                for a, b in sides[1:]
            ]
            cut = any(crossed) or all(_side(a, b, start) > 0 for a, b in sides)
        if cut:
            return True
    return False


def _side(a: NDArray[np.float64], b: NDArray[np.float64], c: NDArray[np.float64]) -> Fraction:
    """Twice the area of the triangle a, b, c, exactly."""
    return orient2d_plain(*a.tolist(), *b.tolist(), *c.tolist())
