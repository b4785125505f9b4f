"""Where the size field may be below its largest value: a coarse map that spares most searches."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.geometry.arrays import Bytes, Floats
    from vasculo.mesh.size import SizeField

PITCH = 0.5
"""Cells of the map of tight places, in largest sizes."""

CELLS = 4_000_000
"""Most cells of that map."""

ACROSS = 16.0
"""Cells across the influence of one source, at most about twice this number."""


def mark_tight(
    field: SizeField, low: NDArray[np.float64], high: NDArray[np.float64]
) -> tuple[NDArray[np.uint8], float]:
    """Map of the places where some source may ask for less than the largest size.

    Parameters
    ----------
    field : SizeField
    low, high : (2,) float64, model length
        Corners of the domain's bounding box.

    Returns
    -------
    tight : (rows, columns) uint8
        0 where the wanted size is certainly the largest.
    fineness : float
        Cells a model length.
    """
    reach = (field.largest - field.sources.weights) / field.slope
    pitch = max(
        PITCH * field.largest,
        float(np.sqrt(np.prod(high - low) / CELLS)),
        float(np.median(np.maximum(reach, 0.0))) / ACROSS,
    )
    columns, rows = np.maximum(np.ceil((high - low) / pitch), 1.0).astype(np.int64)
    tight = np.zeros((rows, columns), dtype=np.uint8)
    mark_boxes(tight, field.sources.segments, reach, low[0], low[1], 1.0 / pitch)
    return tight, 1.0 / pitch


@njit(cache=True, error_model="numpy")
def mark_boxes(tight: Bytes, segments: Floats, reach: Floats, left: float, bottom: float, fineness: float) -> None:
    """Set the cells within `reach` of each segment's bounding box to 1."""
    rows, columns = tight.shape
    for s in range(len(segments)):
        r = reach[s]
        if r <= 0.0:
            continue
        first = max(0, int(np.floor((min(segments[s, 0], segments[s, 2]) - r - left) * fineness)))
        last = min(columns - 1, int((max(segments[s, 0], segments[s, 2]) + r - left) * fineness))
        top = min(rows - 1, int((max(segments[s, 1], segments[s, 3]) + r - bottom) * fineness))
        for row in range(max(0, int(np.floor((min(segments[s, 1], segments[s, 3]) - r - bottom) * fineness))), top + 1):
            for column in range(first, last + 1):
                tight[row, column] = 1
