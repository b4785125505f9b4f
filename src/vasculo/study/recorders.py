"""Watchers that write: each step that is to be kept goes to the record and the table."""

from __future__ import annotations

from dataclasses import dataclass, field
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from vasculo.store.table import to_csv, write_whole
from vasculo.study.rows import growth_row, remodel_row

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from vasculo.pillars.events import Event
    from vasculo.pillars.state import RemodelState, RemodelStep
    from vasculo.store.record import Record
    from vasculo.store.table import Row
    from vasculo.tissue.vasculogenesis import GrowthStep


@dataclass
class Table:
    """The rows so far, written out as `metrics.csv` after each.

    Parameters
    ----------
    path : Path
        The file.
    rows : list of (stage, Row)
        Rows of before, when a run is continued.
    """

    path: Path
    rows: list[tuple[str, Row]] = field(default_factory=list)

    def add(self, stage: str, row: Row) -> None:
        """Add a row and write the table."""
        self.rows.append((stage, row))
        self.write()

    def seconds(self, stage: str) -> float:
        """Wall time of a stage up to its last row."""
        return sum(row.get("seconds", 0.0) for name, row in self.rows if name == stage)

    def write(self) -> None:
        """Write the table, whole or not at all."""
        names = sorted({name for _, row in self.rows for name in row})
        columns = {name: np.array([row.get(name, np.nan) for _, row in self.rows], dtype=float) for name in names}
        write_whole(self.path, to_csv([stage for stage, _ in self.rows], columns))


@dataclass
class GrowthRecorder:
    """Record every so many checks of the vasculogenesis, and the first and the last check of each phase.

    The last check of a phase is known only when the next phase begins, so a check that was not recorded waits.
    """

    record: Record
    table: Table
    every: int
    _waiting: Callable[[], None] | None = None
    _phase: str = ""
    _count: int = 0
    _clock: float = field(default_factory=perf_counter)

    def __call__(self, step: GrowthStep) -> None:
        """Record one check, or keep it for later."""
        if step.phase != self._phase:
            self.flush()
            self._phase, self._count = step.phase, 0
        write = self._writing(step)
        if self._count % self.every == 0:
            self._waiting = None
            write()
        else:
            self._waiting = write
        self._count += 1

    def flush(self) -> None:
        """Record the check that waits, if one does."""
        if self._waiting is not None:
            self._waiting()
            self._waiting = None

    def _writing(self, step: GrowthStep) -> Callable[[], None]:
        """Note the time and return the writing of a check; its network is a copy that stays as it is."""
        now = perf_counter()

        def write() -> None:
            net = step.network
            row = growth_row(step, now - self._clock)
            self._clock = now
            self.record.add_springs(row, net.points, net.velocities, net.springs, net.tensions())
            self.table.add("vasculogenesis", row)

        return write


@dataclass
class RemodelRecorder:
    """Record steps of the angiogenesis.

    Parameters
    ----------
    record, table : Record, Table
        Where to.
    every : int
        Record every so many steps; the first and the last in any case.
    state : RemodelState, optional
        Of the last recorded step.
    """

    record: Record
    table: Table
    every: int
    state: RemodelState | None = None
    _events: list[Event] = field(default_factory=list)
    _clock: float = field(default_factory=perf_counter)

    def __call__(self, step: RemodelStep) -> None:
        """Record one step."""
        self._events += step.events
        if step.step % self.every and not step.is_last:
            return
        now = perf_counter()
        row = remodel_row(step, now - self._clock, len(self._events))
        self.record.add_flow(row, step, self._events)
        self._events.clear()
        self.table.add("angiogenesis", row)
        self._clock = now
        self.state = step.state
