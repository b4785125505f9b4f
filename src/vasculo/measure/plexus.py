"""Morphology of a network: what is left of the springs, and how large and alike the voids are."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vasculo.plexus.survey import survey

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.springs.network import SpringNetwork

    Floats = NDArray[np.float64]


@dataclass(frozen=True)
class PlexusNumbers:
    """Morphology of a network. Lengths in L0 (mean initial spring), areas in A0 (mean initial triangle).

    Attributes
    ----------
    springs_left : float or None
        Living springs over initial ones; None for a network without its initial triangulation.
    components : int
        Connected parts of more than one node.
    dangling_fraction : float
        Share of the living springs that have the same face on both sides.
    voids : int
        Faces above ten A0.
    areas : ndarray of float64, shape (voids,)
        Area of each void.
    void_fraction : float
        Void area over the area of all faces.
    spacing : float
        Square root of the area per void; 0 without voids.
    mean_diameter : float
        d_A: diameter of the area-weighted mean void, 2 sqrt(sum A^2 / (pi sum A)); 0 without voids.
    median_area : float
        Median of the void areas; 0 without voids.
    variation : float
        Standard deviation of the void areas over their mean; 0 without voids.
    """

    springs_left: float | None
    components: int
    dangling_fraction: float
    voids: int
    areas: Floats
    void_fraction: float
    spacing: float
    mean_diameter: float
    median_area: float
    variation: float


def plexus(network: SpringNetwork) -> PlexusNumbers:
    """Measure the morphology of a network.

    Parameters
    ----------
    network : SpringNetwork
        Broken or whole, with its initial triangulation or without one.

    Returns
    -------
    PlexusNumbers

    Raises
    ------
    InputError
        When no spring is left.
    """
    found = survey(network)
    areas = np.array([void.area for void in found.voids])
    left = None
    if network.triangles is not None:
        pairs = np.sort(network.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        left = len(network.springs) / len(np.unique(pairs, axis=0))
    some = len(areas) > 0
    unit, triangle = found.length_unit, found.triangle_area
    weighted = float(np.sum(areas**2) / areas.sum()) if some else 0.0
    return PlexusNumbers(
        springs_left=left,
        components=found.counts["fragments"] + 1,
        dangling_fraction=found.counts["dangling_springs"] / len(network.springs),
        voids=len(areas),
        areas=areas / triangle,
        void_fraction=float(areas.sum()) / found.area,
        spacing=float(np.sqrt(found.area / len(areas))) / unit if some else 0.0,
        mean_diameter=2.0 * float(np.sqrt(weighted / np.pi)) / unit,
        median_area=float(np.median(areas)) / triangle if some else 0.0,
        variation=float(np.std(areas) / np.mean(areas)) if some else 0.0,
    )
