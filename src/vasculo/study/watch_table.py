"""The user's own watchers in a run: called in order, what they return becomes the rows of `watch.csv`."""

from __future__ import annotations

import csv
import io
from math import inf
from numbers import Real
from typing import TYPE_CHECKING, Any

from vasculo.errors import ComputationError, InputError
from vasculo.store.table import write_whole
from vasculo.study.faults import fault
from vasculo.study.watchers import STAGES, StopRun, stages_of

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from vasculo.pillars.state import RemodelStep
    from vasculo.study.beginning import Beginning
    from vasculo.study.watchers import Watched
    from vasculo.tissue.vasculogenesis import GrowthStep

WATCH_TABLE = "watch.csv"
"""Name of the file in the folder of a run."""

KEYS = ("stage", "step", "time")
"""Columns that every row has."""

_STAGE = {"growth": "vasculogenesis", "remodel": "angiogenesis"}


class UserWatchers:
    """Watchers of a study's own file, or given to `run`, as one.

    Parameters
    ----------
    watched : sequence of (str, callable)
        Stages and functions, in the order in which they are called.
    path : Path
        The table.
    done : mapping of stage to step
        Last step of each stage that is kept when the run goes on; rows behind it are dropped.
    """

    def __init__(self, watched: Sequence[Watched], path: Path, done: dict[str, float]) -> None:
        self.watched, self.path = tuple(watched), path
        rows = read_rows(path) if path.is_file() else []
        self._rows = [row for row in rows if float(row["step"]) <= done.get(row["stage"], -1.0)]
        if len(rows) != len(self._rows):
            self._write()

    def growth(self, step: GrowthStep) -> None:
        """Show a step of the vasculogenesis."""
        self._tell("growth", step)

    def remodel(self, step: RemodelStep) -> None:
        """Show a step of the angiogenesis.

        Raises
        ------
        StopRun
            When a watcher raised it; all of them have seen the step.
        """
        self._tell("remodel", step)

    def _tell(self, stage: str, step: Any) -> None:  # a GrowthStep or a RemodelStep
        row: dict[str, str] = {}
        stop: StopRun | None = None
        for function in (function for wanted, function in self.watched if wanted == stage):
            who = f"watcher {getattr(function, '__name__', repr(function))!r}"
            where = f"at step {step.step} of the {_STAGE[stage]}"
            try:
                found = function(step)
            except StopRun as asked:
                if stage == "growth":
                    raise ComputationError(f"{who} raised StopRun {where}: only the angiogenesis can end so") from None
                found, stop = None, asked
            except Exception as error:  # whatever the user's function raises
                raise ComputationError(f"{who} failed {where}: {fault(error)}") from error
            row |= _cells(found, row, f"{who} {where}")
        if row:
            self._rows.append({"stage": _STAGE[stage], "step": str(step.step), "time": repr(float(step.time))} | row)
            self._write()
        if stop is not None:
            raise stop

    def _write(self) -> None:
        """Write the table, whole or not at all."""
        columns = list(dict.fromkeys([*KEYS, *(name for row in self._rows for name in row)]))
        text = io.StringIO()
        writer = csv.DictWriter(text, columns, restval="", lineterminator="\n")
        writer.writeheader()
        writer.writerows(self._rows)
        write_whole(self.path, text.getvalue())


def sort_watchers(watchers: Sequence[object]) -> tuple[list[Watched], list[object]]:
    """Part functions that were registered with `watcher`, each with its stages, from objects with methods.

    Raises
    ------
    InputError
        For what is neither.
    """
    functions: list[Watched] = []
    others: list[object] = []
    for given in watchers:
        stages = stages_of(given)
        if not stages and not any(hasattr(given, name) for name in (*STAGES, "end")):
            raise InputError(
                f'watcher {getattr(given, "__name__", repr(given))!r} is not one: write @vasculo.watcher("remodel") '
                "above a function, or give an object with a method growth, remodel or end"
            )
        if stages and callable(given):
            functions += [(stage, given) for stage in stages]
        else:
            others.append(given)
    return functions, others


def user_watchers(begun: Beginning, functions: Sequence[Watched]) -> tuple[UserWatchers, ...]:
    """Make the watcher of a run from the functions of its study and some more; none where there are none."""
    watched = (*begun.settings.watchers, *functions)
    if not watched:
        return ()
    done = {"vasculogenesis": inf} if begun.checkpoint.plexus is not None else {}
    if begun.start is not None:
        done["angiogenesis"] = float(begun.start.step)
    return (UserWatchers(watched, begun.folder / WATCH_TABLE, done),)


def read_rows(path: Path) -> list[dict[str, str]]:
    """Read the rows of a table of watchers.

    Raises
    ------
    ComputationError
        When the file was changed so that it is no such table.
    """
    try:
        with path.open(newline="", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        for row in rows:
            float(row["step"])
    except (KeyError, TypeError, ValueError):
        raise ComputationError(f"{path} is no table of watchers any more: take it away") from None
    return rows


def _cells(found: object, row: dict[str, str], who: str) -> dict[str, str]:
    """Turn what a watcher returned into cells.

    Raises
    ------
    ComputationError
        When it is no dict of numbers, or its names are taken.
    """
    if found is None:
        return {}
    if not isinstance(found, dict):
        raise ComputationError(f"{who} returned {found!r:.60}: return a dict of numbers, or nothing")
    for name, value in found.items():
        if not isinstance(value, Real):
            raise ComputationError(f"{who} returned {name} = {value!r:.60}, which is no number")
        if name in KEYS or name in row:
            raise ComputationError(f"{who} returned {name!r}, a column that is taken: choose another name")
    return {str(name): _cell(value) for name, value in found.items()}


def _cell(value: Any) -> str:  # a number of any sort
    """Write a number so that it reads back exactly; empty where it does not apply."""
    number = float(value)
    if number != number:  # noqa: PLR0124  # NaN
        return ""
    return repr(int(value)) if number.is_integer() and not isinstance(value, float) else repr(number)
