"""Curves of a run's numbers over its steps."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.ticker import MaxNLocator

from vasculo.draw.canvas import ACCENT, INK, MUTED, PILLAR_EDGE, SMALL, WIDTH, caption, new_figure
from vasculo.store.table import UNIT_OF

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vasculo.store.read import Run

    Panel = tuple[str, dict[str, str]]

_GROWTH: tuple[Panel, ...] = (
    ("springs left", {"springs": ""}),
    ("share of the tissue in voids", {"void_fraction": ""}),
    ("voids", {"pillars": ""}),
)
_REMODELLING: tuple[Panel, ...] = (
    ("pillars and mergers", {"pillars": "pillars", "merges": "mergers so far"}),
    ("long axes along the flow", {"alignment": "local flow", "order": "mean flow"}),
    ("angle to the local flow", {"local_angle": ""}),
    ("aspect ratio", {"aspect_ratio": ""}),
    ("chains", {"chain_fraction": "share of pillars", "straightness": "straightness"}),
    ("distances", {"mean_gap": "mean gap", "corridor_width": "corridor width"}),
    ("permeability over its start", {"permeability": ""}),
    ("corridors that carry the flow", {"corridors": ""}),
    ("mean wall shear over its start", {"mean_wall_shear": ""}),
    ("spread of shear on a pillar", {"shear_variation": ""}),
    ("fastest to slowest shear", {"shear_ratio": ""}),
    ("computing time", {"seconds_flow": "flow", "seconds_mesh": "mesh", "seconds_cells": "cells"}),
)
_RELATIVE = {"permeability", "mean_wall_shear"}
_SAME = 1e-6
"""Relative change below which a number counts as the same."""
_NARROWEST = 2.3  # inches of a panel
_STYLES = (("-", ACCENT), ("--", PILLAR_EDGE), (":", INK))


def draw_curves(run: Run, stage: str, width: float = WIDTH) -> Figure:
    """Draw the numbers of one stage, a panel a quantity, three a row at most.

    What a run has not, or what stays the same all the time, is left out.
    """
    rows = run.metrics["stage"] == stage
    known = {name: column[rows] for name, column in run.metrics.items() if name != "stage"}
    panels = _GROWTH if stage == "vasculogenesis" else _REMODELLING
    panels = tuple((title, names) for title, names in panels if any(_moves(known, name) for name in names))
    growing = stage == "vasculogenesis"
    columns = max(1, min(3, int(width / _NARROWEST)))
    count = -(-len(panels) // columns)
    figure = new_figure(width, 1.55 * count)
    grid = figure.subplots(count, columns, squeeze=False).ravel()
    for axes, (title, names) in zip(grid, panels, strict=False):
        unit = ""
        for (name, word), (style, colour) in zip(names.items(), _STYLES, strict=False):
            if not _has(known, name):
                continue
            values = known[name]
            if name in _RELATIVE and values[0] > 0.0:
                values = values / values[0]
            elif name in UNIT_OF:
                values, unit = run.units.factor(UNIT_OF[name]) * values, run.units.name(UNIT_OF[name])
            if name.startswith("seconds_") and len(values) > 2:
                values = np.append(np.nan, values[1:])  # the first step loads and compiles
            _curve(axes, known["time" if growing else "step"], values, style, colour, word)
        plain(axes, f"{title}, {unit}" if unit else title, "")
        axes.set_xlabel("model time" if growing else "step", fontsize=SMALL, color=MUTED)
        axes.xaxis.set_major_locator(MaxNLocator(5, integer=True))
        if len(axes.lines) > 1:
            axes.legend(frameon=False, fontsize=SMALL, labelcolor=INK, handlelength=1.8, loc="best", borderaxespad=0.2)
    for axes in grid[len(panels) :]:
        axes.set_visible(False)
    return figure


def _has(known: dict[str, np.ndarray], name: str) -> bool:
    return name in known and bool(np.isfinite(known[name]).any())


def _moves(known: dict[str, np.ndarray], name: str) -> bool:
    """Whether a number is there and changes; with a single step all count as changing."""
    if not _has(known, name):
        return False
    values = known[name][np.isfinite(known[name])]
    return len(values) < 2 or bool(np.ptp(values) > _SAME * np.abs(values).max())


def _curve(axes: Any, x: np.ndarray, y: np.ndarray, style: str, colour: str, word: str) -> None:
    found = np.isfinite(y)
    marker = "o" if found.sum() < 3 else None
    axes.plot(x[found], y[found], style, color=colour, linewidth=1.3, marker=marker, label=word)


def plain(axes: Any, title: str, up: str) -> None:
    """Give axes their caption, the name of what goes up, and a quiet frame."""
    caption(axes, title)
    axes.set_ylabel(up, fontsize=SMALL, color=MUTED)
    axes.tick_params(labelsize=SMALL, colors=MUTED, length=2.5)
    axes.grid(color="#e5e7eb", linewidth=0.6)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        axes.spines[side].set_color(INK)
        axes.spines[side].set_linewidth(0.6)
