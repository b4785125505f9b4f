"""Pillars that touch become one."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import shapely

from vasculo.errors import ComputationError
from vasculo.geometry.neighbours import as_polygons, near_pairs
from vasculo.geometry.outline import as_outline, centroid, resample
from vasculo.pillars.parameters import MINIMUM_NODES
from vasculo.pillars.state import Merge

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from vasculo.pillars.state import Lineage

WIDEN = 1.5  # the closing radius grows by this until one polygon results
WIDEN_TIMES = 12


def close_up(outlines: Sequence[NDArray[np.float64]], radius: float) -> NDArray[np.float64]:
    """Join outlines to one simple outline: exterior ring of the morphological closing of their union.

    Fluid that the union encloses is filled.

    Parameters
    ----------
    outlines : sequence of (k, 2) float64
        One outline may be given too; a crossing in it goes away.
    radius : float
        Radius of the closing, model length; widened by 1.5 until one piece results.

    Returns
    -------
    (k, 2) float64
        Counter-clockwise, not evenly spaced.

    Raises
    ------
    ComputationError
        If the pieces are too far apart to be joined.
    """
    polygons = as_polygons(outlines)
    for _ in range(WIDEN_TIMES):
        closed = shapely.buffer(shapely.union_all(shapely.buffer(polygons, radius)), -radius)
        if isinstance(closed, shapely.Polygon) and not closed.is_empty:
            return as_outline(np.asarray(closed.exterior.coords)[:-1])
        radius *= WIDEN
    raise ComputationError(f"{len(outlines)} pillars cannot be joined by a closing of radius {radius / WIDEN:.3g}")


def direction(first: NDArray[np.float64], second: NDArray[np.float64]) -> float:
    """Angle of the line between two centroids, degrees in (-90, 90]."""
    x, y = centroid(second) - centroid(first)
    angle = math.degrees(math.atan2(y, x))
    return angle - 180.0 if angle > 90.0 else angle + 180.0 if angle <= -90.0 else angle


def merge(
    outlines: Sequence[NDArray[np.float64]],
    rest_areas: NDArray[np.float64],
    lineage: Lineage,
    gap: float,
    radius: float,
    spacing: float,
    step: int,
) -> tuple[list[NDArray[np.float64]], NDArray[np.float64], Lineage, tuple[Merge, ...]]:
    """Merge all pillars nearer than `gap`, until none are.

    Two pillars that merge add their rest areas and their original pillars. A merged pillar takes the place of its first
    part, so that the order never depends on chance.

    Parameters
    ----------
    outlines : sequence of (k, 2) float64
        Simple outlines; they may overlap.
    rest_areas : (p,) float64
        Model length squared.
    lineage : tuple of tuple of int
        Original pillars in each.
    gap, radius, spacing : float
        Distance at which pillars merge, radius of the closing, node spacing of a merged outline, model length.
    step : int
        For the record of merges.

    Returns
    -------
    outlines : list of (k, 2) float64
        No two nearer than `gap`.
    rest_areas : (p,) float64
    lineage : tuple of tuple of int
    merges : tuple of Merge
        One a pair that joined, nearest pillars first: as many as there are pillars fewer.

    Raises
    ------
    ComputationError
        If a closing does not give one pillar.
    """
    outlines, areas, families = list(outlines), list(rest_areas), list(lineage)
    merges: list[Merge] = []
    while len(pairs := near_pairs(outlines, gap)):
        roots = _join(outlines, families, pairs, step, merges)
        groups: dict[int, list[int]] = {}
        for pillar, root in enumerate(roots):
            groups.setdefault(root, []).append(pillar)
        outlines = [
            outlines[group[0]]
            if len(group) == 1
            else resample(close_up([outlines[k] for k in group], radius), spacing, minimum=MINIMUM_NODES)
            for group in groups.values()
        ]
        areas = [sum(areas[k] for k in group) for group in groups.values()]
        families = [tuple(sorted(i for k in group for i in families[k])) for group in groups.values()]
    return outlines, np.array(areas, dtype=np.float64), tuple(families), tuple(merges)


def _join(
    outlines: list[NDArray[np.float64]],
    families: Sequence[tuple[int, ...]],
    pairs: NDArray[np.int32],
    step: int,
    merges: list[Merge],
) -> list[int]:
    """Group pillars by union-find, nearest pairs first; append each union to `merges` and return the roots."""
    polygons = as_polygons(outlines)
    distance = shapely.distance(polygons[pairs[:, 0]], polygons[pairs[:, 1]])
    roots = list(range(len(outlines)))

    def find(pillar: int) -> int:
        while roots[pillar] != pillar:
            roots[pillar] = roots[roots[pillar]]
            pillar = roots[pillar]
        return pillar

    parts = [tuple(family) for family in families]
    for i, j in pairs[np.argsort(distance, kind="stable")].tolist():
        a, b = sorted((find(i), find(j)))
        if a != b:
            merges.append(Merge(step, (parts[a], parts[b]), direction(outlines[i], outlines[j])))
            roots[b] = a
            parts[a] = tuple(sorted(parts[a] + parts[b]))
    return [find(pillar) for pillar in range(len(outlines))]
