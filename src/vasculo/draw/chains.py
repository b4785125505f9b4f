"""Chains: the lanes of flow between them, and from which pillars they came."""

from __future__ import annotations

from string import ascii_uppercase
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.patches import Patch
from shapely import Polygon

from vasculo.draw.canvas import CHAIN, CHAINS, PILLAR_EDGE, SMALL, WIDTH, panel
from vasculo.draw.flow import draw_field, mesh_box
from vasculo.draw.frames import columns_of
from vasculo.draw.pillars import add, pen
from vasculo.draw.sheet import Legend, key, sheet
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
OTHER, SINGLE = "#c9c2ba", "#f1ece6"


def chain_classes(largest: int) -> list[tuple[int, str, Any]]:
    """Classes of chain sizes up to `largest` original pillars: where each begins, its name, its colour."""
    begins = [size for size in _SIZES if size <= largest]
    ends = [*(size - 1 for size in begins[1:]), largest]
    tones = CHAIN(np.linspace(0.0, 1.0, max(2, len(begins))))
    return [
        (first, str(first) if first == last else f"{first} to {last}", tuple(tone))
        for first, last, tone in zip(begins, ends, tones, strict=False)
    ]


def draw_lanes(
    axes: Any,
    flow: FlowFields,
    pillars: Pillars,
    box: Box,
    title: str,
    classes: Classes,
    top: float,
) -> Any:
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
    top : float
        Speed drawn brightest.

    Returns
    -------
    The coloured mesh, for a colour bar.
    """
    shown = draw_field(axes, flow, top, gamma=1.0)
    draw_streamlines(axes, flow, LANES, width=0.6)
    begins = [first for first, _, _ in classes]
    rank = np.searchsorted(begins, [len(group) for group in pillars.lineage], side="right") - 1
    fill(axes, pillars.outlines, [classes[k][2] for k in rank])
    panel(axes, box, title)
    return shown


def draw_lineage(run: Run, width: float = WIDTH) -> Figure:
    """Draw the pillars of the start and the end, a colour and a letter for each of the largest chains."""
    steps = (run.steps()[0], run.steps()[-1])
    first, last = (run.pillars(step) for step in steps)
    order = sorted(range(len(last.lineage)), key=lambda k: (-len(last.lineage[k]), last.lineage[k]))
    colour: dict[int, str] = {}
    letter: dict[int, str] = {}
    for rank, k in enumerate(order):
        size = len(last.lineage[k])
        named = size > 1 and rank < len(CHAINS)
        tone = SINGLE if size == 1 else CHAINS[rank] if named else OTHER
        colour |= dict.fromkeys(last.lineage[k], tone)
        if named:
            letter |= dict.fromkeys(last.lineage[k], ascii_uppercase[rank])
    legend = _named([len(last.lineage[k]) for k in order])
    box = mesh_box(run.mesh(steps[0]))
    made = sheet(box, width, 2, min(2, columns_of(box, 2, width)), legend=legend, bar=False)
    titles = (f"step {steps[0]} · the chains to come", f"step {steps[1]} · the chains")
    for axes, pillars, title in zip(made.panels, (first, last), titles, strict=True):
        fill(axes, pillars.outlines, [colour.get(group[0], SINGLE) for group in pillars.lineage])
        _letters(axes, pillars.outlines, [letter.get(group[0], "") for group in pillars.lineage])
        panel(axes, box, title)
    key(made, run)
    return made.figure


def _letters(axes: Any, outlines: Sequence[NDArray[np.float64]], letters: Sequence[str]) -> None:
    """Write a letter into each outline that has one: in grey print the colours look alike."""
    size = max(4.5, SMALL * pen(len(outlines)))
    for outline, word in zip(outlines, letters, strict=True):
        if word:
            place = Polygon(outline).representative_point()
            axes.text(
                place.x, place.y, word, fontsize=size, color="white", ha="center", va="center", zorder=4, clip_on=True
            )


def fill(axes: Any, outlines: Sequence[NDArray[np.float64]], colours: Sequence[Any]) -> None:
    """Fill each outline with its own colour."""
    from matplotlib.collections import PolyCollection  # noqa: PLC0415  # heavy, and only here

    width = 0.6 * pen(len(outlines))
    add(
        axes,
        PolyCollection(outlines, facecolors=list(colours), edgecolors=PILLAR_EDGE, linewidths=width, zorder=3),
    )


def _named(sizes: list[int]) -> Legend:
    """Name the colours of the largest chains by their letter and their number of original pillars."""
    chains = [size for size in sizes if size > 1]
    keys = [
        Patch(facecolor=tone, label=f"{word}: {size}")
        for word, tone, size in zip(ascii_uppercase, CHAINS, chains, strict=False)
    ]
    rest = len(chains) - len(keys)
    if rest > 0:
        keys.append(Patch(facecolor=OTHER, label=f"{rest} smaller"))
    keys.append(Patch(facecolor=SINGLE, edgecolor=PILLAR_EDGE, linewidth=0.4, label="single"))
    return Legend(keys, "original pillars in the chain")
