"""Splitting: a pillar whose neck has become too thin parts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import shapely
from scipy.spatial import cKDTree

from vasculo.geometry.outline import as_outline, outline_areas, resample
from vasculo.pillars.cell import side_lengths, stack
from vasculo.pillars.gaps import DETOUR
from vasculo.pillars.parameters import MINIMUM_NODES

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

NECK = 0.25  # thickness at which a neck parts, merge gaps
CLEAR = 4.4  # the parts then stand so many neck thicknesses apart: a tenth more than the gap at which they would merge


def split_thin(
    outlines: Sequence[NDArray[np.float64]], neck: float, smallest: float, spacing: float
) -> tuple[list[NDArray[np.float64]], NDArray[np.int32]]:
    """Part all pillars that have a neck thinner than `neck`.

    Parameters
    ----------
    outlines : sequence of (k, 2) float64, model length
        Simple, counter-clockwise.
    neck, smallest, spacing : float, model length
        Thickness of a neck that parts; radius below which a piece is no pillar and the neck stays; node spacing of the
        pieces.

    Returns
    -------
    outlines : list of (k, 2) float64, model length
        Those without a neck unchanged, pieces in the place of their pillar, the largest first.
    source : (q,) int32
        The given pillar that each was.
    """
    # A chord of a new outline may cut half a side deep into the way that was cleared.
    clear = float(np.hypot(CLEAR * neck, 0.5 * spacing))
    result, source = list(outlines), list(range(len(outlines)))
    for pillar in thin(outlines, neck)[::-1].tolist():
        pieces = split(outlines[pillar], neck, smallest, clear)
        if len(pieces) > 1:
            result[pillar : pillar + 1] = [resample(piece, spacing, minimum=MINIMUM_NODES) for piece in pieces]
            source[pillar : pillar + 1] = [pillar] * len(pieces)
    return result, np.array(source, dtype=np.int32)


def thin(outlines: Sequence[NDArray[np.float64]], neck: float) -> NDArray[np.int64]:
    """Pillars that may have a neck: two nodes that are close across and far along the membrane; (m,) int64."""
    # Strategy: where a pillar is thinner than `neck`, two places face each other over no more, and the nodes next to
    # them are not further apart than `neck` and half of the longest side on both membranes.
    if not len(outlines):
        return np.zeros(0, dtype=np.int64)
    points, starts = stack(outlines)
    sides = side_lengths(points, starts)
    near = cKDTree(points).query_pairs(neck + float(sides.max()), output_type="ndarray")
    owner = np.repeat(np.arange(len(outlines)), np.diff(starts))
    near = near[owner[near[:, 0]] == owner[near[:, 1]]]
    whole = np.add.reduceat(sides, starts[:-1])[owner]
    passed = np.cumsum(sides) - sides
    along = np.abs(passed[near[:, 0]] - passed[near[:, 1]])
    along = np.minimum(along, whole[near[:, 0]] - along)
    longest = np.maximum.reduceat(sides, starts[:-1])[owner[near[:, 0]]]
    across = np.hypot(*(points[near[:, 0]] - points[near[:, 1]]).T)
    facing = (across <= neck + longest) & (along > DETOUR * np.maximum(across, neck))
    return np.unique(owner[near[facing, 0]])


def split(outline: NDArray[np.float64], neck: float, smallest: float, clear: float) -> list[NDArray[np.float64]]:
    """Part one pillar at its necks: the pieces of its morphological opening, a little apart from each other.

    Parameters
    ----------
    outline : (k, 2) float64, model length
        Simple, counter-clockwise.
    neck, smallest : float, model length
        As in `split_thin`.
    clear : float, model length
        Distance between the pieces; the larger ones give way.

    Returns
    -------
    list of (m, 2) float64
        Largest first, not evenly spaced; the outline itself where fewer than two pieces are large enough.
    """
    opened = shapely.get_parts(shapely.buffer(shapely.buffer(shapely.Polygon(outline), -0.5 * neck), 0.5 * neck))
    least = np.pi * smallest**2
    pieces = sorted((piece for piece in opened if piece.area >= least), key=lambda piece: -piece.area)
    if len(pieces) < 2:
        return [outline]
    apart = []
    for k, piece in enumerate(pieces):
        smaller = shapely.buffer(shapely.union_all(pieces[k + 1 :]), clear)
        left = shapely.get_parts(shapely.difference(piece, smaller))
        apart.append(max(left, key=lambda part: part.area, default=shapely.Polygon()))
    if any(piece.area < least for piece in apart):
        return [outline]
    return [as_outline(np.asarray(piece.exterior.coords)[:-1]) for piece in apart]


def shared_areas(
    rest_areas: NDArray[np.float64], outlines: Sequence[NDArray[np.float64]], source: NDArray[np.int32]
) -> NDArray[np.float64]:
    """Rest areas of pieces, shared out in proportion to their areas.

    Parameters
    ----------
    rest_areas : (p,) float64, model length squared
        Before the split.
    outlines, source
        As given by `split_thin`.

    Returns
    -------
    (q,) float64, model length squared
        With the same sum.
    """
    areas = outline_areas(outlines)
    return rest_areas[source] * areas / np.bincount(source, areas)[source]
