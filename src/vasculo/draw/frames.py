"""Pillars and speed at a few steps on one scale, as in the paper's Figs 4 and 5."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from matplotlib.patches import Patch

from vasculo.draw.canvas import INK, PILLAR, PILLAR_EDGE, new_figure
from vasculo.draw.flow import draw_speed, mean_speed, mesh_box, speed_scale
from vasculo.draw.scale import TEXT, colour_bar, flow_arrow, length_unit, scale_bar
from vasculo.draw.streamlines import draw_streamlines

if TYPE_CHECKING:
    from matplotlib.cm import ScalarMappable
    from matplotlib.figure import Figure

    from vasculo.draw.canvas import Box
    from vasculo.store.read import Run

_TALL, _LONG = 1.25, 3.2
"""Width over height below which three panels fit in a row, and above which a panel takes the whole row."""
_FRAMES = 5
_LINES = 20
"""Streamlines around a single pillar."""
_EARLY = 1.5
"""Above 1, more of the frames of a single pillar are early ones, where it changes most."""


def iterations(run: Run, count: int = _FRAMES, bias: float = 1.0) -> list[int]:
    """Spread at most `count` recorded steps over the angiogenesis, ends included; a bias above 1 favours early ones."""
    steps = run.steps("angiogenesis")
    last = len(steps) - 1
    shares = [(i / max(1, count - 1)) ** bias for i in range(count)]
    return sorted({steps[round(last * share)] for share in shares})


def draw_frames(run: Run) -> Figure:
    """Draw the speed and the pillars at up to five steps, with a legend in the last cell."""
    alone = len(run.pillars(run.steps()[0]).outlines) == 1
    steps = iterations(run, bias=_EARLY if alone else 1.0)
    flows = [run.flow(step) for step in steps]
    box = mesh_box(flows[0].mesh)
    top = max(speed_scale(flow) for flow in flows)
    figure, cells = cells_of(box, len(steps) + 1)
    for axes, flow, step in zip(cells, flows, steps, strict=False):
        outlines = run.pillars(step).outlines
        word = "pillar" if len(outlines) == 1 else "pillars"
        shown = draw_speed(axes, flow, outlines, box, f"step {step} · {len(outlines)} {word}", top)
        if alone:
            draw_streamlines(axes, flow, _LINES)
    draw_legend(cells[len(steps)], run, box, shown, mean_speed(flows[0]))
    return figure


def cells_of(box: Box, count: int, below: float = 0.0) -> tuple[Figure, list[Any]]:
    """Make a figure of at least `count` cells that each show `box`; those that are left over are not seen.

    `below` is the height that is left for something else, inches.
    """
    ratio = (box[2] - box[0]) / (box[3] - box[1])
    columns = min(count, 1 if ratio > _LONG else 2 if ratio > _TALL else 3)
    rows = -(-count // columns)
    figure = new_figure(9.6, rows * (9.6 / columns / ratio + 0.2) + below)
    cells = list(figure.subplots(rows, columns, squeeze=False).ravel())
    for axes in cells[count:]:
        axes.set_visible(False)
    return figure, cells


def draw_legend(axes: Any, run: Run, box: Box, shown: ScalarMappable, unit: float) -> None:
    """Fill a cell with the colour bar of the speed, a scale bar on the scale of the other cells, and the flow."""
    axes.set(xlim=(box[0], box[2]), ylim=(box[1], box[3]), aspect="equal")
    axes.set_axis_off()
    words = f"speed over its mean at step {run.steps()[0]}"
    colour_bar(axes, shown, words, (0.06, 0.62, 0.88, 0.07), unit)
    keys = [Patch(facecolor=PILLAR, edgecolor=PILLAR_EDGE, linewidth=0.5, label="pillar")]
    where = {"loc": "center left", "bbox_to_anchor": (0.03, 0.36)}
    axes.legend(handles=keys, frameon=False, fontsize=TEXT, labelcolor=INK, **where)
    scale_bar(axes, box, length_unit(run))
    flow_arrow(axes, run, (0.7, 0.12))
