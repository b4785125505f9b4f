"""Curves of a run's numbers over its steps."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from vasculo.draw.canvas import ACCENT, INK, MUTED, PILLAR_EDGE, caption, new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vasculo.store.read import Run

_GROWTH = (
    ("springs", ("springs",), "springs left"),
    ("void_fraction", ("void_fraction",), "share of voids"),
    ("pillars", ("pillars",), "voids"),
)
_REMODELLING = (
    ("pillars", ("pillars", "merges"), "pillars (line), mergers (dashed)"),
    ("order", ("alignment", "order"), "alignment (line), order (dashed)"),
    ("aspect_ratio", ("aspect_ratio",), "aspect ratio"),
    ("permeability", ("permeability",), "permeability over its start"),
    ("mean_wall_shear", ("mean_wall_shear",), "mean wall shear over its start"),
    ("mean_gap", ("mean_gap",), "mean gap"),
)
_RELATIVE = {"permeability", "mean_wall_shear"}


def draw_curves(run: Run, stage: str) -> Figure:
    """Draw the numbers of one stage, a panel a quantity, three panels a row."""
    rows = run.metrics["stage"] == stage
    panels = _GROWTH if stage == "vasculogenesis" else _REMODELLING
    across = "time" if stage == "vasculogenesis" else "step"
    figure = new_figure(9.0, 2.3 * ((len(panels) + 2) // 3))
    grid = figure.subplots((len(panels) + 2) // 3, 3, squeeze=False).ravel()
    for axes, (_, names, title) in zip(grid, panels, strict=True):
        for name, style in zip(names, ("-", "--"), strict=False):
            values = run.metrics[name][rows]
            if name in _RELATIVE and len(values) and values[0] > 0.0:
                values = values / values[0]
            _curve(axes, run.metrics[across][rows], values, style)
        _plain(axes, title, across)
    return figure


def _curve(axes: Any, x: np.ndarray, y: np.ndarray, style: str) -> None:
    known = np.isfinite(y)
    if not known.any():
        return
    colour = ACCENT if style == "-" else PILLAR_EDGE
    axes.plot(x[known], y[known], style, color=colour, linewidth=1.6, marker="o" if known.sum() < 3 else None)


def _plain(axes: Any, title: str, across: str) -> None:
    caption(axes, title)
    axes.set_xlabel(across, fontsize=7.5, color=MUTED)
    axes.tick_params(labelsize=7, colors=MUTED, length=2.5)
    axes.grid(color="#e5e7eb", linewidth=0.6)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        axes.spines[side].set_color(INK)
        axes.spines[side].set_linewidth(0.6)
