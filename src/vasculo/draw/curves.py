"""Curves of a run's numbers over its steps."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from vasculo.draw.canvas import ACCENT, INK, MUTED, PILLAR_EDGE, caption, new_figure

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vasculo.store.read import Run

_GROWTH: tuple[tuple[tuple[str, ...], str], ...] = (
    (("springs",), "springs left"),
    (("void_fraction",), "share of voids"),
    (("pillars",), "voids"),
)
_REMODELLING: tuple[tuple[tuple[str, ...], str], ...] = (
    (("pillars", "merges"), "pillars (line), mergers (dashed)"),
    (("alignment", "order"), "alignment (line), order (dashed)"),
    (("local_angle",), "mean angle to the local flow, degrees"),
    (("aspect_ratio",), "aspect ratio"),
    (("chain_fraction", "straightness"), "share in chains (line), straightness (dashed)"),
    (("mean_gap", "corridor_width"), "mean gap (line), corridor width (dashed)"),
    (("permeability",), "permeability over its start"),
    (("corridors",), "corridors that carry the flow"),
    (("mean_wall_shear",), "mean wall shear over its start"),
    (("shear_variation",), "spread of the shear around a pillar"),
    (("shear_ratio",), "slowest to fastest: shear ratio"),
    (("seconds_flow", "seconds_mesh", "seconds_cells"), "seconds: flow, mesh (dashed), cells (dots)"),
)
_RELATIVE = {"permeability", "mean_wall_shear"}
_STYLES = (("-", ACCENT), ("--", PILLAR_EDGE), (":", INK))


def draw_curves(run: Run, stage: str) -> Figure:
    """Draw the numbers of one stage, a panel a quantity, three panels a row; those that a run has not are left out."""
    rows = run.metrics["stage"] == stage
    known = {name: column[rows] for name, column in run.metrics.items() if name != "stage"}
    panels = _GROWTH if stage == "vasculogenesis" else _REMODELLING
    panels = tuple((names, title) for names, title in panels if any(_has(known, name) for name in names))
    across = "time" if stage == "vasculogenesis" else "step"
    count = -(-len(panels) // 3)
    figure = new_figure(9.6, 2.1 * count)
    grid = figure.subplots(count, 3, squeeze=False).ravel()
    for axes, (names, title) in zip(grid, panels, strict=False):
        for name, (style, colour) in zip(names, _STYLES, strict=False):
            if not _has(known, name):
                continue
            values = known[name]
            if name in _RELATIVE and values[0] > 0.0:
                values = values / values[0]
            if name.startswith("seconds_") and len(values) > 2:
                values = np.append(np.nan, values[1:])  # the first step loads and compiles
            _curve(axes, known[across], values, style, colour)
        plain(axes, title, "")
        axes.set_xlabel(across, fontsize=7.5, color=MUTED)
    for axes in grid[len(panels) :]:
        axes.set_visible(False)
    return figure


def _has(known: dict[str, np.ndarray], name: str) -> bool:
    return name in known and bool(np.isfinite(known[name]).any())


def _curve(axes: Any, x: np.ndarray, y: np.ndarray, style: str, colour: str) -> None:
    found = np.isfinite(y)
    marker = "o" if found.sum() < 3 else None
    axes.plot(x[found], y[found], style, color=colour, linewidth=1.6, marker=marker)


def plain(axes: Any, title: str, up: str) -> None:
    """Give axes their caption, the name of what goes up, and a quiet frame."""
    caption(axes, title)
    axes.set_ylabel(up, fontsize=7.5, color=MUTED)
    axes.tick_params(labelsize=7, colors=MUTED, length=2.5)
    axes.grid(color="#e5e7eb", linewidth=0.6)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    for side in ("left", "bottom"):
        axes.spines[side].set_color(INK)
        axes.spines[side].set_linewidth(0.6)
