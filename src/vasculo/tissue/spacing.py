"""How far apart voids open: a measured law, and the rate of growth that gives a wanted spacing.

Strain relaxes around a young void by overdamped spreading, with diffusivity ~ k L0^2 / D, while growth opens new voids
everywhere at the rate rho; the distance that is relieved is ~ sqrt(k L0^2 / (D rho)). Measured spacings follow the load
D rho with a smaller power, since small voids stay between the large ones, and level off at the size of the mesh.
"""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import brentq

from vasculo.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import ArrayLike, NDArray

    from vasculo.springs.network import SpringNetwork
    from vasculo.tissue.parameters import Vasculogenesis

    Floats = NDArray[np.float64]

COEFFICIENTS: Mapping[str, float] = MappingProxyType(
    {
        "1": 2.0867,
        "load": -0.2876,
        "load*load": 0.0271,
        "threshold": 0.3602,
        "spread": -0.4513,
        "tether": -0.1561,
        "stop": 1.4282,
        "variation": -1.1097,
        "spread*spread": -4.5727,
        "load*threshold": -0.0927,
        "load*spread": 0.2695,
        "load*tether": 0.0772,
        "load*stop": -0.4720,
    }
)
"""The fit of ln(spacing / L0), by term (see `terms`): 398 tissues of 12,000 nodes, `benchmarks/spacing_law.py`.

Single tissues scatter about it by 3.6 % where only the load differs from the preset "medium", by 8.6 % in general.
"""

LOADS = 0.001, 0.06
"""Loads D rho (in k, m, sqrt(m / k)) between which the law was measured."""

RANGES: Mapping[str, tuple[float, float]] = MappingProxyType(
    {
        "damping": (1.0, 10.0),
        "threshold": (0.3, 0.7),
        "threshold_spread": (0.05, 0.4),
        "tether": (0.0, 0.1),
        "stop_void_fraction": (0.25, 0.5),
    }
)
"""Settings between which it was measured."""

ROOMY = 8.0
"""Spacing over L0 that a plexus looks best at; the number of nodes that is proposed gives it."""


def terms(
    load: ArrayLike, threshold: ArrayLike, spread: ArrayLike, tether: ArrayLike, stop: ArrayLike, variation: ArrayLike
) -> dict[str, Floats]:
    """Terms of the law, each 0 for the preset "medium" at D rho = 0.0045 (but "1").

    Parameters
    ----------
    load : array_like
        D rho.
    threshold, spread, tether, stop : array_like
        As in `Vasculogenesis`.
    variation : array_like
        Standard deviation of the first spring lengths over their mean.
    """
    parts = {
        "load": np.log(np.asarray(load) / 0.0045),
        "threshold": np.log(np.asarray(threshold) / 0.5),
        "spread": np.asarray(spread) - 0.2,
        "tether": np.log((np.asarray(tether) + 0.01) / 0.02),
        "stop": np.asarray(stop) - 0.4,
        "variation": np.asarray(variation) - 0.24,
    }
    products = ("load*load", "spread*spread", *(f"load*{name}" for name in ("threshold", "spread", "tether", "stop")))
    found: dict[str, Floats] = {"1": np.ones_like(parts["load"])} | parts
    for product in products:
        one, other = product.split("*")
        found[product] = parts[one] * parts[other]
    return found


def expected_spacing(tissue: SpringNetwork, parameters: Vasculogenesis, load: float | None = None) -> float:
    """Spacing of the voids that the law expects, in mean spring lengths.

    Parameters
    ----------
    tissue : SpringNetwork
        The tissue before growth.
    parameters : Vasculogenesis
        Its settings.
    load : float, optional
        D rho, instead of that of the parameters.

    Notes
    -----
    Outside the loads and settings for which the law was measured this is a guess.
    """
    lengths = tissue.rest_lengths
    found = terms(
        parameters.growth_rate * max(parameters.damping, 1.0) if load is None else load,
        parameters.threshold,
        parameters.threshold_spread,
        parameters.tether,
        parameters.stop_void_fraction,
        float(np.std(lengths) / np.mean(lengths)),
    )
    return float(np.exp(sum(COEFFICIENTS[name] * value for name, value in found.items())))


def growth_rate_for(tissue: SpringNetwork, parameters: Vasculogenesis, spacing: float) -> float:
    """Rate of growth that gives a spacing (model length) by the law.

    Raises
    ------
    InputError
        When the law was not measured for such settings, or no load gives the spacing in this tissue.
    """
    _check_measured(tissue, parameters)
    unit = float(np.mean(tissue.rest_lengths))
    wanted = spacing / unit
    widest, closest = (expected_spacing(tissue, parameters, load) for load in LOADS)
    if not closest <= wanted <= widest:
        nodes = len(tissue.points) * (ROOMY / wanted) ** 2
        raise InputError(
            f"pillar_spacing {spacing:g} is {wanted:.3g} mean spring lengths of this tissue of {len(tissue.points)} "
            f"nodes, growth gives {closest:.3g} to {widest:.3g} with these settings ({closest * unit:.3g} to "
            f"{widest * unit:.3g}): take about {float(f'{nodes:.2g}'):.0f} nodes, or another spacing"
        )

    def excess(logarithm: float) -> float:
        return expected_spacing(tissue, parameters, float(np.exp(logarithm))) - wanted

    low, high = (float(np.log(load)) for load in LOADS)
    return float(np.exp(brentq(excess, low, high, xtol=1e-10))) / parameters.damping


def _check_measured(tissue: SpringNetwork, parameters: Vasculogenesis) -> None:
    """Refuse settings for which the law was not measured."""
    for name, (low, high) in RANGES.items():
        value = getattr(parameters, name)
        if not low <= value <= high:
            raise InputError(
                f"pillar_spacing was measured for {name} from {low:g} to {high:g}, not {value:g}: give growth_rate"
            )
    other = [
        f"{name} = {getattr(parameters, name)!r}"
        for name, usual in (("threshold_kind", "strain"), ("threshold_law", "normal"), ("threshold_correlation", 0.0))
        if getattr(parameters, name) != usual
    ]
    if other:
        raise InputError(f"pillar_spacing was not measured for {', '.join(other)}: give growth_rate")
    if tissue.box is None and not tissue.pinned.any():
        raise InputError("pillar_spacing was not measured for a tissue with a free boundary: give growth_rate")
