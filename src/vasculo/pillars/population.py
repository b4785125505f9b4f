"""The pillars between two steps, as they vanish and part: outlines with what belongs to them."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from vasculo.errors import ComputationError
from vasculo.geometry.outline import centroid, outline_areas
from vasculo.pillars.erosion import vanishing
from vasculo.pillars.events import Event
from vasculo.pillars.splitting import shared_areas, split_thin

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from vasculo.pillars.state import Lineage

    Floats = NDArray[np.float64]


class Population(NamedTuple):
    """Pillars on their way from one step to the next.

    Attributes
    ----------
    outlines : sequence of (k, 2) float64
        Model length.
    rest_areas : (p,) float64
        Model length squared.
    lineage : tuple of tuple of int
        Original pillars in each.
    source : (p,) int
        Pillar of the step before with the same outline, -1 for a new outline.
    next_pillar : int
        Number of the next pillar that parts from another.
    """

    outlines: Sequence[Floats]
    rest_areas: Floats
    lineage: Lineage
    source: NDArray[np.integer]
    next_pillar: int


def vanish(population: Population, smallest: float, step: int, time: float) -> tuple[Population, tuple[Event, ...]]:
    """Take out pillars that have become smaller than `smallest` (radius, model length).

    Raises
    ------
    ComputationError
        If none is left.
    """
    gone = vanishing(outline_areas(population.outlines), smallest)
    if not gone.any():
        return population, ()
    if gone.all():
        raise ComputationError(
            f"no pillar is left: the last {len(gone)} became smaller than a radius of {smallest:.3g}"
        )
    events = tuple(
        Event(step, time, "vanish", _place(centroid(population.outlines[k])), (population.lineage[k],))
        for k in np.flatnonzero(gone).tolist()
    )
    stay = np.flatnonzero(~gone)
    kept = Population(
        [population.outlines[k] for k in stay.tolist()],
        population.rest_areas[stay],
        tuple(population.lineage[k] for k in stay.tolist()),
        population.source[stay],
        population.next_pillar,
    )
    return kept, events


def part(
    population: Population, neck: float, smallest: float, spacing: float, step: int, time: float
) -> tuple[Population, tuple[Event, ...]]:
    """Part pillars in two where they are thinner than `neck`; lengths as in `split_thin`.

    The largest piece keeps the original pillars, the others get numbers of their own.
    """
    outlines, source = split_thin(population.outlines, neck, smallest, spacing)
    if len(outlines) == len(population.outlines):
        return population, ()
    pieces = np.bincount(source, minlength=len(population.outlines))
    areas = outline_areas(outlines)
    lineage, events, number = [population.lineage[s] for s in source], [], population.next_pillar
    for pillar in np.flatnonzero(pieces > 1):
        mine = np.flatnonzero(source == pillar)
        largest = mine[np.argmax(areas[mine])]
        for k in mine[mine != largest]:
            lineage[k] = (number,)
            number += 1
            place = 0.5 * (centroid(outlines[k]) + centroid(outlines[largest]))
            events.append(Event(step, time, "split", _place(place), (lineage[largest], lineage[k])))
    fresh = np.where(pieces[source] == 1, population.source[source], -1)
    rest = shared_areas(population.rest_areas, outlines, source)
    return Population(outlines, rest, tuple(lineage), fresh, number), tuple(events)


def _place(point: Floats) -> tuple[float, float]:
    return float(point[0]), float(point[1])
