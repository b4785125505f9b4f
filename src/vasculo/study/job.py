"""One run on its way: the stages in order, with the watchers attached and the files kept in step."""

from __future__ import annotations

import inspect
import resource
from contextlib import contextmanager
from dataclasses import dataclass, field, fields
from time import perf_counter
from typing import TYPE_CHECKING, Any

from vasculo import measure
from vasculo.errors import ComputationError, InputError
from vasculo.pillars.angiogenesis import is_done, remodel
from vasculo.plexus.extract import extract
from vasculo.store.read import CHECKPOINT
from vasculo.study import watch
from vasculo.study.drawn import drawn_domain
from vasculo.study.faults import naming_line
from vasculo.study.invariants import check_growth, check_remodelling
from vasculo.study.machine import machine
from vasculo.study.recorders import GrowthRecorder, RemodelRecorder
from vasculo.study.schema import parameter_meanings
from vasculo.study.sections import defaults_of, meanings_of
from vasculo.study.telling import tell_events
from vasculo.study.watchers import StopRun
from vasculo.tissue.lattice import lattice
from vasculo.tissue.vasculogenesis import grow_plexus

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence
    from pathlib import Path

    from vasculo.geometry.domain import Domain
    from vasculo.pillars.state import RemodelState
    from vasculo.springs.network import SpringNetwork
    from vasculo.store.checkpoint import Checkpoint
    from vasculo.store.record import Record
    from vasculo.study.folder import Log
    from vasculo.study.recorders import Table
    from vasculo.study.settings import Settings


@dataclass
class Job:
    """What the stages of one run share.

    Attributes
    ----------
    settings : Settings
        The study.
    folder : Path
        Folder of the run.
    record, table, log : Record, Table, Log
        Its files, open.
    checkpoint : Checkpoint
        What is finished.
    start : RemodelState or None
        Where the angiogenesis goes on, when it was begun.
    progress : Progress
        Who wants to see it.
    pause : callable
        Called at safe places; may raise KeyboardInterrupt.
    watchers : sequence of object
        More who look on, each with any of the methods `growth(step)`, `remodel(step)` and `end()`. They are called
        before a step is recorded; `remodel` may raise `StopRun`, and `end` is called in any case.
    """

    settings: Settings
    folder: Path
    record: Record
    table: Table
    log: Log
    checkpoint: Checkpoint
    start: RemodelState | None
    progress: watch.Progress
    pause: Callable[..., None]
    watchers: Sequence[object] = ()
    _result: str = field(default="", init=False)

    def work(self) -> None:
        """Go through the stages that are not finished yet."""
        try:
            self._work()
        finally:
            for end in watch.methods(self.watchers, "end"):
                end()

    def _work(self) -> None:
        self.record.set_facts("meanings", meanings_of(self.settings.kind))
        self.record.set_facts("defaults", defaults_of(self.settings.kind))
        self.record.set_facts("machine", machine())
        done = {stage["name"] for stage in self.checkpoint.stages}
        for name in self.settings.stages:
            if name not in done:
                with self.stage(name):
                    getattr(self, f"_{name}")()

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Time a stage, note its peak memory, and save the checkpoint behind it."""
        self.pause()
        self.progress.begin(name, "")
        self.log.line(f"{name}: begins")
        clock, before, self._result = perf_counter(), self.table.seconds(name), ""
        yield
        seconds = before + perf_counter() - clock
        fact = {"name": name, "seconds": round(seconds, 3), "peak_mb": round(peak_memory()), "result": self._result}
        self.checkpoint.stages.append(fact)
        self.checkpoint.frames = len(self.record)
        self.record.set_facts("stages", self.checkpoint.stages)
        self.checkpoint.save(self.folder / CHECKPOINT)
        self.log.line(f"{name}: {self._result} ({seconds:.1f} s, peak {fact['peak_mb']} MB)")
        self.progress.end(self._result)

    def _vasculogenesis(self) -> None:
        settings = self.settings
        tissue = lattice(**settings.tissue, seed=settings.study.seed)
        self.log.line(f"vasculogenesis: {len(tissue.points)} nodes, {len(tissue.springs)} springs")
        if tissue.box is not None:
            self.record.set_facts("tissue", {"box": tissue.box.tolist()})
        recorder = GrowthRecorder(self.record, self.table, settings.output.growth_interval(len(tissue.springs)))
        seen = watch.in_turn(
            check_growth,
            *watch.methods(self.watchers, "growth"),
            recorder,
            watch.growth_progress(self.progress),
            self.pause,
        )
        plexus = grow_plexus(tissue, settings.vasculogenesis, settings.study.seed, seen)
        recorder.flush()
        self.checkpoint.plexus = plexus
        try:
            self.record.set_facts("plexus", numbers_of(plexus))
        except (InputError, ComputationError) as error:  # the plexus itself is there
            self.log.line(f"plexus: not measured: {error}")
        left = len(plexus.springs) / len(tissue.springs)
        self._result = (
            f"{len(tissue.points)} nodes, {len(plexus.springs)} of {len(tissue.springs)} springs left ({left:.0%})"
        )

    def _extraction(self) -> None:
        found = extract(self._plexus, self.settings.extraction)
        meanings = parameter_meanings(inspect.getdoc(type(found.report)) or "")
        rows = found.report.rows().items()
        facts = [{"name": name, "value": value, "meaning": meanings.get(name, "")} for name, value in rows]
        self.record.set_facts("extraction", facts)
        self.record.set_facts("voids_of_pillar", [list(group) for group in found.lineage])
        self._keep(found.domain)
        for note in found.report.notes:
            self.log.line(f"extraction: {note}")
        merged = f", merged {found.report.merged}" if found.report.merged else ""
        self._result = f"voids {found.report.voids}, pillars {len(found.domain.pillars)}{merged}"

    def _domain(self) -> None:
        self._keep(drawn_domain(self.settings))
        self._result = f"pillars {len(self._domain_there.pillars)}"

    def _angiogenesis(self) -> None:
        settings, domain = self.settings, self._domain_there
        if self.start is not None:
            self.log.line(f"angiogenesis: goes on behind step {self.start.step}")
        recorder = RemodelRecorder(self.record, self.table, settings.output.step_every, self.start)
        rest = watch.in_turn(
            recorder,
            tell_events(self.log.line, self.progress.note),
            watch.remodel_progress(self.progress, settings.angiogenesis.steps),
            self.pause,
        )
        seen = watch.until_stopped(watch.in_turn(check_remodelling, *watch.methods(self.watchers, "remodel")), rest)
        ended = ""
        try:
            for parameters in settings.phases():
                if recorder.state is None or not is_done(recorder.state, parameters):
                    with naming_line(settings.laws):
                        remodel(domain, parameters, seen, start=recorder.state)
        except StopRun as stop:
            ended = f", ended by a watcher{f': {stop}' if str(stop) else ''}"
        state = _there(recorder.state)
        left, merges = len(state.rest_areas), state.merges_total
        self._result = f"pillars {len(domain.pillars)} to {left}, mergers {merges}, steps {state.step}{ended}"

    def _keep(self, domain: Domain) -> None:
        """Keep the domain before the remodelling."""
        self.checkpoint.domain = domain
        self.record.set_domain(domain)

    @property
    def _plexus(self) -> SpringNetwork:
        return _there(self.checkpoint.plexus)

    @property
    def _domain_there(self) -> Domain:
        return _there(self.checkpoint.domain)


def numbers_of(plexus: SpringNetwork) -> list[dict[str, Any]]:
    """Morphology of a plexus as facts: each single number with its name and meaning."""
    numbers, meanings = measure.plexus(plexus), parameter_meanings(inspect.getdoc(measure.PlexusNumbers) or "")
    values = ((field.name, getattr(numbers, field.name)) for field in fields(numbers))
    return [
        {"name": name, "value": value, "meaning": meanings[name]}
        for name, value in values
        if isinstance(value, int | float)
    ]


def _there(value: Any) -> Any:  # whichever result of an earlier stage
    """Return a result of an earlier stage."""
    if value is None:
        raise RuntimeError("a stage was reached before the one it builds on")
    return value


def peak_memory() -> float:
    """Largest memory that this process has held, MB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
