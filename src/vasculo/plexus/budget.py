"""Refine or merge: what is done about a flow mesh that would be larger than its budget of triangles.

Within the budget nothing is done: the mesh is refined in narrow passages. Above it the tubules are widened, then the
pillars beside the dearest passages are merged, and what is still too large is refused.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import InputError
from vasculo.geometry.outline import signed_area
from vasculo.plexus.clearing import even_outlines
from vasculo.plexus.merging import MOST_MERGES, merge_dearest
from vasculo.plexus.passages import find_passages
from vasculo.plexus.width import WIDTH_RANGE, widen_for

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from vasculo.plexus.clearing import Cleared
    from vasculo.plexus.parameters import Extraction
    from vasculo.plexus.passages import Passages

    Floats = NDArray[np.float64]
    Shapes = NDArray[np.object_]

CLOSING = 0.5
"""First closing radius (L0) of merged pillars."""
MERGE_ROUNDS = 6
"""How often the mesh is predicted anew while pillars are merged."""


@dataclass(frozen=True)
class Layout:
    """Pillars as they would stand in the domain.

    Attributes
    ----------
    outlines : list of ndarray of float64, shape (k_i, 2)
        Even outlines (model length).
    halved : int
        Outlines with a finer spacing than asked for.
    outer : ndarray of float64, shape (4, 2)
        The rectangle with its strips (model length).
    sides : tuple of str
        Names of its sides.
    passages : Passages
        Between them, with the expected mesh.
    """

    outlines: list[Floats]
    halved: int
    outer: Floats
    sides: tuple[str, ...]
    passages: Passages


@dataclass(frozen=True)
class Fitted:
    """Pillars whose expected mesh fits the budget.

    Attributes
    ----------
    width : float
        Tubule width that it took (model length).
    cleared : Cleared
        Pillars at this width, before merging.
    lineage : tuple of tuple of int
        Voids of each pillar, sorted.
    layout : Layout
        The pillars.
    """

    width: float
    cleared: Cleared
    lineage: tuple[tuple[int, ...], ...]
    layout: Layout


def laid_out_for(
    shapes: Shapes, width: float, bounds: tuple[float, float, float, float], unit: float, wanted: Extraction
) -> Layout:
    """Put shapes (p,), at least one, into the rectangle around the tissue with its strips, and measure the passages."""
    outlines, halved = even_outlines(shapes, wanted.spacing * unit, width, bounds)
    radius = float(np.sqrt(np.mean([signed_area(outline) for outline in outlines]) / np.pi))
    (x0, y0, x1, y1), pad = bounds, wanted.strip * radius
    outer = np.array([(x0 - pad, y0), (x1 + pad, y0), (x1 + pad, y1), (x0 - pad, y1)])
    sides = ("bottom", "right", "top", "left")
    passages = find_passages(outlines, outer, sides, wanted.edge_length * radius, wanted.triangles_across)
    return Layout(outlines, halved, outer, sides, passages)


def fit_budget(
    cleared: Callable[[float], Cleared],
    layout: Callable[[Shapes, float], Layout],
    width: float,
    unit: float,
    tissue: float,
    budget: int | None,
) -> Fitted:
    """Refine, widen, merge or refuse.

    Parameters
    ----------
    cleared : callable
        Pillars for a tubule width (model length).
    layout : callable
        Layout of shapes for a tubule width (model length).
    width : float
        Tubule width wanted (model length), at which there is a pillar.
    unit : float
        L0 (model length).
    tissue : float
        Area of the tissue (model length squared).
    budget : int or None
        Triangles allowed; None: no limit.

    Returns
    -------
    Fitted

    Raises
    ------
    InputError
        When the budget cannot be met.
    """

    @cache
    def at(trial: float) -> Layout:
        return layout(cleared(trial).shapes, trial)

    def triangles(trial: float) -> float:
        return at(trial).passages.total if len(cleared(trial).shapes) else 1.0

    if budget is not None and triangles(width) > budget and width < WIDTH_RANGE[1] * unit:
        width = widen_for(triangles, budget, width, unit)
    pillars = cleared(width)
    if not len(pillars.shapes):
        raise InputError(
            f"the budget of {budget} triangles cannot be met: no pillar is left at a tubule width of "
            f"{width / unit:.3g} L0: raise triangle_budget"
        )
    now = at(width)
    lineage: list[tuple[int, ...]] = [(int(void),) for void in pillars.void]
    if budget is None or now.passages.total <= budget:
        return Fitted(width, pillars, tuple(lineage), now)
    # Strategy: where a round of merging saved less than was expected, the next one aims that much lower.
    shapes, most, aim = pillars.shapes, int(MOST_MERGES * len(pillars.shapes)), float(budget)
    for _ in range(MERGE_ROUNDS):
        left = most - (len(pillars.shapes) - len(shapes))
        if now.passages.total <= budget or left < 1:
            break
        merged, groups = merge_dearest(shapes, tissue, now.passages, aim, CLOSING * unit, width, left)
        if len(merged) == len(shapes):
            break
        shapes, lineage = merged, [tuple(sorted(void for k in group for void in lineage[k])) for group in groups]
        now = layout(shapes, width)
        aim -= max(now.passages.total - budget, 0.0)
    if now.passages.total > budget:
        count = len(pillars.shapes)
        raise InputError(
            f"the flow mesh would have about {now.passages.total:.0f} triangles, the budget is {budget}: tubules are "
            f"{width / unit:.3g} L0 wide (widened up to {WIDTH_RANGE[1]} L0), {count - len(shapes)} of {count} pillars "
            f"are merged (limit {most}; {at(width).passages.total:.0f} triangles before): raise "
            f"triangle_budget or lower triangles_across"
        )
    return Fitted(width, pillars, tuple(lineage), now)
