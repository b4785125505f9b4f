"""How the wall shear is spread over the membranes: shares of their length, at the start and at the end."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from vasculo.draw.canvas import ACCENT, INK, MUTED, PILLAR, PILLAR_EDGE, SMALL, WIDTH, new_figure
from vasculo.draw.curves import plain

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from vasculo.store.read import Pillars, Run

    Floats = NDArray[np.float64]

_BINS = 40
_NARROWEST = 4.5  # inches of two panels beside each other
_MOST = 3.0
"""Shear over its mean at which the last bin ends; it holds what is above, too."""


def membrane(pillars: Pillars) -> tuple[Floats, Floats, Floats]:
    """Length, shear over the mean of all membranes, and activation, of every membrane node of a step.

    Returns
    -------
    length, shear, activation : (n,) float64
        Half the two sides at each node, model length; dimensionless; dimensionless.
    """
    lengths = []
    for outline in pillars.outlines:
        side = np.hypot(*(np.roll(outline, -1, axis=0) - outline).T)
        lengths.append(0.5 * (side + np.roll(side, 1)))
    length, shear = np.concatenate(lengths), np.concatenate(pillars.node_shear)
    mean = float(length @ shear / length.sum())
    return length, shear / mean if mean > 0.0 else shear, np.concatenate(pillars.activation)


def draw_shares(run: Run, width: float = WIDTH) -> Figure:
    """Draw the distribution of the wall shear and of the activation over the membranes, first and last step."""
    shown = {step: run.pillars(step) for step in sorted({run.steps()[0], run.steps()[-1]})}
    steps = [step for step, pillars in shown.items() if pillars.outlines]
    sensed = [membrane(shown[step]) for step in steps]
    beside = width > _NARROWEST
    figure = new_figure(width, 0.34 * width if beside else 1.4 * width)
    left, right = figure.subplots(*((1, 2) if beside else (2, 1)))
    limit = max(1.0, *(float(np.abs(activation).max()) for _, _, activation in sensed))
    for k, (step, (length, shear, activation)) in enumerate(zip(steps, sensed, strict=True)):
        last = k == len(steps) - 1
        _bars(left, np.minimum(shear, _MOST), length, (0.0, _MOST), _words(step, shear, length), last=last)
        _bars(right, activation, length, (-limit, limit), _words(step, activation, length), last=last)
    plain(left, f"wall shear over its mean (all above {_MOST:g} in the last bin)", "share of membrane length, %")
    plain(right, "activation: above 0 the filaments contract", "share of membrane length, %")
    left.axvline(1.0, color=MUTED, linewidth=0.8, linestyle=":")
    right.axvline(0.0, color=MUTED, linewidth=0.8, linestyle=":")
    for axes in (left, right):
        axes.set_ylim(0.0, 1.2 * axes.get_ylim()[1])
        axes.legend(frameon=False, fontsize=SMALL, labelcolor=INK, loc="upper right")
    return figure


def _words(step: int, values: Floats, length: Floats) -> str:
    mean = float(values @ length / length.sum())
    spread = float(np.sqrt((values - mean) ** 2 @ length / length.sum()))
    return f"step {step}: spread {spread:.2f}"


def _bars(axes: Any, values: Floats, length: Floats, span: tuple[float, float], words: str, *, last: bool) -> None:
    shares, edges = np.histogram(values, _BINS, span, weights=100.0 * length / length.sum())
    if last:
        axes.stairs(shares, edges, fill=True, facecolor=PILLAR, edgecolor=PILLAR_EDGE, linewidth=0.8, label=words)
    else:
        axes.stairs(shares, edges, color=ACCENT, linewidth=1.4, label=words, zorder=3)
