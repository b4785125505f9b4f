"""Rows of the table of a run, from a step of a stage."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo import measure

if TYPE_CHECKING:
    from vasculo.pillars.state import RemodelStep
    from vasculo.store.table import Row
    from vasculo.tissue.vasculogenesis import GrowthStep


def growth_row(step: GrowthStep, seconds: float) -> Row:
    """Numbers of a step of the vasculogenesis; `seconds` is the wall time since the row before."""
    return {
        "step": step.step,
        "time": step.time,
        "springs": len(step.network.springs),
        "void_fraction": step.void_fraction,
        "pillars": step.voids,
        "residual": step.residual,
        "seconds": seconds,
    }


def remodel_row(step: RemodelStep, seconds: float) -> Row:
    """Numbers of a step of the angiogenesis; `seconds` is the wall time since the row before."""
    table = measure.pillars(step.domain)
    weight = table.area / table.area.sum()
    twice = 2.0 * np.radians(table.orientation)
    # The axis of a round pillar means nothing: long ones count for more, by how far they are from round.
    pull = weight * (table.aspect_ratio - 1.0)
    angle = 0.5 * np.degrees(np.arctan2(pull @ np.sin(twice), pull @ np.cos(twice)))
    gap = measure.mean_gap(step.domain)
    return {
        "step": step.step,
        "time": step.time,
        "pillars": len(step.domain.pillars),
        "merges": step.merges_total,
        "order": measure.order(step.domain),
        "alignment": measure.alignment(step.domain, step.flow),
        "aspect_ratio": float(weight @ table.aspect_ratio),
        "angle": float(angle),
        "mean_gap": gap if np.isfinite(gap) else np.nan,
        "permeability": measure.permeability(step.domain, step.flow),
        "mean_wall_shear": measure.mean_wall_shear(step.flow),
        "triangles": len(step.mesh.triangles),
        "residual": step.residual,
        "mass_imbalance": step.flow.mass_imbalance,
        "seconds": seconds,
    }
