"""Sensing: the flow through the plexus, and what the membranes feel of it."""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import ComputationError
from vasculo.flow.boundary import Pressure, Slip, Wall
from vasculo.flow.read.forces import pillar_walls
from vasculo.flow.stokes import solve_stokes
from vasculo.mesh.generate import generate_mesh
from vasculo.pillars.activation import activation, node_shear, node_traction, pillar_means, rolled
from vasculo.pillars.border import flow_mesh
from vasculo.pillars.outlines import MARGIN

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from vasculo.flow.boundary import Condition
    from vasculo.flow.linear.kept import KeptAnalysis
    from vasculo.flow.solution import Flow
    from vasculo.geometry.domain import Domain
    from vasculo.mesh.triangulation import Triangulation
    from vasculo.pillars.parameters import Angiogenesis
    from vasculo.pillars.state import RemodelState


@dataclass(frozen=True, slots=True)
class Sensed:
    """Flow through a domain and what the membranes feel of it.

    Attributes
    ----------
    mesh : Triangulation
    flow : Flow
    shear : (n,) float64
        Magnitude of the wall shear at the membrane nodes, model pressure.
    means : (p,) float64
        Its mean over each membrane, model pressure.
    activation : (n,) float64
    traction : (n, 2) float64
        Force of the fluid on the membrane nodes, model pressure times model length; zero when it is not asked for.
    touching : (p,) bool
        Pillars that have joined a closed side.
    seconds : dict of str to float
        Wall time by part.
    """

    mesh: Triangulation
    flow: Flow
    shear: NDArray[np.float64]
    means: NDArray[np.float64]
    activation: NDArray[np.float64]
    traction: NDArray[np.float64]
    touching: NDArray[np.bool_]
    seconds: dict[str, float]

    @property
    def shear_ratio(self) -> float:
        """95th over 5th percentile of the pillars' mean shears; infinite when more than a twentieth have none."""
        low, high = np.percentile(self.means, (5, 95))
        return float(high / low) if low > 0.0 else float("inf")


def sense(
    domain: Domain,
    state: RemodelState,
    parameters: Angiogenesis,
    make: Callable[..., Triangulation] = generate_mesh,
    kept: KeptAnalysis | None = None,
) -> Sensed:
    """Mesh the fluid, solve the flow and read what the membrane nodes feel.

    Parameters
    ----------
    domain : Domain
        With the pillars of `state`.
    state : RemodelState
    parameters : Angiogenesis
    make : callable
        Makes the mesh; called like `generate_mesh`.
    kept : KeptAnalysis, optional
        Of the flow solver, from the step before.

    Returns
    -------
    Sensed

    Raises
    ------
    ComputationError
        If no fluid gets from the inlet to the outlet, or the cell response fails.
    """
    unit = state.length_unit
    walls: Condition = Slip() if parameters.walls == "slip" else Wall()
    conditions = dict.fromkeys(domain.side_names, walls)
    conditions |= {parameters.inlet: Pressure(parameters.pressure_drop), parameters.outlet: Pressure(0.0)}
    clock = perf_counter()
    spacing = parameters.membrane_spacing * unit
    sizes = (parameters.flow_spacing * unit, spacing)
    if parameters.border_joining:
        contact = max(0.5 * parameters.merge_gap, MARGIN) * spacing
        openings = (parameters.inlet, parameters.outlet)
        mesh, touching, sealed, blocked = flow_mesh(
            domain, openings, contact, spacing, *sizes, across=parameters.flow_across, make=make
        )
    else:
        mesh = make(domain, *sizes, across=parameters.flow_across)
        touching, sealed = np.zeros(len(domain.pillars), dtype=np.bool_), np.zeros(len(state.points), dtype=np.bool_)
        blocked = False
    if blocked:
        raise ComputationError(
            f"the channel is blocked: nothing flows from {parameters.inlet!r} to {parameters.outlet!r} "
            f"between {len(domain.pillars)} pillars, {int(touching.sum())} of them at the border"
        )
    meshed = perf_counter()
    flow = solve_stokes(mesh, conditions, parameters.viscosity, pockets="rest", kept=kept)
    solved = perf_counter()
    shear = node_shear(flow, state.points, state.starts, parameters.smoothing, sealed)
    means = pillar_means(shear, state.points, state.starts)
    active = np.zeros(len(shear))
    if not parameters.is_hanging:
        active = activation(shear, state.points, state.starts, parameters.response, parameters.activation_limit)
        if parameters.sensing == "rolled":
            active = rolled(active, state.starts, parameters.roll_seed, state.step)
    traction = np.zeros((len(shear), 2))
    if parameters.traction > 0.0:
        traction = node_traction(
            flow, state.points, state.starts, "full" if parameters.traction_part == "full" else "viscous"
        )
    seconds = {"mesh": meshed - clock, "flow": solved - meshed, "cells": perf_counter() - solved}
    return Sensed(mesh, flow, shear, means, active, traction, touching, seconds)


def mean_shear(flow: Flow) -> float:
    """Mean magnitude of the wall shear over the length of all pillars, model pressure.

    Raises
    ------
    ComputationError
        If it is zero.
    """
    mine, length = pillar_walls(flow)
    mean = float((np.abs(flow.wall_shear[mine]) * length).sum() / length.sum())
    if not mean > 0.0:
        raise ComputationError("no shear acts on any pillar at the start: the inlet and the outlet are not connected")
    return mean
