"""A recording in the making: each step with its layers, its numbers and its words."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.store.table import UNIT_OF
from vasculo.view import layers, legend, numbers
from vasculo.view.layout import ABOUT, TIMELINE
from vasculo.view.plane import CAMERA, Plane
from vasculo.view.sdk import rerun

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from vasculo.store.read import Springs
    from vasculo.store.units import Units
    from vasculo.view.layers import FlowLike, Scales


class Stage:
    """What a recording shows, step by step; the steps may come in any order.

    Parameters
    ----------
    recording : RecordingStream
        Where to.
    plane : Plane
        What the pictures show.
    units : Units
        For the keys and the plots.
    """

    def __init__(self, recording: rerun.RecordingStream, plane: Plane, units: Units) -> None:
        self.recording, self.plane, self.units = recording, plane, units
        recording.set_log_tick_enabled(enabled=False)
        recording.set_log_time_enabled(enabled=False)
        recording.log(CAMERA, *plane.camera(), static=True)
        for path, key in legend.length_bar(plane, units):
            recording.log(path, key, static=True)

    def at(self, index: int) -> None:
        """Turn to a step, by its number in the record."""
        self.recording.set_time(TIMELINE, sequence=index)

    def tissue(self, state: Springs) -> int:
        """Show the springs; return how many are too short to be seen."""
        lines, hidden = layers.springs(state, self.plane)
        self.recording.log(layers.SPRINGS, lines)
        return hidden

    def no_blood(self, text: str) -> None:
        """Say in the pictures of the flow that there is none yet."""
        self.recording.log(legend.LATER, legend.later(self.plane, text))

    def end_tissue(self, scales: Scales) -> None:
        """Take the springs away, at the first step of the angiogenesis, and put the colour bars there."""
        for path in (layers.SPRINGS, legend.LATER):
            self.recording.log(path, rerun.Clear(recursive=True))
        for path, key in legend.colour_bars(self.plane, scales, self.units):
            self.recording.log(path, key)

    def blood(self, flow: FlowLike, outlines: Sequence[NDArray[np.float64]], scales: Scales) -> None:
        """Show the flow and the pillars."""
        log, plane = self.recording.log, self.plane
        log(layers.SPEEDS, layers.speed(flow, plane, scales))
        log(layers.PRESSURES, layers.pressure(flow, plane, scales))
        if not outlines:
            log("pillars", rerun.Clear(recursive=True))
            return
        inside, edges = layers.pillars(outlines, plane)
        log(layers.FILLS, inside)
        log(layers.OUTLINES, edges)
        log(layers.SHEARS, layers.wall_shear(flow, plane, scales))

    def words(self, caption: str, text: str) -> None:
        """Say which step is shown: in a line above the picture, and at length."""
        self.recording.log(legend.CAPTION, legend.caption(self.plane, caption))
        self.recording.log(ABOUT, rerun.TextDocument(text, media_type=rerun.MediaType.MARKDOWN))

    def number(self, column: str, value: float) -> None:
        """Add a point to a plot."""
        if np.isfinite(value):
            self.recording.log(numbers.entity(column), rerun.Scalars(value * self._factor(column)))

    def style(self, column: str) -> None:
        """Name and colour the line of a column."""
        self.recording.log(numbers.entity(column), numbers.style(column, self.units), static=True)

    def curves(self, metrics: Mapping[str, NDArray[np.float64]]) -> None:
        """Send all plots of a table at once, a row a recorded step."""
        for column in numbers.plotted(metrics):
            self.style(column)
            rows = np.flatnonzero(np.isfinite(metrics[column]))
            self.recording.send_columns(
                numbers.entity(column),
                indexes=[rerun.TimeColumn(TIMELINE, sequence=rows)],
                columns=rerun.Scalars.columns(scalars=metrics[column][rows] * self._factor(column)),
            )

    def _factor(self, column: str) -> float:
        return self.units.factor(UNIT_OF.get(column, ""))
