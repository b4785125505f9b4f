"""From raw void outlines to pillars that keep a tubule's width from each other: all lengths in model length.

A cord of the network, however thin, becomes a tubule at least `width` wide. Outlines are never merged across a cord.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import shapely

from vasculo.errors import ComputationError
from vasculo.geometry.neighbours import as_polygons
from vasculo.geometry.outline import segment_lengths
from vasculo.plexus.even import even_rings
from vasculo.plexus.outlines import largest_part, ring_nodes
from vasculo.plexus.rules import RULES, near_pairs

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.plexus.rules import Near

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
SHORT_OF_WIDTH = 0.98
"""Shapes closer than this share of the width are cut apart."""


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


def clear(
    raw: Shapes,
    box: shapely.Polygon,
    width: float,
    rule: str,
    rounding: float,
    smallest: float,
    near: Near | None = None,
) -> Cleared:
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
    near : Near, optional
        Pairs of raw outlines, with a reach of `width` at least; found if not given.

    Returns
    -------
    Cleared
    """
    if near is None or near.reach < width:
        near = near_pairs(raw, width)
    opened = RULES[rule](raw, box, width, rounding, near)
    shapes, pieces = _largest_parts(opened)
    empty = shapely.is_empty(shapes)
    # Outlines that do not overlap end up a width apart: by the offset exactly, by the minimum rule up to its samples.
    apart = near.pairs[near.gap <= 0.0] if rule == "offset" else near.pairs[near.gap < width]
    shapes, cut, swallowed = _separate(shapes, raw, apart, width, rounding)
    radius = np.sqrt(shapely.area(shapes) / np.pi)
    small = (radius < smallest) & ~empty & ~swallowed
    kept = np.flatnonzero(~(empty | swallowed | small))
    return Cleared(
        shapes[kept], kept, int(np.sum(pieces > 1)), cut, int(empty.sum()), int(small.sum()), int(swallowed.sum())
    )


def even_outlines(
    shapes: Shapes, spacing: float, width: float, box: tuple[float, float, float, float] | None = None
) -> tuple[list[Floats], int]:
    """Resample outlines evenly and check them: simple, gaps, spacing.

    Nodes lie at equal distances along the rounded polygon, with its corners and its area kept. Where a chord across a
    hollow narrows a gap too much, or an outline is uneven, its spacing is halved.

    Parameters
    ----------
    shapes : ndarray of shapely.Polygon, shape (p,)
        Rounded, separated polygons.
    spacing : float
        Wanted distance between nodes.
    width : float
        Tubule width the gaps are checked against.
    box : tuple of four floats, optional
        Smallest x and y, largest x and y of the tissue; half a width is kept from them.

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
    outlines = even_rings(rings, spacing, FEWEST_NODES) if rings else []
    for _ in range(HALVINGS + 1):
        polygons = as_polygons(outlines)
        ratio = np.array([np.divide(*np.sort(segment_lengths(outline))[[-1, 0]]) for outline in outlines])
        bad = ~shapely.is_valid(polygons) | (ratio > SPACING_RATIO)
        pairs = shapely.STRtree(polygons).query(polygons, predicate="dwithin", distance=GAP_SHARE * width)
        bad[pairs[0][pairs[0] != pairs[1]]] = True
        if box is not None:
            margins = (shapely.bounds(polygons) - box) * (1.0, 1.0, -1.0, -1.0)
            bad |= (margins <= 0.5 * GAP_SHARE * width).any(axis=1)
        if not bad.any():
            return outlines, int(np.count_nonzero(finer))
        finer[bad] += 1
        for halvings in np.unique(finer[bad]):
            mine = np.flatnonzero(bad & (finer == halvings))
            fresh = even_rings([rings[k] for k in mine], spacing / 2.0**halvings, FEWEST_NODES * 2 ** int(halvings))
            for index, outline in zip(mine, fresh, strict=True):
                outlines[index] = outline
    worst = int(np.flatnonzero(bad)[0])
    raise ComputationError(
        f"{np.count_nonzero(bad)} of {len(outlines)} outlines stay invalid, uneven (pillar {worst}: segment ratio "
        f"{ratio[worst]:.3g}, limit {SPACING_RATIO}) or closer than {GAP_SHARE * width:.3g} to another or half of that "
        f"to the frame: raise the tubule width"
    )


def _largest_parts(shapes: Shapes) -> tuple[Shapes, NDArray[np.int64]]:
    """Largest polygon of each shape, without holes (an empty one where there is none), and how many there are."""
    parts, owner = shapely.get_parts(shapes, return_index=True)
    area = shapely.area(parts)
    parts, owner, area = parts[area > 0.0], owner[area > 0.0], area[area > 0.0]
    order = np.lexsort((area, owner))
    last = order[np.append(owner[order][1:] != owner[order][:-1], True)[: len(order)]]
    result = np.full(len(shapes), shapely.Polygon(), dtype=object)
    result[owner[last]] = shapely.polygons(shapely.get_exterior_ring(parts[last]))
    return result, np.bincount(owner, minlength=len(shapes))


def _separate(
    shapes: Shapes, raw: Shapes, pairs: NDArray[np.int64], width: float, rounding: float
) -> tuple[Shapes, int, NDArray[np.bool_]]:
    """Cut the smaller of two shapes that overlap or come too close; says which lie inside another void.

    Needed only where folded tissue makes raw outlines overlap, or where a void sits on a piece that hangs inside
    another void.
    """
    result = shapes.copy()
    swallowed = np.zeros(len(shapes), dtype=bool)
    close = shapely.distance(shapes[pairs[:, 0]], shapes[pairs[:, 1]]) < SHORT_OF_WIDTH * width
    cut = 0
    for i, j in pairs[close].tolist():
        large, little = (i, j) if shapely.area(shapes[i]) >= shapely.area(shapes[j]) else (j, i)
        if swallowed[little] or swallowed[large]:
            continue
        if shapely.contains(raw[large], shapely.point_on_surface(shapes[little])):
            swallowed[little] = True
            result[little] = shapely.Polygon()
            continue
        if shapely.distance(result[large], result[little]) < SHORT_OF_WIDTH * width:
            rest = shapely.difference(result[little], shapely.buffer(result[large], width))
            result[little] = largest_part(shapely.buffer(shapely.buffer(rest, -rounding), rounding))
            cut += 1
    return result, cut, swallowed
