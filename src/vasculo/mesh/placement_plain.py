"""Plain twin of the placement of interior nodes: every candidate against every node and every wall."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.mesh.placement import CLEAR, OFF_WALL
from vasculo.mesh.size import sizes_at_plain

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.mesh.size import SizeField
    from vasculo.mesh.walls import Walls


def interior_nodes_plain(
    walls: Walls, field: SizeField, points: NDArray[np.float64], edges: NDArray[np.int32]
) -> NDArray[np.float64]:
    """Interior nodes, in the order of `interior_nodes`.

    Parameters
    ----------
    walls : Walls
    field : SizeField
    points : (n, 2) float64, model length
        Wall nodes.
    edges : (e, 2) int32
        Wall edges, fluid on the left.

    Returns
    -------
    (k, 2) float64, model length
    """
    height = np.sqrt(3.0) / 2.0
    step = points[edges[:, 1]] - points[edges[:, 0]]
    middle = 0.5 * (points[edges[:, 0]] + points[edges[:, 1]])
    nodes = list(points)
    queue: list[tuple[NDArray[np.float64], float, float]] = []

    def offer(start: NDArray[np.float64], reach: float, angle: float, wall_size: float | None) -> None:
        heading = np.array([np.cos(angle), np.sin(angle)])
        place = start + reach * heading
        size = _size(field, place)
        if wall_size is None:
            if _nearest(nodes, place) < CLEAR * (1.0 - field.slope) * reach:
                return
            place = start + 0.5 * (reach + size) * heading
        else:
            size = min(size, wall_size)
        if _nearest(nodes, place) >= CLEAR * size and _off_wall(walls, place, size):
            nodes.append(place)
            queue.append((place, size, angle))

    for place, way in zip(middle, step, strict=True):
        size = _size(field, place)
        offer(place, height * size, float(np.arctan2(way[0], -way[1])), size)
    for place, size, angle in queue:
        for turn in range(6):
            offer(place, size, angle + turn * np.pi / 3.0, None)
    return np.array(nodes[len(points) :]).reshape(-1, 2)


def _size(field: SizeField, place: NDArray[np.float64]) -> float:
    """Wanted edge length at one place."""
    tree = field.sources
    return float(sizes_at_plain(place[None], tree.segments, tree.weights, field.slope, field.largest)[0])


def _nearest(nodes: list[NDArray[np.float64]], place: NDArray[np.float64]) -> float:
    """Distance to the nearest node."""
    away = np.array(nodes) - place
    return float(np.hypot(away[:, 0], away[:, 1]).min())


def _off_wall(walls: Walls, place: NDArray[np.float64], size: float) -> bool:
    """Whether a place lies in the fluid, far enough from all walls; walls farther than the size do not count."""
    start, step = walls.segments[:, :2], walls.segments[:, 2:] - walls.segments[:, :2]
    along = np.clip(((place - start) * step).sum(axis=1) / walls.lengths**2, 0.0, 1.0)
    way = place - start - along[:, None] * step
    distance = np.hypot(way[:, 0], way[:, 1])
    near = np.flatnonzero(distance <= distance.min() * (1.0 + 1e-9))
    if distance.min() >= size:
        return True
    unit = np.column_stack((-step[:, 1], step[:, 0])) / walls.lengths[:, None]
    return bool(distance.min() >= OFF_WALL * size and way[near[0]] @ unit[near].sum(axis=0) > 0.0)
