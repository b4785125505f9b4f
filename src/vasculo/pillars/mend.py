"""Outlines that nearly touch themselves: a narrow bay is filled, a thin spike falls off."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import shapely

from vasculo.geometry.outline import as_outline, is_simple, resample
from vasculo.pillars.closing import joined
from vasculo.pillars.parameters import MINIMUM_NODES
from vasculo.pillars.splitting import NECK, thin

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

LEAST = 0.5  # area that a bay or a spike has at least, gaps squared: less is a rounded corner


def mended(
    outlines: Sequence[NDArray[np.float64]], gap: float, radius: float, spacing: float
) -> dict[int, NDArray[np.float64]]:
    """Close what a membrane has come near to itself across fluid, and cut what has become too thin to be a pillar.

    A bay narrower than `gap` is filled by the closing with which pillars merge; of an outline that has a spike thinner
    than a neck (`NECK` gaps) the largest piece of the opening is kept.

    Parameters
    ----------
    outlines : sequence of (k, 2) float64, model length
        Simple, counter-clockwise.
    gap, radius, spacing : float, model length
        Distance at which pillars merge, radius of the closing, node spacing of a new outline.

    Returns
    -------
    dict of int to (k, 2) float64
        The new outlines, by the numbers of the old ones.
    """
    result = {}
    for pillar in thin(outlines, gap).tolist():
        shape = old = shapely.Polygon(outlines[pillar])
        if _filled(shape, 0.5 * gap).area > old.area + LEAST * gap**2:
            shape = _filled(shape, radius)
        half = 0.5 * NECK * gap
        opened = _largest(shapely.buffer(shapely.buffer(shape, -half), half))
        if not opened.is_empty and opened.area < shape.area - LEAST * gap**2:
            shape = opened
        if shape is not old:
            ring = as_outline(np.asarray(shape.exterior.coords)[:-1])
            fresh = resample(ring, spacing, minimum=MINIMUM_NODES)
            result[pillar] = fresh if is_simple(fresh) else joined([ring], radius, spacing)
    return result


def _filled(shape: shapely.Polygon, radius: float) -> shapely.Polygon:
    """Return the closing of a polygon, with the fluid that it encloses."""
    return shapely.Polygon(_largest(shapely.buffer(shapely.buffer(shape, radius), -radius)).exterior)


def _largest(shape: shapely.Geometry) -> shapely.Polygon:
    """Return the largest piece; an empty polygon where there is none."""
    return max(shapely.get_parts(shape), key=lambda piece: piece.area, default=shapely.Polygon())
