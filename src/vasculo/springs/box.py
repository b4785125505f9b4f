"""Networks that repeat: which image of a node an edge runs to, and where the images lie.

Nodes are never wrapped into the box while they move, so the first positions tell which image of its head an edge runs
to: the nearest one, since first edges are shorter than half a box. An infinite period is none.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Ints = NDArray[np.int32]
    Floats = NDArray[np.float64]


def nearest_periods(arms: Floats, box: Floats) -> Floats:
    """Whole periods (k, 2) nearest to vectors; none in a direction whose period is infinite (model length)."""
    return np.asarray(np.rint(arms / box) * np.where(np.isfinite(box), box, 0.0))


def image_offsets(reference: Floats, tails: Ints, heads: Ints, box: Floats) -> Floats:
    """Whole periods (e, 2) to take from heads - tails for the edges of a periodic network (model length)."""
    return nearest_periods(reference[heads] - reference[tails], box)


def arms_between(points: Floats, tails: Ints, heads: Ints, reference: Floats, box: Floats | None) -> Floats:
    """Vectors (e, 2) from tails to heads, in a box to the images of the heads that the edges run to (model length)."""
    arms = np.take(points, heads, axis=0) - np.take(points, tails, axis=0)
    return arms if box is None else arms - image_offsets(reference, tails, heads, box)


def wrapped(points: Floats, box: Floats) -> Floats:
    """Wrap points (n, 2) into a box, from 0 on and below its periods; not in a direction of infinite period."""
    period = np.where(np.isfinite(box), box, 1.0)
    inside = np.mod(points, period)
    return np.where(np.isfinite(box), np.where(inside < period, inside, 0.0), points)  # -1e-20 rounds up to a period
