"""What watches the stages: invariants, record, checkpoint and progress, each a small object of its own.

A stage calls one function once a step; `Watchers` passes the call on to each watcher in turn.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from time import perf_counter
from typing import TYPE_CHECKING, Protocol, TypeVar

import numpy as np

from vasculo.errors import ComputationError
from vasculo.store.table import to_csv, write_whole
from vasculo.study.rows import growth_row, remodel_row

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from vasculo.pillars.state import Merge, RemodelStep
    from vasculo.store.checkpoint import Checkpoint
    from vasculo.store.record import Record
    from vasculo.store.table import Row
    from vasculo.tissue.vasculogenesis import GrowthStep

Step = TypeVar("Step")

MASS_LIMIT = 1e-6
"""Relative error of the mass balance above which a run stops; a sound solve is below 1e-9."""


class Progress(Protocol):
    """What shows how far a run has come; the command line draws bars, a script may pass its own."""

    def begin(self, stage: str, text: str) -> None:
        """Say that a stage begins."""

    def advance(self, done: float, total: float, text: str) -> None:
        """Say how far the stage is, with its numbers in words."""

    def end(self, text: str) -> None:
        """Say that the stage is done, with what came out."""


class Silence:
    """Progress that nobody sees."""

    def begin(self, stage: str, text: str) -> None:
        """Do nothing."""

    def advance(self, done: float, total: float, text: str) -> None:
        """Do nothing."""

    def end(self, text: str) -> None:
        """Do nothing."""


@dataclass
class GrowthInvariants:
    """Stop when the tissue is no longer finite."""

    def __call__(self, step: GrowthStep) -> None:
        """Check one step."""
        bad = np.flatnonzero(~np.isfinite(step.network.points).all(axis=1))
        if bad.size:
            raise ComputationError(
                f"vasculogenesis step {step.step} (time {step.time:g}): {bad.size} of {len(step.network.points)} nodes "
                f"are not finite, the first is node {bad[0]}; lower vasculogenesis.dt"
            )


@dataclass
class RemodelInvariants:
    """Stop when pillars, mesh or flow break what must hold: finite numbers, positive areas, balanced mass."""

    def __call__(self, step: RemodelStep) -> None:
        """Check one step."""
        where = f"angiogenesis step {step.step}"
        areas = step.domain.pillar_areas
        if not (areas > 0.0).all():
            raise ComputationError(f"{where}: pillar {int(np.argmin(areas))} has area {areas.min():.3g}")
        for name in ("velocity", "pressure", "wall_shear"):
            values = getattr(step.flow, name)
            if not np.isfinite(values).all():
                bad = int(np.count_nonzero(~np.isfinite(values)))
                raise ComputationError(f"{where}: {bad} of {values.size} values of the {name} are not finite")
        off = step.flow.mass_imbalance
        if not off <= MASS_LIMIT:
            raise ComputationError(f"{where}: the mass balance of the flow is off by {off:.2g}, above {MASS_LIMIT:g}")


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
    """Record steps of the angiogenesis and save the checkpoint behind each.

    Parameters
    ----------
    record, table : Record, Table
        Where to.
    checkpoint : Checkpoint
        Gets the state of the last recorded step.
    path : Path
        The checkpoint's file.
    every : int
        Record every so many steps; the first and the last in any case.
    """

    record: Record
    table: Table
    checkpoint: Checkpoint
    path: Path
    every: int
    _merges: list[Merge] = field(default_factory=list)
    _clock: float = field(default_factory=perf_counter)

    def __call__(self, step: RemodelStep) -> None:
        """Record one step."""
        self._merges += step.merges
        if step.step % self.every and step.step != step.steps_total:
            return
        now = perf_counter()
        row = remodel_row(step, now - self._clock)
        self.record.add_flow(row, step, self._merges)
        self._merges.clear()
        self.table.add("angiogenesis", row)
        self.checkpoint.seconds += now - self._clock
        self._clock = now
        self.checkpoint.frames = len(self.record)
        self.checkpoint.state = step.state
        self.checkpoint.save(self.path)


def growth_progress(progress: Progress) -> Callable[[GrowthStep], None]:
    """Show the vasculogenesis."""

    def show(step: GrowthStep) -> None:
        text = f"{step.phase}: {len(step.network.springs)} springs, voids {step.void_fraction:.0%} in {step.voids}"
        progress.advance(step.step, step.steps_total, text)

    return show


def remodel_progress(progress: Progress) -> Callable[[RemodelStep], None]:
    """Show the angiogenesis."""

    def show(step: RemodelStep) -> None:
        text = f"step {step.step}: pillars {len(step.domain.pillars)}, mergers {step.merges_total}"
        progress.advance(step.step, step.steps_total, f"{text}, triangles {len(step.mesh.triangles)}")

    return show


def in_turn(*watchers: Callable[[Step], object]) -> Callable[[Step], None]:
    """Join watchers into one: each is called in the order given."""

    def call(step: Step) -> None:
        for watcher in watchers:
            watcher(step)

    return call
