"""Narrow passages: what they cost to mesh, and when the two pillars beside one are merged.

Szczerba & Szekely 2005, section 3, refine the mesh in narrow passages or merge the two polygons "if refinement leads to
excessive mesh sizes". The measure of cost and the limits on merging are ours.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import shapely
from scipy.spatial import Delaunay

from vasculo.plexus.outlines import largest_part

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Ints = NDArray[np.int32]
    Floats = NDArray[np.float64]
    Shapes = NDArray[np.object_]

MESH_FACTOR = 1.35
"""Triangles of a real mesh over those of the estimate, measured at three triangles across."""
LARGEST_CLUSTER = 0.1
"""No merged pillar may cover more than this share of the tissue."""
MOST_MERGES = 0.15
"""At most this share of the pillars may disappear by merging."""


@dataclass(frozen=True)
class MeshCost:
    """Expected triangles of a flow mesh.

    Attributes
    ----------
    total : float
        Triangles in all.
    pairs : ndarray of int32, shape (k, 2)
        Neighbouring pillars i < j.
    cost : ndarray of float64, shape (k,)
        Triangles in the passage between them.
    """

    total: float
    pairs: Ints
    cost: Floats


def mesh_cost(shapes: Shapes, box: shapely.Polygon, narrowest: float, across: int) -> MeshCost:
    """Predict the size of a mesh with so many triangles across every passage.

    Strategy: in the Delaunay triangulation of closely spaced boundary points the circumdiameter of a triangle is the
    local gap g; equilateral triangles of side g/across cover an area A with across^2 A / (0.433 g^2) of them. Points
    near the box are mirrored in its walls, so half a tubule there counts as half of a whole one.

    Parameters
    ----------
    shapes : ndarray of shapely.Polygon, shape (p,)
        Pillars.
    box : shapely.Polygon
        Tissue box (model length).
    narrowest : float
        Narrowest gap (model length); points are half of it apart.
    across : int
        Triangles wanted across a passage.

    Returns
    -------
    MeshCost
    """
    dense = shapely.segmentize(shapely.boundary(shapes), 0.5 * narrowest)
    points, owner = shapely.get_coordinates(dense, return_index=True)
    x0, y0, x1, y1 = box.bounds
    reach = 2.0 * float(np.sqrt(np.mean(shapely.area(shapes)) / np.pi))
    images, owners = [points], [owner]
    for axis, wall in ((0, x0), (0, x1), (1, y0), (1, y1)):
        near = np.abs(points[:, axis] - wall) < reach
        image = points[near].copy()
        image[:, axis] = 2.0 * wall - image[:, axis]
        images.append(image)
        owners.append(owner[near])
    nodes, owned = np.unique(np.concatenate(images), axis=0, return_index=True)
    owned = np.concatenate(owners)[owned]
    corners = Delaunay(nodes).simplices
    middle = nodes[corners].mean(axis=1)
    inside = (middle[:, 0] > x0) & (middle[:, 0] < x1) & (middle[:, 1] > y0) & (middle[:, 1] < y1)
    corners, middle = corners[inside], middle[inside]
    alone = np.flatnonzero((owned[corners] == owned[corners[:, :1]]).all(axis=1))
    solid = np.zeros(len(corners), dtype=bool)
    same = shapely.contains(shapes[owned[corners[alone, 0]]], shapely.points(middle[alone]))
    solid[alone] = same
    corners = corners[~solid]
    a, b, c = nodes[corners[:, 0]], nodes[corners[:, 1]], nodes[corners[:, 2]]
    area = 0.5 * np.abs((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    sides = np.hypot(*(b - a).T) * np.hypot(*(c - b).T) * np.hypot(*(a - c).T)
    # circumdiameter = product of the sides / (2 area), so area / diameter^2 = 4 area^3 / product^2
    triangles = MESH_FACTOR * across**2 / 0.433 * 4.0 * area**3 / sides**2
    who = np.sort(owned[corners], axis=1)
    two = (who[:, 0] != who[:, 2]) & ((who[:, 0] == who[:, 1]) | (who[:, 1] == who[:, 2]))
    pairs, index = np.unique(who[two][:, [0, 2]], axis=0, return_inverse=True)
    cost = np.bincount(index.ravel(), weights=triangles[two], minlength=len(pairs)).astype(np.float64)
    return MeshCost(float(triangles.sum()), pairs.astype(np.int32), cost)


def merge_dearest(
    shapes: Shapes, box: shapely.Polygon, cost: MeshCost, budget: float, radius: float, width: float, allowed: int
) -> tuple[Shapes, list[tuple[int, ...]]]:
    """Merge the pillars beside the dearest passages until the expected mesh fits the budget.

    Parameters
    ----------
    shapes : ndarray of shapely.Polygon, shape (p,)
        Pillars.
    box : shapely.Polygon
        Tissue box.
    cost : MeshCost
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
    A merge that would cover more than a tenth of the box, or come too close to a third pillar, is passed over.
    """
    current = list(shapes)
    group = [{index} for index in range(len(shapes))]
    home = list(range(len(shapes)))
    expected, merges = cost.total, 0
    limit = LARGEST_CLUSTER * box.area
    for row in np.argsort(-cost.cost, kind="stable"):
        if expected <= budget or merges >= allowed:
            break
        i, j = sorted((home[cost.pairs[row, 0]], home[cost.pairs[row, 1]]))
        if i == j:
            expected -= cost.cost[row]
            continue
        if current[i].area + current[j].area > limit:
            continue
        merged = _closed_union(current[i], current[j], radius)
        others = np.array([shape for k, shape in enumerate(current) if k not in (i, j) and group[k]], dtype=object)
        if len(others) and float(np.min(shapely.distance(others, merged))) < 0.98 * width:
            continue
        current[i], group[i], group[j] = merged, group[i] | group[j], set()
        home = [i if place == j else place for place in home]
        expected -= cost.cost[row]
        merges += 1
    kept = [index for index in range(len(shapes)) if group[index]]
    return np.array([current[k] for k in kept], dtype=object), [tuple(sorted(group[k])) for k in kept]


def _closed_union(one: shapely.Polygon, two: shapely.Polygon, radius: float) -> shapely.Polygon:
    """Close the union of two polygons with a growing radius until it is one part; enclosed fluid is filled."""
    union = shapely.union(one, two)
    closing = radius
    while True:
        shape = shapely.buffer(shapely.buffer(union, closing), -closing)
        if shapely.get_num_geometries(shape) == 1:
            return largest_part(shape)
        closing *= 1.5
