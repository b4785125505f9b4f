"""How the runs of a sweep ended: a small picture a point, on the grid of the settings where there is one."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from vasculo.draw.canvas import INK, MUTED, SMALL, TEXT, WIDTH, new_figure, panel
from vasculo.draw.page import as_text
from vasculo.draw.phase import Axis, levels
from vasculo.draw.pillars import draw_pillars
from vasculo.draw.springs import draw_springs, whole_tissue, zoom

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from vasculo.draw.canvas import Box
    from vasculo.store.read import Run, Springs

_MOST_SPRINGS = 5_000
"""Springs that a small picture shows; of a larger tissue it shows the middle."""


@dataclass(frozen=True)
class EndState:
    """The end of one run.

    Attributes
    ----------
    title : str
        Caption.
    box : tuple of float
        Region.
    pillars : list of (k, 2) float64 or None
        Outlines of the pillars, None of a run without remodelling.
    springs : Springs or None
        The tissue of such a run.
    """

    title: str
    box: Box
    pillars: list[NDArray[Any]] | None = None
    springs: Springs | None = None


def end_state(run: Run, title: str) -> EndState:
    """Read the end of a run."""
    if run.steps("angiogenesis"):
        domain = run.domain()
        return EndState(title, domain.bounds, pillars=list(domain.pillars))
    springs = run.network()
    box = whole_tissue(run.period)
    if (count := len(springs.springs)) > _MOST_SPRINGS:
        half = 0.5 * (_MOST_SPRINGS / count) ** 0.5
        middle = (0.5 * (box[0] + box[2]), 0.5 * (box[1] + box[3]))
        box = (middle[0] - half, middle[1] - half, middle[0] + half, middle[1] + half)
    return EndState(title, box, springs=springs)


def draw_end_states(states: Sequence[EndState | None], x: Axis | None = None, y: Axis | None = None) -> Figure:
    """Draw the ends of runs.

    Parameters
    ----------
    states : sequence of EndState or None
        One a point; None for a point without a complete run.
    x, y : Axis, optional
        The settings of the points, each pair of values at most once; without them the pictures stand in a row after
        the other with their captions.
    """
    known = next(state for state in states if state is not None)
    shape = (known.box[3] - known.box[1]) / (known.box[2] - known.box[0])
    columns = levels(x.values) if x is not None else list(range(min(6, len(states))))
    rows = levels(y.values) if y is not None else list(range(-(-len(states) // len(columns))))
    wide = min(WIDTH, 1.5 * len(columns) + 0.7)
    each = (wide - 0.6) / len(columns)
    figure = new_figure(wide, len(rows) * (each * shape + (0.08 if x is not None else 0.28)) + 0.55)
    grid = figure.subplots(len(rows), len(columns), squeeze=False)
    for axes in grid.ravel():
        axes.set_visible(False)
    for point, state in enumerate(states):
        if x is not None and y is not None:
            row = len(rows) - 1 - rows.index(y.values[point].item())
            column = columns.index(x.values[point].item())
        else:
            row, column = divmod(point, len(columns))
        _paint(grid[row, column], state, "" if x is not None else None)
    if x is not None and y is not None:
        for column, value in enumerate(columns):
            _outer(grid[-1, column].set_xlabel, grid[-1, column], as_text(value))
        for row, value in enumerate(reversed(rows)):
            _outer(grid[row, 0].set_ylabel, grid[row, 0], as_text(value))
        figure.supxlabel(x.label, fontsize=TEXT, color=INK)
        figure.supylabel(y.label, fontsize=TEXT, color=INK)
    return figure


def _outer(put: Any, axes: Any, text: str) -> None:
    axes.set_visible(True)
    put(text, fontsize=SMALL, color=INK)


def _paint(axes: Any, state: EndState | None, title: str | None) -> None:
    """Draw one end into its axes."""
    axes.set_visible(True)
    if state is None:
        panel(axes, (0.0, 0.0, 1.0, 1.0))
        axes.text(0.5, 0.5, "no complete run", ha="center", va="center", fontsize=SMALL, color=MUTED)
        return
    if state.pillars is not None:
        draw_pillars(axes, state.pillars)
        panel(axes, state.box)
    elif state.springs is not None:
        draw_springs(axes, state.springs, state.box, widen=0.35 * zoom(min(len(state.springs.springs), _MOST_SPRINGS)))
    if title is None:
        axes.set_title(state.title, fontsize=SMALL, color=INK, loc="left", pad=3)
