"""Vasculogenesis: a tissue grows in a fixed frame, its fibres stretch and break, and what is left tightens to a plexus.

Stages: growth (nothing has broken yet), rupture, tightening (no rupture any more), settling.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import InputError
from vasculo.tissue.parameters import PRESETS, Vasculogenesis
from vasculo.tissue.process import Process
from vasculo.tissue.step import GrowthPhase, GrowthStep

if TYPE_CHECKING:
    from collections.abc import Callable

    from vasculo.springs.network import SpringNetwork

__all__ = ["PRESETS", "GrowthPhase", "GrowthStep", "Vasculogenesis", "check_time_step", "grow_plexus"]


def grow_plexus(
    tissue: SpringNetwork,
    parameters: Vasculogenesis | None = None,
    seed: int = 0,
    watch: Callable[[GrowthStep], object] | None = None,
) -> SpringNetwork:
    """Grow a plexus: stretch the fibres of a tissue until enough of them broke, then tighten what is left.

    Parameters
    ----------
    tissue : SpringNetwork
        The initial tissue with its triangles and a pinned frame, as `lattice` makes it. Not changed. Its own damping
        and tether are replaced by those of the parameters.
    parameters : Vasculogenesis, optional
        The preset "medium" if not given.
    seed : int
        Seed of the rupture thresholds, >= 0. The same seed gives the same plexus.
    watch : callable, optional
        Called with a `GrowthStep` at the start and about every 0.005 of the rest-length factor.

    Returns
    -------
    SpringNetwork
        The plexus: living springs with their final rest lengths, positions, and the damping of the last stage. Nodes
        and triangles keep their numbers; nodes of loose pieces stay as points without springs.

    Raises
    ------
    InputError
        When the tissue has no triangles or no free node, or the time step exceeds the stability limit in growth or
        in tightening; before the first call of `watch`.
    ComputationError
        When the voids do not reach `stop_void_fraction` before the growth limit, rupture does not end by itself where
        it should, less than 99 % of the nodes hold together, or the tissue has cracked into a few huge voids.

    Notes
    -----
    Szczerba & Szekely 2005, section 2, eqs. (1)-(3). The end of rupture, the tether and the tightening are ours.
    """
    chosen = Vasculogenesis() if parameters is None else parameters
    if tissue.triangles is None:
        raise InputError(f"a tissue of {len(tissue.points)} nodes without triangles has no voids: use lattice()")
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
        raise InputError(f"seed is {seed!r}, expected a whole number >= 0")
    if len(tissue.springs) == 0 or tissue.pinned.all():
        raise InputError(
            f"a tissue of {len(tissue.springs)} springs and {int((~tissue.pinned).sum())} free nodes cannot grow"
        )
    check_time_step(tissue, chosen)
    process = Process(tissue, chosen, int(seed), watch)
    process.rupture()
    process.drop_loose_pieces()
    process.tighten()
    return process.network_now()


def stability_limits(tissue: SpringNetwork, parameters: Vasculogenesis) -> tuple[float, float]:
    """Longest stable time steps of a tissue in growth and in tightening (sqrt(m / k))."""
    stiffness, mass = float(np.mean(tissue.stiffness)), float(np.mean(tissue.masses))
    network = tissue.copy()
    network.tether = parameters.tether * stiffness
    limits = []
    for damping in (parameters.damping, parameters.tightening_damping):
        network.damping = damping * float(np.sqrt(mass * stiffness))
        limits.append(network.stability_limit() / float(np.sqrt(mass / stiffness)))
    return limits[0], limits[1]


def check_time_step(tissue: SpringNetwork, parameters: Vasculogenesis) -> tuple[float, float]:
    """Refuse a time step that is unstable in growth or in tightening.

    Parameters
    ----------
    tissue : SpringNetwork
        The tissue before growth.
    parameters : Vasculogenesis
        Dampings, tether and time step.

    Returns
    -------
    tuple of float
        The limits in growth and in tightening (sqrt(m / k)).

    Raises
    ------
    InputError
        When the time step exceeds one of them.
    """
    growth, tightening = stability_limits(tissue, parameters)
    limit = min(growth, tightening)
    if parameters.time_step > limit:
        raise InputError(
            f"vasculogenesis.time_step = {parameters.time_step:g} exceeds the stability limit {limit:.3g} of this "
            f"tissue ({growth:.3g} in growth, {tightening:.3g} in tightening): lower it below the limit"
        )
    return growth, tightening
