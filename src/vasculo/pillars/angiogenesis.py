"""Angiogenesis: the loop of mesh, flow, wall shear, activation, motion and merging."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import ComputationError, InputError
from vasculo.flow.linear.kept import KeptAnalysis
from vasculo.pillars.events import Event
from vasculo.pillars.meshing import CarriedMesh, FreshMesh
from vasculo.pillars.motion import move
from vasculo.pillars.notice import QUIET_STEPS, notice
from vasculo.pillars.parameters import Angiogenesis
from vasculo.pillars.sense import mean_shear, sense
from vasculo.pillars.settle import begin, settle
from vasculo.pillars.state import RemodelState, RemodelStep

if TYPE_CHECKING:
    from vasculo.geometry.domain import Domain
    from vasculo.pillars.motion import Motion
    from vasculo.pillars.sense import Sensed

__all__ = ["Angiogenesis", "Event", "RemodelState", "RemodelStep", "remodel"]

Watch = Callable[[RemodelStep], object]


def remodel(
    domain: Domain,
    parameters: Angiogenesis | None = None,
    watch: Watch | None = None,
    *,
    start: RemodelState | None = None,
) -> Domain:
    """Let pillars remodel in the flow that they shape (Szczerba & Szekely 2005, section 4).

    Each step solves the flow, turns the wall shear into contraction and stretching of the filaments, relaxes membranes,
    filaments and matrix (eqs. 2, 3), moves the pillars a little and merges those that touch.

    Parameters
    ----------
    domain : Domain
        Box and pillars; with `start` only the box counts.
    parameters : Angiogenesis, optional
        The default ones if left out.
    watch : callable, optional
        Called with a `RemodelStep` for every step from 0 to the last, each with a solved flow. With `start` the first
        call is for the step after it.
    start : RemodelState, optional
        Go on from here, to the same numbers as without interruption; or, with other parameters, on another branch.

    Returns
    -------
    Domain
        After the last step.

    Raises
    ------
    InputError
        If there are no pillars, or the domain lacks the inlet or the outlet.
    ComputationError
        If a step fails; the steps before it were watched.

    Examples
    --------
    >>> import vasculo as vc
    >>> from vasculo.plexus.voronoi import disk_domain
    >>> ratios = []
    >>> def watch(step):
    ...     ratios.append(vc.measure.pillars(step.domain).aspect_ratio[0])
    >>> final = vc.remodel(disk_domain(6.0, 5.0), vc.Angiogenesis(steps=2, flow_spacing=1.5), watch)
    >>> len(ratios), bool(ratios[0] < 1.01 < ratios[2])
    (3, True)
    """
    parameters = parameters or Angiogenesis()
    check_domain(domain, parameters)
    if start is None:
        domain, state = begin(domain, parameters)
    else:
        domain, state = domain.with_pillars(start.pillars), start
    make, kept = mesher(domain, state, parameters)
    sensed = sense(domain, state, parameters, make, kept)
    if start is None:
        state = replace(state, shear_unit=mean_shear(sensed.flow), mesh_points=make.base_points(domain))
        state, events = notice(domain, state, sensed, None, (), parameters)
        _show(watch, domain, state, sensed, parameters, events, None, 0.0)
    while not is_done(state, parameters):
        clock = perf_counter()
        with _naming(state.step + 1):
            loads = sensed.traction * (parameters.traction / (state.shear_unit * state.length_unit))
            motion = move(domain, state, sensed.activation, loads, parameters)
            domain, state, changes = settle(domain, state, sensed, motion, parameters)
            cells = perf_counter() - clock
            sensed = sense(domain, state, parameters, make, kept)
        state = replace(state, mesh_points=make.base_points(domain))
        state, events = notice(domain, state, sensed, motion, changes, parameters)
        _show(watch, domain, state, sensed, parameters, events, motion, cells)
    return domain


def mesher(
    domain: Domain, state: RemodelState, parameters: Angiogenesis
) -> tuple[CarriedMesh | FreshMesh, KeptAnalysis | None]:
    """Return what makes the flow meshes of a run, and what keeps the analysis of its solver."""
    if parameters.meshing == "anew":
        return FreshMesh(), None
    base = None
    if len(state.mesh_points):
        base = domain.with_pillars(np.split(state.mesh_points, state.starts[1:-1]))
    return CarriedMesh(base), KeptAnalysis()


def is_done(state: RemodelState, parameters: Angiogenesis) -> bool:
    """Whether a run ends here."""
    rests = parameters.stop_at_rest and state.quiet_steps >= QUIET_STEPS
    return state.step >= parameters.steps or state.time >= parameters.strain_limit or rests


@contextmanager
def _naming(step: int) -> Iterator[None]:
    """Put the step before whatever goes wrong in it."""
    try:
        yield
    except (InputError, ComputationError) as error:
        raise ComputationError(f"remodelling step {step}: {error}") from error


def _show(
    watch: Watch | None,
    domain: Domain,
    state: RemodelState,
    sensed: Sensed,
    parameters: Angiogenesis,
    events: tuple[Event, ...],
    motion: Motion | None,
    cells: float,
) -> None:
    """Hand the step to the watch."""
    if watch is None:
        return
    cuts = state.starts[1:-1]
    parts = sensed.seconds | {"cells": sensed.seconds["cells"] + cells}
    watch(
        RemodelStep(
            step=state.step,
            parameters=parameters,
            is_last=is_done(state, parameters),
            time=state.time,
            domain=domain,
            mesh=sensed.mesh,
            flow=sensed.flow,
            activation=np.split(sensed.activation, cuts),
            node_shear=np.split(sensed.shear, cuts),
            lineage=state.lineage,
            events=events,
            merges_total=state.merges_total,
            shear_ratio=state.shear_ratio,
            residual=motion.residual if motion is not None else 0.0,
            sweeps=motion.sweeps if motion is not None else 0,
            displacement=motion.displacement if motion is not None else 0.0,
            seconds=sum(parts.values()),
            seconds_by_part=parts,
            state=state,
        )
    )


def check_domain(domain: Domain, parameters: Angiogenesis) -> None:
    """Raise InputError if a domain cannot be remodelled."""
    if not domain.pillars:
        raise InputError("remodelling needs at least one pillar, the domain has none")
    for role in ("inlet", "outlet"):
        side = getattr(parameters, role)
        if side not in domain.side_names:
            raise InputError(f"{role} = {side!r} is no side of the domain: it has {', '.join(domain.side_names)}")
