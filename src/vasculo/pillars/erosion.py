"""Erosion: small pillars in fast flow lose area, and pillars that have become too small vanish."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

SMALLEST = 0.1  # radius below which a pillar vanishes, R0: its membrane is then a third of its usual spacing


def erode(
    rest_areas: NDArray[np.float64],
    areas: NDArray[np.float64],
    mean_shear: NDArray[np.float64],
    everywhere: float,
    radius: float,
    rate: float,
) -> NDArray[np.float64]:
    """Take area from small pillars in fast flow (ours: the paper leaves them as islands in the vessels).

    Parameters
    ----------
    rest_areas : (p,) float64, model length squared
        Areas that the cells restore.
    areas : (p,) float64, model length squared
        Areas of the pillars.
    mean_shear : (p,) float64, model pressure
        Mean wall shear of each pillar.
    everywhere : float, model pressure
        Mean wall shear over all pillars.
    radius : float, model length
        Pillars with sqrt(area / pi) below it are small.
    rate : float, dimensionless
        Share of its rest area that a small pillar under more than the mean shear loses, as its area follows:
        the rest area does not fall below ``1 - rate`` of the area.

    Returns
    -------
    (p,) float64, model length squared
        The new rest areas.
    """
    eroded = (areas < np.pi * radius**2) & (mean_shear > everywhere)
    left = np.minimum(rest_areas, (1.0 - rate) * np.maximum(rest_areas, areas))
    return np.where(eroded, left, rest_areas)


def vanishing(areas: NDArray[np.float64], smallest: float) -> NDArray[np.bool_]:
    """Which pillars are too small to go on: those with sqrt(area / pi) below `smallest`, and those turned over.

    Parameters
    ----------
    areas : (p,) float64, model length squared
        Signed, positive counter-clockwise.
    smallest : float, model length

    Returns
    -------
    (p,) bool
        True also where the area is not a number.
    """
    return ~(areas >= np.pi * smallest**2)
