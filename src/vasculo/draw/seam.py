"""Springs of a periodic tissue as they lie in its box: wrapped, and drawn on both sides of the seam."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


def images(
    points: NDArray[np.float64], springs: NDArray[np.int32], box: tuple[float, float]
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Place every spring in the box, as its shortest image; what crosses the seam comes back on the other side.

    Parameters
    ----------
    points : (n, 2) float64
        Nodes anywhere in the plane, model length.
    springs : (m, 2) int32
        Pairs of nodes.
    box : tuple of float
        Width and height of the box, which begins at the origin; model length.

    Returns
    -------
    ends : (k, 2, 2) float64
        Both ends of each piece; of a spring across the seam, one end of each lies outside the box.
    origin : (k,) int64
        Spring of each piece.
    """
    size = np.array(box)
    inside = np.mod(points, size)
    start = inside[springs[:, 0]]
    span = inside[springs[:, 1]] - start
    turns = np.rint(span / size)
    ends = np.stack([start, start + span - turns * size], axis=1)
    pieces, origin = [ends], [np.arange(len(springs))]
    for x, y in ((1, 0), (0, 1), (1, 1)):
        again = np.flatnonzero((np.abs(turns[:, 0]) >= x) & (np.abs(turns[:, 1]) >= y))
        shift = turns[again] * (x, y) * size
        pieces.append(ends[again] + shift[:, None])
        origin.append(again)
    return np.concatenate(pieces), np.concatenate(origin)
