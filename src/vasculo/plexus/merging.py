"""Merging: the pillars beside the dearest passages become one, where a mesh would be too large otherwise.

Szczerba & Szekely 2005, section 3, refine the mesh in narrow passages or merge the two polygons "if refinement leads to
excessive mesh sizes". The measure of cost and the limits on merging are ours. A gap alone never merges anything.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import shapely

from vasculo.plexus.outlines import largest_part

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.plexus.passages import Passages

    Shapes = NDArray[np.object_]

LARGEST_CLUSTER = 0.1
"""No merged pillar may cover more than this share of the tissue."""
MOST_MERGES = 0.15
"""At most this share of the pillars may disappear by merging."""
KEPT_WIDTH = 0.98
"""Share of the tubule width that a merged pillar keeps from all others."""


def merge_dearest(
    shapes: Shapes, tissue: float, passages: Passages, budget: float, radius: float, width: float, allowed: int
) -> tuple[Shapes, list[tuple[int, ...]]]:
    """Merge the pillars beside the dearest passages until the expected mesh fits the budget.

    To put n triangles across a passage takes about n^2 length / width of them, so the dearest ones are those that are
    longest for their mean width.

    Parameters
    ----------
    shapes : ndarray of shapely.Polygon, shape (p,)
        Pillars.
    tissue : float
        Area of the tissue (model length squared).
    passages : Passages
        Of these pillars.
    budget : float
        Triangles allowed.
    radius : float
        First closing radius (model length); grows until the union is one part.
    width : float
        Tubule width that a merged pillar keeps from all others (model length).
    allowed : int
        Merges allowed.

    Returns
    -------
    shapes : ndarray of shapely.Polygon
        Pillars after merging.
    groups : list of tuple of int
        For each of them the given pillars it is made of.

    Notes
    -----
    A merge that would cover more than a tenth of the tissue, or come too close to a third pillar, is passed over.
    """
    # Strategy: `home` points each given pillar to the one it is part of, which stands at its smallest member. A closing
    # adds nothing farther from the members than its radius (`reach`, the largest so far), so the tree of the given
    # shapes finds all that can be too close to a merged one.
    current = shapes.copy()
    group = [(index,) for index in range(len(shapes))]
    home = np.arange(len(shapes))
    tree = shapely.STRtree(shapes)
    expected, merges, reach = passages.total, 0, radius
    cost = np.where(passages.between_pillars, passages.length / passages.mean_width, 0.0)
    for row in np.argsort(-cost, kind="stable")[: np.count_nonzero(cost)]:
        if expected <= budget or merges >= allowed:
            break
        i, j = sorted(home[passages.bodies[row]].tolist())
        if i == j:
            expected -= passages.triangles[row]
            continue
        if current[i].area + current[j].area > LARGEST_CLUSTER * tissue:
            continue
        merged, closing = closed_union(current[i], current[j], radius)
        others = np.unique(home[tree.query(merged, predicate="dwithin", distance=width + reach)])
        others = others[(others != i) & (others != j)]
        if len(others) and float(np.min(shapely.distance(current[others], merged))) < KEPT_WIDTH * width:
            continue
        current[i], group[i] = merged, tuple(sorted(group[i] + group[j]))
        home[list(group[i])] = i
        reach = max(reach, closing)
        expected -= passages.triangles[row]
        merges += 1
    kept = np.unique(home)
    return current[kept], [group[k] for k in kept]


def closed_union(one: shapely.Polygon, two: shapely.Polygon, radius: float) -> tuple[shapely.Polygon, float]:
    """Close the union of two polygons with a growing radius until it is one part; also returns that radius.

    Enclosed fluid is filled.
    """
    union = shapely.union(one, two)
    closing = radius
    while True:
        shape = shapely.buffer(shapely.buffer(union, closing), -closing)
        if shapely.get_num_geometries(shape) == 1:
            return largest_part(shape), closing
        closing *= 1.5
