"""What a picture of the flow needs beside it: a bar of a round length, an arrow of the flow, a colour bar."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.transforms import blended_transform_factory

from vasculo.draw.canvas import INK

if TYPE_CHECKING:
    from matplotlib.cm import ScalarMappable

    from vasculo.draw.canvas import Box
    from vasculo.store.read import Run

TEXT = 8.5  # points
_ROUND = (1.0, 2.0, 5.0)
_TICKS = (0.0, 0.1, 0.3, 0.6, 1.0)  # of the top of a scale that is not linear
_WAYS = {"left": (1, 0), "right": (-1, 0), "bottom": (0, 1), "top": (0, -1)}
_REACH = 15.0  # points, half the length of the arrow


def nice_length(wanted: float) -> float:
    """Largest of 1, 2, 5, 10, 20, ... that is not above `wanted`."""
    power = 10.0 ** np.floor(np.log10(wanted))
    return float(max(step * power for step in _ROUND if step * power <= wanted * (1.0 + 1e-12)))


def length_unit(run: Run) -> tuple[float, str]:
    """Model length of one unit of the scale bar, and its name: micrometres, or R0, the mean pillar radius at the start.

    Returns
    -------
    tuple of float and str
    """
    micrometres = run.settings.get("units", {}).get("length")
    if micrometres is not None:
        return 1.0 / float(micrometres), "µm"
    return run.domain(run.steps()[0]).mean_radius, "$R_0$"


def scale_bar(axes: Any, box: Box, unit: tuple[float, str], y: float = 0.1, measured: Any = None) -> None:
    """Draw a bar of a round length with its length above, at the lower left of empty axes.

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
    """
    wide = box[2] - box[0]
    length = nice_length(0.2 * wide / unit[0])
    place = blended_transform_factory((measured or axes).transData, axes.transAxes)
    left = box[0] + 0.06 * wide if measured is None else box[0]
    ends = (left, left + length * unit[0])
    axes.plot(ends, (y, y), transform=place, color=INK, linewidth=3.0, solid_capstyle="butt")
    words = {"xytext": (0.0, 5.0), "textcoords": "offset points", "fontsize": TEXT, "color": INK}
    axes.annotate(f"{length:g} {unit[1]}", (left, y), xycoords=place, **words)


def flow_arrow(axes: Any, run: Run, place: tuple[float, float]) -> None:
    """Draw an arrow from the side where the blood comes in; `place` is its middle, shares of the axes."""
    x, y = _WAYS.get(run.settings["angiogenesis"].get("inlet", "left"), (1, 0))
    where = {"xy": place, "xycoords": "axes fraction", "textcoords": "offset points"}
    style = {"arrowstyle": "-|>", "color": INK, "linewidth": 1.6, "shrinkA": 0.0, "shrinkB": 0.0}
    axes.annotate("", xytext=(-2.0 * _REACH * x, -2.0 * _REACH * y), arrowprops=style, **where)
    axes.annotate("flow", xytext=(6.0 + 2.0 * _REACH * (x < 0), -3.0), fontsize=TEXT, color=INK, **where)


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
        ticks = unit * np.array(MaxNLocator(5).tick_values(0.0, top / unit))
    bar.set_ticks(ticks[ticks <= top * (1.0 + 1e-9)])
    bar.minorticks_off()
    bar.ax.xaxis.set_major_formatter(lambda value, _: f"{value / unit:.2g}")
    bar.ax.tick_params(labelsize=7.5, length=2.5)
    bar.ax.set_title(words, fontsize=TEXT, color=INK, loc="left", pad=4)
    bar.outline.set_linewidth(0.6)
    return bar
