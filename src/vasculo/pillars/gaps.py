"""How far membranes may move at once: never more than the gap between them."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from vasculo.pillars.cell import ring, side_lengths

if TYPE_CHECKING:
    from numpy.typing import NDArray

APPROACH = 0.98  # largest part of the gap between two membranes that they may close in one step
DETOUR = 3.0  # two places of one membrane face each other if the way along is so many times the way across


def gap_factors(
    points: NDArray[np.float64], starts: NDArray[np.int32], shift: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Part of its move that each pillar may make so that no two membranes come nearer by more than their gap.

    Each node looks at the nearest place of every side nearby. Both pillars may together close `APPROACH` of that gap,
    along the line across it; the pillar's own membrane counts where it lies far along it.

    Parameters
    ----------
    points, starts : (n, 2) float64, (p + 1,) int32
        Membranes, model length.
    shift : (n, 2) float64, model length
        Where the nodes would move.

    Returns
    -------
    (p,) float64
        0 to 1; all ones where twice the largest move is below `APPROACH` of the narrowest gap.
    """
    factors = np.ones(len(starts) - 1)
    reach = 2.0 * float(np.hypot(shift[:, 0], shift[:, 1]).max(initial=0.0)) / APPROACH
    if reach == 0.0:
        return factors
    sides = side_lengths(points, starts)
    following = ring(starts)[1]
    # Strategy: sides lie in the cell of a grid that their first node is in. What is nearer than `reach` to a node is in
    # the cells around it.
    cell = reach + float(sides.max())
    low = points.min(axis=0)
    place = np.floor((points - low) / cell).astype(np.int64)
    width = int(place[:, 0].max()) + 1
    key = place[:, 1] * width + place[:, 0]
    order = np.argsort(key, kind="stable")
    owner = np.repeat(np.arange(len(starts) - 1, dtype=np.int32), np.diff(starts))
    passed = np.cumsum(sides) - sides
    whole = np.add.reduceat(sides, starts[:-1])
    _limit(points, shift, following, owner, passed, whole, place, width, key[order], order, reach, factors)
    return factors


@njit(cache=True, error_model="numpy")
def _limit(  # type: ignore[no-untyped-def]
    points, shift, following, owner, passed, whole, place, width, keys, order, reach, factors
):
    for i in range(len(points)):
        for row in range(place[i, 1] - 1, place[i, 1] + 2):
            first = np.searchsorted(keys, row * width + max(place[i, 0] - 1, 0))
            last = row * width + min(place[i, 0] + 1, width - 1)
            while first < len(keys) and keys[first] <= last:
                j = order[first]
                first += 1
                k = following[j]
                if (j - i) * (k - i) == 0:  # the sides that meet in this node
                    continue
                sx, sy = points[k, 0] - points[j, 0], points[k, 1] - points[j, 1]
                rx, ry = points[i, 0] - points[j, 0], points[i, 1] - points[j, 1]
                t = min(max((rx * sx + ry * sy) / (sx * sx + sy * sy), 0.0), 1.0)
                nx, ny = t * sx - rx, t * sy - ry
                gap = math.sqrt(nx * nx + ny * ny)
                if gap >= reach:
                    continue
                a, b = owner[i], owner[j]
                if a == b:
                    along = abs(passed[i] - passed[j] - t * math.sqrt(sx * sx + sy * sy))
                    if min(along, whole[a] - along) <= DETOUR * gap:
                        continue
                if gap == 0.0:
                    factors[a] = factors[b] = 0.0
                    continue
                own = (shift[i, 0] * nx + shift[i, 1] * ny) / gap
                other = (
                    -(
                        ((1.0 - t) * shift[j, 0] + t * shift[k, 0]) * nx
                        + ((1.0 - t) * shift[j, 1] + t * shift[k, 1]) * ny
                    )
                    / gap
                )
                closing = own + other if a == b else max(own, 0.0) + max(other, 0.0)
                if closing > APPROACH * gap:
                    factor = APPROACH * gap / closing
                    if own > 0.0 or a == b:
                        factors[a] = min(factors[a], factor)
                    if other > 0.0 or a == b:
                        factors[b] = min(factors[b], factor)


def gap_factors_plain(
    points: NDArray[np.float64], starts: NDArray[np.int32], shift: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Give what `gap_factors` gives: every node against every side."""
    sides, following = side_lengths(points, starts), ring(starts)[1]
    owner = np.repeat(np.arange(len(starts) - 1), np.diff(starts))
    passed = np.cumsum(sides) - sides
    whole = np.add.reduceat(sides, starts[:-1])
    factors = np.ones(len(starts) - 1)
    for i, (point, move) in enumerate(zip(points, shift, strict=True)):
        side = points[following] - points
        t = np.clip(((point - points) * side).sum(axis=1) / sides**2, 0.0, 1.0)
        across = points + t[:, None] * side - point
        gap = np.linalg.norm(across, axis=1)
        along = np.abs(passed[i] - passed - t * sides)
        along = np.minimum(along, whole[owner] - along)
        mine = owner == owner[i]
        looks = (~mine | (along > DETOUR * gap)) & (np.arange(len(points)) != i) & (following != i)
        normal = across / np.where(gap > 0.0, gap, 1.0)[:, None]
        own = normal @ move
        other = -(((1.0 - t)[:, None] * shift + t[:, None] * shift[following]) * normal).sum(axis=1)
        closing = np.where(mine, own + other, np.maximum(own, 0.0) + np.maximum(other, 0.0))
        for j in np.flatnonzero(looks & (closing > APPROACH * gap)):
            factor = APPROACH * gap[j] / closing[j]
            if own[j] > 0.0 or mine[j]:
                factors[owner[i]] = min(factors[owner[i]], factor)
            if other[j] > 0.0 or mine[j]:
                factors[owner[j]] = min(factors[owner[j]], factor)
    return factors
