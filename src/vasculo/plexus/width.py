"""How wide the narrowest tubule is: given, or found for a wanted fluid fraction."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.geometry.outline import resample, signed_area
from vasculo.plexus.clearing import FEWEST_NODES, clear
from vasculo.plexus.outlines import ring_nodes

if TYPE_CHECKING:
    from collections.abc import Callable

    import shapely
    from numpy.typing import NDArray

    from vasculo.plexus.clearing import Cleared
    from vasculo.plexus.parameters import Extraction

    Shapes = NDArray[np.object_]

WIDTH_RANGE = (0.25, 1.25)
"""Tubule widths (L0) that are chosen by themselves: below, the mesh is dear; above, voids are lost."""
FIRST_STEP = 0.177
"""Narrowest gap (R0) that no pillars close in their first step: merge gap 0.09 R0 plus two moves of 0.043 R0."""
ROUNDING = 0.3
"""Radius (L0) of rounded corners."""
BISECTIONS = 12


def cleared_at(raw: Shapes, box: shapely.Polygon, width: float, unit: float, wanted: Extraction) -> Cleared:
    """Pillars of a tissue for one tubule width (model length); `unit` is L0."""
    return clear(raw, box, width, wanted.rule, ROUNDING * unit, wanted.smallest_radius * unit)


def choose_width(raw: Shapes, box: shapely.Polygon, unit: float, wanted: Extraction) -> tuple[float, str]:
    """Tubule width, and what decided on it.

    Strategy: the fluid fraction grows with the width, so bisection finds it. The lower end is 0.25 L0 or the width at
    which the remodelling would merge neighbours in its first step, whichever is larger.

    Parameters
    ----------
    raw : ndarray of shapely.Polygon, shape (v,)
        Valid outlines of the voids.
    box : shapely.Polygon
        Tissue box.
    unit : float
        L0 (model length).
    wanted : Extraction
        Parameters.

    Returns
    -------
    width : float
        Model length.
    source : str
        "given", "fluid fraction", "lower limit" or "upper limit".
    """
    if wanted.tubule_width is not None:
        return wanted.tubule_width * unit, "given"

    def areas(width: float) -> list[float]:
        shapes = cleared_at(raw, box, width, unit, wanted).shapes
        rings = [resample(ring_nodes(shape), wanted.spacing * unit, minimum=FEWEST_NODES) for shape in shapes]
        return [signed_area(ring) for ring in rings]

    def fluid(width: float) -> float:
        return 1.0 - sum(areas(width)) / box.area

    low, high = WIDTH_RANGE[0] * unit, WIDTH_RANGE[1] * unit
    largest = areas(low)
    if largest:
        low = min(max(low, FIRST_STEP * float(np.sqrt(np.mean(largest) / np.pi))), high)
    if fluid(low) >= wanted.fluid_fraction:
        return low, "lower limit"
    if fluid(high) <= wanted.fluid_fraction:
        return high, "upper limit"
    return _bisect(lambda width: fluid(width) >= wanted.fluid_fraction, low, high), "fluid fraction"


def widen_for(fits: Callable[[float], bool], width: float, unit: float) -> float:
    """Smallest width above `width` that fits a budget, at most 1.25 L0 (returned even where nothing fits)."""
    high = WIDTH_RANGE[1] * unit
    return _bisect(fits, width, high, 6) if fits(high) else high


def _bisect(reached: Callable[[float], bool], low: float, high: float, steps: int = BISECTIONS) -> float:
    """Lowest width, to within the last interval, from which on a condition holds; it holds at `high`."""
    for _ in range(steps):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if reached(middle) else (middle, high)
    return high
