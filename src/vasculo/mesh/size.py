"""Target edge length: uniform, by wall distance and by gap width, with a bounded gradient."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from vasculo.geometry.boxtree import BoxTree, box_tree, least
from vasculo.mesh.passages import passages_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.mesh.passages import Passages
    from vasculo.mesh.walls import Walls

LAYER = 2.0 / np.sqrt(3.0)
"""Edge length over height of an equilateral triangle: n layers across a gap of width g have edges LAYER g / n."""

BASE_LAYERS = 1.25
"""Layers that fit across every gap even when none are asked for: wall edges stay below 0.92 of the gap."""


@dataclass(frozen=True, eq=False)
class SizeField:
    """Wanted edge length h(x) = min(largest, min over sources of (size + slope * distance)).

    Parameters
    ----------
    sources : BoxTree
        Wall segments and points in the passages, with their sizes as weights (model length).
    slope : float, dimensionless
        Largest gradient of h.
    largest : float, model length
        h far from all sources.
    """

    sources: BoxTree
    slope: float
    largest: float

    def at(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Wanted edge length at points (n, 2); (n,) float64, model length."""
        tree = self.sources
        places = np.ascontiguousarray(points, dtype=np.float64)
        return sizes_at(places, tree.segments, tree.weights, tree.boxes, tree.lowest, self.slope, self.largest)


def size_field(
    walls: Walls, edge_length: float, wall_edge_length: float, across: float, grading: float
) -> tuple[SizeField, Passages]:
    """Make the size field of a domain.

    Parameters
    ----------
    walls : Walls
    edge_length : float, model length
        Largest edge length.
    wall_edge_length : float, model length
        Edge length at walls; a wall segment shorter than that sets its own length.
    across : float
        Layers of triangles across each passage (`BASE_LAYERS` at least).
    grading : float, dimensionless
        Largest gradient of the edge length.

    Returns
    -------
    field : SizeField
    passages : Passages
        The passages measured on the way, with the size in each.
    """
    layers = max(float(across), BASE_LAYERS)
    passages = passages_of(walls, edge_length * layers / LAYER)
    at_wall = np.minimum(np.minimum(wall_edge_length, edge_length), walls.lengths)
    narrow = np.minimum(passages.gap * (LAYER / layers), wall_edge_length)
    points = np.concatenate((passages.points, 0.5 * (passages.points + passages.across)))
    segments = np.concatenate((walls.segments, np.hstack((points, points))))
    sizes = np.concatenate((at_wall, narrow, np.minimum(passages.gap * (LAYER / layers), edge_length)))
    return SizeField(box_tree(segments, sizes), float(grading), float(edge_length)), passages


def sizes_at_plain(
    points: NDArray[np.float64],
    segments: NDArray[np.float64],
    weights: NDArray[np.float64],
    slope: float,
    largest: float,
) -> NDArray[np.float64]:
    """Plain twin of `sizes_at`: every point against every source."""
    start, step = segments[:, :2], segments[:, 2:] - segments[:, :2]
    square = (step**2).sum(axis=1)
    away = points[:, None] - start
    along = np.clip((away * step).sum(axis=2) / np.where(square > 0.0, square, 1.0), 0.0, 1.0)
    rest = away - along[:, :, None] * step
    return np.minimum(largest, (weights + slope * np.hypot(rest[:, :, 0], rest[:, :, 1])).min(axis=1))


@njit(cache=True, error_model="numpy")
def sizes_at(points, segments, weights, boxes, lowest, slope, largest):  # type: ignore[no-untyped-def]
    """Wanted edge length at each point."""
    sizes = np.empty(len(points))
    for i in range(len(points)):
        sizes[i] = least(segments, weights, boxes, lowest, slope, points[i, 0], points[i, 1], largest, -1)[0]
    return sizes
