"""A sheet: pictures at their true shape, below them what the colours mean, a scale bar, and where the blood goes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from vasculo.draw.canvas import INK, RESOLUTION, TEXT, new_figure
from vasculo.draw.scale import colour_bar, flow_arrow, flow_way, force_key, length_unit, scale_bar

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure

    from vasculo.draw.canvas import Box
    from vasculo.store.read import Run

_MARGIN, _GAP, _TITLE = 0.05, 0.1, 0.24  # inches: around all, between columns, above each picture
_STRIP, _ROW = 0.52, 0.18  # inches: the strip below, and what a row of its legend adds
_TALLEST = 1.25  # height of all pictures over the width of the sheet, at most
_BAR, _LEFT = 0.42, 0.53  # shares of the strip: colour bar; all that is left of the scale bar


@dataclass(frozen=True)
class Legend:
    """Entries of a legend below the pictures, each at most `each` inches wide."""

    handles: Sequence[Any]
    title: str = ""
    each: float = 0.68

    def columns(self, width: float) -> int:
        """Entries beside each other in a width in inches."""
        return max(1, min(len(self.handles), int(width / self.each)))

    def rows(self, width: float) -> int:
        """Lines that it takes in a width in inches."""
        return -(-len(self.handles) // self.columns(width)) + bool(self.title)


@dataclass(frozen=True)
class Sheet:
    """A figure with pictures of one shape, and a strip below them.

    Attributes
    ----------
    figure : matplotlib Figure
        Without a layout engine: nothing on it moves.
    panels : list of matplotlib Axes
        The pictures, row by row.
    below : matplotlib Axes
        The strip, which `key` fills.
    box : tuple of float
        Region that the first picture shows; model length.
    legend : Legend or None
        Entries for which there is room: below a colour bar, or in its place.
    bar : bool
        Whether there is room for a colour bar.
    """

    figure: Figure
    panels: list[Any]
    below: Any
    box: Box
    legend: Legend | None
    bar: bool

    @property
    def strip(self) -> tuple[float, float]:
        """Width and height of the strip, inches."""
        wide, high = self.below.get_position().size * self.figure.get_size_inches()
        return float(wide), float(high)

    @property
    def row(self) -> float:
        """Height of the colour bar, the scale bar and the arrow, share of the strip."""
        return 1.0 - 0.26 / self.strip[1]


def sheet(
    box: Box,
    width: float,
    count: int = 1,
    columns: int = 1,
    *,
    legend: Legend | None = None,
    bar: bool = True,
    resolution: int = RESOLUTION,
) -> Sheet:
    """Make an empty sheet with an even number of pixels each way.

    Parameters
    ----------
    box : tuple of float
        Region xmin, ymin, xmax, ymax that each picture shows; model length.
    width : float
        Width of the sheet, inches.
    count, columns : int
        Number of pictures, and how many stand beside each other.
    legend : Legend, optional
        Entries of a legend.
    bar : bool
        Make room for a colour bar.
    resolution : int
        Dots per inch.
    """
    down = -(-count // columns)
    wide = (width - 2.0 * _MARGIN - _GAP * (columns - 1)) / columns
    span = box[2] - box[0], box[3] - box[1]
    high = min(wide * span[1] / span[0], _TALLEST * width / down)
    shown = min(wide, high * span[0] / span[1])
    room = width if bar else _LEFT * width
    lines = legend.rows(room) if legend else 0
    strip = max(_STRIP, _ROW * lines + (_STRIP if bar else 0.1))
    height = down * (high + _TITLE) + strip + _MARGIN
    pixels = [2 * max(1, round(0.5 * side * resolution)) for side in (width, height)]
    figure = new_figure(pixels[0] / resolution, pixels[1] / resolution, resolution, layout=None)
    panels = []
    for k in range(count):
        row, column = divmod(k, columns)
        left = _MARGIN + column * (wide + _GAP) + 0.5 * (wide - shown)
        bottom = height - (row + 1) * (high + _TITLE)
        panels.append(figure.add_axes((left / width, bottom / height, shown / width, high / height)))
    strip -= 0.06
    below = figure.add_axes((_MARGIN / width, _MARGIN / height, 1.0 - 2.0 * _MARGIN / width, strip / height))
    below.set_axis_off()
    return Sheet(figure, panels, below, box, legend, bar)


def key(
    made: Sheet,
    run: Run,
    shown: Any = None,
    words: str = "",
    told: float = 1.0,
    *,
    blood: bool = True,
) -> None:
    """Fill the strip of a sheet.

    Parameters
    ----------
    made : Sheet
        From `sheet`.
    run : Run
        For the units, and for the side where the blood comes in.
    shown : ScalarMappable or "springs", optional
        What the colour bar explains; none by default.
    words : str
        Caption of the colour bar.
    told : float
        The numbers of the colour bar are told in this.
    blood : bool
        Draw the direction of the flow.
    """
    wide, high = made.strip
    if isinstance(shown, str):
        force_key(made.below, (0.0, made.row, _BAR, 0.1 / high))
    elif shown is not None:
        colour_bar(made.below, shown, words, (0.0, made.row, _BAR, 0.09 / high), told)
    if made.legend is not None:
        made.below.legend(
            handles=list(made.legend.handles),
            title=made.legend.title or None,
            ncols=made.legend.columns(wide if made.bar else _LEFT * wide),
            bbox_to_anchor=(0.0, 1.0 - 0.5 / high if made.bar else 1.0),
            **LEGEND,
        )
    bar_of(made, length_unit(run), _LEFT, made.panels[0], made.box)
    if blood:
        head = 1.0 - 0.38 / wide, made.row + 0.2 / high * flow_way(run)[1]
        flow_arrow(made.below, run, head)


def bar_of(made: Sheet, unit: tuple[float, str], share: float, panel: Any, box: Box, words: str = "") -> None:
    """Draw the scale bar of a panel that shows `box`, beginning at a share of the strip; `unit` as of `length_unit`."""
    strip, place = made.below.get_position(), panel.get_position()
    start = (strip.x0 + share * strip.width - place.x0) / place.width
    scale_bar(made.below, box, unit, made.row, panel, start, words)


LEGEND: dict[str, Any] = {
    "loc": "upper left",
    "alignment": "left",
    "fontsize": TEXT,
    "title_fontsize": TEXT,
    "frameon": False,
    "labelcolor": INK,
    "handlelength": 1.2,
    "columnspacing": 1.2,
    "borderpad": 0.0,
    "borderaxespad": 0.0,
}
"""Look of all legends."""
