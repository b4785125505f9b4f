"""Chains: the lanes of flow between them, and from which pillars they came."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.patches import Patch

from vasculo.draw.canvas import CHAIN, INK, PILLAR_EDGE, new_figure, panel
from vasculo.draw.flow import draw_field, mean_speed, mesh_box, node_speed
from vasculo.draw.pillars import add, pen
from vasculo.draw.scale import TEXT, colour_bar, flow_arrow, length_unit, scale_bar
from vasculo.draw.streamlines import draw_streamlines

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from vasculo.draw.canvas import Box
    from vasculo.store.read import FlowFields, Pillars, Run

    Classes = Sequence[tuple[int, str, Any]]

LANES = 24
"""Streamlines in a picture of the corridors: each stands for 1/24 of the flow."""
_SIZES = (1, 2, 3, 5, 9, 17, 33, 65, 129, 257, 513, 1025)
"""Chains of as many original pillars and more, up to the next, have one colour."""
_FAST = 99.9
"""Percentile of the node speeds that is drawn brightest."""
_NAMED = ("#1b6ca8", "#d1495b", "#2e933c", "#edae49", "#6f4a8e", "#00798c", "#b5651d", "#e07be0")
_OTHER, _SINGLE = "#c9c2ba", "#f1ece6"
_SIDE, _NARROW, _STRIP = 8.0, 6.0, 0.9  # inches: the longer side, the least width, the strip below
_LEGEND: dict[str, Any] = {
    "fontsize": TEXT,
    "title_fontsize": TEXT,
    "frameon": False,
    "labelcolor": INK,
    "handlelength": 1.2,
    "columnspacing": 1.2,
    "borderpad": 0.0,
}


def chain_classes(largest: int) -> list[tuple[int, str, Any]]:
    """Classes of chain sizes up to `largest` original pillars: where each begins, its name, its colour."""
    begins = [size for size in _SIZES if size <= largest]
    ends = [*(size - 1 for size in begins[1:]), largest]
    tones = CHAIN(np.linspace(0.0, 1.0, max(2, len(begins))))
    return [
        (first, str(first) if first == last else f"{first} to {last}", tuple(tone))
        for first, last, tone in zip(begins, ends, tones, strict=False)
    ]


def draw_lanes(axes: Any, flow: FlowFields, pillars: Pillars, box: Box, title: str, classes: Classes) -> Any:
    """Draw the flow on a linear scale of its own with lines of equal flow, and the pillars by the size of their chain.

    Parameters
    ----------
    axes : matplotlib Axes
        Where.
    flow : FlowFields
        The flow at one step.
    pillars : Pillars
        The pillars at that step.
    box : tuple of float
        Region xmin, ymin, xmax, ymax; model length.
    title : str
        Caption.
    classes : list of tuple
        From `chain_classes`.

    Returns
    -------
    The coloured mesh, for a colour bar.
    """
    shown = draw_field(axes, flow, float(np.percentile(node_speed(flow), _FAST)), gamma=1.0)
    draw_streamlines(axes, flow, LANES, width=0.6)
    begins = [first for first, _, _ in classes]
    rank = np.searchsorted(begins, [len(group) for group in pillars.lineage], side="right") - 1
    fill(axes, pillars.outlines, [classes[k][2] for k in rank])
    panel(axes, box, title)
    return shown


def draw_corridors(run: Run) -> Figure:
    """Draw the lanes of the last step, and below what the colours mean."""
    step = run.steps()[-1]
    flow, pillars = run.flow(step), run.pillars(step)
    box = mesh_box(flow.mesh)
    classes = chain_classes(max((len(group) for group in pillars.lineage), default=1))
    wide, high = box[2] - box[0], box[3] - box[1]
    factor = _SIDE / max(wide, high)
    figure = new_figure(max(_NARROW, wide * factor), high * factor + _STRIP + 0.3)
    above, below = figure.subplots(2, 1, height_ratios=(high * factor, _STRIP))
    title = f"step {step} · {len(pillars.outlines)} pillars · as much flow between each two lines"
    shown = draw_lanes(above, flow, pillars, box, title, classes)
    below.set_axis_off()
    colour_bar(below, shown, "speed over its mean", (0.0, 0.14, 0.36, 0.16), mean_speed(flow))
    keys = [Patch(facecolor=tone, edgecolor=PILLAR_EDGE, linewidth=0.5, label=name) for _, name, tone in classes]
    below.legend(
        handles=keys,
        title="pillars filled by how many original ones are in them",
        alignment="left",
        ncols=len(keys) if len(keys) < 6 else -(-len(keys) // 2),
        loc="upper left",
        bbox_to_anchor=(0.44, 0.6),
        **_LEGEND,
    )
    scale_bar(below, box, length_unit(run), 0.88, above)
    flow_arrow(below, run, (0.93, 0.88))
    return figure


def draw_lineage(run: Run) -> Figure:
    """Draw the pillars of the start and the end, those of the largest chains in one colour a chain."""
    steps = (run.steps()[0], run.steps()[-1])
    first, last = (run.pillars(step) for step in steps)
    order = sorted(range(len(last.lineage)), key=lambda k: (-len(last.lineage[k]), last.lineage[k]))
    colour: dict[int, str] = {}
    for rank, k in enumerate(order):
        size = len(last.lineage[k])
        tone = _SINGLE if size == 1 else _NAMED[rank] if rank < len(_NAMED) else _OTHER
        colour |= dict.fromkeys(last.lineage[k], tone)
    box = mesh_box(run.mesh(steps[0]))
    ratio = (box[3] - box[1]) / (box[2] - box[0])
    figure = new_figure(9.6, 4.8 * ratio + 0.8)
    titles = (f"step {steps[0]} · which chain each pillar will be in", f"step {steps[1]} · the chains")
    for axes, pillars, title in zip(figure.subplots(1, 2), (first, last), titles, strict=True):
        fill(axes, pillars.outlines, [colour.get(group[0], _SINGLE) for group in pillars.lineage])
        panel(axes, box, title)
    _named(figure, [len(last.lineage[k]) for k in order])
    return figure


def fill(axes: Any, outlines: Sequence[NDArray[np.float64]], colours: Sequence[Any]) -> None:
    """Fill each outline with its own colour."""
    from matplotlib.collections import PolyCollection  # noqa: PLC0415  # heavy, and only here

    width = 0.6 * pen(len(outlines))
    add(
        axes,
        PolyCollection(outlines, facecolors=list(colours), edgecolors=PILLAR_EDGE, linewidths=width, zorder=3),
    )


def _named(figure: Figure, sizes: list[int]) -> None:
    """Name the colours of the largest chains by their number of original pillars."""
    chains = [size for size in sizes if size > 1]
    keys = [Patch(facecolor=tone, label=f"{size}") for tone, size in zip(_NAMED, chains, strict=False)]
    rest = len(chains) - len(keys)
    if rest > 0:
        keys.append(Patch(facecolor=_OTHER, label=f"in {rest} smaller chains"))
    keys.append(Patch(facecolor=_SINGLE, edgecolor=PILLAR_EDGE, linewidth=0.4, label="single"))
    words = "original pillars in the chain"
    figure.legend(handles=keys, title=words, loc="outside lower center", ncols=len(keys), **_LEGEND)
