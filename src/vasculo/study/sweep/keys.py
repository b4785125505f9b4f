"""The sections of a sweep file: their keys, and what each means."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from vasculo.errors import InputError
from vasculo.study.sections import Section

MOST_SEED = 2**32


@dataclass(frozen=True)
class SweepKeys:
    """What is swept.

    Parameters
    ----------
    study : str
        A built-in study, or a study file beside the sweep file.
    title : str
        One line for the report.
    method : {"grid", "list", "latin"}
        Every combination of the values in [vary], the points in [[point]], or a Latin hypercube over [vary].
    seeds : int or list of int
        Runs of each point, which differ in their seed: how many (seeds 0, 1, 2, ...), or the seeds themselves.
    points : int, optional
        Points of a Latin hypercube, 1 or more.
    draw : int
        Seed of a Latin hypercube, 0 or more: the same seed draws the same points.
    """

    study: str
    title: str = ""
    method: Literal["grid", "list", "latin"] = "grid"
    seeds: Any = 1
    points: int | None = None
    draw: int = 0

    def __post_init__(self) -> None:
        if self.points is not None and self.points < 1:
            raise InputError(f"points = {self.points} is not a whole number from 1 up")
        if (self.points is None) == (self.method == "latin"):
            raise InputError(f"points goes with method = 'latin', and method = {self.method!r}")
        if self.draw < 0:
            raise InputError(f"draw = {self.draw} is not a whole number from 0 up")
        seeds = self.seeds if isinstance(self.seeds, list) else [self.seeds]
        if not seeds or any(isinstance(seed, bool) or not isinstance(seed, int) for seed in seeds):
            raise InputError(f"seeds = {self.seeds!r} must be a whole number or a list of whole numbers")
        if not isinstance(self.seeds, list) and self.seeds < 1:
            raise InputError(f"seeds = {self.seeds} is not a whole number from 1 up")
        if any(not 0 <= seed < MOST_SEED for seed in seeds):
            raise InputError(f"seeds = {self.seeds} must be whole numbers from 0 to {MOST_SEED - 1}")
        if len(set(seeds)) < len(seeds):
            raise InputError(f"seeds = {self.seeds} has a seed twice")

    @property
    def seed_count(self) -> int:
        """Runs of each point."""
        return len(self.seeds) if isinstance(self.seeds, list) else int(self.seeds)

    @property
    def all_seeds(self) -> list[int]:
        """The seeds of each point."""
        return list(self.seeds) if isinstance(self.seeds, list) else list(range(self.seeds))


@dataclass(frozen=True)
class MeasureKeys:
    """Which numbers of a run go into the table.

    Parameters
    ----------
    numbers : list of str, optional
        Names, see `vasculo.study.sweep.numbers`; if not given all that the study leads to.
    """

    numbers: Any = None


@dataclass(frozen=True)
class DiagramKeys:
    """What the phase diagram shows.

    Parameters
    ----------
    x, y : str, optional
        The varied settings along the axes; if not given the first one and the second one.
    colour : str or list of str, optional
        Numbers of the table, a diagram each; if not given those that say most about such a study.
    gallery : bool
        Draw how one run of each point ended.
    """

    x: str | None = None
    y: str | None = None
    colour: Any = None
    gallery: bool = True


SWEEP = Section("sweep", "What is swept", SweepKeys)
MEASURE = Section("measure", "Numbers of the table", MeasureKeys)
DIAGRAM = Section("diagram", "The phase diagram", DiagramKeys)
SECTIONS = {section.name: section for section in (SWEEP, MEASURE, DIAGRAM)}
ORDER = ("sweep", "settings", "vary", "point", "measure", "diagram")
