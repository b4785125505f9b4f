"""Weighted values: their mean, spread and quantiles."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from vasculo.geometry.arrays import Floats


@dataclass(frozen=True)
class Distribution:
    """Values with weights that add up to 1.

    Attributes
    ----------
    values, weights : ndarray of float64, shape (n,)
        In ascending order of the values.

    Examples
    --------
    >>> import numpy as np
    >>> import vasculo as vc
    >>> sizes = vc.measure.Distribution(np.array([1.0, 3.0]), np.array([0.75, 0.25]))
    >>> sizes.mean, sizes.quantile(0.5)
    (1.5, 1.0)
    """

    values: Floats
    weights: Floats

    @property
    def mean(self) -> float:
        """Weighted mean."""
        return float(self.values @ self.weights)

    @property
    def variation(self) -> float:
        """Weighted standard deviation over the mean."""
        return float(np.sqrt((self.values - self.mean) ** 2 @ self.weights)) / self.mean

    def quantile(self, share: float) -> float:
        """Smallest value that at least this share of the weight does not exceed."""
        at = int(np.searchsorted(np.cumsum(self.weights), share * (1.0 - 1e-12)))
        return float(self.values[min(at, len(self.values) - 1)])


def distribution(values: Floats, weights: Floats) -> Distribution:
    """Sort values (n,) and scale their weights (n,) to the sum 1."""
    order = np.argsort(values, kind="stable")
    return Distribution(values[order], weights[order] / weights.sum())
