"""The table of a run's numbers: its columns, and the CSV file that spreadsheets open."""

from __future__ import annotations

import csv
import io
import os
from contextlib import suppress
from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from numpy.typing import NDArray

STAGES = ("vasculogenesis", "angiogenesis")
"""Stages with recorded steps, in their order; files hold the position in this tuple."""

COUNTS = ("step", "springs", "pillars", "merges", "triangles", "chains", "largest_chain", "events")
"""Columns of whole numbers."""

COLUMNS = (
    "stage",
    "step",
    "time",
    "springs",
    "void_fraction",
    "pillars",
    "merges",
    "order",
    "alignment",
    "aspect_ratio",
    "angle",
    "mean_gap",
    "permeability",
    "mean_wall_shear",
    "triangles",
    "residual",
    "mass_imbalance",
    "seconds",
    "local_angle",
    "chains",
    "largest_chain",
    "chain_fraction",
    "straightness",
    "resistance",
    "shear_variation",
    "shear_ratio",
    "corridors",
    "corridor_width",
    "corridor_run",
    "events",
    "seconds_mesh",
    "seconds_flow",
    "seconds_cells",
)
"""Columns of `metrics.csv`, in order."""

MEANINGS = {
    "stage": "vasculogenesis or angiogenesis",
    "step": "time step (vasculogenesis) or geometry step (angiogenesis)",
    "time": "model time (vasculogenesis) or accumulated activation strain (angiogenesis)",
    "springs": "living springs",
    "void_fraction": "share of the tissue covered by voids",
    "pillars": "voids so far (vasculogenesis) or pillars (angiogenesis)",
    "merges": "mergers so far",
    "order": "mean cos 2 theta, theta between the long axis of a pillar and the mean flow",
    "alignment": "the same, theta between the long axis and the friction drag on that pillar (the local flow)",
    "aspect_ratio": "long over short axis of the pillars, mean weighted by area",
    "angle": "mean long axis of the pillars against x, degrees",
    "mean_gap": "mean distance from a pillar to its nearest neighbour, model length",
    "permeability": "Darcy permeability along x, model length squared",
    "mean_wall_shear": "mean magnitude of the wall shear on the pillars, model pressure",
    "triangles": "triangles of the flow mesh",
    "residual": "largest force left over the force scale of the stage, dimensionless",
    "mass_imbalance": "largest relative error of the mass balance of the flow",
    "seconds": "wall time since the previous row of the stage",
    "local_angle": (
        "mean acute angle between the long axis of a pillar and the mean velocity around it (the local flow), degrees"
    ),
    "chains": "pillars that two or more original pillars have merged into",
    "largest_chain": "original pillars in the largest pillar",
    "chain_fraction": "share of the original pillars that are in chains",
    "straightness": "end-to-end distance over length of the middle line of the chains, mean weighted by length",
    "resistance": "pressure drop over flow rate, model pressure times model time per model length squared",
    "shear_variation": (
        "spread of the wall shear around each pillar over its own mean (root mean square over the pillars); "
        "0: uniform shear"
    ),
    "shear_ratio": "95th over 5th percentile of the pillars' mean wall shears; above 20 the plexus closes itself off",
    "corridors": (
        "effective number of lanes that carry the flow, (sum q)^2 / sum q^2 at stations across the mean "
        "flow, mean of the stations"
    ),
    "corridor_width": "width of these lanes, mean weighted by flow, model length",
    "corridor_run": (
        "how far a lane runs between the same two banks, without a branch: mean weighted by flow, model length"
    ),
    "events": "events (merges, borders, vanishings, splits, ...) since the previous row",
    "seconds_mesh": "wall time of the flow mesh in this step",
    "seconds_flow": "wall time of the flow in this step",
    "seconds_cells": "wall time of cells, matrix, motion and merging in this step",
}
"""What each column means, a line each."""

UNIT_OF = {
    "mean_gap": "length",
    "corridor_width": "length",
    "corridor_run": "length",
    "permeability": "area",
    "mean_wall_shear": "pressure",
    "resistance": "resistance",
    "angle": "angle",
    "local_angle": "angle",
    "seconds": "seconds",
    "seconds_mesh": "seconds",
    "seconds_flow": "seconds",
    "seconds_cells": "seconds",
}
"""Dimension of a column, as `vasculo.store.units` names it; the others are pure numbers or model time."""

Row = dict[str, float]


def to_csv(stages: Sequence[str], columns: Mapping[str, NDArray[np.float64]]) -> str:
    """Write the table as CSV text; numbers read back exactly, cells that do not apply are empty.

    Parameters
    ----------
    stages : sequence of str
        Stage of each row.
    columns : mapping of str to (rows,) float64
        NaN where a cell does not apply. A missing column is empty.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for row, stage in enumerate(stages):
        cells = [_cell(name, columns[name][row]) if name in columns else "" for name in COLUMNS[1:]]
        writer.writerow([stage, *cells])
    return text.getvalue()


def from_csv(path: Path) -> tuple[list[str], dict[str, NDArray[np.float64]]]:
    """Read what `to_csv` wrote, also as an earlier version did: a column that it does not have is NaN.

    Raises
    ------
    InputError
        When the file is no such table.
    """
    with path.open(newline="", encoding="utf-8") as file:
        rows = list(csv.reader(file))
    names = rows[0] if rows else []
    if tuple(names[:3]) != COLUMNS[:3] or not set(names) <= set(COLUMNS):
        raise InputError(f"{path} is no table of a run: its first line must name {', '.join(COLUMNS)}")
    body = rows[1:]
    columns = {name: np.full(len(body), np.nan) for name in COLUMNS[1:]}
    for place, name in enumerate(names[1:], 1):
        columns[name][:] = [float(row[place]) if row[place] else np.nan for row in body]
    return [row[0] for row in body], columns


def write_whole(path: Path, content: str | bytes) -> None:
    """Write a file so that it is there as a whole or not at all.

    Raises
    ------
    OSError
        When it cannot be written; nothing is left behind then.
    """
    part = path.with_name(f".{path.name}.part")
    try:
        part.write_bytes(content.encode() if isinstance(content, str) else content)
        os.replace(part, path)  # noqa: PTH105  # atomic on one file system, which is the point
    except OSError as error:
        with suppress(OSError):
            part.unlink(missing_ok=True)
        raise type(error)(error.errno, error.strerror, str(path)) from None


def _cell(name: str, value: float) -> str:
    if np.isnan(value):
        return ""
    return str(int(value)) if name in COUNTS else repr(float(value))
