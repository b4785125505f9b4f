"""Which fibres break: the force that each of them bears, drawn once."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np
from scipy.ndimage import gaussian_filter, map_coordinates
from scipy.optimize import brentq
from scipy.special import gamma, log_ndtr

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import NDArray

    from vasculo.springs.network import SpringNetwork
    from vasculo.tissue.parameters import Vasculogenesis

    Floats = NDArray[np.float64]

WEAKEST = 0.3
"""Least threshold of the normal law, over the mean threshold."""

ALIKE = 1e-3
"""Spread below which Weibull's law is taken as no spread at all: its shape would leave the finite numbers."""

CELLS = 3.0
"""Cells of the grid of a correlated field in one correlation length."""

REACH = 6.0
"""Correlation lengths by which such a field is drawn wider than the tissue, so that its ends do not know each other."""


def breaking_forces(tissue: SpringNetwork, parameters: Vasculogenesis, seed: int) -> Floats:
    """Draw the force above which each spring breaks, once.

    A spring of rest length L and stiffness k breaks when its force exceeds k L theta X (thresholds of strain), or
    mean(k) mean(L) theta X (of force), with X from a law of mean 1. Springs between two pinned nodes never break.

    Parameters
    ----------
    tissue : SpringNetwork
        The tissue before growth.
    parameters : Vasculogenesis
        `threshold` (theta), `threshold_kind`, `threshold_law`, `threshold_spread` and `threshold_correlation`.
    seed : int
        Seed of the draw.

    Returns
    -------
    ndarray of float64, shape (m,)

    Notes
    -----
    Szczerba & Szekely 2005, section 2: "selectively remove springs that are stretched over a given threshold". Laws,
    spread and correlation are ours.
    """
    # The second number keeps this draw apart from that of a lattice with the same seed.
    rng = np.random.default_rng((seed, 1))
    if parameters.threshold_correlation > 0.0:
        scores = correlated(tissue, parameters.threshold_correlation * float(np.mean(tissue.rest_lengths)), rng)
    else:
        scores = rng.standard_normal(len(tissue.springs))
    share = parameters.threshold * LAWS[parameters.threshold_law](scores, parameters.threshold_spread)
    if parameters.threshold_kind == "strain":
        limits = share * tissue.stiffness * tissue.rest_lengths
    else:
        limits = share * float(np.mean(tissue.stiffness) * np.mean(tissue.rest_lengths))
    limits[tissue.pinned[tissue.springs].all(axis=1)] = np.inf
    return np.asarray(limits)


def normal_law(scores: Floats, spread: float) -> Floats:
    """Make normal thresholds of mean 1 from standard normal scores, none below 0.3."""
    return np.maximum(WEAKEST, 1.0 + spread * scores)


def weibull_law(scores: Floats, spread: float) -> Floats:
    """Make Weibull thresholds of mean 1 and standard deviation `spread`, at the quantiles of standard normal scores."""
    if spread < ALIKE:
        return np.ones_like(scores)

    def excess(shape: float) -> float:
        return float(gamma(1.0 + 2.0 / shape) / gamma(1.0 + 1.0 / shape) ** 2 - 1.0 - spread**2)

    shape = brentq(excess, 0.9, 2.0 / ALIKE)
    return np.asarray((-log_ndtr(-scores)) ** (1.0 / shape) / gamma(1.0 + 1.0 / shape))


LAWS: Mapping[str, Callable[[Floats, float], Floats]] = MappingProxyType({"normal": normal_law, "weibull": weibull_law})
"""Laws of the thresholds, by name: thresholds of mean 1 from standard normal scores and a spread."""


def correlated(tissue: SpringNetwork, length: float, rng: np.random.Generator) -> Floats:
    """Draw standard normal scores (m,) at the middles of the springs, with correlation exp(-r^2 / 2 length^2)."""
    # Strategy: white noise on a grid, smoothed by a Gaussian (which gives that correlation), read off between the
    # nodes by cubic splines. Where the tissue repeats the grid does; elsewhere it reaches beyond the tissue.
    low, high = tissue.reference.min(axis=0), tissue.reference.max(axis=0)
    size, period = high - low + 2.0 * REACH * length, np.zeros(2)
    if tissue.box is not None:
        period = np.where(np.isfinite(tissue.box), tissue.box, 0.0)
        size = np.where(period > 0.0, period, size)
    cells = np.maximum(1, np.ceil(CELLS * size / length)).astype(np.int64)
    width = size / cells
    smooth = length / np.sqrt(2.0) / width
    noise = gaussian_filter(rng.standard_normal(tuple(cells)), smooth, mode="wrap", truncate=REACH)
    point = np.zeros(tuple(np.minimum(cells, 2 * np.ceil(REACH * smooth).astype(np.int64) + 1)))
    point.flat[0] = 1.0
    strength = np.sqrt(np.sum(gaussian_filter(point, smooth, mode="wrap", truncate=REACH) ** 2))
    middle = tissue.reference[tissue.springs[:, 0]] - low + 0.5 * tissue.arms()
    place = (middle + np.where(period > 0.0, 0.0, REACH * length)) / width
    return np.asarray(map_coordinates(noise / strength, place.T, order=3, mode="grid-wrap"))
