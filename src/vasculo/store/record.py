"""The record of a run: one VTKHDF file that grows by a frame a recorded step.

The group `VTKHDF` is what ParaView and pyvista show: springs as lines, the flow mesh as triangles, its boundary as
lines. The group `run` holds what they have no place for: the study, the domain, pillar outlines, lineage, events, the
states to go on from, the table.
"""

from __future__ import annotations

import errno
import json
import os
import secrets
import shutil
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np

from vasculo.errors import InputError
from vasculo.store.events import event_rows
from vasculo.store.frames import flow_frame, outlines, spring_frame
from vasculo.store.guarded import GuardedFile, uninterrupted
from vasculo.store.ragged import Ragged
from vasculo.store.states import SCALARS, state_rows
from vasculo.store.table import COLUMNS, STAGES, Row
from vasculo.store.vtkhdf import GridFrame, TransientGrid, extend

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from vasculo.geometry.domain import Domain
    from vasculo.pillars.events import Event
    from vasculo.pillars.state import RemodelStep

FORMAT, READABLE = 2, (1, 2)
"""Format that is written, and those that can be read; an older one cannot be continued."""

_REMODELLING = ("pillars", "events", "states")
_LAYOUT = ("VTKHDF", "run", "run/metrics", "run/pillars")
_ROOM = 4 * 2**20  # bytes that must stay free on the disk beyond what a frame needs


class Record:
    """A growing record; use `create` or `reopen`, and close it.

    Parameters
    ----------
    file : h5py.File
        Open for writing, laid out.
    guard : GuardedFile
        What lies under it.
    """

    def __init__(self, file: h5py.File, guard: GuardedFile) -> None:
        self.path = guard.path
        self._guard = guard
        self._file = file
        self._run = file["run"]
        self._grid = TransientGrid(file["VTKHDF"])
        self._remodelling = {name: Ragged(self._run.require_group(name)) for name in _REMODELLING}

    @classmethod
    def create(cls, path: Path, settings: str, version: str) -> Record:
        """Start a new record.

        Parameters
        ----------
        path : Path
            File to write; there must be none yet.
        settings : str
            The resolved study, as TOML.
        version : str
            Version of the program.
        """
        guard = GuardedFile(path, "x")
        file = h5py.File(guard, "w")
        try:
            file.create_group("VTKHDF")
            run = file.create_group("run")
            run.attrs.update({"format": FORMAT, "complete": 0, "version": version, "id": new_id()})
            run.create_dataset("settings", data=settings)
            for name in ("metrics", *_REMODELLING):
                run.create_group(name)
            run["states"].attrs["scalars"] = json.dumps(SCALARS)
            record = cls(file, guard)
            record._flush()
        except BaseException:
            file.close()
            guard.close()
            raise
        return record

    @classmethod
    def reopen(cls, path: Path, frames: int) -> Record:
        """Open a record to go on behind its first `frames` frames; what lies behind them is dropped.

        Raises
        ------
        InputError
            When the file is damaged, of an older format, or holds fewer frames.
        """
        record = cls._open(path, "continued")
        found = int(record._run.attrs["format"])  # noqa: SLF001  # one of this class
        if found != FORMAT:
            record.close()
            raise InputError(
                f"{path} has record format {found}, which can be read but not continued: "
                f"start the run anew in another folder"
            )
        if len(record) < frames:
            found = len(record)
            record.close()
            raise InputError(f"{path} holds {found} frames, the checkpoint expects {frames}: start the run anew")
        record._truncate(frames)  # noqa: SLF001  # one of this class
        return record

    @classmethod
    def amend(cls, path: Path) -> Record:
        """Open a complete record to change its facts.

        Raises
        ------
        InputError
            When the file is damaged.
        """
        return cls._open(path, "changed")

    @classmethod
    def _open(cls, path: Path, purpose: str) -> Record:
        """Open the record that is there; looked at first in a way that writes nothing."""
        guard = GuardedFile(path, "r+")
        file = None
        try:
            with h5py.File(guard, "r") as found:
                missing = [name for name in _LAYOUT if name not in found]
            if missing:
                raise InputError(f"there is no group {', '.join(missing)} in it")  # noqa: TRY301  # told below
            file = h5py.File(guard, "r+")
            return cls(file, guard)
        except (InputError, OSError, KeyError, ValueError, RuntimeError) as error:
            if file is not None:
                file.close()
            guard.close()
            raise InputError(f"{path} cannot be {purpose} ({first_line(error)}): start the run anew") from None

    def __len__(self) -> int:
        return len(self._grid)

    def add_springs(
        self,
        row: Row,
        points: NDArray[np.float64],
        velocities: NDArray[np.float64],
        springs: NDArray[np.int32],
        forces: NDArray[np.float64],
    ) -> None:
        """Append a frame of the tissue.

        Parameters
        ----------
        row : dict of str to float
            Numbers of this step, by column of the table.
        points, velocities : (n, 2) float64
            Nodes; model length, model length per time.
        springs : (m, 2) int32
            Living springs.
        forces : (m,) float64
            Their forces, positive when stretched.
        """
        self._add("vasculogenesis", row, spring_frame(points, velocities, springs, forces))

    def add_flow(self, row: Row, step: RemodelStep, events: Sequence[Event]) -> None:
        """Append a frame of the flow around the pillars, with the events since the frame before."""
        pillars = outlines(step)
        groups = {"pillars": pillars, "events": event_rows(events), "states": state_rows(step.state, pillars)}
        self._add("angiogenesis", row, flow_frame(step.mesh, step.flow), groups)

    def set_settings(self, settings: str, *, new: bool) -> None:
        """Store the text of the study anew; a record that was copied becomes one of its own (`new`)."""
        with self._writing():
            del self._run["settings"]
            self._run["settings"] = settings
            if new:
                self._run.attrs["id"] = new_id()

    def set_domain(self, domain: Domain) -> None:
        """Store the outer boundary; it is the same in every frame."""
        with self._writing():
            group = self._run.require_group("domain")
            for name in list(group):
                del group[name]
            group["outer"] = domain.outer
            group["sides"] = json.dumps(domain.sides)

    def facts(self, name: str) -> Any:  # whatever was stored
        """Return stored facts by name, an empty dict when there are none."""
        return json.loads(self._run[name].asstr()[()]) if name in self._run else {}

    def set_facts(self, name: str, facts: Mapping[str, Any] | Sequence[Any]) -> None:
        """Store named facts (numbers and words) under `run`, as JSON text: the extraction report, the stages."""
        with self._writing():
            if name in self._run:
                del self._run[name]
            self._run[name] = json.dumps(facts)

    def finish(self) -> None:
        """Mark the record as complete."""
        with self._writing():
            self._run.attrs.modify("complete", 1)

    def close(self) -> None:
        """Close the file; it can be read from now on."""
        with uninterrupted():
            try:
                self._file.close()
            finally:
                self._guard.close()
        self._guard.check()

    def _add(
        self, stage: str, row: Row, frame: GridFrame, groups: Mapping[str, Mapping[str, NDArray[Any]]] | None = None
    ) -> None:
        """Write one frame, its row of the table and its outlines; the frame counts once all of them are there."""
        number = float(STAGES.index(stage))
        fields = {"stage": number, "step": row["step"], "time": row["time"]}
        frame.field_data.update({name: np.array([value], dtype=np.float64) for name, value in fields.items()})
        require_room(self.path, sum(a.nbytes for a in (*frame.cell_data.values(), *frame.point_data.values())))
        with uninterrupted(), self._writing():
            for name in COLUMNS:
                value = number if name == "stage" else float(row.get(name, np.nan))
                extend(self._run["metrics"], name, np.array([value]))
            for name, arrays in (groups or {}).items():
                self._remodelling[name].append(arrays)
            self._grid.append(len(self._grid), frame)

    def _truncate(self, frames: int) -> None:
        with self._writing():
            self._grid.truncate(frames)
            metrics = self._run["metrics"]
            for name in list(metrics):
                metrics[name].resize(frames, axis=0)
            stages = metrics["stage"][:] if frames else np.empty(0)
            for rows in self._remodelling.values():
                rows.truncate(int(np.count_nonzero(stages == STAGES.index("angiogenesis"))))
            self._run.attrs.modify("complete", 0)

    @contextmanager
    def _writing(self) -> Iterator[None]:
        """Flush what the block wrote; when a write failed, tell that rather than what HDF5 made of it."""
        try:
            yield
            self._flush()
        except (OSError, RuntimeError, KeyError, ValueError):
            self._guard.check()
            raise

    def _flush(self) -> None:
        with uninterrupted():
            self._file.flush()
        self._guard.check()


def new_id() -> str:
    """Make a name for a run that no other has, 12 hexadecimal digits."""
    return secrets.token_hex(6)


def require_room(path: Path, need: int) -> None:
    """Raise OSError when the disk has no room for `need` bytes, before a file is torn by trying."""
    free = shutil.disk_usage(path.parent).free
    if free < need + _ROOM:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))


def first_line(error: BaseException) -> str:
    """Return the first line of an error's message."""
    return next(iter(str(error).splitlines()), type(error).__name__)
