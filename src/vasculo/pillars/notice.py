"""What a step has led to, seen once its flow is known: borders joined, a plexus that closes itself off, rest."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import shapely

from vasculo.pillars.events import Event

if TYPE_CHECKING:
    from vasculo.geometry.domain import Domain
    from vasculo.pillars.motion import Motion
    from vasculo.pillars.parameters import Angiogenesis
    from vasculo.pillars.sense import Sensed
    from vasculo.pillars.state import RemodelState

QUIET = 1e-3  # largest move of a membrane node in a step that counts as none, R0
QUIET_STEPS = 5  # so many of them in a row are rest


def notice(
    domain: Domain,
    state: RemodelState,
    sensed: Sensed,
    motion: Motion | None,
    changes: tuple[Event, ...],
    parameters: Angiogenesis,
) -> tuple[RemodelState, tuple[Event, ...]]:
    """Complete a state and its events by what the flow tells.

    Parameters
    ----------
    domain : Domain
    state : RemodelState
        After the step; `touching`, `shear_ratio` and `quiet_steps` are those of before.
    sensed : Sensed
        The flow after the step.
    motion : Motion or None
        None at the start.
    changes : tuple of Event
        What has happened to the pillars.
    parameters : Angiogenesis

    Returns
    -------
    state : RemodelState
    events : tuple of Event
        `changes`, and then the new ones.
    """
    lineage = state.lineage
    border = shapely.LinearRing(domain.outer)
    joined = []
    for pillar in np.flatnonzero(sensed.touching & ~state.touching):
        near = shapely.shortest_line(border, shapely.LinearRing(domain.pillars[pillar]))
        joined.append(_event(state, "border", near.coords[0], (lineage[pillar],)))
    x0, y0, x1, y1 = domain.bounds
    middle = (0.5 * (x0 + x1), 0.5 * (y0 + y1))
    closing = sensed.shear_ratio > parameters.closure_ratio >= state.shear_ratio
    closures = [_event(state, "closure", middle)] if closing else []
    still = motion is not None and motion.displacement < QUIET and not changes and not joined
    quiet = state.quiet_steps + 1 if still else 0
    rests = [_event(state, "rest", middle)] if quiet == QUIET_STEPS else []
    state = replace(state, touching=state.touching | sensed.touching, shear_ratio=sensed.shear_ratio, quiet_steps=quiet)
    return state, (*changes, *joined, *closures, *rests)


def _event(
    state: RemodelState, kind: str, place: tuple[float, ...], pillars: tuple[tuple[int, ...], ...] = ()
) -> Event:
    """Make an event of this step."""
    return Event(state.step, state.time, kind, (float(place[0]), float(place[1])), pillars)  # type: ignore[arg-type]
