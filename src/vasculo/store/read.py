"""Open a run: its settings, its numbers and every recorded step, as the arrays and shapes the stages use."""

from __future__ import annotations

import json
import tomllib
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np

from vasculo.errors import InputError
from vasculo.geometry.domain import Domain
from vasculo.mesh.triangulation import Triangulation
from vasculo.pillars.events import Event
from vasculo.store.events import events_of
from vasculo.store.frames import BOUNDARY
from vasculo.store.guarded import mend
from vasculo.store.ragged import Ragged
from vasculo.store.record import READABLE, first_line
from vasculo.store.states import state_of
from vasculo.store.table import COLUMNS, STAGES
from vasculo.store.units import Units
from vasculo.store.vtkhdf import TransientGrid

if TYPE_CHECKING:
    from collections.abc import Callable, Container, Iterator

    from numpy.typing import NDArray

    from vasculo.pillars.state import RemodelState

RECORD = "run.vtkhdf"
CHECKPOINT = "checkpoint.h5"
STUDY = "study.toml"
TABLE = "metrics.csv"
REPORT = "report.html"
FIGURES = "figures"
LOG = "log.txt"


@dataclass(frozen=True)
class Frame:
    """One recorded step: where it stands in the record, its stage, step and time."""

    index: int
    stage: str
    step: int
    time: float


@dataclass(frozen=True)
class Springs:
    """The tissue at one recorded step.

    Attributes
    ----------
    points, velocities : (n, 2) float64
        Nodes; model length, model length per time.
    springs : (m, 2) int32
        Living springs.
    forces : (m,) float64
        Their forces, positive when stretched.
    box : tuple of float or None
        Width and height of the box of a periodic tissue, which begins at the origin; model length. None: not periodic.
    """

    points: NDArray[np.float64]
    velocities: NDArray[np.float64]
    springs: NDArray[np.int32]
    forces: NDArray[np.float64]
    box: tuple[float, float] | None = None


@dataclass(frozen=True)
class FlowFields:
    """The flow at one recorded step, under the names of `vasculo.Flow`.

    Attributes
    ----------
    mesh : Triangulation
        Flow mesh.
    velocity, pressure : (t, 2) and (t,) float64
        Values a triangle; model length per time, model pressure.
    nodes : (n, 2) float64
        Velocity at the mesh nodes.
    wall_edges : (w, 2) int32
        No-slip edges, fluid on the left.
    wall_pillar : (w,) int32
        Pillar of each, -1 for the outer wall.
    wall_shear : (w,) float64
        Signed wall shear along the edge, model pressure.
    """

    mesh: Triangulation
    velocity: NDArray[np.float64]
    pressure: NDArray[np.float64]
    nodes: NDArray[np.float64]
    wall_edges: NDArray[np.int32]
    wall_pillar: NDArray[np.int32]
    wall_shear: NDArray[np.float64]

    def node_velocity(self) -> NDArray[np.float64]:
        """Velocity at the mesh nodes; (n, 2) float64."""
        return self.nodes


@dataclass(frozen=True)
class Pillars:
    """The pillars at one recorded step.

    Attributes
    ----------
    outlines : list of (k, 2) float64
        Counter-clockwise, model length.
    lineage : tuple of tuple of int
        Original pillars in each.
    activation, node_shear : list of (k,) float64
        Activation (-1 to 1) and magnitude of the wall shear at each node.
    events : tuple of Event
        What happened since the recorded step before; of records of format 1 the mergers only, without place and
        pillars.
    """

    outlines: list[NDArray[np.float64]]
    lineage: tuple[tuple[int, ...], ...]
    activation: list[NDArray[np.float64]]
    node_shear: list[NDArray[np.float64]]
    events: tuple[Event, ...]

    @property
    def merge_angles(self) -> NDArray[np.float64]:
        """Directions of the mergers among the events, degrees against x; (m,) float64."""
        return np.array([event.angle for event in self.events if event.kind == "merge"], dtype=np.float64)


class Run:
    """A run on disk; made by `open_run`. The file is open only while something is read from it.

    Attributes
    ----------
    folder : Path
        Folder of the run.
    path : Path
        Its record.
    complete : bool
        Whether the run came to its end.
    version : str
        Version of the program that made it.
    id : str
        Name of the run that no other has, 12 hexadecimal digits; empty for records of format 1.
    settings : dict
        The resolved study, as read from its TOML text.
    frames : tuple of Frame
        What was recorded, in order.
    metrics : dict of str to array
        The table of numbers: `stage` as text, the other columns float64 with NaN where a cell does not apply.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.folder = path.parent
        with h5py.File(path) as file:
            run = file["run"]
            if run.attrs["format"] not in READABLE:
                known = " and ".join(map(str, READABLE))
                raise InputError(f"{path} has record format {run.attrs['format']}, this version reads format {known}")
            self.complete = bool(run.attrs["complete"])
            self.version = str(run.attrs["version"])
            self.id = str(run.attrs.get("id", ""))
            self.settings_text = run["settings"].asstr()[()]
            count = len(TransientGrid(file["VTKHDF"]))
            columns = {name: run["metrics"][name][:count] for name in COLUMNS if name in run["metrics"]}
        self.settings: dict[str, Any] = tomllib.loads(self.settings_text)
        numbers = columns.pop("stage", np.empty(0)).astype(int)
        self.metrics: dict[str, NDArray[Any]] = {"stage": np.array([STAGES[n] for n in numbers], dtype="<U16")}
        self.metrics |= columns
        self.frames = tuple(
            Frame(i, STAGES[n], int(columns["step"][i]), float(columns["time"][i])) for i, n in enumerate(numbers)
        )

    def __repr__(self) -> str:
        state = "complete" if self.complete else "incomplete"
        return f"Run({str(self.folder)!r}, {state}, {len(self.frames)} recorded steps)"

    @property
    def units(self) -> Units:
        """Physical units that the study names."""
        return Units(**self.settings.get("units", {}))

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
        with _reading(self.path, " in its states"), h5py.File(self.path) as file:
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
        with _reading(self.path, " in its domain"), h5py.File(self.path) as file:
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
        with _reading(self.path, f" in its {name}"), h5py.File(self.path) as file:
            return json.loads(str(file[f"run/{name}"].asstr()[()]))

    def _holds(self, name: str) -> bool:
        with _reading(self.path, f" in its {name}"), h5py.File(self.path) as file:
            return f"run/{name}" in file

    def _rows(self, group: str, step: int | None, wanted: Container[str] | None = None) -> dict[str, NDArray[Any]]:
        """Read arrays of a step of the angiogenesis from a group of ragged arrays."""
        first = self.frame("angiogenesis").index + 1 - len(self.steps("angiogenesis"))
        return self._read(lambda file, i: Ragged(file[f"run/{group}"]).read(i - first, wanted), "angiogenesis", step)

    def _read(self, read: Callable[[h5py.File, int], Any], stage: str, step: int | None) -> Any:
        """Read one frame, with the file open for just that long."""
        frame = self.frame(stage, step)
        with _reading(self.path, f" at {stage} step {frame.step}"), h5py.File(self.path) as file:
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
        Also of a run that did not come to its end: look at `complete`.

    Raises
    ------
    InputError
        When there is no run, or its record is of another kind or damaged.
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
    except (OSError, KeyError, ValueError, IndexError, OverflowError, RuntimeError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{record} is no readable record of a run: {first_line(error)}") from None


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
