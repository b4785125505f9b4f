"""Target edge length: uniform, by wall distance, curvature, gap width or a function, with a bounded gradient."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from vasculo.geometry.boxtree import STACK, BoxTree, box_tree, distance_to, least
from vasculo.mesh.passages import passages_of
from vasculo.mesh.wishes import curvature_wishes, function_wishes
from vasculo.springs.threads import run_team

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from vasculo.geometry.arrays import Floats
    from vasculo.mesh.passages import WallSamples
    from vasculo.mesh.walls import Walls

LAYER = 2.0 / np.sqrt(3.0)
"""Edge length over height of an equilateral triangle: n layers across a gap of width g have edges LAYER g / n."""

BASE_LAYERS = 1.25
"""Layers that fit across every gap even when none are asked for: wall edges stay below 0.92 of the gap."""

GRADING = 0.25
"""Largest change of the edge length per length, where no other is asked for."""

FEWEST = 2000
"""Fewest places of one thread."""

LEVEL_SLOPE = 0.25
"""Gradient that is never used in a field of one length."""


@dataclass(frozen=True, eq=False)
class SizeField:
    """Wanted edge length h(x) = min(largest, min over sources of (size + slope * distance)).

    Parameters
    ----------
    sources : BoxTree
        Wall segments, lines in the passages and places with wishes of their own, with their sizes as weights.
    slope : float, dimensionless
        Largest gradient of h.
    largest : float, model length
        h far from all sources.
    wall_sizes : (n,) float64, model length
        Size at each wall segment, passages left aside.
    passages : WallSamples
        The passages found.
    passage_sizes : (s,) float64, model length
        Size in each passage sample.
    beside : (k, 4) float64, model length
        Sources that are no walls: lines in the passages, nodes of curved walls, cells of a size function.
    beside_sizes : (k,) float64, model length
        Size at each of them.
    wish_cost : float
        Integral of 1 / h^2 - 1 / largest^2 that curvature and the size function ask for, about.
    """

    sources: BoxTree
    slope: float
    largest: float
    wall_sizes: NDArray[np.float64]
    passages: WallSamples
    passage_sizes: NDArray[np.float64]
    beside: NDArray[np.float64]
    beside_sizes: NDArray[np.float64]
    wish_cost: float

    def at(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """Wanted edge length at points (n, 2); (n,) float64, model length."""
        tree = self.sources
        places = np.ascontiguousarray(points, dtype=np.float64)
        sizes = np.empty(len(places))
        run_team(
            sizes_at, len(places) // FEWEST + 1, places, tree.segments, tree.weights, tree.boxes, tree.lowest,
            self.slope, self.largest, sizes,
        )  # fmt: skip
        return sizes


def size_field(
    walls: Walls,
    edge_length: float,
    wall_edge_length: float,
    across: float,
    grading: float,
    *,
    curvature: float = 0.0,
    size: Callable[[NDArray[np.float64]], NDArray[np.float64]] | None = None,
    most: int = 5_000_000,
) -> SizeField:
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
    curvature : float, default 0
        Edges in a full turn of a wall; 0: curvature sets no size.
    size : callable, optional
        (n, 2) points to (n,) edge lengths, model length.
    most : int, default 5 000 000
        Most places at which `size` is read.

    Returns
    -------
    SizeField

    Raises
    ------
    InputError
        What `size` gives is no length, or it needs too many places.
    """
    # Strategy: a size at each wall segment, and one at each measured passage, on the wall and half way across; between
    # them the size grows with the distance. In a passage the wall sizes alone would grow towards its middle.
    layers = max(float(across), BASE_LAYERS)
    passages = passages_of(walls, edge_length * layers / LAYER)
    at_wall = np.minimum(min(wall_edge_length, edge_length), walls.lengths)
    narrow = np.minimum(passages.gap * (LAYER / layers), edge_length)
    half_way = np.tile(0.5 * (passages.across - passages.points), 2)
    beside, sizes, cost = [passages.pieces, passages.pieces + half_way], [narrow, narrow], 0.0
    if curvature > 0.0:
        wishes, wanted, more = curvature_wishes(walls, curvature, edge_length, grading)
        beside.append(wishes)
        sizes.append(wanted)
        cost += more
    if size is not None:
        places, wanted, more = function_wishes(size, walls, edge_length, most)
        beside.append(np.tile(places, 2))
        sizes.append(wanted)
        cost += more
    lines, lengths = np.concatenate(beside), np.concatenate(sizes)
    sources = box_tree(np.concatenate((walls.segments, lines)), np.concatenate((at_wall, lengths)))
    return SizeField(sources, float(grading), float(edge_length), at_wall, passages, narrow, lines, lengths, cost)


def level_field(walls: Walls, length: float, passages: WallSamples) -> SizeField:
    """Make a field that asks for the same length (model length) everywhere."""
    level = box_tree(walls.segments[-1:], np.array([length]))
    sizes, none = np.full(len(walls.edges), length), np.empty((0, 4))
    return SizeField(level, LEVEL_SLOPE, length, sizes, passages, passages.gap, none, none[:, 0], 0.0)


def with_wall_edges(field: SizeField, points: NDArray[np.float64], edges: NDArray[np.int32]) -> SizeField:
    """Let the wall edges as they were cut set the size at the walls.

    Parameters
    ----------
    field : SizeField
    points : (n, 2) float64, model length
        Wall nodes.
    edges : (e, 2) int32
        Wall edges.

    Returns
    -------
    SizeField
        The other sources as before; each wall edge asks for its own length.
    """
    # Strategy: whole numbers of edges fit on an outline segment, so edges come out shorter than asked for; nodes in
    # front of them that kept the longer size would make flat triangles.
    ends = np.hstack((points[edges[:, 0]], points[edges[:, 1]]))
    lengths = np.minimum(np.hypot(ends[:, 2] - ends[:, 0], ends[:, 3] - ends[:, 1]), field.largest)
    sources = box_tree(np.concatenate((ends, field.beside)), np.concatenate((lengths, field.beside_sizes)))
    return replace(field, sources=sources)


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


@njit(cache=True, error_model="numpy", nogil=True)
def sizes_at(
    rank: int,
    threads: int,
    points: Floats,
    segments: Floats,
    weights: Floats,
    boxes: Floats,
    lowest: Floats,
    slope: float,
    largest: float,
    sizes: Floats,
) -> int:
    """Wanted edge length at this thread's points, into `sizes`; neighbours in the list should be near each other."""
    stack = np.empty(STACK, dtype=np.int64)
    item = np.int64(-1)
    for i in range(rank * len(points) // threads, (rank + 1) * len(points) // threads):
        bound = largest
        if item >= 0:
            bound = min(bound, weights[item] + slope * distance_to(segments, item, points[i, 0], points[i, 1])[0])
        sizes[i], item = least(segments, weights, boxes, lowest, stack, slope, points[i, 0], points[i, 1], bound, item)
    return 0
