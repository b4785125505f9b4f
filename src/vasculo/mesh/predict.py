"""How many triangles a size field asks for, before any is made."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.mesh.wishes import strip_cost

if TYPE_CHECKING:
    from vasculo.mesh.size import SizeField
    from vasculo.mesh.walls import Walls

TRIANGLE = np.sqrt(3.0) / 4.0
"""Area of an equilateral triangle over its edge length squared."""


def predicted_triangles(walls: Walls, field: SizeField, area: float) -> tuple[float, float, tuple[int, int, float]]:
    """Estimate the number of triangles: integral of dA / (TRIANGLE h^2), within about a factor of two.

    Parameters
    ----------
    walls : Walls
    field : SizeField
    area : float, model length squared
        Area of the fluid.

    Returns
    -------
    total : float
        Triangles in all.
    dearest : float
        Triangles in the passage that takes most.
    passage : (int, int, float)
        The two outlines of that passage (numbered as in `Walls`) and its smallest width; (-1, -1, inf): none.
    """
    # Strategy: the open fluid at the largest size; a strip along each wall, in which the size grows from the wall's;
    # but in front of each passage sample, half of the passage's width, if that is less than such a strip.
    passages = field.passages
    covered = np.bincount(passages.segment, weights=passages.share, minlength=len(walls.lengths))
    open_wall = np.maximum(walls.lengths - covered, 0.0)
    total = area / field.largest**2 + field.wish_cost
    total += float((strip_cost(field.wall_sizes, field.largest, field.slope) * open_wall).sum())
    if not len(passages.gap):
        return total / TRIANGLE, 0.0, (-1, -1, np.inf)
    sizes = np.minimum(field.passage_sizes, field.wall_sizes[passages.segment])
    each = passages.share * np.minimum(0.5 * passages.gap / sizes**2, strip_cost(sizes, field.largest, field.slope))
    total += float(each.sum())
    bodies = int(walls.body.max()) + 1
    pair = np.minimum(passages.body, passages.other).astype(np.int64) * bodies
    pair += np.maximum(passages.body, passages.other)
    number, place = np.unique(pair, return_inverse=True)
    cost = np.bincount(place, weights=each)
    most = int(np.argmax(cost))
    low, high = divmod(int(number[most]), bodies)
    return total / TRIANGLE, float(cost[most]) / TRIANGLE, (low, high, float(passages.gap[place == most].min()))
