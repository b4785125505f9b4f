"""What a fit found: the best settings, how sure they are, and both tables side by side."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from vasculo.measure.distance import SCALES, distance
from vasculo.measure.morphometry import pooled
from vasculo.study.match.settings import SEARCHED, vasculogenesis_of

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from vasculo.measure.distance import Distance
    from vasculo.study.match.evaluation import Evaluation
    from vasculo.study.match.sample import Sample
    from vasculo.study.match.target import Target
    from vasculo.tissue.parameters import Vasculogenesis

UNKNOWN = 0.5
"""A setting whose range takes more than this share of what was searched is not identified."""
OFF = 2.0
"""A number of the picture is off when it differs by more than this in units of chance (see `distance`)."""


@dataclass(frozen=True)
class Range:
    """What the target says about one setting.

    Attributes
    ----------
    name : str
    best : float
        Value in the best settings.
    low, high : float
        Smallest and largest value among the evaluations that came as near as the best, see `Matched.level`.
    searched : tuple of 2 float
        Range that was searched.
    share : float
        Width of the range over that of the search, 0 to 1, on the scale of the search.
    """

    name: str
    best: float
    low: float
    high: float
    searched: tuple[float, float]
    share: float

    @property
    def identified(self) -> bool:
        """Whether the target tells the setting."""
        return self.share <= UNKNOWN


@dataclass(frozen=True, eq=False)
class Matched:
    """A fit.

    Attributes
    ----------
    folder : Path
        Where its files lie.
    target : Target
        What was fitted to.
    vasculogenesis : Vasculogenesis
        The best settings.
    best : Evaluation
        Their evaluation in the search.
    evaluations : tuple of Evaluation
        All of the search.
    ended : str
        Why the search ended.
    level : float
        Distance up to which an evaluation counts as near as the best: that of the best, the mean of fresh evaluations,
        and two standard errors over the seeds of an evaluation.
    samples, defaults : tuple of Sample
        Plexuses with the best and with the default settings (none where these give none), of fresh seeds, each
        measured in a window with the shape and the number of islands of the target.
    ranges : tuple of Range
        Of each setting, over the evaluations up to that level.
    """

    folder: Path
    target: Target
    vasculogenesis: Vasculogenesis
    best: Evaluation
    evaluations: tuple[Evaluation, ...]
    ended: str
    level: float
    samples: tuple[Sample, ...]
    defaults: tuple[Sample, ...]
    ranges: tuple[Range, ...]

    @property
    def near(self) -> int:
        """Number of the evaluations that came as near as the best."""
        return sum(each.distance <= self.level for each in self.evaluations)

    @property
    def distance(self) -> Distance:
        """Distance of the target from the common table of the plexuses with the best settings."""
        return distance(self.target.table, pooled([sample.table for sample in self.samples]))

    @property
    def single(self) -> tuple[float, float]:
        """Mean and standard deviation of the distances of the single plexuses from the target."""
        return spread_of([distance(self.target.table, sample.table).value for sample in self.samples])

    @property
    def default(self) -> tuple[float, float]:
        """The same with the default settings."""
        return spread_of([distance(self.target.table, sample.table).value for sample in self.defaults])

    @property
    def floor(self) -> tuple[float, float]:
        """Mean and standard deviation of the distances between two plexuses with the best settings: the noise floor."""
        pairs = combinations([sample.table for sample in self.samples], 2)
        return spread_of([distance(one, two).value for one, two in pairs])

    @property
    def off(self) -> tuple[str, ...]:
        """Terms in which the target differs by more than twice of what chance makes, worst first."""
        differences = self.distance.differences
        return tuple(sorted((n for n in SCALES if abs(differences[n]) > OFF), key=lambda n: -abs(differences[n])))

    @property
    def lumen_width(self) -> float:
        """Width that the extraction adds to the cords: mean over the plexuses (mean spring lengths)."""
        return float(f"{np.mean([sample.lumen_width for sample in self.samples]):.4g}")

    @property
    def nodes(self) -> int:
        """Nodes of the tissue out of which a window with the islands of the target is cut."""
        return round(float(np.mean([sample.nodes for sample in self.samples])))

    @property
    def shown(self) -> Sample:
        """The plexus that is nearest to the target, and is drawn."""
        return min(self.samples, key=lambda sample: distance(self.target.table, sample.table).value)

    def table(self) -> dict[str, tuple[float, float, float, float, float]]:
        """Put both tables together: of each number the target's, mean and deviation of the best and of the defaults."""
        mine = [sample.table.rows() for sample in self.samples]
        usual = [sample.table.rows() for sample in self.defaults]
        return {
            name: (value, *spread_of([row[name] for row in mine]), *spread_of([row[name] for row in usual]))
            for name, value in self.target.table.rows().items()
        }


def ranges_of(best: Evaluation, level: float, tried: Sequence[Evaluation]) -> tuple[Range, ...]:
    """Ranges of the settings over all evaluations that came as near as the best.

    Parameters
    ----------
    best : Evaluation
        The best settings.
    level : float
        Distance up to which an evaluation counts.
    tried : sequence of Evaluation
        All of the search.

    Returns
    -------
    tuple of Range
        In the order of `SEARCHED`.
    """
    near = np.array([best.places, *(each.places for each in tried if each.distance <= level)])
    ends = zip(SEARCHED, best.places, near.min(axis=0).tolist(), near.max(axis=0).tolist(), strict=True)
    return tuple(
        Range(
            each.name,
            each.value(place),
            each.value(low),
            each.value(high),
            (each.value(0.0), each.value(1.0)),
            high - low,
        )
        for each, place, low, high in ends
    )


def settings_of(evaluation: Evaluation) -> Vasculogenesis:
    """Return the settings of an evaluation."""
    return vasculogenesis_of(evaluation.places)


def spread_of(values: Sequence[float]) -> tuple[float, float]:
    """Mean and standard deviation; both NaN of nothing."""
    if not values:
        return float("nan"), float("nan")
    return float(np.mean(values)), float(np.std(values, ddof=1)) if len(values) > 1 else 0.0
