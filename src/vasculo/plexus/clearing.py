"""From raw void outlines to pillars that keep a tubule's width from each other: all lengths in model length.

A cord of the network, however thin, becomes a tubule at least `width` wide. Outlines are never merged across a cord.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import shapely

from vasculo.errors import ComputationError
from vasculo.geometry.outline import resample, segment_lengths
from vasculo.plexus.outlines import largest_part, ring_nodes

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Shapes = NDArray[np.object_]

FEWEST_NODES = 16
"""Nodes of the smallest outline."""
GAP_SHARE = 0.8
"""Every gap must exceed this share of the tubule width."""
SPACING_RATIO = 1.3
"""Largest over smallest segment of an outline."""
HALVINGS = 4
"""How often the spacing of an outline may be halved to keep its gaps and its evenness."""


@dataclass(frozen=True)
class Cleared:
    """Pillars after widening the tubules.

    Attributes
    ----------
    shapes : ndarray of shapely.Polygon, shape (p,)
        Rounded polygons.
    void : ndarray of int64, shape (p,)
        Number of the void each comes from.
    split : int
        Voids that came apart into several pieces; the largest was kept.
    cut : int
        Pairs that were too close or overlapped after widening; the smaller one was cut back.
    vanished, small, nested : int
        Voids dropped because nothing was left, because they fell below the smallest radius, or because they lay
        inside another void.
    """

    shapes: Shapes
    void: NDArray[np.int64]
    split: int
    cut: int
    vanished: int
    small: int
    nested: int


def clear(raw: Shapes, box: shapely.Polygon, width: float, rule: str, rounding: float, smallest: float) -> Cleared:
    """Widen all tubules to `width`, round, separate, and drop what is too small.

    Parameters
    ----------
    raw : ndarray of shapely.Polygon, shape (v,)
        Valid outlines of the voids.
    box : shapely.Polygon
        The tissue's bounding box; its edges are mirror walls, from which half a width is kept.
    width : float
        Tubule width.
    rule : {"offset", "minimum"}
        One of `RULES`: move every outline inward by half a width, or only where a cord is narrower than the width.
    rounding : float
        Opening radius: convex corners are rounded, spikes and lobes on narrow necks removed.
    smallest : float
        Pillars of smaller equivalent radius are dropped.

    Returns
    -------
    Cleared
    """
    opened = RULES[rule](raw, box, width, rounding)
    pieces = np.array([_pieces(shape) for shape in opened])
    shapes = np.array([largest_part(shape) for shape in opened], dtype=object)
    empty = shapely.is_empty(shapes)
    shapes, cut, swallowed = _separate(shapes, raw, width, rounding)
    radius = np.sqrt(shapely.area(shapes) / np.pi)
    small = (radius < smallest) & ~empty & ~swallowed
    kept = np.flatnonzero(~(empty | swallowed | small))
    return Cleared(
        shapes[kept], kept, int(np.sum(pieces > 1)), cut, int(empty.sum()), int(small.sum()), int(swallowed.sum())
    )


def even_outlines(shapes: Shapes, spacing: float, width: float) -> tuple[list[Floats], int]:
    """Resample outlines evenly and check them: simple, gaps, spacing.

    Nodes lie at equal arc length on the rounded polygon, which cuts its corners and never overshoots. Where a chord
    across a hollow narrows a gap too much, or an outline is uneven, its spacing is halved.

    Parameters
    ----------
    shapes : ndarray of shapely.Polygon, shape (p,)
        Rounded, separated polygons.
    spacing : float
        Wanted distance between nodes.
    width : float
        Tubule width the gaps are checked against.

    Returns
    -------
    outlines : list of ndarray of float64, shape (k_i, 2)
        Counter-clockwise.
    halved : int
        Outlines with a smaller spacing than asked for.

    Raises
    ------
    ComputationError
        When an outline stays invalid, uneven or too close to another after four halvings.
    """
    rings = [ring_nodes(shape) for shape in shapes]
    finer = np.zeros(len(rings), dtype=np.int64)
    outlines = [resample(ring, spacing, minimum=FEWEST_NODES) for ring in rings]
    for _ in range(HALVINGS + 1):
        polygons = np.array([shapely.Polygon(outline) for outline in outlines], dtype=object)
        lengths = [segment_lengths(outline) for outline in outlines]
        ratio = np.array([edges.max() / edges.min() for edges in lengths])
        bad = ~shapely.is_valid(polygons) | (ratio > SPACING_RATIO)
        pairs = shapely.STRtree(polygons).query(polygons, predicate="dwithin", distance=GAP_SHARE * width)
        bad[pairs[0][pairs[0] != pairs[1]]] = True
        if not bad.any():
            return outlines, int(np.count_nonzero(finer))
        finer[bad] += 1
        for index in np.flatnonzero(bad):
            wanted = spacing / 2.0 ** finer[index]
            outlines[index] = resample(rings[index], wanted, minimum=FEWEST_NODES * 2 ** int(finer[index]))
    worst = int(np.flatnonzero(bad)[0])
    raise ComputationError(
        f"{np.count_nonzero(bad)} of {len(outlines)} outlines stay invalid, uneven (pillar {worst}: segment ratio "
        f"{ratio[worst]:.3g}, limit {SPACING_RATIO}) or closer than {GAP_SHARE * width:.3g} to another: "
        f"raise the tubule width"
    )


def wall_gaps(shapes: Shapes, box: shapely.Polygon) -> Floats:
    """Distance of each pillar to the box's border."""
    return np.asarray(shapely.distance(shapes, box.exterior), dtype=np.float64)


def neighbour_gaps(shapes: Shapes, reach: float) -> Floats:
    """Distances of all pairs closer than `reach`, sorted."""
    first, second = shapely.STRtree(shapes).query(shapes, predicate="dwithin", distance=reach)
    once = first < second
    return np.sort(shapely.distance(shapes[first[once]], shapes[second[once]]))


def _offset(raw: Shapes, box: shapely.Polygon, width: float, rounding: float) -> Shapes:
    """Constant offset: a cord of n springs stays n springs thick plus the width."""
    inner = shapely.intersection(shapely.buffer(raw, -0.5 * width - rounding), _inner(box, 0.5 * width + rounding))
    return np.asarray(shapely.buffer(inner, rounding))


def _minimum(raw: Shapes, box: shapely.Polygon, width: float, rounding: float) -> Shapes:
    """Minimum width: cut disks of radius (width - gap)/2 along the outlines where the gap is below the width.

    A straight way between two cut outlines crosses both raw ones, at points with gaps at most its middle part; the two
    disks add the rest, so it is at least `width` long. Closing after opening fills the cusps between disks.
    """
    edges = shapely.boundary(raw)
    tree = shapely.STRtree(raw)
    cut = np.empty(len(raw), dtype=object)
    inner = _inner(box, 0.5 * width)
    for index, polygon in enumerate(raw):
        near = tree.query(polygon, predicate="dwithin", distance=width)
        near = near[near != index]
        samples = shapely.points(shapely.get_coordinates(shapely.segmentize(edges[index], 0.15 * width))[:-1])
        gap = np.full(len(samples), width)
        for other in near:
            gap = np.minimum(gap, shapely.distance(samples, raw[other]))
        tight = gap < width
        disks = shapely.union_all(shapely.buffer(samples[tight], 0.5 * (width - gap[tight]), quad_segs=6))
        cut[index] = shapely.intersection(shapely.difference(polygon, disks), inner)
    opened = shapely.buffer(shapely.buffer(cut, -rounding), rounding)
    return np.asarray(shapely.buffer(shapely.buffer(opened, rounding), -rounding))


RULES: dict[str, Callable[[Shapes, shapely.Polygon, float, float], Shapes]] = {"offset": _offset, "minimum": _minimum}
"""The ways to give tubules their width."""


def _inner(box: shapely.Polygon, margin: float) -> shapely.Polygon:
    """Shrink the box by a margin on all sides; empty when nothing is left."""
    x0, y0, x1, y1 = box.bounds
    if min(x1 - x0, y1 - y0) <= 2.0 * margin:
        return shapely.Polygon()
    return shapely.box(x0 + margin, y0 + margin, x1 - margin, y1 - margin)


def _pieces(shape: shapely.Geometry) -> int:
    """Count the polygons of a shape."""
    return int(np.sum(shapely.area(shapely.get_parts(shape)) > 0.0))


def _separate(shapes: Shapes, raw: Shapes, width: float, rounding: float) -> tuple[Shapes, int, NDArray[np.bool_]]:
    """Cut the smaller of two shapes that overlap or come too close; says which lie inside another void.

    Needed only where folded tissue makes raw outlines overlap, or where a void sits on a piece that hangs inside
    another void.
    """
    result = shapes.copy()
    swallowed = np.zeros(len(shapes), dtype=bool)
    first, second = shapely.STRtree(shapes).query(shapes, predicate="dwithin", distance=0.98 * width)
    pairs = sorted((int(i), int(j)) for i, j in zip(first, second, strict=True) if i < j)
    cut = 0
    for i, j in pairs:
        large, little = (i, j) if shapely.area(shapes[i]) >= shapely.area(shapes[j]) else (j, i)
        if swallowed[little] or swallowed[large]:
            continue
        if shapely.contains(raw[large], shapely.point_on_surface(shapes[little])):
            swallowed[little] = True
            result[little] = shapely.Polygon()
            continue
        if shapely.distance(result[large], result[little]) < 0.98 * width:
            rest = shapely.difference(result[little], shapely.buffer(result[large], width))
            result[little] = largest_part(shapely.buffer(shapely.buffer(rest, -rounding), rounding))
            cut += 1
    return result, cut, swallowed
