"""Points of a sweep: every combination, a list, or a Latin hypercube."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from scipy.stats import qmc

from vasculo.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Mapping

Point = dict[str, Any]
"""Settings of one point, "section.key" to value."""

MOST_RUNS = 100_000
"""Runs that a sweep may have."""
DIGITS = 12
"""Significant digits of values that are computed."""


@dataclass(frozen=True)
class Span:
    """An interval of numbers.

    Attributes
    ----------
    low, high : float
        Its ends, low < high; above 0 on a logarithmic scale.
    scale : {"linear", "log"}
        How values are spread over it.
    steps : int or None
        Values of a grid, both ends among them, 2 or more.
    whole : bool
        Whether values are rounded to whole numbers.
    """

    low: float
    high: float
    scale: Literal["linear", "log"] = "linear"
    steps: int | None = None
    whole: bool = False

    def at(self, share: float) -> float | int:
        """Value at a share of the way from low to high, 0 to 1."""
        if self.scale == "log":
            value = math.exp(math.log(self.low) + share * (math.log(self.high) - math.log(self.low)))
        else:
            value = self.low + share * (self.high - self.low)
        return round(value) if self.whole else float(f"{value:.{DIGITS}g}")

    def values(self) -> list[float | int]:
        """Values of a grid; whole ones that fall together are taken once."""
        steps = self.steps or 0
        return list(dict.fromkeys(self.at(step / (steps - 1)) for step in range(steps)))


Axis = Span | list[Any]
"""What one setting is varied over: an interval, or values."""


def grid(axes: Mapping[str, Axis]) -> list[Point]:
    """Combine every value of each setting with every value of the others, the last one changing fastest.

    Raises
    ------
    InputError
        When that is more than a sweep may have.
    """
    values = {key: axis.values() if isinstance(axis, Span) else axis for key, axis in axes.items()}
    check_count(math.prod(len(each) for each in values.values()), 1)
    return [dict(zip(values, chosen, strict=True)) for chosen in itertools.product(*values.values())]


def latin(axes: Mapping[str, Axis], points: int, seed: int) -> list[Point]:
    """Draw points of a Latin hypercube: each setting has one point in each of `points` equal parts of its interval.

    Parameters
    ----------
    axes : mapping of str to Span or list
        A list counts as an interval cut into as many equal parts as it has values.
    points : int
        Points, 1 or more.
    seed : int
        The same seed draws the same points.

    References
    ----------
    McKay, Beckman, Conover: A comparison of three methods for selecting values of input variables. Technometrics 1979.
    """
    shares = qmc.LatinHypercube(len(axes), rng=np.random.default_rng(seed)).random(points)
    return [
        {key: _chosen(axis, float(share)) for (key, axis), share in zip(axes.items(), row, strict=True)}
        for row in shares
    ]


def check_count(points: int, seeds: int) -> None:
    """Refuse a sweep that is too large.

    Raises
    ------
    InputError
        With the numbers.
    """
    if points * seeds > MOST_RUNS:
        raise InputError(f"{points:,} points of {seeds:,} seeds are {points * seeds:,} runs, above {MOST_RUNS:,}")


def _chosen(axis: Axis, share: float) -> Any:  # a value of any setting
    """Value at a share of an axis."""
    return axis.at(share) if isinstance(axis, Span) else axis[int(share * len(axis))]
