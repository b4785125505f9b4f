"""Pillars that touch become one."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import shapely

from vasculo.geometry.neighbours import as_polygons
from vasculo.geometry.outline import as_outline, centroid, resample
from vasculo.pillars.closing import joined
from vasculo.pillars.events import Event
from vasculo.pillars.mend import mended
from vasculo.pillars.parameters import MINIMUM_NODES

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from vasculo.pillars.state import Lineage

OVERREACH = 0.125  # a membrane may lie so many spacings beyond the limit before it is cut: half of the border's margin
CORNER = 30.0  # degrees: sharper turns of a membrane that was cut stay


class Merged(NamedTuple):
    """Pillars after merging.

    Parameters
    ----------
    outlines : list of (k, 2) float64, model length
        No two nearer than the gap.
    rest_areas : (q,) float64, model length squared
    lineage : tuple of tuple of int
        Original pillars in each.
    events : tuple of Event
        One a pair that joined, nearest pillars first: as many as there are pillars fewer.
    source : (q,) int32
        The given pillar that each is, unchanged; -1 for one that is new.
    """

    outlines: list[NDArray[np.float64]]
    rest_areas: NDArray[np.float64]
    lineage: Lineage
    events: tuple[Event, ...]
    source: NDArray[np.int32]


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
    time: float,
    within: shapely.Polygon | None = None,
) -> Merged:
    """Merge all pillars nearer than `gap`, until none are; a pillar nearer to itself closes up.

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
        For the events.
    time : float
        For the events, accumulated activation strain.
    within : shapely polygon, optional
        Outlines that reach beyond it by more than an eighth of a spacing are cut to it: over a corner of the border
        that points inwards, a closing does, and so may a single side of a membrane.

    Returns
    -------
    Merged

    Raises
    ------
    ComputationError
        If a closing does not give one pillar.
    """
    outlines, areas, families = list(outlines), list(rest_areas), list(lineage)
    source = np.arange(len(outlines), dtype=np.int32)
    fresh = np.arange(len(outlines))
    events: list[Event] = []
    while True:
        for place, outline in mended([outlines[k] for k in fresh], gap, radius, spacing).items():
            outlines[fresh[place]], source[fresh[place]] = outline, -1
        for place in _beyond(outlines, fresh, within, OVERREACH * spacing):
            outlines[place], source[place] = _cut(outlines[place], within, spacing), -1
        polygons = as_polygons(outlines)
        pairs, places, distances = _near(polygons, fresh, gap)
        if not len(pairs):
            return Merged(outlines, np.array(areas, dtype=np.float64), tuple(families), tuple(events), source)
        order = np.argsort(distances, kind="stable")
        roots = _join(outlines, families, pairs[order], places[order], step, time, events)
        groups: dict[int, list[int]] = {}
        for pillar, root in enumerate(roots):
            groups.setdefault(root, []).append(pillar)
        fresh = np.flatnonzero([len(group) > 1 for group in groups.values()])
        outlines = [
            outlines[root] if len(group) == 1 else joined([outlines[k] for k in group], radius, spacing)
            for root, group in groups.items()
        ]
        source = source[list(groups)]
        source[fresh] = -1
        areas = [sum(areas[k] for k in group) for group in groups.values()]
        families = [tuple(sorted(i for k in group for i in families[k])) for group in groups.values()]


def _beyond(
    outlines: Sequence[NDArray[np.float64]],
    fresh: NDArray[np.int64],
    within: shapely.Polygon | None,
    overreach: float,
) -> list[int]:
    """Which of the fresh outlines reach further beyond the limit than they may."""
    if within is None or not len(fresh):
        return []
    widened = within.buffer(overreach, join_style="mitre")
    shapely.prepare(widened)
    inside = shapely.covers(widened, as_polygons([outlines[k] for k in fresh]))
    return [int(k) for k in fresh[~inside]]


def _cut(outline: NDArray[np.float64], within: shapely.Polygon, spacing: float) -> NDArray[np.float64]:
    """Keep what lies within the limit, the largest piece of it, with the corners of the cut."""
    pieces = shapely.get_parts(shapely.intersection(shapely.Polygon(outline), within))
    pieces = pieces[shapely.get_dimensions(pieces) == 2]
    if not len(pieces):
        return outline
    ring = as_outline(np.asarray(pieces[np.argmax(shapely.area(pieces))].exterior.coords)[:-1])
    return resample(ring, spacing, minimum=MINIMUM_NODES, corners=CORNER)


def _near(
    polygons: NDArray[np.object_], fresh: NDArray[np.int64], gap: float
) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]]:
    """Sorted pairs i < j nearer than `gap`, one of them fresh; the middles between nearest points; the distances."""
    which, other = shapely.STRtree(polygons).query(polygons[fresh], predicate="dwithin", distance=gap)
    pairs = np.sort(np.column_stack((fresh[which], other)), axis=1)
    pairs = np.unique(pairs[pairs[:, 0] < pairs[:, 1]], axis=0)
    one, two = polygons[pairs[:, 0]], polygons[pairs[:, 1]]
    distance = shapely.distance(one, two)
    close = distance < gap
    ends = shapely.get_coordinates(shapely.shortest_line(one[close], two[close])).reshape(-1, 2, 2)
    return pairs[close], ends.mean(axis=1), distance[close]


def _join(
    outlines: Sequence[NDArray[np.float64]],
    families: Sequence[tuple[int, ...]],
    pairs: NDArray[np.int64],
    places: NDArray[np.float64],
    step: int,
    time: float,
    events: list[Event],
) -> list[int]:
    """Group pillars by union-find in the order of the pairs; append each union to `events` and return the roots."""
    roots = list(range(len(outlines)))

    def find(pillar: int) -> int:
        while roots[pillar] != pillar:
            roots[pillar] = roots[roots[pillar]]
            pillar = roots[pillar]
        return pillar

    parts = [tuple(family) for family in families]
    for (i, j), (x, y) in zip(pairs.tolist(), places.tolist(), strict=True):
        a, b = sorted((find(i), find(j)))
        if a != b:
            angle = direction(outlines[i], outlines[j])
            events.append(Event(step, time, "merge", (x, y), (parts[a], parts[b]), angle))
            roots[b] = a
            parts[a] = tuple(sorted(parts[a] + parts[b]))
    return [find(pillar) for pillar in range(len(outlines))]
