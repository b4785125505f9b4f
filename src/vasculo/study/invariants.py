"""What must hold at every step: finite numbers, positive areas, a flow that balances."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import ComputationError

if TYPE_CHECKING:
    from vasculo.pillars.state import RemodelStep
    from vasculo.tissue.vasculogenesis import GrowthStep

MASS_LIMIT = 1e-6
"""Relative error of the mass balance above which a run stops; a sound solve is below 1e-9."""


def check_growth(step: GrowthStep) -> None:
    """Stop when the tissue is no longer finite.

    Raises
    ------
    ComputationError
        With the step, the first node and how many there are.
    """
    bad = np.flatnonzero(~np.isfinite(step.network.points).all(axis=1))
    if bad.size:
        raise ComputationError(
            f"vasculogenesis step {step.step} (time {step.time:g}): {bad.size} of {len(step.network.points)} nodes "
            f"are not finite, the first is node {bad[0]}; lower vasculogenesis.dt"
        )


def check_remodelling(step: RemodelStep) -> None:
    """Stop when pillars, mesh or flow break what must hold: finite numbers, positive areas, balanced mass.

    Raises
    ------
    ComputationError
        With the step and the numbers.
    """
    where = f"angiogenesis step {step.step}"
    areas = step.domain.pillar_areas
    if not (areas > 0.0).all():
        raise ComputationError(f"{where}: pillar {int(np.argmin(areas))} has area {areas.min():.3g}")
    for name in ("velocity", "pressure", "wall_shear"):
        values = getattr(step.flow, name)
        if not np.isfinite(values).all():
            bad = int(np.count_nonzero(~np.isfinite(values)))
            raise ComputationError(f"{where}: {bad} of {values.size} values of the {name} are not finite")
    off = step.flow.mass_imbalance
    if not off <= MASS_LIMIT:
        raise ComputationError(f"{where}: the mass balance of the flow is off by {off:.2g}, above {MASS_LIMIT:g}")
