"""The table of a run as plots over the steps."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.draw.canvas import ACCENT, MUTED, PILLAR_EDGE
from vasculo.store.table import UNIT_OF
from vasculo.view.sdk import bytes_of, rerun

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from vasculo.store.units import Units

PLOTS = (
    ("Voids and pillars", ("pillars", "merges", "chains")),
    ("Order", ("order", "alignment", "void_fraction")),
    ("Permeability", ("permeability",)),
    ("Shear ratio", ("shear_ratio",)),
    ("Wall shear", ("mean_wall_shear",)),
    ("Aspect ratio", ("aspect_ratio",)),
    ("Gap", ("mean_gap",)),
    ("Residual", ("residual",)),
)
"""Plots, and the columns of the table in each; those that a run does not have are left out."""

COLUMNS = tuple(column for _, columns in PLOTS for column in columns)
EARLY = ("pillars", "void_fraction", "residual")
"""Those that the vasculogenesis has."""

_COLOURS = (ACCENT, PILLAR_EDGE, MUTED, "#c98a1b")
_NAMES = {
    "pillars": "voids, then pillars",
    "merges": "mergers",
    "order": "order cos 2θ",
    "alignment": "alignment cos 2θ",
}


def entity(column: str) -> str:
    """Name of a column among the layers of the viewer."""
    return f"numbers/{column}"


def title(column: str, units: Units) -> str:
    """Name of a column with its unit.

    Examples
    --------
    >>> from vasculo.store.units import Units
    >>> title("permeability", Units(length=1000.0)), title("merges", Units())
    ('permeability, µm²', 'mergers')
    """
    unit = units.name(UNIT_OF.get(column, ""))
    name = _NAMES.get(column, column.replace("_", " "))
    return f"{name}, {unit}" if unit else name


def style(column: str, units: Units) -> rerun.SeriesLines:
    """Line of a column: its name with the unit, and a colour that differs from the others of its plot."""
    place = next(columns.index(column) for _, columns in PLOTS if column in columns)
    return rerun.SeriesLines(names=title(column, units), colors=bytes_of(_COLOURS[place]), widths=1.8)


def plotted(metrics: Mapping[str, NDArray[np.float64]]) -> list[str]:
    """Columns with at least one number, in the order of the plots."""
    return [column for column in COLUMNS if column in metrics and np.isfinite(metrics[column]).any()]
