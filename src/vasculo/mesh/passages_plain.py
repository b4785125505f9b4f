"""Plain twin of the passage search: every sample against every wall segment."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.mesh.passages import DETOUR, FACING, TOUCHING

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.mesh.walls import Walls


def nearest_facing_plain(
    walls: Walls, segment: int, place: float, widest: float
) -> tuple[float, int, NDArray[np.float64]]:
    """Distance, segment and point of the nearest wall in front of one wall sample.

    Parameters
    ----------
    walls : Walls
    segment : int
        Wall segment of the sample.
    place : float
        Where on it the sample lies, 0 to 1.
    widest : float, model length
        Walls farther away do not count.

    Returns
    -------
    gap : float, model length
    hit : int
        Segment found, -1 if there is none.
    point : (2,) float64, model length
    """
    start, end = walls.segments[:, :2], walls.segments[:, 2:]
    step = end - start
    here = start[segment] + place * step[segment]
    along = np.clip(((here - start) * step).sum(axis=1) / walls.lengths**2, 0.0, 1.0)
    nearest = start + along[:, None] * step
    way = nearest - here
    distance = np.hypot(way[:, 0], way[:, 1])
    normal = np.column_stack((-step[:, 1], step[:, 0])) / walls.lengths[:, None]
    away = np.abs(walls.arc + along * walls.lengths - walls.arc[segment] - place * walls.lengths[segment])
    away = np.minimum(away, walls.around - away)
    faces = (way @ normal[segment] >= FACING * distance) & ((-way * normal).sum(axis=1) >= FACING * distance)
    apart = _between(walls, segment) > TOUCHING * walls.around
    seen = apart & faces & (away > DETOUR * distance + TOUCHING * walls.around)
    distance = np.where((walls.body != walls.body[segment]) | seen, distance, np.inf)
    hit = int(np.argmin(distance))
    if not distance[hit] < widest:
        return widest, -1, here
    return float(distance[hit]), hit, nearest[hit]


def _between(walls: Walls, segment: int) -> NDArray[np.float64]:
    """Way along the outline between one segment and each other one, from end to start; zero for neighbours."""
    before = np.abs(walls.arc + walls.lengths - walls.arc[segment])
    after = np.abs(walls.arc[segment] + walls.lengths[segment] - walls.arc)
    around = walls.around
    return np.minimum.reduce([before, np.abs(before - around), after, np.abs(after - around)])
