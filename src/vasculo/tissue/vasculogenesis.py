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

__all__ = ["PRESETS", "GrowthPhase", "GrowthStep", "Vasculogenesis", "grow_plexus"]


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
        When the tissue has no triangles or no free node, or the time step exceeds the stability limit.
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
    process = Process(tissue, chosen, int(seed), watch)
    process.rupture()
    process.drop_loose_pieces()
    process.tighten()
    return process.network_now()
