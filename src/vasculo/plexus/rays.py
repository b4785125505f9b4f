"""Test rays from the centres of the voids to the nearest springs (Szczerba & Szekely 2005, section 3).

The paper reconstructs its polygons from such rays. Here they are an independent check of outlines that come from the
topology: rays miss short springs between two of them and stop at springs that dangle into the void.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import shapely
from scipy.spatial import KDTree

from vasculo.errors import InputError
from vasculo.plexus.outlines import repaired

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Ints = NDArray[np.int32]
    Floats = NDArray[np.float64]


def ray_distances(points: Floats, springs: Ints, centres: Floats, rays: int = 64) -> tuple[Floats, Ints]:
    """Distance along each ray from each centre to the nearest spring it meets.

    Strategy: seen from a centre a spring covers an interval of angles, so only the few rays in that interval are
    intersected with it. Springs are searched within a disk that doubles until every ray has met one inside it.

    Parameters
    ----------
    points : ndarray of float64, shape (n, 2)
        Node positions (model length).
    springs : ndarray of int32, shape (m, 2)
        Living springs, all of them candidates.
    centres : ndarray of float64, shape (c, 2)
        Where the rays start (model length).
    rays : int
        Rays a centre, evenly spread, the first along x.

    Returns
    -------
    distances : ndarray of float64, shape (c, rays)
        Model length; infinite where a ray meets no spring.
    hits : ndarray of int32, shape (c, rays)
        The spring met, -1 for none.

    Raises
    ------
    InputError
        When there are fewer than 3 rays.
    """
    if rays < 3:
        raise InputError(f"at least 3 rays are needed, got {rays}")
    start, end = points[springs[:, 0]], points[springs[:, 1]]
    tree = KDTree(0.5 * (start + end))
    reach = 0.5 * float(np.hypot(*(end - start).T).max(initial=0.0))
    extent = float(np.hypot(*np.ptp(points, axis=0)))
    distances = np.full((len(centres), rays), np.inf)
    hits = np.full((len(centres), rays), -1, dtype=np.int32)
    for index, centre in enumerate(centres):
        radius = 4.0 * reach
        while True:
            near = np.array(sorted(tree.query_ball_point(centre, radius + reach)), dtype=np.int32)
            if near.size:
                distances[index], hit = _nearest(start[near] - centre, end[near] - centre, rays)
                hits[index] = np.where(hit < 0, -1, near[hit])
            if radius > 2.0 * extent or distances[index].max() <= radius:
                break
            radius *= 2.0
    return distances, hits


def ray_agreement(points: Floats, springs: Ints, outlines: Sequence[Floats], rays: int = 64) -> Floats:
    """Overlap of each outline with the polygon that the rays find from its centroid.

    Parameters
    ----------
    points : ndarray of float64, shape (n, 2)
        Node positions (model length).
    springs : ndarray of int32, shape (m, 2)
        Living springs.
    outlines : sequence of ndarray of float64, shape (k_i, 2)
        Outlines from the topology (model length).
    rays : int
        Rays an outline.

    Returns
    -------
    agreement : ndarray of float64, shape (v,)
        Area of the intersection over area of the union, dimensionless; 1 where both agree. Rays that meet nothing
        are left out of the polygon.
    """
    polygons = np.array([repaired(outline)[0] for outline in outlines], dtype=object)
    centres = shapely.get_coordinates(shapely.centroid(polygons))
    distances, _ = ray_distances(points, springs, centres, rays)
    angle = 2.0 * np.pi * np.arange(rays) / rays
    direction = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    result = np.zeros(len(polygons))
    for index, polygon in enumerate(polygons):
        met = np.isfinite(distances[index])
        star, _ = repaired(centres[index] + distances[index, met, None] * direction[met])
        shared = shapely.intersection(star, polygon).area
        union = star.area + polygon.area - shared
        result[index] = shared / union if union > 0.0 else 0.0
    return result


def _nearest(start: Floats, end: Floats, rays: int) -> tuple[Floats, Ints]:
    """Nearest segment on each ray from the origin; segments as end points relative to the origin."""
    step = 2.0 * np.pi / rays
    cross = start[:, 0] * end[:, 1] - start[:, 1] * end[:, 0]
    opening = np.arctan2(cross, np.einsum("ij,ij->i", start, end))
    first = np.arctan2(start[:, 1], start[:, 0])
    low, high = np.minimum(first, first + opening), np.maximum(first, first + opening)
    from_ray = np.ceil(low / step - 1e-12).astype(np.int64)
    count = np.maximum(np.floor(high / step + 1e-12).astype(np.int64) - from_ray + 1, 0)
    count[cross == 0.0] = 0  # a segment seen end on is met through its neighbours
    segment = np.repeat(np.arange(len(start)), count)
    within = np.arange(segment.size) - np.repeat(np.cumsum(count) - count, count)
    ray = from_ray[segment] + within
    along = end[segment] - start[segment]
    facing = np.cos(step * ray) * along[:, 1] - np.sin(step * ray) * along[:, 0]
    good = np.abs(facing) > 1e-300
    segment, ray, facing = segment[good], ray[good] % rays, facing[good]
    distance = np.maximum(cross[segment] / facing, 0.0)
    order = np.lexsort((segment, distance, ray))
    ray_sorted, where = np.unique(ray[order], return_index=True)
    nearest = np.full(rays, np.inf)
    hit = np.full(rays, -1, dtype=np.int32)
    nearest[ray_sorted] = distance[order][where]
    hit[ray_sorted] = segment[order][where]
    return nearest, hit
