"""What a picture of the flow needs beside it: a bar of a round length, an arrow of the flow, a colour bar."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.transforms import blended_transform_factory

from vasculo.draw.canvas import INK, SMALL, TEXT
from vasculo.draw.springs import CLIP, look

if TYPE_CHECKING:
    from matplotlib.cm import ScalarMappable

    from vasculo.draw.canvas import Box
    from vasculo.store.read import Run

_ROUND = (1.0, 2.0, 5.0)
_TICKS = (0.0, 0.1, 0.3, 0.6, 1.0)  # of the top of a scale that is not linear
_WAYS = {"left": (1, 0), "right": (-1, 0), "bottom": (0, 1), "top": (0, -1)}
_REACH = 15.0  # points, half the length of the arrow


def nice_length(wanted: float) -> float:
    """Largest of 1, 2, 5, 10, 20, ... that is not above `wanted`."""
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(max(step * power for step in _ROUND if step * power <= wanted * (1.0 + 1e-12)))


def length_unit(run: Run) -> tuple[float, str]:
    """Model length of one unit of the scale bar, and its name.

    Micrometres where the study names them; else R0, the mean pillar radius at the start; without pillars the side of
    the tissue.

    Returns
    -------
    tuple of float and str
    """
    if run.units.known("length"):
        return 1.0 / run.units.factor("length"), run.units.name("length")
    steps = run.steps()
    return (run.domain(steps[0]).mean_radius, "R₀") if steps else (1.0, "of the side")


def scale_bar(
    axes: Any,
    box: Box,
    unit: tuple[float, str],
    y: float = 0.1,
    measured: Any = None,
    start: float = 0.06,
    words: str = "",
) -> None:
    """Draw a bar of a round length with its length above.

    Parameters
    ----------
    axes : matplotlib Axes
        Where.
    box : tuple of float
        Region xmin, ymin, xmax, ymax of the picture; model length.
    unit : tuple of float and str
        From `length_unit`.
    y : float
        Height of the bar, share of the axes.
    measured : matplotlib Axes, optional
        The picture whose scale it has; by default these axes.
    start : float
        Where it begins, share of the width of the picture.
    words : str
        What comes before its length.
    """
    wide = box[2] - box[0]
    length = nice_length(0.2 * wide / unit[0])
    place = blended_transform_factory((measured or axes).transData, axes.transAxes)
    left = box[0] + start * wide
    ends = (left, left + length * unit[0])
    axes.plot(ends, (y, y), transform=place, color=INK, linewidth=2.5, solid_capstyle="butt")
    where = {"xycoords": place, "xytext": (0.0, 4.5), "textcoords": "offset points"}
    axes.annotate(f"{words}{length:g} {unit[1]}", (left, y), fontsize=TEXT, color=INK, **where)


def flow_way(run: Run) -> tuple[int, int]:
    """Direction of the flow, from the side where the blood comes in: x and y, one of them 0."""
    return _WAYS.get(run.settings["angiogenesis"].get("inlet", "left"), (1, 0))


def flow_arrow(axes: Any, run: Run, place: tuple[float, float]) -> None:
    """Draw an arrow from the side where the blood comes in; `place` is its head, shares of the axes."""
    x, y = flow_way(run)
    where = {"xy": place, "xycoords": "axes fraction", "textcoords": "offset points"}
    style = {"arrowstyle": "-|>", "color": INK, "linewidth": 1.6, "shrinkA": 0.0, "shrinkB": 0.0}
    axes.annotate("", xytext=(-2.0 * _REACH * x, -2.0 * _REACH * y), arrowprops=style, **where)
    axes.annotate("flow", xytext=(6.0 + 2.0 * _REACH * (x < 0), -3.0), fontsize=TEXT, color=INK, **where)


def force_key(axes: Any, place: tuple[float, float, float, float]) -> None:
    """Put the key of the springs into empty axes: pieces of lines, wider and darker with their force.

    `place` is left, bottom, width and height, shares of the axes.
    """
    from matplotlib.collections import LineCollection  # noqa: PLC0415  # heavy, and only here

    inside = axes.inset_axes(place)
    ends = np.linspace(0.0, 1.0, 41)
    pieces = np.stack((ends[:-1], ends[1:]), axis=1)
    widths, greys = look(pieces.mean(axis=1))
    lines = np.stack((pieces, np.full_like(pieces, 0.5)), axis=2)
    inside.add_collection(LineCollection(list(lines), linewidths=3.0 * widths, colors=greys.astype(str).tolist()))
    inside.set(xlim=(0.0, 1.0), ylim=(0.0, 1.0), yticks=[])
    inside.set_xticks([0.0, 1.0], ["0", f"{CLIP:g}th percentile"])
    inside.tick_params(labelsize=SMALL, length=0.0)
    for label, side in zip(inside.get_xticklabels(), ("left", "right"), strict=True):
        label.set_horizontalalignment(side)
    for spine in inside.spines.values():
        spine.set_visible(False)
    inside.set_title("pull of a spring", fontsize=TEXT, color=INK, loc="left", pad=4)


def colour_bar(
    axes: Any, shown: ScalarMappable, words: str, place: tuple[float, float, float, float], unit: float = 1.0
) -> Any:
    """Put a lying colour bar into empty axes and return it.

    Parameters
    ----------
    axes : matplotlib Axes
        Where.
    shown : ScalarMappable
        What it explains.
    words : str
        Caption.
    place : tuple of float
        Left, bottom, width and height, shares of the axes.
    unit : float
        The numbers are told in this.
    """
    from matplotlib.colors import PowerNorm  # noqa: PLC0415  # heavy, and only here
    from matplotlib.ticker import MaxNLocator  # noqa: PLC0415

    bar = axes.figure.colorbar(shown, cax=axes.inset_axes(place), orientation="horizontal")
    top = float(shown.norm.vmax)  # type: ignore[arg-type]  # set, and a number
    if isinstance(shown.norm, PowerNorm) and shown.norm.gamma != 1.0:
        ticks = top * np.array(_TICKS)
    else:
        inches = place[2] * axes.get_position().width * axes.figure.get_figwidth()
        ticks = unit * np.array(MaxNLocator(max(2, min(5, int(inches / 0.4)))).tick_values(0.0, top / unit))
    bar.set_ticks(ticks[ticks <= top * (1.0 + 1e-9)])
    bar.minorticks_off()
    bar.ax.xaxis.set_major_formatter(lambda value, _: f"{float(f'{value / unit:.2g}'):g}")
    bar.ax.tick_params(labelsize=SMALL, length=2.5)
    bar.ax.set_title(words, fontsize=TEXT, color=INK, loc="left", pad=4)
    bar.outline.set_linewidth(0.6)
    return bar
