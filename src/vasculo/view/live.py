"""A run on its way, shown while it goes: a watcher that sends steps to the viewer and stays out of the way."""

from __future__ import annotations

from contextlib import contextmanager
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from vasculo.draw.flow import mesh_box
from vasculo.draw.springs import whole_tissue
from vasculo.store.read import Springs
from vasculo.view import words
from vasculo.view.layers import Scales
from vasculo.view.layout import layout
from vasculo.view.numbers import COLUMNS, EARLY
from vasculo.view.plane import Plane
from vasculo.view.show import new_recording, open_browser, serving
from vasculo.view.stage import Stage

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping, Sequence

    from vasculo.pillars.state import RemodelStep
    from vasculo.store.units import Units
    from vasculo.tissue.step import GrowthStep
    from vasculo.view.plane import Box
    from vasculo.view.sdk import rerun

    Row = Mapping[str, float]

SHARE = 0.04
"""Share of the run's time that showing it may take; steps are left out to keep it."""
OFTEN = 0.25
"""Seconds between two steps at least."""
SMALL = 128 * 2**20
"""Bytes of the stream after which half as many steps are sent, and again after as many: so it stays small."""


class Live:
    """A watcher of a run that shows it; whatever goes wrong here, the run goes on.

    Parameters
    ----------
    recording : RecordingStream
        Where to.
    units : Units
        For keys and plots.
    growth_row, remodel_row : callable
        From a step and the seconds since the last one to its row of the table.
    size : callable
        Bytes of the stream so far.
    tell : callable
        Is told when the viewer had to be given up.
    clock : callable
        Seconds.
    """

    def __init__(
        self,
        recording: rerun.RecordingStream,
        units: Units,
        growth_row: Callable[[GrowthStep, float], Row],
        remodel_row: Callable[[RemodelStep, float], Row],
        size: Callable[[], int] = lambda: 0,
        tell: Callable[[str], object] = print,
        clock: Callable[[], float] = perf_counter,
    ) -> None:
        self.recording, self.units, self.size, self.tell, self.clock = recording, units, size, tell, clock
        self.growth_row, self.remodel_row = growth_row, remodel_row
        self.shown, self.left_out = 0, 0
        self._boxes: list[Box] = []
        self._stage: Stage | None = None
        self._scales: Scales | None = None
        self._waiting: GrowthStep | None = None
        self._next = -np.inf
        self._given_up = False

    def growth(self, step: GrowthStep) -> None:
        """Show a step of the vasculogenesis, or keep it in case it is the last."""
        if self._due():
            self._show(lambda: self._tissue(step))
        else:
            self._waiting = step

    def remodel(self, step: RemodelStep) -> None:
        """Show a step of the angiogenesis; the first and the last one in any case."""
        self._last_growth()
        if self._scales is None or step.is_last or self._due():
            self._show(lambda: self._blood(step))

    def end(self) -> None:
        """Show what waits."""
        self._last_growth()
        self.recording.flush()

    def _last_growth(self) -> None:
        if (step := self._waiting) is not None:
            self._show(lambda: self._tissue(step))

    def _due(self) -> bool:
        """Whether enough time has passed since the last step that was shown."""
        due = self.clock() >= self._next
        self.left_out += not due
        return due

    def _show(self, send: Callable[[], None]) -> None:
        """Send a step, and rest so long that all sending takes only its share of the time."""
        self._waiting = None
        if self._given_up:
            return
        begun = self.clock()
        try:
            send()
        except Exception as error:  # noqa: BLE001  # a picture is not worth a run
            self._given_up = True
            self.tell(f"the viewer was given up, the run goes on: {type(error).__name__}: {error}")
            return
        self.shown += 1
        taken = self.clock() - begun
        self._next = self.clock() + max(OFTEN, taken / SHARE) * 2.0 ** (self.size() / SMALL)

    def _tissue(self, step: GrowthStep) -> None:
        net = step.network
        box = None if net.box is None else (float(net.box[0]), float(net.box[1]))
        if self._stage is None:
            self._begin([whole_tissue(box)], EARLY, tissue=True, blood=False)
        row = self.growth_row(step, 0.0)
        state = Springs(net.points, net.velocities, net.springs, net.tensions(), box)
        stage = self._at("vasculogenesis", row, step.steps_total)
        stage.tissue(state)

    def _blood(self, step: RemodelStep) -> None:
        outlines = step.domain.pillars
        row = self.remodel_row(step, 0.0)
        if self._scales is None:
            tissue = self._stage is not None
            self._scales = Scales.of(step.flow, len(outlines))
            self._begin([*self._boxes, mesh_box(step.mesh)], COLUMNS, tissue=tissue, blood=True)
            self._at("angiogenesis", row, step.steps_total).end_tissue(self._scales)
        self._at("angiogenesis", row, step.steps_total).blood(step.flow, outlines, self._scales)

    def _begin(self, boxes: list[Box], columns: Sequence[str], *, tissue: bool, blood: bool) -> None:
        """Lay out the screen for a stage."""
        self._boxes = boxes
        plane = Plane.around(boxes)
        there = {"tissue": tissue, "blood": blood}
        self.recording.send_blueprint(layout(plane, self.units, columns, **there, steps=1, live=True))
        self._stage = Stage(self.recording, plane, self.units)
        for column in columns:
            self._stage.style(column)

    def _at(self, name: str, row: Row, last: float) -> Stage:
        """Turn to the present step, with its words and numbers."""
        stage = self._stage
        assert stage is not None  # noqa: S101  # `_begin` came first
        stage.at(self.shown)
        notes = [f"{self.left_out} steps were left out so far, so that the run is not slowed down"]
        stage.words(
            words.caption(name, row),
            words.about("the run goes on", name, last, row, self.units, notes if self.left_out else []),
        )
        for column in COLUMNS:
            stage.number(column, row.get(column, np.nan))
        return stage


@contextmanager
def live_view(
    name: str,
    units: Units,
    growth_row: Callable[[GrowthStep, float], Row],
    remodel_row: Callable[[RemodelStep, float], Row],
    tell: Callable[[str], object],
) -> Iterator[Live]:
    """Open the viewer in the browser, and yield the watcher that fills it.

    The browser keeps what it has been sent when the program ends.
    """
    with serving() as server:
        open_browser(server.address, name, tell)
        recording = new_recording(name)
        recording.save(server.path)
        yield Live(recording, units, growth_row, remodel_row, lambda: server.path.stat().st_size, tell)
        recording.disconnect()
        server.finish()
