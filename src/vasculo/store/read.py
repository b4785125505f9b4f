"""Open a run: its settings, its numbers and every recorded step, as the arrays and shapes the stages use."""

from __future__ import annotations

import json
import tomllib
from contextlib import contextmanager, suppress
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from vasculo import __version__
from vasculo.errors import InputError
from vasculo.geometry.domain import Domain
from vasculo.mesh.triangulation import Triangulation
from vasculo.pillars.events import Event
from vasculo.shown import Shown
from vasculo.store.events import events_of
from vasculo.store.frames import BOUNDARY
from vasculo.store.guarded import mend
from vasculo.store.ragged import Ragged
from vasculo.store.record import READABLE, first_line
from vasculo.store.shortened import open_to_read, shortened
from vasculo.store.states import state_of
from vasculo.store.steps import FlowFields, Frame, Pillars, Springs
from vasculo.store.table import COLUMNS, STAGES, from_csv
from vasculo.store.units import Units
from vasculo.store.vtkhdf import TransientGrid

if TYPE_CHECKING:
    from collections.abc import Callable, Container, Iterator

    import h5py
    from numpy.typing import NDArray

    from vasculo.pillars.state import RemodelState

    Floats = NDArray[np.float64]
    Columns = dict[str, Floats]

__all__ = ["FlowFields", "Frame", "Pillars", "Run", "Springs", "open_run"]

RECORD = "run.vtkhdf"
CHECKPOINT = "checkpoint.h5"
STUDY = "study.toml"
TABLE = "metrics.csv"
REPORT = "report.html"
FIGURES = "figures"
LOG = "log.txt"


class Run(Shown):
    """A run on disk; made by `open_run`. The file is open only while something is read from it.

    Attributes
    ----------
    folder : Path
        Folder of the run.
    path : Path
        Its record.
    complete : bool
        Whether the run came to its end, and all of its record is there.
    damage : str
        What is missing of a record that was cut short, in words; empty when it is all there.
    version : str
        Version of the program that made it.
    id : str
        Name of the run that no other has, 12 hexadecimal digits; empty for records of format 1.
    settings : dict
        The resolved study, as read from its TOML text.
    frames : tuple of Frame
        What was recorded, in order; of a record that was cut short the steps that are whole.
    metrics : dict of str to array
        The table of numbers, a row a recorded step: `stage` as text, the other columns float64 with NaN where a cell
        does not apply.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.folder = path.parent
        self.damage = shortened(path)
        with open_to_read(path) as file:
            run = file["run"]
            self.version = str(run.attrs["version"])
            _require_readable(path, int(run.attrs["format"]), self.version)
            self.complete = bool(run.attrs["complete"])
            self.id = str(run.attrs.get("id", ""))
            self.settings_text = self._settings_text(run)
            columns = _columns(run, len(TransientGrid(file["VTKHDF"])))
        self.settings: dict[str, Any] = tomllib.loads(self.settings_text)
        numbers = columns.pop("stage")
        if self.damage:
            self.complete = False
            columns, numbers = self._with_table(columns, numbers)
        self.metrics: dict[str, NDArray[Any]] = {"stage": np.array([STAGES[int(n)] for n in numbers], dtype="<U16")}
        self.metrics |= columns
        steps, times = columns["step"], columns["time"]
        self.frames = tuple(Frame(i, STAGES[int(n)], int(steps[i]), float(times[i])) for i, n in enumerate(numbers))
        if self.damage:
            self.frames = tuple(frame for frame in self.frames if self._is_whole(frame))
            if not self.frames:
                raise OSError(f"no one of {len(numbers)} recorded steps is whole")

    @property
    def caveat(self) -> str:
        """What to know before relying on this run, one line; empty when it came to its end and is all there."""
        if self.damage:
            whole, steps = len(self.frames), len(self.metrics["stage"])
            return f"{self.path} is {self.damage}; {whole} of {steps} recorded steps are whole and can be read"
        go_on = f"vasculo run --resume --out {self.folder} goes on"
        return "" if self.complete else f"incomplete: the run stopped before its end; {go_on}"

    def __repr__(self) -> str:
        state = "cut short" if self.damage else "complete" if self.complete else "incomplete"
        return f"Run({str(self.folder)!r}, {state}, {len(self.frames)} recorded steps)"

    @property
    def units(self) -> Units:
        """Physical units that the study names, for the model viscosity that it computes with."""
        named = Units(**self.settings.get("units", {}))
        if named.viscosity is None:
            return named
        return replace(named, viscosity=named.viscosity / self.settings.get("angiogenesis", {}).get("viscosity", 1.0))

    def steps(self, stage: str = "angiogenesis") -> list[int]:
        """List the recorded steps of a stage."""
        return [frame.step for frame in self.frames if frame.stage == stage]

    def frame(self, stage: str, step: int | None = None) -> Frame:
        """Return the recorded step nearest to `step` of a stage; the last one when it is None.

        Raises
        ------
        InputError
            When nothing was recorded of that stage.
        """
        found = [frame for frame in self.frames if frame.stage == stage]
        if not found:
            raise InputError(f"{self.folder} has no recorded step of {stage}")
        return found[-1] if step is None else min(found, key=lambda frame: abs(frame.step - step))

    def network(self, step: int | None = None) -> Springs:
        """Tissue at a step of the vasculogenesis, the last one when `step` is None."""
        grid = self._read(lambda file, i: TransientGrid(file["VTKHDF"]).read(i, {"force"}), "vasculogenesis", step)
        velocities = grid.point_data["node_velocity"][:, :2]
        return Springs(grid.points, velocities, grid.lines.astype(np.int32), grid.cell_data["force"], self.period)

    def flow(self, step: int | None = None) -> FlowFields:
        """Flow at a step of the angiogenesis, the last one when `step` is None."""
        grid = self._read(lambda file, i: TransientGrid(file["VTKHDF"]).read(i), "angiogenesis", step)
        edges = len(grid.lines)
        if np.any(grid.cell_data["kind"][:edges] != BOUNDARY):
            raise InputError(f"{self.path} is damaged: a step of the angiogenesis holds springs")
        lines, tags = grid.lines.astype(np.int32), grid.cell_data["tag"][:edges]
        mesh = Triangulation(grid.points, grid.triangles.astype(np.int32), lines, tags, self._sides)
        shear = grid.cell_data["wall_shear"][:edges]
        walls = np.isfinite(shear)
        return FlowFields(
            mesh=mesh,
            velocity=grid.cell_data["velocity"][edges:, :2],
            pressure=grid.cell_data["pressure"][edges:],
            nodes=grid.point_data["node_velocity"][:, :2],
            wall_edges=lines[walls],
            wall_pillar=np.maximum(tags[walls], -1),
            wall_shear=shear[walls],
        )

    def mesh(self, step: int | None = None) -> Triangulation:
        """Flow mesh at a step of the angiogenesis."""
        return self.flow(step).mesh

    def pillars(self, step: int | None = None) -> Pillars:
        """Pillars at a step of the angiogenesis, the last one when `step` is None."""
        data = self._rows("pillars", step)
        return Pillars(
            outlines=_split(data["points"], data["sizes"]),
            lineage=_lineage(data),
            activation=_split(data["activation"], data["sizes"]),
            node_shear=_split(data["node_shear"], data["sizes"]),
            events=self._events(step),
        )

    def lineage(self, step: int | None = None) -> tuple[tuple[int, ...], ...]:
        """Original pillars in each pillar at a step of the angiogenesis, the last one when `step` is None."""
        return _lineage(self._rows("pillars", step, {"members", "member_sizes"}))

    @cached_property
    def events(self) -> tuple[Event, ...]:
        """All that happened to pillars in the angiogenesis, in order; of records of format 1 the mergers only."""
        return tuple(event for step in self.steps() for event in self._events(step))

    def state(self, step: int | None = None) -> RemodelState:
        """Return the state of the angiogenesis at a step, the last one when `step` is None: `remodel` goes on from it.

        Raises
        ------
        InputError
            When the record is of format 1, which holds none.
        """
        if not self._holds("states/ends/scalars"):
            raise InputError(f"{self.path} holds no states to go on from: it is of an earlier version")
        with _reading(self.path, " in its states"), open_to_read(self.path) as file:
            scalars = tuple(json.loads(file["run/states"].attrs["scalars"]))
        frame = self._rows("pillars", step, {"points", "sizes", "members", "member_sizes"})
        return state_of(self._rows("states", step), scalars, frame)

    def _events(self, step: int | None) -> tuple[Event, ...]:
        """Events between a recorded step and the one before it."""
        if self._holds("events/ends/step"):
            return events_of(self._rows("events", step))
        frame, nowhere = self.frame("angiogenesis", step), (np.nan, np.nan)
        angles = self._rows("pillars", step, {"merge_angles"})["merge_angles"].tolist()
        return tuple(Event(frame.step, frame.time, "merge", nowhere, (), angle) for angle in angles)

    def domain(self, step: int | None = None) -> Domain:
        """Domain at a step of the angiogenesis, the last one when `step` is None."""
        with _reading(self.path, " in its domain"), open_to_read(self.path) as file:
            if "domain" not in file["run"]:
                raise InputError(f"{self.folder} has no domain: the run did not come to the extraction")
            outer = file["run/domain/outer"][:]
        sides = self._fact("domain/sides")
        return Domain(outer, self.pillars(step).outlines, sides)

    def facts(self, name: str) -> Any:  # whatever was stored: numbers and words
        """Return stored facts by name ("extraction", "stages", ...), an empty dict when there are none."""
        return self._fact(name) if self._holds(name) else {}

    @cached_property
    def period(self) -> tuple[float, float] | None:
        """Width and height of the box of a periodic tissue, model length; None when the tissue is not periodic."""
        box = self.facts("tissue").get("box")
        return None if box is None else (float(box[0]), float(box[1]))

    @cached_property
    def _sides(self) -> tuple[str, ...]:
        return tuple(sorted(set(self._fact("domain/sides"))))

    def _fact(self, name: str) -> Any:  # whatever was stored
        with _reading(self.path, f" in its {name}"), open_to_read(self.path) as file:
            return json.loads(str(file[f"run/{name}"].asstr()[()]))

    def _holds(self, name: str) -> bool:
        with _reading(self.path, f" in its {name}"), open_to_read(self.path) as file:
            return f"run/{name}" in file

    def _settings_text(self, run: h5py.Group) -> str:
        """Read the study; of a record that was cut short from the file beside it, where need be."""
        try:
            return str(run["settings"].asstr()[()])
        except (OSError, KeyError):
            if not self.damage:
                raise
            return (self.folder / STUDY).read_text()

    def _with_table(self, columns: Columns, numbers: Floats) -> tuple[Columns, Floats]:
        """Fill columns that cannot be read any more from the table beside the record."""
        try:
            stages, rows = from_csv(self.folder / TABLE)
        except (OSError, ValueError, IndexError):
            return columns, numbers
        count = len(numbers)
        if len(stages) < count:
            return columns, numbers
        columns |= {name: rows[name][:count] for name, column in columns.items() if np.isnan(column).all()}
        return columns, np.array([STAGES.index(stage) for stage in stages[:count]], dtype=np.float64)

    def _is_whole(self, frame: Frame) -> bool:
        """Whether everything of a step can be read."""
        try:
            if frame.stage == "vasculogenesis":
                self.network(frame.step)
            else:
                self.flow(frame.step)
                self.pillars(frame.step)
        except InputError:
            return False
        return True

    def _rows(self, group: str, step: int | None, wanted: Container[str] | None = None) -> dict[str, NDArray[Any]]:
        """Read arrays of a step of the angiogenesis from a group of ragged arrays."""
        first = int(np.count_nonzero(self.metrics["stage"] != "angiogenesis"))
        return self._read(lambda file, i: Ragged(file[f"run/{group}"]).read(i - first, wanted), "angiogenesis", step)

    def _read(self, read: Callable[[h5py.File, int], Any], stage: str, step: int | None) -> Any:
        """Read one frame, with the file open for just that long."""
        frame = self.frame(stage, step)
        with _reading(self.path, f" at {stage} step {frame.step}"), open_to_read(self.path) as file:
            return read(file, frame.index)


def open_run(path: str | Path) -> Run:
    """Open a run.

    Parameters
    ----------
    path : str or Path
        Folder of the run, or its `run.vtkhdf`.

    Returns
    -------
    Run
        Also of a run that did not come to its end, and of a record that was cut short, with the steps that are whole:
        look at `complete` and `caveat`. No file is changed.

    Raises
    ------
    InputError
        When there is no run, its record is of another kind, of a later version, or damaged, or no step of it is whole.

    Examples
    --------
    >>> import vasculo as vc
    >>> run = vc.open_run("runs/disk")  # doctest: +SKIP
    >>> run.steps(), run.metrics["permeability"][-1]  # doctest: +SKIP
    >>> vc.open_run("nowhere")
    Traceback (most recent call last):
        ...
    vasculo.errors.InputError: nowhere holds no run: there is no run.vtkhdf; `vasculo run --out nowhere` would make one
    """
    given = Path(path)
    record = given / RECORD if given.is_dir() else given
    if not record.is_file():
        raise InputError(f"{given} holds no run: there is no {RECORD}; `vasculo run --out {given}` would make one")
    try:
        mend(record)
        return Run(record)
    except BlockingIOError:
        raise InputError(f"{record} is being written by a run that goes on: wait for its end") from None
    except InputError:
        raise
    except (OSError, KeyError, ValueError, IndexError, OverflowError, RuntimeError) as error:
        if missing := shortened(record):
            raise InputError(_what_is_left(record, missing)) from None
        raise InputError(f"{record} is no readable record of a run: {first_line(error)}") from None


def _require_readable(path: Path, found: int, version: str) -> None:
    """Refuse a record of a format that this version does not know."""
    if found not in READABLE:
        known = " and ".join(map(str, READABLE))
        raise InputError(
            f"{path} has record format {found}, made by vasculo {version}; vasculo {__version__} reads formats "
            f"{known}: vasculo {version} or a later one is needed"
        )


def _columns(run: h5py.Group, count: int) -> Columns:
    """Read the table of a record; a column that it does not have, or not any more, is NaN."""
    columns = {name: np.full(count, np.nan) for name in COLUMNS}
    for name in COLUMNS:
        with suppress(OSError, KeyError):
            columns[name][:] = run[f"metrics/{name}"][:count]
    return columns


def _what_is_left(record: Path, missing: str) -> str:
    """Say what there is beside a record of which nothing can be read, and how to go on."""
    line = f"{record} is {missing}, and no step is whole"
    if (record.parent / TABLE).is_file():
        line += f"; the numbers of all steps are in {TABLE}"
    study = record.parent / STUDY
    return f"{line}; the settings are in {STUDY}: `vasculo run {study}` runs it again" if study.is_file() else line


@contextmanager
def _reading(path: Path, where: str) -> Iterator[None]:
    """Turn what HDF5 says of a record it cannot read into one line with the file and a way out."""
    try:
        yield
    except InputError:
        raise
    except BlockingIOError:
        raise InputError(f"{path} is being written by a run that goes on: wait for its end") from None
    except (OSError, KeyError, ValueError, IndexError, RuntimeError) as error:
        raise InputError(
            f"{path} is damaged{where} ({first_line(error)}): bring back a sound copy, or run the study anew"
        ) from None


def _lineage(rows: dict[str, NDArray[Any]]) -> tuple[tuple[int, ...], ...]:
    return tuple(tuple(group.tolist()) for group in _split(rows["members"], rows["member_sizes"]))


def _split(rows: NDArray[Any], sizes: NDArray[np.int32]) -> list[NDArray[Any]]:
    return np.split(rows, np.cumsum(sizes)[:-1]) if len(sizes) else []
