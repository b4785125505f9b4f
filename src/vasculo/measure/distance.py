"""How far apart two plexuses are: differences of their morphometry in units of what chance makes of them."""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np
from scipy.stats import wasserstein_distance

from vasculo.errors import InputError
from vasculo.geometry.outline import is_number

if TYPE_CHECKING:
    from collections.abc import Mapping

    from vasculo.measure.morphometry import Morphometry

SCALES: Mapping[str, float] = MappingProxyType(
    {
        "vessel_fraction": 0.0284,
        "areas": 0.259,
        "roundnesses": 0.0233,
        "solidities": 0.00687,
        "elongations": 0.116,
        "order": 0.107,
        "regularity": 0.138,
        "neighbours": 0.227,
        "widths": 0.0296,
        "segments": 0.0489,
        "degree": 0.0593,
    }
)
"""Root mean square difference between two windows of about 80 islands, of tissues that differ in their seed only.

Over the presets fine, medium, coarse and uniform, six seeds each, four windows a seed: `benchmarks/match.py scales`.
"""

DISTRIBUTIONS = ("areas", "roundnesses", "solidities", "elongations", "widths", "segments")
"""Terms that compare distributions, by their Wasserstein distance; the others are plain differences."""

ISLANDS = 80
"""Islands in the windows that the scales were measured in."""


@dataclass(frozen=True)
class Distance:
    """Distance between two tables of morphometry.

    Attributes
    ----------
    value : float
        Root of the weighted mean of the squared differences; 0 for the same table, about 1 for two seeds of the same
        settings with 80 islands each, less for more islands.
    differences : mapping of str to float
        Difference of each term in units of its scale, signed (second less first) for plain numbers, from 0 up for
        distributions.
    shares : mapping of str to float
        What each term contributes to the square of the distance; they add up to 1, or are all 0.

    Examples
    --------
    >>> import vasculo as vc
    >>> from vasculo.plexus.voronoi import voronoi_plexus
    >>> table = vc.measure.morphometry(voronoi_plexus(30, seed=1))
    >>> found = vc.measure.distance(table, table)
    >>> float(found), sum(found.shares.values())
    (0.0, 0.0)
    """

    value: float
    differences: Mapping[str, float]
    shares: Mapping[str, float]

    def __float__(self) -> float:
        return self.value


def distance(first: Morphometry, second: Morphometry, weights: Mapping[str, float] | None = None) -> Distance:
    """Distance between two tables of morphometry, and what it consists of.

    Parameters
    ----------
    first, second : Morphometry
        Tables, as `morphometry` makes them.
    weights : mapping of str to float, optional
        Weight of each term, 0 or more; 1 for those that are not named. The terms are the names in `SCALES`.

    Returns
    -------
    Distance
        Symmetric in value, 0 for the same table.

    Raises
    ------
    InputError
        For unknown names, negative weights, or when all are 0.

    Notes
    -----
    Terms that compare distributions (areas, roundnesses, solidities, elongations, widths, segments) are their first
    Wasserstein distance: the mean way by which values have to be moved to make one distribution of the other. The
    scale, the spacing of the islands, does not enter.

    Examples
    --------
    >>> import vasculo as vc
    >>> from vasculo.plexus.voronoi import voronoi_plexus
    >>> table = vc.measure.morphometry(voronoi_plexus(30, seed=1))
    >>> alike = vc.measure.morphometry(voronoi_plexus(30, seed=2))
    >>> wider = vc.measure.morphometry(voronoi_plexus(30, seed=2, channel=1.2))
    >>> vc.measure.distance(table, alike).value < vc.measure.distance(table, wider).value
    True
    """
    chosen = _weights(weights)
    differences = {name: difference(first, second, name) / scale for name, scale in SCALES.items()}
    squares = {name: chosen[name] * value**2 for name, value in differences.items()}
    total = sum(squares.values())
    return Distance(
        value=float(np.sqrt(total / sum(chosen.values()))),
        differences=MappingProxyType(differences),
        shares=MappingProxyType({name: square / total if total > 0.0 else 0.0 for name, square in squares.items()}),
    )


def difference(first: Morphometry, second: Morphometry, name: str) -> float:
    """Difference of one term in its own unit: second less first, or the Wasserstein distance of distributions."""
    one, two = getattr(first, name), getattr(second, name)
    if name in DISTRIBUTIONS:
        return float(wasserstein_distance(one.values, two.values, one.weights, two.weights))
    return float(two - one)


def _weights(weights: Mapping[str, float] | None) -> dict[str, float]:
    """Check weights and complete them."""
    given = {} if weights is None else dict(weights)
    for name, value in given.items():
        if name not in SCALES:
            raise InputError(f"no term of the distance is called {name!r}: they are {', '.join(SCALES)}")
        if not (is_number(value) and 0.0 <= value < np.inf):
            raise InputError(f"the weight of {name} is {value!r}, expected a number from 0 up")
    chosen = {name: float(given.get(name, 1.0)) for name in SCALES}
    if sum(chosen.values()) == 0.0:
        raise InputError(f"all {len(chosen)} weights are 0: nothing is compared")
    return chosen
