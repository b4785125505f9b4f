"""What all pictures share: colours, panels, captions, and how a picture becomes a file."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any, Literal

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
RESOLUTION = 200  # dots per inch
TEXT, SMALL = 8.0, 7.0  # points: captions; numbers at bars and axes
WIDTH = 180.0 / 25.4
"""Width of a picture, inches: two columns of a journal."""


def _scale(name: str, *tones: str, clipped: bool = False) -> LinearSegmentedColormap:
    scale = LinearSegmentedColormap.from_list(name, tones)
    scale.colorbar_extend = "max" if clipped else False  # type: ignore[assignment]  # takes words too
    return scale


# All scales go from dark to light or from light to dark only, so that grey print keeps their order; `tests/draw` holds
# them to it, also as colour-blind eyes see them.
SPEED = _scale("speed", "#0a0d14", "#152c42", "#1f6f8b", "#5fb4c4", "#8adbe0", clipped=True)
"""Dark where the fluid rests, bright where it is fast; also in grey never as light as a pillar."""

CHAIN = _scale("chain", "#f9f1ea", "#f0c9b4", "#e59a6f", "#d0623d", "#a02a1b")
"""Pale for a single pillar, strong for the largest chain."""

SHEAR = _scale("shear", "#ecc987", "#ee9f58", "#d55c3d", "#9a2b3e", "#46103e", clipped=True)
"""Sand where the shear is small, dark where it is large."""

PRESSURE = _scale("pressure", "#f4eff8", "#c9bfe0", "#9686bf", "#62509a", "#2f1f5c")
"""Pale at the outlet, dark at the inlet."""

ERROR = _scale("error", "#2050a8", "#7592bf", "#b9b6ae", "#dfcd8e", "#fff3b0")
"""Blue below, grey at, bright yellow above zero; for lines on dark ground."""

CHAINS = ("#004667", "#fb971e", "#0ca457", "#cd0003", "#916eff", "#6c1418", "#c27bc5", "#5500a2")
"""Colours that name single chains: far from each other for every kind of eye."""


def new_figure(
    width: float, height: float, resolution: int = RESOLUTION, layout: Literal["constrained"] | None = "constrained"
) -> Figure:
    """Make an empty figure, sizes in inches, resolution in dots per inch; no global state is touched."""
    figure = Figure(figsize=(width, height), dpi=resolution, layout=layout, facecolor="white")
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
    axes.set_title(title, fontsize=TEXT, color=INK, loc="left", pad=4)


def fragment(box: Box, centre: tuple[float, float], share: float = 1.0 / 3.0) -> Box:
    """Cut a square of `share` of the shorter side out of `box`, around `centre` as far as it fits."""
    half = 0.5 * share * min(box[2] - box[0], box[3] - box[1])
    x = min(max(centre[0], box[0] + half), box[2] - half)
    y = min(max(centre[1], box[1] + half), box[3] - half)
    return x - half, y - half, x + half, y + half


def render(figure: Figure, kind: str = "png", dpi: float | None = None) -> bytes:
    """Render a figure as PNG, SVG or PDF; the same figure gives the same bytes.

    Text stays text in SVG and PDF; what is too much for vector graphics is an image inside.
    """
    from matplotlib import rc_context  # noqa: PLC0415  # global state, for just as long as it takes

    buffer = io.BytesIO()
    with rc_context({"svg.fonttype": "none", "svg.hashsalt": "vasculo", "pdf.fonttype": 42}):
        figure.savefig(buffer, format=kind, dpi=dpi or "figure", metadata=_UNDATED[kind])
    if kind != "svg":
        return buffer.getvalue()
    from vasculo.draw.embedded import lighter  # noqa: PLC0415  # only here

    return lighter(buffer.getvalue())


_UNDATED: dict[str, dict[str, Any]] = {
    "png": {"Software": None},
    "svg": {"Date": None, "Creator": None},
    "pdf": {"CreationDate": None, "Creator": None, "Producer": None},
}
FORMATS = tuple(_UNDATED)


def png(figure: Figure) -> bytes:
    """Render a figure as PNG."""
    return render(figure)


def save(figure: Figure, path: Path, dpi: float | None = None) -> Path:
    """Write a figure in the format that the name of the file ends with, whole or not at all."""
    path.parent.mkdir(parents=True, exist_ok=True)
    write_whole(path, render(figure, path.suffix[1:], dpi))
    return path
