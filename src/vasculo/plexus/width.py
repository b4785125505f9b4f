"""How wide the narrowest tubule is: given, found for a wanted fluid fraction, or as wide as a budget needs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import shapely

from vasculo.plexus.clearing import clear
from vasculo.plexus.parameters import USUAL_FRACTION

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from vasculo.plexus.clearing import Cleared
    from vasculo.plexus.parameters import Extraction
    from vasculo.plexus.rules import Near

    Shapes = NDArray[np.object_]

WIDTH_RANGE = (0.25, 1.25)
"""Tubule widths (L0) that are chosen by themselves: below, the mesh is dear; above, voids are lost."""
FIRST_STEP = 0.177
"""Narrowest gap (R0) that no pillars close in their first step: merge gap 0.09 R0 plus two moves of 0.043 R0."""
ROUNDING = 0.3
"""Radius (L0) of rounded corners."""
SHARP = 1e-3
"""How well a width is found (L0)."""
TRIALS = 12
"""Most widths that are tried."""
WELL_USED = 0.98
"""Share of the budget from which on it counts as used."""


def cleared_at(raw: Shapes, near: Near, box: shapely.Polygon, width: float, unit: float, wanted: Extraction) -> Cleared:
    """Pillars of a tissue for one tubule width (model length); `unit` is L0."""
    return clear(raw, box, width, wanted.rule, ROUNDING * unit, wanted.smallest_radius * unit, near)


def choose_width(
    cleared: Callable[[float], Cleared], area: float, unit: float, wanted: Extraction
) -> tuple[float, str]:
    """Tubule width, and what decided on it.

    Strategy: moving outlines inward by a distance d takes perimeter * d - pi d^2 a pillar from them (Steiner's formula;
    exact for convex ones), which gives the next width to try; bisection where that leaves the bracket. The lower end is
    0.25 L0 or the width at which the remodelling would merge neighbours in its first step, whichever is larger.

    Parameters
    ----------
    cleared : callable
        Pillars for a tubule width (model length).
    area : float
        Area of the tissue (model length squared).
    unit : float
        L0 (model length).
    wanted : Extraction
        Parameters.

    Returns
    -------
    width : float
        Model length.
    source : str
        "lumen width", "minimum width", "fluid fraction", "lower limit" or "upper limit".
    """
    if wanted.width is not None:
        return wanted.width * unit, "lumen width" if wanted.rule == "offset" else "minimum width"
    fraction = USUAL_FRACTION if wanted.fluid_fraction is None else wanted.fluid_fraction
    low, high = WIDTH_RANGE[0] * unit, WIDTH_RANGE[1] * unit
    largest = shapely.area(cleared(low).shapes)
    if len(largest):
        low = min(max(low, FIRST_STEP * float(np.sqrt(np.mean(largest) / np.pi))), high)
    width, below, above = low, low, high
    for _ in range(TRIALS):
        shapes = cleared(width).shapes
        missing = (fraction - 1.0) * area + float(shapely.area(shapes).sum())
        if missing <= 0.0 and width == low:
            return low, "lower limit"
        if missing >= 0.0 and width == high:
            return high, "upper limit"
        below, above = (width, above) if missing > 0.0 else (below, width)
        perimeter, bend = float(shapely.length(shapes).sum()), np.pi * len(shapes)
        root = perimeter**2 - 4.0 * bend * missing
        move = 4.0 * missing / (perimeter + np.sqrt(root)) if root > 0.0 else np.inf
        trial = min(width + move, high)
        if abs(trial - width) < SHARP * unit or above - below < SHARP * unit:
            break
        inside = below < trial < above or trial == above == high
        width = trial if inside else 0.5 * (below + above)
    return width, "fluid fraction"


def widen_for(triangles: Callable[[float], float], budget: float, width: float, unit: float) -> float:
    """Smallest width that meets a budget, at most 1.25 L0 (returned even where nothing fits).

    Strategy: the mesh shrinks about like a power of the width, so the next trial is where the straight line between
    the two ends of the bracket, both in logarithms, meets the budget; until the budget is nearly used up.

    Parameters
    ----------
    triangles : callable
        Expected triangles for a width (model length).
    budget : float
        Triangles allowed; more are expected at `width`.
    width : float
        Where to start (model length).
    unit : float
        L0 (model length).
    """
    low, high = width, WIDTH_RANGE[1] * unit
    many, few = triangles(low), triangles(high)
    for _ in range(TRIALS):
        if not WELL_USED * budget > few or high - low < SHARP * unit:
            break
        share = np.log(many / (0.5 * (1.0 + WELL_USED) * budget)) / np.log(many / few)
        trial = float(low * (high / low) ** np.clip(share, 0.05, 0.95))
        count = triangles(trial)
        if count > budget:
            low, many = trial, count
        else:
            high, few = trial, count
    return high
