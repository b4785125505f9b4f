"""Rows of the table of a run, from a step of a stage."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

import numpy as np

from vasculo import measure
from vasculo.errors import InputError

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


def remodel_row(step: RemodelStep, seconds: float, events: int | None = None) -> Row:
    """Numbers of a step of the angiogenesis.

    Parameters
    ----------
    step : RemodelStep
    seconds : float
        Wall time since the row before.
    events : int, optional
        Events since the row before; those of this step alone if left out.

    Returns
    -------
    Row
        NaN where a number has no value: without pillars, without flow, or of chains where there are none.
    """
    return {
        "step": step.step,
        "time": step.time,
        "pillars": len(step.domain.pillars),
        "merges": step.merges_total,
        "triangles": len(step.mesh.triangles),
        "residual": step.residual,
        "mass_imbalance": step.flow.mass_imbalance,
        "seconds": seconds,
        "events": len(step.events) if events is None else events,
        "shear_ratio": _finite(step.shear_ratio),
        **{f"seconds_{part}": taken for part, taken in step.seconds_by_part.items()},
        **_shapes(step),
        **_chains(step),
        **_flow(step),
    }


def _shapes(step: RemodelStep) -> Row:
    """Numbers of the outlines."""
    domain, parameters = step.domain, step.parameters
    if not domain.pillars:
        return {}
    table = measure.pillars(domain)
    weight = table.area / table.area.sum()
    twice = 2.0 * np.radians(table.orientation)
    # The axis of a round pillar means nothing: long ones count for more, by how far they are from round.
    pull = weight * (table.aspect_ratio - 1.0)
    angle = 0.5 * np.degrees(np.arctan2(pull @ np.sin(twice), pull @ np.cos(twice)))
    direction = measure.flow_direction(domain, parameters.inlet, parameters.outlet)
    return {
        "order": measure.order(domain, direction),
        "aspect_ratio": float(weight @ table.aspect_ratio),
        "angle": float(angle),
        "mean_gap": _finite(float(table.nearest_gap.mean())),
    }


def _chains(step: RemodelStep) -> Row:
    """Numbers of the chains."""
    if not step.domain.pillars:
        return {}
    found = measure.chains(step.domain, step.lineage)
    return {
        "chains": found.count,
        "largest_chain": found.largest,
        "chain_fraction": found.fraction,
        "straightness": found.mean_straightness,
    }


def _flow(step: RemodelStep) -> Row:
    """Numbers of the flow; those that are not defined without pillars, walls or flow are left out."""
    domain, flow = step.domain, step.flow
    sides = (step.parameters.inlet, step.parameters.outlet)
    row: Row = {}
    with suppress(InputError):
        row["permeability"] = measure.permeability(domain, flow, *sides)
        row["resistance"] = _finite(measure.resistance(flow, *sides))
    if row.get("permeability") == 0.0:
        return row
    with suppress(InputError):
        row["local_angle"] = measure.local_angles(domain, flow).summary().mean
        row["alignment"] = measure.alignment(domain, flow)
    with suppress(InputError):
        shear = measure.shear_distribution(flow)
        row["mean_wall_shear"] = shear.mean
        row["shear_variation"] = shear.within
    with suppress(InputError):
        lanes = measure.corridors(domain, flow, *sides)
        row["corridors"] = lanes.effective_count
        row["corridor_width"] = lanes.mean_width
        row["corridor_run"] = lanes.mean_run
    return row


def _finite(value: float) -> float:
    """Return a number, NaN instead of infinity."""
    return value if np.isfinite(value) else float("nan")
