"""What a tissue decides for parameters that are left to it: the rate of growth and the time step."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import InputError
from vasculo.springs.stability import chosen_step
from vasculo.tissue.spacing import growth_rate_for

if TYPE_CHECKING:
    from collections.abc import Callable

    from vasculo.springs.network import SpringNetwork
    from vasculo.tissue.parameters import Vasculogenesis


def settle(tissue: SpringNetwork, parameters: Vasculogenesis) -> Vasculogenesis:
    """Fill in the rate of growth and the time step for a tissue, and check the time step.

    Parameters
    ----------
    tissue : SpringNetwork
        The tissue before growth.
    parameters : Vasculogenesis
        With `growth_time`, `pillar_spacing` or `time_step` given or not.

    Returns
    -------
    Vasculogenesis
        With a `growth_rate` and a `time_step`, and neither `growth_time` nor `pillar_spacing`.

    Raises
    ------
    InputError
        When the spacing is out of reach of this tissue, or the time step exceeds the stability limit.
    """
    rate = parameters.growth_rate
    if parameters.growth_time is not None:
        rate = (1.0 - parameters.growth_limit) / parameters.growth_time
    elif parameters.pillar_spacing is not None:
        rate = growth_rate_for(tissue, parameters, parameters.pillar_spacing)
    safe = _limits(tissue, parameters, lambda network: network.safe_limit())
    step = parameters.time_step
    if step is None:
        step = chosen_step(min(safe))
    elif step > min(safe):
        growth, tightening = stability_limits(tissue, parameters)
        if step > min(growth, tightening):
            raise InputError(
                f"vasculogenesis.time_step = {step:g} exceeds the stability limit {min(growth, tightening):.3g} of "
                f"this tissue ({growth:.3g} in growth, {tightening:.3g} in tightening): lower it below the limit"
            )
    return replace(parameters, growth_rate=rate, growth_time=None, pillar_spacing=None, time_step=step)


def stability_limits(tissue: SpringNetwork, parameters: Vasculogenesis) -> tuple[float, float]:
    """Longest stable time steps of a tissue in growth and in tightening (sqrt(m / k))."""
    return _limits(tissue, parameters, lambda network: network.stability_limit())


def _limits(
    tissue: SpringNetwork, parameters: Vasculogenesis, limit: Callable[[SpringNetwork], float]
) -> tuple[float, float]:
    """Limits of a kind in growth and in tightening (sqrt(m / k))."""
    stiffness, mass = float(np.mean(tissue.stiffness)), float(np.mean(tissue.masses))
    network = tissue.copy()
    network.tether = parameters.tether * stiffness
    limits = []
    for damping in (parameters.damping, parameters.tightening_damping):
        network.damping = damping * float(np.sqrt(mass * stiffness))
        limits.append(limit(network) / float(np.sqrt(mass / stiffness)))
    return limits[0], limits[1]
