"""What all pictures share: colours, panels, captions, and how a picture becomes a file."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

from vasculo.errors import missing_extra
from vasculo.store.table import write_whole

try:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.colors import LinearSegmentedColormap
    from matplotlib.figure import Figure
except ImportError:
    raise missing_extra("pictures", "matplotlib", "draw") from None

if TYPE_CHECKING:
    from pathlib import Path

    Box = tuple[float, float, float, float]

INK = "#20242c"
MUTED = "#6b7280"
PILLAR = "#f0c9b4"
PILLAR_EDGE = "#8f4331"
ACCENT = "#1f6f8b"
RESOLUTION = 160  # dots per inch

SPEED = LinearSegmentedColormap.from_list("speed", ["#0a0d14", "#152c42", "#1f6f8b", "#5fb4c4", "#8adbe0"])
"""Dark where the fluid rests, bright where it is fast; also in grey never as light as a pillar."""

CHAIN = LinearSegmentedColormap.from_list("chain", ["#f9f1ea", "#f0c9b4", "#e59a6f", "#d0623d", "#b0331f"])
"""Pale for a single pillar, strong for the largest chain."""

SHEAR = LinearSegmentedColormap.from_list("shear", ["#2b3a67", "#4a7fa7", "#e8dcc4", "#e08a4f", "#a61c1c"])
"""Blue below, sand at, red above the middle of its scale."""


def new_figure(width: float, height: float, resolution: int = RESOLUTION) -> Figure:
    """Make an empty figure, sizes in inches, resolution in dots per inch; no global state is touched."""
    figure = Figure(figsize=(width, height), dpi=resolution, layout="constrained", facecolor="white")
    FigureCanvasAgg(figure)
    return figure


def panel(axes: Any, box: Box, title: str = "") -> None:  # matplotlib has no types here
    """Turn axes into a plain picture of the region `box` (xmin, ymin, xmax, ymax), with a small caption."""
    axes.set_xlim(box[0], box[2])
    axes.set_ylim(box[1], box[3])
    axes.set_aspect("equal")
    axes.set_xticks([])
    axes.set_yticks([])
    for spine in axes.spines.values():
        spine.set_color(INK)
        spine.set_linewidth(0.6)
    caption(axes, title)


def caption(axes: Any, title: str) -> None:
    """Put a small caption above the axes, at the left."""
    axes.set_title(title, fontsize=8.5, color=INK, loc="left", pad=4)


def fragment(box: Box, centre: tuple[float, float], share: float = 1.0 / 3.0) -> Box:
    """Cut a square of `share` of the shorter side out of `box`, around `centre` as far as it fits."""
    half = 0.5 * share * min(box[2] - box[0], box[3] - box[1])
    x = min(max(centre[0], box[0] + half), box[2] - half)
    y = min(max(centre[1], box[1] + half), box[3] - half)
    return x - half, y - half, x + half, y + half


def png(figure: Figure) -> bytes:
    """Render a figure as PNG; the same figure gives the same bytes."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", metadata={"Software": None})
    return buffer.getvalue()


def save(figure: Figure, path: Path) -> Path:
    """Write a figure as a PNG file, whole or not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, png(figure))
    return path
