"""A fit to a picture, drawn: its islands beside those of the found plexus, and what differs in units of chance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely

from vasculo.draw.canvas import ACCENT, INK, MUTED, PILLAR, PILLAR_EDGE, SMALL, WIDTH, caption, new_figure, panel, save
from vasculo.geometry.neighbours import as_polygons
from vasculo.plexus.outlines import ring_nodes

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from vasculo.geometry.arrays import Floats
    from vasculo.geometry.domain import Domain
    from vasculo.measure.morphometry import Morphometry

VESSEL = "#fbfaf8"
"""Paper between the islands."""
MOST = 12.0
"""Differences beyond this are drawn at the edge, with their number."""
TITLE, ROW, PAD = 0.36, 0.23, 0.06
"""Heights of a title and of a row of the forest plot, and space around each panel, inches."""


@dataclass(frozen=True)
class Shown:
    """A window of a pattern: its domain, its table and a title."""

    domain: Domain
    table: Morphometry
    title: str


@dataclass(frozen=True)
class Bar:
    """A row of the forest plot: what, and mean and deviation of the difference of the best and the default settings."""

    name: str
    best: tuple[float, float]
    default: tuple[float, float]


@dataclass(frozen=True)
class Known:
    """A row of the settings: name, place of the best value, ends of the range (0 to 1), and its words."""

    name: str
    best: float
    low: float
    high: float
    words: str


def draw_match(
    target: Shown, found: Shown, bars: Sequence[Bar], known: Sequence[Known], path: Path, resolution: int = 160
) -> Path:
    """Draw a fit as a PNG file.

    Parameters
    ----------
    target, found : Shown
        The picture's islands and the plexus, drawn at one scale: the spacing of the islands.
    bars : sequence of Bar
        Differences from the target.
    known : sequence of Known
        What is known of the settings.
    path : Path
    resolution : int
        Dots per inch.

    Returns
    -------
    Path
    """
    size = (
        max(_extent(target), _extent(found)),
        max(_extent(target, 1), _extent(found, 1)),
    )
    high, low = 0.47 * WIDTH * size[1] / size[0] + TITLE, ROW * len(bars) + 2.0 * TITLE
    figure: Any = new_figure(WIDTH, high + low, resolution)  # its types know no subfigures
    figure.get_layout_engine().set(w_pad=PAD, h_pad=PAD)
    upper, lower = figure.subfigures(2, 1, height_ratios=(high, low))
    for axes, shown in zip(upper.subplots(1, 2), (target, found), strict=True):
        _islands(axes, shown, size)
    left, right = lower.subplots(1, 2, width_ratios=(1.0, 0.8))
    _forest(left, bars)
    _settings(right, known)
    return save(figure, path)


def _extent(shown: Shown, axis: int = 0) -> float:
    """Width or height of a window in spacings."""
    return (shown.table.window[axis + 2] - shown.table.window[axis]) / shown.table.spacing


def _islands(axes: Any, shown: Shown, size: tuple[float, float]) -> None:  # matplotlib has no types here
    """Draw the islands in a window, lengths in spacings, centred in a field of common size."""
    from matplotlib.collections import PolyCollection  # noqa: PLC0415  # heavy, and only here
    from matplotlib.patches import Rectangle  # noqa: PLC0415

    window = np.array(shown.table.window)
    middle, spacing = 0.5 * (window[:2] + window[2:]), shown.table.spacing
    inside = shapely.get_parts(shapely.intersection(as_polygons(shown.domain.pillars), shapely.box(*window)))
    rings: list[Floats] = [(ring_nodes(piece) - middle) / spacing for piece in inside if piece.area > 0.0]
    low, high = (window[:2] - middle) / spacing, (window[2:] - middle) / spacing
    axes.add_patch(Rectangle(low, *(high - low), facecolor=VESSEL, edgecolor=MUTED, linewidth=0.6, clip_on=False))
    axes.add_collection(PolyCollection(rings, facecolors=PILLAR, edgecolors=PILLAR_EDGE, linewidths=0.5))
    half = 0.5 * np.array(size)
    panel(axes, (-half[0], -half[1], half[0], half[1]), shown.title)
    axes.axis("off")


def _forest(axes: Any, bars: Sequence[Bar]) -> None:  # matplotlib has no types here
    """Draw the differences, a row a term."""
    axes.axvspan(-2.0, 2.0, color="#eef2f4", linewidth=0)
    axes.axvspan(-1.0, 1.0, color="#dde6ea", linewidth=0)
    axes.axvline(0.0, color=MUTED, linewidth=0.6)
    for row, bar in enumerate(bars):
        for (mean, spread), shift, colour, fill in (
            (bar.default, 0.18, MUTED, "white"),
            (bar.best, -0.18, ACCENT, ACCENT),
        ):
            place = float(np.clip(mean, -MOST, MOST))
            axes.errorbar(
                place,
                row + shift,
                xerr=spread,
                color=colour,
                marker="o",
                markersize=3.6,
                markerfacecolor=fill,
                linewidth=1.0,
            )
            if place != mean:
                axes.annotate(
                    f"{mean:.0f}",
                    (place, row + shift),
                    xytext=(0, 4),
                    textcoords="offset points",
                    fontsize=6,
                    ha="center",
                )
    axes.set_yticks(range(len(bars)), [bar.name for bar in bars], fontsize=SMALL)
    axes.set_ylim(len(bars) - 0.5, -0.5)
    axes.tick_params(axis="x", labelsize=SMALL)
    axes.set_xlabel("difference from the picture, in units of chance", fontsize=SMALL)
    caption(axes, "filled: found plexus; hollow: defaults")
    axes.spines[["top", "right"]].set_visible(False)


def _settings(axes: Any, known: Sequence[Known]) -> None:  # matplotlib has no types here
    """Draw the ranges of the settings within those that were searched."""
    for row, each in enumerate(known):
        axes.plot([0.0, 1.0], [row, row], color="#dde6ea", linewidth=5, solid_capstyle="round")
        axes.plot([each.low, each.high], [row, row], color=ACCENT, linewidth=3, solid_capstyle="round")
        axes.plot(each.best, row, "o", color=INK, markersize=4)
        axes.text(0.0, row + 0.38, each.words, fontsize=SMALL, color=MUTED, va="center")
    axes.set_yticks(range(len(known)), [each.name for each in known], fontsize=SMALL)
    axes.set_ylim(len(known) - 0.3, -0.5)
    axes.set_xlim(-0.04, 1.04)
    axes.set_xticks([])
    caption(axes, "settings: best, range of those as near")
    axes.spines[["top", "right", "bottom"]].set_visible(False)
