"""What a sweep has come to: the class that holds it, and the files that are written anew after every run."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from vasculo.errors import InputError
from vasculo.store.read import Run, open_run
from vasculo.store.table import write_whole
from vasculo.study.sweep.file import SweepFile, read_sweep
from vasculo.study.sweep.home import FAILURES, PARQUET, PLAN, RUNS, STUDY, SUMMARY, SWEEP, TABLE
from vasculo.study.sweep.labels import setting_label
from vasculo.study.sweep.numbers import Number, chosen_numbers, shown_numbers
from vasculo.study.sweep.plan import Looked, Plan, PlannedRun, look, plan_from_json
from vasculo.study.sweep.table import about, make_table, rows_to_csv, summary, to_csv, to_parquet
from vasculo.study.sweep.work import Outcome

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.study.sweep.work import Status

    Table = dict[str, NDArray[Any]]


@dataclass(frozen=True)
class Failure:
    """A run that failed.

    Attributes
    ----------
    run : str
        Its name.
    seed : int
        Its seed.
    settings : dict
        Its varied settings.
    line : str
        Why, in one line.
    """

    run: str
    seed: int
    settings: dict[str, Any]
    line: str


class Sweep:
    """A sweep on disk; made by `sweep` and `open_sweep`.

    Attributes
    ----------
    folder : Path
        Its folder.
    plan : Plan
        All runs with their settings.
    numbers : list of Number
        Columns of numbers, with their meanings and units.
    shown : list of Number
        Those that get a diagram.
    file : SweepFile
        The sweep file.
    settings : Settings
        The checked study of the first point.
    weights : dict
        About how long a run of each point takes beside the others.
    samples : dict
        Checked studies of some points, by their numbers.
    outcomes : dict
        What became of the runs so far, by name.
    """

    def __init__(self, folder: Path, file: SweepFile, plan: Plan, looked: Looked) -> None:
        settings = looked.first
        self.folder, self.file, self.plan, self.settings = folder, file, plan, settings
        self.weights, self.samples = looked.weights, looked.samples
        self.numbers: list[Number] = chosen_numbers(file.measure.numbers, settings, f"{file.source}: measure.numbers")
        where = f"{file.source}: diagram.colour"
        self.shown: list[Number] = shown_numbers(file.diagram.colour, self.numbers, settings, where)
        for key in ("x", "y"):
            name = getattr(file.diagram, key)
            if name is not None and name not in plan.varied:
                raise InputError(
                    f"{file.source}: diagram.{key} = {name!r} is not varied: it must be one of {', '.join(plan.varied)}"
                )
        self.outcomes: dict[str, Outcome] = {}

    def __repr__(self) -> str:
        done, runs, failed = self.count("complete"), len(self.plan.runs), self.count("failed")
        return f"Sweep({str(self.folder)!r}, {done} of {runs} runs complete, {failed} failed)"

    @property
    def varied(self) -> tuple[str, ...]:
        """Settings that differ between the runs, as "section.key"."""
        return self.plan.varied

    @property
    def names(self) -> list[str]:
        """Names of the columns of numbers."""
        return [number.name for number in self.numbers]

    @property
    def table(self) -> Table:
        """A row a run: run, point, seed, varied settings, numbers, seconds, status; (runs,) each, NaN where empty."""
        return make_table(self.plan, self.outcomes, self.numbers)

    @property
    def summary(self) -> Table:
        """A row a point: its settings, complete runs n, mean and standard deviation of each number over them."""
        return summary(self.table, self.varied, self.names)

    @property
    def failures(self) -> list[Failure]:
        """Runs that failed, each with its line."""
        return [
            Failure(run.name, run.seed, run.settings, self.outcomes[run.name].line)
            for run in self.plan.runs
            if run.name in self.outcomes and self.outcomes[run.name].status == "failed"
        ]

    @property
    def complete(self) -> bool:
        """Whether every run came to its end."""
        return self.count("complete") == len(self.plan.runs)

    def count(self, status: Status) -> int:
        """Count the runs of a status: "complete", "failed" or "stopped"."""
        return sum(outcome.status == status for outcome in self.outcomes.values())

    def label(self, key: str) -> str:
        """Name of a setting with its unit."""
        return setting_label(key, self.settings.kind, self.varied)

    def words(self, key: str) -> str:
        """Name of a setting without its unit."""
        return self.label(key).partition(",")[0]

    def run(self, name: str) -> Run:
        """Open one of the runs by its name."""
        return open_run(self.folder / RUNS / name)

    @cached_property
    def planned(self) -> dict[str, PlannedRun]:
        """The runs by their names."""
        return {run.name: run for run in self.plan.runs}

    def write_tables(self) -> None:
        """Write table, summary and failures, each as a whole or not at all."""
        table = self.table
        write_whole(self.folder / TABLE, to_csv(table))
        write_whole(self.folder / PARQUET, to_parquet(table, self.numbers, self.settings.units, about(self.plan)))
        write_whole(self.folder / SUMMARY, to_csv(summary(table, self.varied, self.names)))
        rows = [(f.run, f.seed, *(f.settings.get(key) for key in self.varied), f.line) for f in self.failures]
        write_whole(self.folder / FAILURES, rows_to_csv(["run", "seed", *self.varied, "failure"], rows))

    def read_tables(self) -> None:
        """Take the outcomes from the tables in the folder; of runs that are not in them nothing is known."""
        lines = {row["run"]: row["failure"] for row in _rows(self.folder / FAILURES)}
        for row in _rows(self.folder / TABLE):
            name = row["run"]
            if name not in self.planned or row["status"] not in {"complete", "failed"}:
                continue
            numbers = {number: float(row[number] or np.nan) for number in self.names if number in row}
            seconds = float(row["seconds"] or np.nan)
            status = "complete" if row["status"] == "complete" else "failed"
            self.outcomes[name] = Outcome(name, status, lines.get(name, ""), seconds, numbers)  # type: ignore[arg-type]


def open_sweep(folder: str | Path) -> Sweep:
    """Open a sweep.

    Parameters
    ----------
    folder : str or Path
        Folder of the sweep.

    Returns
    -------
    Sweep
        Also of one that did not come to its end; its table is that of the last run that ended.

    Raises
    ------
    InputError
        When there is none, or it cannot be read.

    Examples
    --------
    >>> open_sweep("sweeps/none")
    Traceback (most recent call last):
    ...
    vasculo.errors.InputError: sweeps/none holds no sweep: there is no plan.json
    """
    home = Path(folder)
    if not (home / PLAN).is_file():
        raise InputError(f"{home} holds no sweep: there is no {PLAN}")
    plan = plan_from_json((home / PLAN).read_text(encoding="utf-8"), str(home / PLAN))
    found = Sweep(home, read_sweep(home / SWEEP), plan, look(plan, home / STUDY, str(home)))
    found.read_tables()
    return found


def _rows(path: Path) -> list[dict[str, str]]:
    """Rows of a CSV file, none when it is not there."""
    if not path.is_file():
        return []
    with path.open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))
