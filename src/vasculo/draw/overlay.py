"""A picture with the outlines that were taken from it, to judge them by."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from vasculo.draw.canvas import ACCENT, INK, MUTED, caption, new_figure, save
from vasculo.draw.scale import nice_length
from vasculo.plexus.image_levels import grey_values

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from vasculo.plexus.image import Pictured
    from vasculo.plexus.image_parameters import Side

    Floats = NDArray[np.float64]

WHOLE, CUT, WALL, LOST = "#d1451b", "#f2b134", "#5b2a86", "#f06fb4"
"""Colours of pillars, pillars that the border cuts, walls, and vessel parts that were left out."""
PALE = 0.45
"""Share of white that is laid over the picture."""
_SIDE, _BAR = 8.0, 0.2  # inches of the longer side; wanted length of the scale bar over the width
_RIM = 0.035  # width of the rim with the marks, over the longer side


def draw_overlay(picture: NDArray[np.generic], found: Pictured, pixel_size: float | None, path: Path) -> Path:
    """Draw the outlines of a domain over the picture they were taken from.

    Parameters
    ----------
    picture : (h, w), (h, w, 3) or (h, w, 4) array
        The (cropped) picture.
    found : Pictured
        What was taken from it.
    pixel_size : float, optional
        Size of a pixel, micrometres; with it a scale bar is drawn.
    path : Path
        PNG file to write.

    Returns
    -------
    Path
    """
    from matplotlib.collections import LineCollection, PolyCollection  # noqa: PLC0415  # heavy, and only here
    from matplotlib.lines import Line2D  # noqa: PLC0415

    height, width = found.mask.shape
    wide = 1.6 * _RIM * max(width, height)
    thin = 0.1 * wide
    sideways = found.inlet in ("left", "right")
    rim, top = (wide, thin) if sideways else (thin, wide)
    bottom = thin if sideways and pixel_size is None else wide
    factor = _SIDE / max(width, height)
    figure = new_figure((width + 2.0 * rim) * factor, (height + top + bottom) * factor + 0.7)
    axes = figure.subplots()
    shown = _shades(picture)
    shown[found.lost] = _rgb(LOST)
    axes.imshow(shown, extent=(0.0, width, height, 0.0), interpolation="nearest")
    outlines = [found.in_picture(pillar) for pillar in found.domain.pillars]
    colours = [CUT if cut else WHOLE for cut in found.cut]
    line = 0.5 if len(outlines) > 100 else 1.0
    axes.add_collection(
        PolyCollection(outlines, facecolors=[(*_rgb(c), 0.18) for c in colours], edgecolors=colours, linewidths=line)
    )
    corners = found.in_picture(found.domain.outer)
    walls = np.stack((corners, np.roll(corners, -1, axis=0)), axis=1)[np.array(found.domain.sides) == "wall"]
    axes.add_collection(LineCollection(list(walls), colors=WALL, linewidths=1.5 * line))
    _mark_sides(axes, found.inlet, width, height)
    axes.set(xlim=(-rim, width + rim), ylim=(height + bottom, -top), aspect="equal")
    axes.set_axis_off()
    if pixel_size is not None:
        _scale_bar(axes, width, height, pixel_size)
    counts = {WHOLE: ("pillar", int((~found.cut).sum())), CUT: ("pillar cut by the border", int(found.cut.sum()))}
    counts |= {WALL: ("island that is wall", found.report.walls), LOST: ("vessel left out", found.report.lost_parts)}
    keys = [Line2D([], [], color=c, label=f"{name}: {count}") for c, (name, count) in counts.items() if count]
    figure.legend(handles=keys, loc="outside lower center", ncols=4, fontsize=7.5, frameon=False, labelcolor=INK)
    caption(axes, f"{len(outlines)} pillars · fluid fraction {found.report.fluid_fraction:.2f}")
    return save(figure, path)


def _shades(picture: NDArray[np.generic]) -> Floats:
    """Grey values of a picture as colours from 0 to 1, stretched over their range and paled."""
    grey = grey_values(picture)
    share = (grey - grey.min()) / (grey.max() - grey.min())
    return np.repeat((PALE + (1.0 - PALE) * share)[..., None], 3, axis=2)


def _rgb(colour: str) -> tuple[float, float, float]:
    """Colour as three numbers from 0 to 1."""
    from matplotlib.colors import to_rgb  # noqa: PLC0415

    return to_rgb(colour)


def _mark_sides(axes: Any, inlet: Side, width: int, height: int) -> None:
    """Put a bar with an arrow along the inlet and the outlet."""
    rim = _RIM * max(width, height)
    across = {"left": (1, 0), "right": (-1, 0), "top": (0, 1), "bottom": (0, -1)}[inlet]
    middle = np.array([0.5 * width, 0.5 * height])
    for word, sign in (("inlet", -1.0), ("outlet", 1.0)):
        place = middle + sign * np.array(across) * (middle + 0.3 * rim)
        along = np.array(across[::-1]) * middle
        axes.plot(*np.stack((place - along, place + along)).T, color=ACCENT, linewidth=2.5, solid_capstyle="butt")
        label = place + sign * np.array(across) * 0.8 * rim
        angle = 90.0 if across[0] else 0.0
        arrow = {(1, 0): "↓", (-1, 0): "↑", (0, 1): "↓", (0, -1): "↑"}[across]
        axes.text(*label, f"{arrow} {word} {arrow}", rotation=angle, ha="center", va="center", color=ACCENT, fontsize=8)


def _scale_bar(axes: Any, width: int, height: int, pixel_size: float) -> None:
    """Put a bar of a round number of micrometres below the picture, at the right."""
    length = nice_length(_BAR * width * pixel_size)
    rim = _RIM * max(width, height)
    y = height + 0.85 * rim
    axes.plot((width - length / pixel_size, width), (y, y), color=INK, linewidth=3.0, solid_capstyle="butt")
    text = f"{length:g} µm"
    axes.text(width - length / pixel_size - 0.3 * rim, y, text, ha="right", va="center", fontsize=8, color=INK)
    axes.text(0.0, y, f"{pixel_size:g} µm a pixel", ha="left", va="center", fontsize=7, color=MUTED)
