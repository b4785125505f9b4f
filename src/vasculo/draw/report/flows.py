"""Pictures of flow, or of tissue, in rows and columns, all on one scale of length and one of colour."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from vasculo.draw.canvas import new_figure, panel, png
from vasculo.draw.flow import draw_field, mesh_box, speed_scale, speed_words
from vasculo.draw.pillars import draw_pillars
from vasculo.draw.report.words import plural
from vasculo.draw.scale import colour_bar, flow_arrow, length_unit, scale_bar
from vasculo.draw.springs import draw_springs, whole_tissue, zoom

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

    from vasculo.draw.canvas import Box
    from vasculo.store.read import Run

_WIDTH, _RESOLUTION = 5.8, 200  # inches, dots per inch
_STRIP, _CAPTION = 0.55, 0.25  # inches: below, above each picture
_LONG = 2.2
"""Width over height of a domain above which start and end stand one above the other."""


@dataclass(frozen=True)
class Shown:
    """One picture: a step of a run, and a line above it."""

    run: Run
    step: int
    title: str


def draw_ends(run: Run) -> tuple[bytes, str]:
    """Draw the start and the end of a run; return the picture (PNG) and what it shows."""
    steps = run.steps("angiogenesis")
    if not steps:
        last = run.steps("vasculogenesis")[-1]
        figure = draw_tissues([Shown(run, last, f"step {last:,}")])
        return png(figure), "The tissue in the end: width and grey of a spring follow its pull."
    ends = sorted({steps[0], steps[-1]})
    shown = [Shown(run, step, f"step {step} · {_count(run, step)}") for step in ends]
    box = mesh_box(run.mesh(steps[0]))
    across = [shown] if (box[2] - box[0]) / (box[3] - box[1]) < _LONG else [[one] for one in shown]
    when = "at the start and at the end" if len(ends) > 1 else "at the start"
    return png(draw_flows(across)), f"Pillars and speed of the blood {when}, on one scale."


def draw_flows(rows: Sequence[Sequence[Shown]]) -> Figure:
    """Draw steps of the angiogenesis in rows and columns; the first one gives the unit of the speed.

    Parameters
    ----------
    rows : sequence of sequence of Shown
        Rows of the same length.
    """
    flows = [[one.run.flow(one.step) for one in row] for row in rows]
    every = [flow for row in flows for flow in row]
    boxes = np.array([mesh_box(flow.mesh) for flow in every])
    box = _whole(boxes)
    top = max(speed_scale(flow) for flow in every)
    first = rows[0][0]
    outlines = [[one.run.pillars(one.step).outlines for one in row] for row in rows]
    gamma = 0.5 if max(len(found) for row in outlines for found in row) > 1 else 1.0
    figure, cells, below = _grid(box, len(rows), len(rows[0]))
    for k, row in enumerate(rows):
        for j, one in enumerate(row):
            shown = draw_field(cells[k][j], flows[k][j], top, gamma)
            draw_pillars(cells[k][j], outlines[k][j])
            panel(cells[k][j], box, one.title)
    unit, words = speed_words(first.run, first.run.flow(first.run.steps()[0]))
    colour_bar(below, shown, words, (0.0, 0.3, 0.45, 0.17), unit)
    scale_bar(below, box, length_unit(first.run), 0.3, cells[-1][-1], 0.2)
    flow_arrow(below, first.run, (0.93, 0.3))
    return figure


def draw_tissues(row: Sequence[Shown]) -> Figure:
    """Draw steps of the vasculogenesis beside each other."""
    springs = [one.run.network(one.step) for one in row]
    box = _whole(np.array([whole_tissue(one.run.period) for one in row]))
    figure, cells, below = _grid(box, 1, len(row))
    for axes, one, state in zip(cells[0], row, springs, strict=True):
        title = f"{one.title} · {len(state.springs):,} springs"
        draw_springs(axes, state, box, title, zoom(len(state.springs)) / len(row) ** 0.5)
    scale_bar(below, box, length_unit(row[0].run), 0.3, cells[0][-1], 0.0)
    return figure


def _count(run: Run, step: int) -> str:
    return plural(len(run.pillars(step).outlines), "pillar")


def _whole(boxes: Any) -> Box:
    """Smallest box around boxes (n, 4)."""
    low, high = boxes[:, :2].min(axis=0), boxes[:, 2:].max(axis=0)
    return float(low[0]), float(low[1]), float(high[0]), float(high[1])


def _grid(box: Box, rows: int, columns: int) -> tuple[Figure, list[list[Any]], Any]:
    """Make a figure of cells that each show `box`, and empty axes below them."""
    wide = _WIDTH if columns < 3 else _WIDTH * 1.5
    high = wide / columns * (box[3] - box[1]) / (box[2] - box[0])
    figure = new_figure(wide, rows * (high + _CAPTION) + _STRIP, _RESOLUTION)
    grid = figure.add_gridspec(rows + 1, columns, height_ratios=[*[high] * rows, _STRIP])
    cells = [[figure.add_subplot(grid[k, j]) for j in range(columns)] for k in range(rows)]
    below = figure.add_subplot(grid[rows, :])
    below.set_axis_off()
    return figure, cells, below
