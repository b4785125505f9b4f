"""Closing: outlines that touch themselves or each other become one simple outline."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import shapely

from vasculo.errors import ComputationError
from vasculo.geometry.neighbours import as_polygons
from vasculo.geometry.outline import as_outline, is_simple, resample
from vasculo.pillars.parameters import MINIMUM_NODES

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

WIDEN = 1.5  # the closing radius grows by this until one polygon results
WIDEN_TIMES = 12


def close_up(outlines: Sequence[NDArray[np.float64]], radius: float) -> NDArray[np.float64]:
    """Join outlines to one simple outline: exterior ring of the morphological closing of their union.

    Fluid that the union encloses is filled.

    Parameters
    ----------
    outlines : sequence of (k, 2) float64
        One outline may be given too; a crossing in it goes away.
    radius : float
        Radius of the closing, model length; widened by 1.5 until one piece results.

    Returns
    -------
    (k, 2) float64
        Counter-clockwise, not evenly spaced.

    Raises
    ------
    ComputationError
        If the pieces are too far apart to be joined.
    """
    polygons = as_polygons(outlines)
    for _ in range(WIDEN_TIMES):
        closed = shapely.buffer(shapely.union_all(shapely.buffer(polygons, radius)), -radius)
        if isinstance(closed, shapely.Polygon) and not closed.is_empty:
            return as_outline(np.asarray(closed.exterior.coords)[:-1])
        radius *= WIDEN
    raise ComputationError(f"{len(outlines)} pillars cannot be joined by a closing of radius {radius / WIDEN:.3g}")


def joined(outlines: Sequence[NDArray[np.float64]], radius: float, spacing: float) -> NDArray[np.float64]:
    """Join outlines as `close_up` does, with evenly spaced nodes; (k, 2) float64, simple."""
    for _ in range(WIDEN_TIMES):
        outline = resample(close_up(outlines, radius), spacing, minimum=MINIMUM_NODES)
        if is_simple(outline):
            return outline
        radius *= WIDEN
    raise ComputationError(f"{len(outlines)} pillars cannot be joined with nodes {spacing:.3g} apart")
