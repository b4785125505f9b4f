"""Vessels and islands of a level field: which belong together, and the outlines of the islands.

Vessels are connected over edges and corners of pixels, tissue over edges only, so that no island can cross a vessel.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.ndimage import generate_binary_structure, label

from vasculo.errors import InputError
from vasculo.plexus.image_levels import scikit_image
from vasculo.plexus.outlines import repaired

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Mask = NDArray[np.bool_]
    Shapes = NDArray[np.object_]

EDGES, CORNERS = generate_binary_structure(2, 1), generate_binary_structure(2, 2)
_LEFT, _RIGHT, _LOW, _HIGH = range(4)


@dataclass(frozen=True)
class Islands:
    """Vessels that lead from the left to the right side of a picture, and the islands between them.

    Attributes
    ----------
    levels : (h, w) float64
        Positive in these vessels, negative in the islands that are kept.
    labels : (h, w) int32
        Island of each pixel from 1 on, 0 in vessels.
    areas : (n,) float64
        Area of each island in square pixels.
    touches : (n, 4) bool
        Whether it is cut by the left, right, lower, upper side of the picture.
    lost : (h, w) bool
        Vessel pixels that are joined to none of these vessels; now tissue.
    lost_parts, small : int
        Parts of vessels that were left out so, and islands that were dropped because they are small.
    """

    levels: Floats
    labels: NDArray[np.int32]
    areas: Floats
    touches: Mask
    lost: Mask
    lost_parts: int
    small: int

    @property
    def cut(self) -> Mask:
        """Islands that a side of the picture cuts; (n,)."""
        return np.asarray(self.touches.any(axis=1))

    @property
    def spanning(self) -> Mask:
        """Islands that reach from the left to the right side; (n,)."""
        return np.asarray(self.touches[:, _LEFT] & self.touches[:, _RIGHT])

    @property
    def beside(self) -> Mask:
        """Islands that the lower or upper side cuts; (n,)."""
        return np.asarray(self.touches[:, _LOW] | self.touches[:, _HIGH])


def find_islands(levels: Floats, smallest_radius: float) -> Islands:
    """Find the vessels that lead from left to right, and the islands between them.

    Parameters
    ----------
    levels : (h, w) float64
        Positive in vessels, negative in tissue.
    smallest_radius : float
        Islands of smaller equivalent radius are dropped (pixels).

    Returns
    -------
    Islands

    Raises
    ------
    InputError
        When no vessel leads from left to right, there is no island, or all are dropped.
    """
    levels = levels.copy()
    parts, count = label(levels > 0.0, CORNERS)
    through = np.intersect1d(parts[:, 0], parts[:, -1])
    through = through[through > 0]
    if not len(through):
        raise InputError(_no_way(parts, count))
    lost = (parts > 0) & ~np.isin(parts, through)
    levels[lost] *= -1.0
    labels, found = label(levels < 0.0, EDGES)
    if not found:
        raise InputError(f"no pillars: all {levels.size} pixels are vessel: raise the threshold or check vessels")
    areas = np.bincount(labels.ravel(), minlength=found + 1)[1:].astype(np.float64)
    keep = areas >= np.pi * smallest_radius**2
    if not keep.any():
        raise InputError(
            f"no pillars: all {found} islands are smaller than a disk of radius {smallest_radius:g}, the largest has "
            f"{areas.max():g} square pixels: lower smallest_radius"
        )
    number = np.zeros(found + 1, dtype=np.int32)
    number[1:][keep] = np.arange(1, keep.sum() + 1)
    dropped = (labels > 0) & (number[labels] == 0)
    levels[dropped] *= -1.0
    labels = number[labels]
    kept = int(keep.sum())
    sides = (labels[:, 0], labels[:, -1], labels[-1], labels[0])
    touches = np.stack([np.isin(np.arange(1, kept + 1), side) for side in sides], axis=1)
    return Islands(levels, labels, areas[keep], touches, lost, count - len(through), found - kept)


def island_shapes(islands: Islands, beyond: int) -> Shapes:
    """Outlines of the islands, to a fraction of a pixel.

    Strategy: marching squares on the level field, continued beyond the picture by its border values, so that islands
    that a side cuts go on straight across it; a rim of vessel closes them there.

    Parameters
    ----------
    islands : Islands
    beyond : int
        How far the islands go on beyond the picture (pixels).

    Returns
    -------
    (n,) array of shapely.Polygon
        x to the right and y up from the lower left corner of the picture (pixels).
    """
    wide = np.pad(islands.levels, beyond, mode="edge")
    rim = float(np.abs(islands.levels).max())
    wide = np.pad(wide, 1, constant_values=rim)
    labels = np.pad(np.pad(islands.labels, beyond, mode="edge"), 1)
    rings = scikit_image("measure").find_contours(wide, 0.0, fully_connected="high")
    shapes = np.empty(len(islands.areas), dtype=object)
    left, top = 0.5 - beyond - 1.0, islands.levels.shape[0] - 0.5 + beyond + 1.0
    for ring in rings:
        polygon, _ = repaired(np.column_stack((left + ring[:-1, 1], top - ring[:-1, 0])))
        index = _owner(ring[0], labels) - 1
        if shapes[index] is None or polygon.area > shapes[index].area:
            shapes[index] = polygon
    return shapes


def _owner(vertex: Floats, labels: NDArray[np.int32]) -> int:
    """Island beside a vertex of an outline; it lies between a pixel of tissue and one of a vessel."""
    low, high = np.floor(vertex).astype(int), np.ceil(vertex).astype(int)
    return int(max(labels[tuple(low)], labels[tuple(high)]))


def _no_way(parts: NDArray[np.integer], count: int) -> str:
    """Say why nothing flows."""
    if not count:
        return f"no vessel: all {parts.size} pixels are tissue: lower the threshold or check vessels"
    into, out = (len(np.unique(side[side > 0])) for side in (parts[:, 0], parts[:, -1]))
    return (
        f"no vessel leads from the inlet to the outlet: of {count} connected parts {into} reach the inlet and {out} "
        "the outlet, none both: change threshold, smoothing, crop or inlet"
    )
