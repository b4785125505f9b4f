"""Where a few runs can be compared: the stages that all have, and the time that all have reached."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import InputError
from vasculo.store.table import STAGES
from vasculo.store.units import Units

if TYPE_CHECKING:
    from collections.abc import Sequence

    from vasculo.store.read import Run

MOST = 4
"""Runs on one page."""


@dataclass(frozen=True)
class Compared:
    """Runs, and where in them they are compared.

    Attributes
    ----------
    runs : tuple of Run
        Two to four.
    names : tuple of str
        Names that tell them apart.
    stages : tuple of str
        Stages that all of them have.
    across : {"step", "time"}
        By what steps of the angiogenesis correspond: the accumulated strain, or the number where there is none.
    until : float
        The latest such time that all of them have reached.
    units : Units
        In which all numbers are told.
    """

    runs: tuple[Run, ...]
    names: tuple[str, ...]
    stages: tuple[str, ...]
    across: str
    until: float
    units: Units

    def end(self, run: Run) -> float:
        """Last step of the angiogenesis of a run, or its time; 0 without one."""
        return _end(run, self.across)

    def row(self, run: Run, share: float = 1.0) -> int:
        """Find the row of the recorded step nearest to a share of the time that all have reached."""
        rows = np.flatnonzero(run.metrics["stage"] == "angiogenesis")
        return int(rows[np.argmin(np.abs(run.metrics[self.across][rows] - share * self.until))])

    def step(self, run: Run, share: float = 1.0) -> int:
        """Find the recorded step nearest to a share of the time that all have reached."""
        return int(run.metrics["step"][self.row(run, share)])


def compare(runs: Sequence[Run]) -> Compared:
    """Find out where runs can be compared; see `write_side_by_side`."""
    if not 2 <= len(runs) <= MOST:
        raise InputError(f"{len(runs)} runs do not go side by side on a page: name 2 to {MOST}")
    folders = [run.folder.resolve() for run in runs]
    for k, folder in enumerate(folders):
        if folder in folders[:k]:
            raise InputError(f"{runs[k].folder} is named twice: name runs that differ")
    stages = tuple(stage for stage in STAGES if all(run.steps(stage) for run in runs))
    if not stages:
        had = (f"{run.folder} has {' and '.join(s for s in STAGES if run.steps(s)) or 'no step'}" for run in runs)
        raise InputError(f"these runs have no stage in common: {', '.join(had)}")
    ends = [_end(run, "time") for run in runs]
    across = "time" if min(ends) > 0.0 else "step"
    until = min(_end(run, across) for run in runs)
    same_units = all(run.units == runs[0].units for run in runs)
    names = [folder.name for folder in folders]
    if len(set(names)) < len(names):
        names = [f"{folder.parent.name}/{folder.name}" for folder in folders]
    units = runs[0].units if same_units else Units()
    return Compared(tuple(runs), tuple(names), stages, across, until, units)


def _end(run: Run, across: str) -> float:
    """Last time, or step, of the angiogenesis; 0 without one."""
    rows = np.flatnonzero(run.metrics["stage"] == "angiogenesis")
    return float(run.metrics[across][rows[-1]]) if len(rows) else 0.0
