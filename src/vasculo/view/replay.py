"""A record, sent to the viewer step by step."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vasculo.draw.flow import mesh_box
from vasculo.draw.springs import whole_tissue
from vasculo.view import numbers, thin, words
from vasculo.view.layers import Scales
from vasculo.view.layout import layout
from vasculo.view.plane import Plane
from vasculo.view.stage import Stage

if TYPE_CHECKING:
    from vasculo.store.read import Frame, Run
    from vasculo.view.sdk import blueprint, rerun


class Replay:
    """What is shown of a run: which steps, on which plane and with which scales.

    Parameters
    ----------
    run : Run
        An opened run, complete or not.
    most : int
        Steps of a stage that are shown at most, >= 2.

    Attributes
    ----------
    steps : list of Frame
        The steps that are shown, in order.
    notes : list of str
        What is left out, a line each.

    Raises
    ------
    InputError
        When no step was recorded, or `most` is below 2.
    """

    def __init__(self, run: Run, most: int = thin.MOST) -> None:
        thin.check(run, most)
        self.run = run
        self.steps: list[Frame] = []
        self.notes: list[str] = []
        for stage in ("vasculogenesis", "angiogenesis"):
            frames = self._recorded(stage)
            every = thin.spacing(len(frames), most)
            self.steps += [frames[i] for i in thin.shown(len(frames), every)]
            if every > 1:
                self.notes.append(
                    f"{stage}: every {words.ordinal(every)} recorded step is shown; the plots have all of them"
                )
        if not run.complete:
            self.notes.append("the run did not come to its end: this is what it recorded")
        self._tissue, self._blood = self._recorded("vasculogenesis"), self._recorded("angiogenesis")
        boxes, self._scales = [], None
        if self._tissue:
            boxes.append(whole_tissue(run.period))
        if self._blood:
            first, last = (run.flow(self._blood[i].step) for i in (0, -1))
            boxes.append(mesh_box(first.mesh))
            self._scales = Scales.of(first, len(run.pillars(self._blood[0].step).outlines), last)
        self.plane = Plane.around(boxes)

    def layout(self) -> blueprint.Blueprint:
        """Arrange the screen."""
        there = {"blood": bool(self._blood), "tissue": bool(self._tissue)}
        columns = numbers.plotted(self.run.metrics)
        return layout(self.plane, self.run.units, columns, **there, steps=len(self.steps), live=False)

    def send(self, recording: rerun.RecordingStream) -> None:
        """Send all numbers, then the steps: the first and the last one before those between."""
        stage = Stage(recording, self.plane, self.run.units)
        stage.curves(self.run.metrics)
        if self._scales is not None:
            if self._tissue:
                stage.at(self._tissue[0].index)
                stage.no_blood(f"the blood flows from step {self._blood[0].index} on")
            stage.at(self._blood[0].index)
            stage.end_tissue(self._scales)
        for frame in thin.coarse_first(self.steps):
            self._show(stage, frame)

    def _show(self, stage: Stage, frame: Frame) -> None:
        """Send one step."""
        run, hidden = self.run, 0
        stage.at(frame.index)
        if self._scales is not None and frame.stage == "angiogenesis":
            stage.blood(run.flow(frame.step), run.pillars(frame.step).outlines, self._scales)
        else:
            hidden = stage.tissue(run.network(frame.step))
        row = {name: float(values[frame.index]) for name, values in run.metrics.items() if name != "stage"}
        left_out = [f"{hidden} springs are too short to be seen and left out"] if hidden else []
        title = str(run.settings.get("study", {}).get("title", ""))
        last = self._recorded(frame.stage)[-1].step
        stage.words(
            words.caption(frame.stage, row),
            words.about(title, frame.stage, last, row, run.units, [*self.notes, *left_out]),
        )

    def _recorded(self, stage: str) -> list[Frame]:
        return [frame for frame in self.run.frames if frame.stage == stage]
