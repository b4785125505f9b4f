"""Distances between outlines: which are close, and how wide the gaps are."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import shapely

from vasculo.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray


def as_polygons(outlines: Sequence[NDArray[np.float64]]) -> NDArray[np.object_]:
    """Shapely polygons of many outlines, made in one call; (p,) objects."""
    if not len(outlines):
        return np.empty(0, dtype=object)
    counts = [len(outline) for outline in outlines]
    rings = shapely.linearrings(np.concatenate(outlines), indices=np.repeat(np.arange(len(counts)), counts))
    return np.asarray(shapely.polygons(rings), dtype=object)


def pillar_gaps(pillars: Sequence[NDArray[np.float64]]) -> NDArray[np.float64]:
    """Distance from each outline to its nearest other one.

    Parameters
    ----------
    pillars : sequence of (k_i, 2) float64, model length
        Closed outlines.

    Returns
    -------
    (p,) float64, model length
        Zero where outlines touch or overlap; infinite for an outline that is alone.
    """
    polygons = as_polygons(pillars)
    gaps = np.full(len(polygons), np.inf)
    if len(polygons) < 2:
        return gaps
    tree = shapely.STRtree(polygons)
    # Strategy: bounding boxes of the polygons order the search; `exclusive` leaves out the polygon itself.
    own, distance = tree.query_nearest(polygons, exclusive=True, return_distance=True, all_matches=False)
    gaps[own[0]] = distance
    return gaps


def near_pairs(pillars: Sequence[NDArray[np.float64]], distance: float) -> NDArray[np.int32]:
    """Pairs of outlines closer to each other than a distance.

    Parameters
    ----------
    pillars : sequence of (k_i, 2) float64, model length
        Closed outlines.
    distance : float, model length
        Pairs at exactly this distance are left out.

    Returns
    -------
    (k, 2) int32
        Sorted pairs i < j.

    Raises
    ------
    InputError
        The distance is negative or not a number.
    """
    if not distance >= 0.0:
        raise InputError(f"the distance of near pairs must not be negative, it is {distance}")
    polygons = as_polygons(pillars)
    if len(polygons) < 2:
        return np.empty((0, 2), dtype=np.int32)
    first, second = shapely.STRtree(polygons).query(polygons, predicate="dwithin", distance=distance)
    once = first < second
    first, second = first[once], second[once]
    close = shapely.distance(polygons[first], polygons[second]) < distance
    pairs = np.column_stack((first[close], second[close])).astype(np.int32)
    return pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]
