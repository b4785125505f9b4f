"""Vasculogenesis: a tissue grows in a fixed frame, its fibres stretch and break, and what is left tightens to a plexus.

Stages: growth (nothing has broken yet), rupture, tightening (no rupture any more), settling.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import InputError
from vasculo.springs.parts import connected_parts
from vasculo.tissue.parameters import PRESETS, Vasculogenesis
from vasculo.tissue.process import Process
from vasculo.tissue.settle import settle
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
        The initial tissue with its triangles, as `lattice` makes it: in one piece, and held by pinned nodes, by a
        tether or by the box of a periodic one. Not changed. Its own damping and tether are replaced by those of the
        parameters.
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
        When the tissue has no triangles or no free node, is in several pieces or held by nothing, has a spring of no
        rest length, when a wanted spacing is out of reach, or when the time step exceeds the stability limit in growth
        or in tightening; before the first call of `watch`.
    ComputationError
        When the voids do not reach `stop_void_fraction` before the growth limit, rupture does not end by itself where
        it should, less than 95 % of the nodes hold together, or the tissue has cracked into a few huge voids.

    Notes
    -----
    Szczerba & Szekely 2005, section 2, eqs. (1)-(3). The end of rupture, the tether and the tightening are ours.

    Examples
    --------
    >>> import vasculo as vc
    >>> tissue = vc.lattice(nodes=1_000, seed=1)
    >>> torn = vc.grow_plexus(tissue, vc.Vasculogenesis(pillar_spacing=0.35), seed=1)
    >>> len(torn.springs) < len(tissue.springs)
    True
    >>> phases = []
    >>> def watch(step):
    ...     phases.append(step.phase.value)
    >>> again = vc.grow_plexus(tissue, vc.Vasculogenesis(pillar_spacing=0.35), seed=1, watch=watch)
    >>> list(dict.fromkeys(phases))
    ['growth', 'rupture', 'tightening', 'settling']
    >>> bool((again.points == torn.points).all())
    True
    """
    chosen = Vasculogenesis() if parameters is None else parameters
    if tissue.triangles is None:
        raise InputError(f"a tissue of {len(tissue.points)} nodes without triangles has no voids: use lattice()")
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
        raise InputError(f"seed is {seed!r}, expected a whole number >= 0")
    check_grows(tissue, chosen)
    process = Process(tissue, settle(tissue, chosen), int(seed), watch)
    process.rupture()
    process.drop_loose_pieces()
    process.tighten()
    return process.network_now()


def check_grows(tissue: SpringNetwork, parameters: Vasculogenesis) -> None:
    """Refuse a tissue that growth cannot stretch, naming the spring or node.

    Raises
    ------
    InputError
        When there is no spring or free node, a spring has no rest length, the tissue is in pieces or nothing holds it.
    """
    nodes, springs = len(tissue.points), len(tissue.springs)
    if springs == 0 or tissue.pinned.all():
        raise InputError(f"a tissue of {springs} springs and {int((~tissue.pinned).sum())} free nodes cannot grow")
    if not (tissue.rest_lengths > 0.0).all():
        at = int(np.argmin(tissue.rest_lengths))
        raise InputError(
            f"spring {at} between nodes {tissue.springs[at].tolist()} has rest length 0 and so no strain: growth needs "
            "rest lengths > 0"
        )
    parts = connected_parts(tissue.springs, nodes)
    sizes = np.sort(np.bincount(parts))[::-1]
    if len(sizes) > 1:
        apart = int(np.argmax(parts != parts[0]))
        raise InputError(
            f"the tissue is in {len(sizes)} pieces of {', '.join(str(size) for size in sizes[:3])}"
            f"{', ...' if len(sizes) > 3 else ''} nodes, node {apart} is not joined to node 0: grow each piece alone"
        )
    if not tissue.pinned.any() and tissue.box is None and parameters.tether == 0.0:
        raise InputError(
            f"nothing holds the tissue: none of its {nodes} nodes is pinned, it has no box and tether is 0, so growth "
            "would shrink it instead of stretching it"
        )
