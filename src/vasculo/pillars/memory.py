"""What a cell remembers of its shape: the places where its filaments are free of stress, carried to new nodes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import shapely

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]


def follow(reference: Floats, points: Floats, memory: float) -> Floats:
    """Let the reference come after the points: by the whole way without memory, not at all with full memory.

    Parameters
    ----------
    reference, points : (n, 2) float64
        Model length.
    memory : float
        0 to 1.

    Returns
    -------
    (n, 2) float64
    """
    return points if memory == 0.0 else reference + (1.0 - memory) * (points - reference)


def carry_reference(outlines: Sequence[Floats], references: Sequence[Floats], fresh: Sequence[Floats]) -> list[Floats]:
    """Give membranes with new nodes the memory of the old ones: the displacement, linear along the old sides.

    Parameters
    ----------
    outlines, references : sequences of (k, 2) float64
        Membranes and their references, model length.
    fresh : sequence of (k', 2) float64
        The same membranes, some with other nodes.

    Returns
    -------
    list of (k', 2) float64
    """
    return [
        reference if new is old or np.array_equal(new, old) else _carried(old, reference, new)
        for old, reference, new in zip(outlines, references, fresh, strict=True)
    ]


def _carried(old: Floats, reference: Floats, new: Floats) -> Floats:
    """Find the reference of the nodes `new` of a membrane."""
    ring = np.concatenate((old, old[:1]))
    line = shapely.LineString(ring)
    way = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(ring, axis=0).T))))
    moved = ring - np.concatenate((reference, reference[:1]))
    at = shapely.line_locate_point(line, shapely.points(new))
    return new - np.column_stack([np.interp(at, way, column) for column in moved.T])
