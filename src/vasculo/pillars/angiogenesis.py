"""Angiogenesis: the loop of mesh, flow, wall shear, activation, motion and merging."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import ComputationError, InputError
from vasculo.flow.boundary import Pressure, Slip, Wall
from vasculo.flow.stokes import solve_stokes
from vasculo.geometry.outline import resample, signed_area
from vasculo.mesh.generate import generate_mesh
from vasculo.pillars.activation import activation, node_shear, node_traction, pillar_means
from vasculo.pillars.cell import stack
from vasculo.pillars.merge import merge
from vasculo.pillars.motion import Motion, move
from vasculo.pillars.outlines import MARGIN, keep_inside, tidy
from vasculo.pillars.parameters import MINIMUM_NODES, Angiogenesis
from vasculo.pillars.state import Merge, RemodelState, RemodelStep

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.flow.boundary import Condition
    from vasculo.flow.solution import Flow
    from vasculo.geometry.domain import Domain
    from vasculo.mesh.triangulation import Triangulation
    from vasculo.pillars.state import Lineage

__all__ = ["Angiogenesis", "Merge", "RemodelState", "RemodelStep", "remodel"]

INLET, OUTLET = "left", "right"

Watch = Callable[[RemodelStep], object]


@dataclass(frozen=True, slots=True)
class Sensed:
    """Flow through a domain and what the membranes feel of it; the last three are (n,), (n,) and (n, 2) float64."""

    mesh: Triangulation
    flow: Flow
    shear: NDArray[np.float64]
    activation: NDArray[np.float64]
    traction: NDArray[np.float64]
    seconds: dict[str, float]


def remodel(
    domain: Domain,
    parameters: Angiogenesis | None = None,
    watch: Watch | None = None,
    *,
    start: RemodelState | None = None,
) -> Domain:
    """Let pillars remodel in the flow that they shape (Szczerba & Szekely 2005, section 4).

    Each step solves the flow, turns the wall shear into contraction and stretching of the filaments, relaxes membranes,
    filaments and matrix (eqs. 2, 3), moves the pillars a little and merges those that touch. The flow enters at the
    side "left" and leaves at "right".

    Parameters
    ----------
    domain : Domain
        Box and pillars; with `start` only the box counts.
    parameters : Angiogenesis, optional
        The default ones if left out.
    watch : callable, optional
        Called with a `RemodelStep` for every step from 0 to ``parameters.steps``, each with a solved flow. With `start`
        the first call is for the step after it.
    start : RemodelState, optional
        Go on from here, to the same numbers as without interruption.

    Returns
    -------
    Domain
        After the last step.

    Raises
    ------
    InputError
        If there are no pillars, or no sides "left" and "right".
    ComputationError
        If a step fails; the steps before it were watched.
    """
    parameters = parameters or Angiogenesis()
    for side in (INLET, OUTLET):
        if side not in domain.side_names:
            raise InputError(f"remodelling needs a side {side!r}, the domain has {', '.join(domain.side_names)}")
    if start is None:
        domain, state = begin(domain, parameters)
    else:
        domain, state = domain.with_pillars(start.pillars), start
    sensed = sense(domain, state, parameters)
    if start is None:
        state = _with_shear_unit(state, sensed)
        _show(watch, domain, state, sensed, parameters, (), None, 0.0)
    for step in range(state.step + 1, parameters.steps + 1):
        clock = perf_counter()
        try:
            loads = sensed.traction * (parameters.traction / (state.shear_unit * state.length_unit))
            motion = move(domain, state, sensed.activation, loads, parameters)
            domain, state, merges = settle(domain, state, motion, parameters)
            cells = perf_counter() - clock
            sensed = sense(domain, state, parameters)
        except (InputError, ComputationError) as error:
            raise ComputationError(f"remodelling step {step}: {error}") from error
        _show(watch, domain, state, sensed, parameters, merges, motion, cells)
    return domain


def begin(domain: Domain, parameters: Angiogenesis) -> tuple[Domain, RemodelState]:
    """Give the membranes evenly spaced nodes and note where everything starts."""
    if not domain.pillars:
        raise InputError("remodelling needs at least one pillar, the domain has none")
    unit = domain.mean_radius
    spacing = parameters.membrane_spacing * unit
    even = domain.with_pillars([resample(outline, spacing, minimum=MINIMUM_NODES) for outline in domain.pillars])
    areas = np.array([signed_area(outline) for outline in even.pillars])
    points, starts = stack(even.pillars)
    lineage = tuple((k,) for k in range(len(starts) - 1))
    return even, _state(0, 0.0, unit, 0.0, points, starts, areas, lineage, 0, None)


def settle(
    domain: Domain, state: RemodelState, motion: Motion, parameters: Angiogenesis
) -> tuple[Domain, RemodelState, tuple[Merge, ...]]:
    """Put moved membranes in order: off the border, evenly spaced, simple, merged where they touch."""
    unit, step = state.length_unit, state.step + 1
    spacing = parameters.membrane_spacing * unit
    points = keep_inside(motion.points, domain.outer, MARGIN * spacing)
    outlines = tidy(np.split(points, state.starts[1:-1]), spacing, parameters.closing * spacing)
    outlines, areas, lineage, merges = merge(
        outlines,
        state.rest_areas,
        state.lineage,
        parameters.merge_gap * spacing,
        parameters.closing * spacing,
        spacing,
        step,
    )
    domain = domain.with_pillars(outlines)
    time = state.time + motion.share * (1.0 if parameters.is_hanging else abs(parameters.activation))
    points, starts = stack(domain.pillars)
    total = state.merges_total + len(merges)
    state = _state(step, time, unit, state.shear_unit, points, starts, areas, lineage, total, motion)
    return domain, state, merges


def sense(domain: Domain, state: RemodelState, parameters: Angiogenesis) -> Sensed:
    """Mesh the fluid, solve the flow and read the wall shear at the membrane nodes."""
    unit = state.length_unit
    walls: Condition = Slip() if parameters.walls == "slip" else Wall()
    conditions = dict.fromkeys(domain.side_names, walls)
    conditions |= {INLET: Pressure(parameters.pressure_drop), OUTLET: Pressure(0.0)}
    clock = perf_counter()
    mesh = generate_mesh(
        domain,
        parameters.flow_spacing * unit,
        parameters.membrane_spacing * unit,
        across=parameters.flow_across,
    )
    meshed = perf_counter()
    flow = solve_stokes(mesh, conditions, parameters.viscosity, pockets="rest")
    solved = perf_counter()
    shear = node_shear(flow, state.points, state.starts)
    active = np.zeros(len(shear))
    if not parameters.is_hanging:
        active = activation(shear, state.points, state.starts)
    traction = np.zeros((len(shear), 2))
    if parameters.traction > 0.0:
        traction = node_traction(flow, state.points, state.starts)
    seconds = {"mesh": meshed - clock, "flow": solved - meshed, "cells": perf_counter() - solved}
    return Sensed(mesh, flow, shear, active, traction, seconds)


def _with_shear_unit(state: RemodelState, sensed: Sensed) -> RemodelState:
    """Note the mean wall shear of the start."""
    ends = sensed.mesh.points[sensed.flow.wall_edges[sensed.flow.wall_pillar >= 0]]
    vector = ends[:, 1] - ends[:, 0]
    length = np.hypot(vector[:, 0], vector[:, 1])
    shear = np.abs(sensed.flow.wall_shear[sensed.flow.wall_pillar >= 0])
    unit = float((shear * length).sum() / length.sum())
    if not unit > 0.0:
        raise ComputationError("no shear acts on any pillar at the start: the inlet and the outlet are not connected")
    return replace(state, shear_unit=unit)


def _state(
    step: int,
    time: float,
    unit: float,
    shear_unit: float,
    points: NDArray[np.float64],
    starts: NDArray[np.int32],
    areas: NDArray[np.float64],
    lineage: Lineage,
    merges_total: int,
    motion: Motion | None,
) -> RemodelState:
    """Gather a state; lineage becomes arrays."""
    members, member_starts = stack_lineage(lineage)
    matrix = motion.matrix if motion is not None else None
    none = np.zeros((0, 2))
    return RemodelState(
        step,
        time,
        unit,
        shear_unit,
        points,
        starts,
        areas,
        members,
        member_starts,
        merges_total,
        none if matrix is None else matrix.points,
        none if matrix is None else matrix.reference,
        np.zeros((0, 2), dtype=np.int32) if matrix is None else matrix.springs,
        np.zeros((0, 3), dtype=np.int32) if matrix is None else matrix.triangles,
        np.zeros(0, dtype=np.bool_) if matrix is None else matrix.pinned,
    )


def stack_lineage(lineage: Lineage) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Original pillars of all pillars behind one another, and where each pillar begins."""
    starts = np.zeros(len(lineage) + 1, dtype=np.int32)
    starts[1:] = np.cumsum([len(group) for group in lineage])
    return np.array([i for group in lineage for i in group], dtype=np.int32), starts


def _show(
    watch: Watch | None,
    domain: Domain,
    state: RemodelState,
    sensed: Sensed,
    parameters: Angiogenesis,
    merges: tuple[Merge, ...],
    motion: Motion | None,
    cells: float,
) -> None:
    """Hand the step to the watch."""
    if watch is None:
        return
    cuts = state.starts[1:-1]
    low, high = np.percentile(pillar_means(sensed.shear, state.points, state.starts), (5, 95))
    parts = sensed.seconds | {"cells": sensed.seconds["cells"] + cells}
    watch(
        RemodelStep(
            step=state.step,
            steps_total=parameters.steps,
            time=state.time,
            domain=domain,
            mesh=sensed.mesh,
            flow=sensed.flow,
            activation=np.split(sensed.activation, cuts),
            node_shear=np.split(sensed.shear, cuts),
            lineage=state.lineage,
            merges=merges,
            merges_total=state.merges_total,
            shear_ratio=float(high / low) if low > 0.0 else float("inf"),
            residual=motion.residual if motion is not None else 0.0,
            sweeps=motion.sweeps if motion is not None else 0,
            displacement=motion.displacement if motion is not None else 0.0,
            seconds=sum(parts.values()),
            seconds_by_part=parts,
            state=state,
        )
    )
