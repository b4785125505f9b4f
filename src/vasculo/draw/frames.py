"""Pillars and speed at a few steps on one scale, as in the paper's Figs 4 and 5."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vasculo.draw.canvas import WIDTH
from vasculo.draw.flow import draw_speed, mesh_box, speed_scale, speed_words
from vasculo.draw.sheet import key, sheet
from vasculo.draw.streamlines import draw_streamlines

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vasculo.draw.canvas import Box
    from vasculo.store.read import Run

_TALL, _LONG = 1.25, 3.2
"""Width over height below which three pictures fit beside each other, and above which one takes the whole row."""
_NARROWEST = 1.6  # inches, a picture with a caption that can be read
_FRAMES = 6
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


def columns_of(box: Box, count: int, width: float) -> int:
    """Choose how many of `count` pictures of a box stand beside each other on a sheet `width` inches wide."""
    ratio = (box[2] - box[0]) / (box[3] - box[1])
    most = 1 if ratio > _LONG else 2 if ratio > _TALL else 3
    return max(1, min(count, most, int(width / _NARROWEST)))


def draw_frames(run: Run, width: float = WIDTH) -> Figure:
    """Draw the speed and the pillars at up to six steps."""
    alone = len(run.pillars(run.steps()[0]).outlines) == 1
    steps = iterations(run, bias=_EARLY if alone else 1.0)
    flows = [run.flow(step) for step in steps]
    box = mesh_box(flows[0].mesh)
    top = max(speed_scale(flow) for flow in flows)
    made = sheet(box, width, len(steps), columns_of(box, len(steps), width))
    for axes, flow, step in zip(made.panels, flows, steps, strict=True):
        outlines = run.pillars(step).outlines
        word = "pillar" if len(outlines) == 1 else "pillars"
        shown = draw_speed(axes, flow, outlines, box, f"step {step} · {len(outlines):,} {word}", top)
        if alone:
            draw_streamlines(axes, flow, _LINES)
    told, words = speed_words(run, flows[0])
    key(made, run, shown, words, told)
    return made.figure
