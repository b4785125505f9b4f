"""The two rules that give tubules their width: all outlines move inward, or only those beside narrow cords."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import shapely
from numba import njit

from vasculo.plexus.passage_kernels import nearest_on

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Shapes = NDArray[np.object_]

ARC = 8
"""Segments of a quarter circle in rounded corners."""
SAMPLES = 0.25
"""Distance of the samples of the minimum rule over the width."""
LEVELS = 12
"""Depths to which it cuts."""


@dataclass(frozen=True)
class Near:
    """Pairs of raw outlines that are near each other.

    Attributes
    ----------
    pairs : ndarray of int64, shape (k, 2)
        i < j, in order.
    gap : ndarray of float64, shape (k,)
        Distance (model length); 0 where they touch or overlap.
    reach : float
        Every pair closer than this is there (model length).
    """

    pairs: NDArray[np.int64]
    gap: Floats
    reach: float


def near_pairs(shapes: Shapes, reach: float) -> Near:
    """Find all pairs of shapes (p,) closer than `reach` (model length)."""
    first, second = shapely.STRtree(shapes).query(shapes, predicate="dwithin", distance=reach)
    once = first < second
    pairs = np.column_stack((first[once], second[once]))
    pairs = pairs[np.lexsort((pairs[:, 1], pairs[:, 0]))]
    return Near(pairs, np.asarray(shapely.distance(shapes[pairs[:, 0]], shapes[pairs[:, 1]])), reach)


def _offset(raw: Shapes, box: shapely.Polygon, width: float, rounding: float, near: Near) -> Shapes:  # noqa: ARG001
    """Constant offset: a cord of n springs stays n springs thick plus the width."""
    inner = shapely.buffer(raw, -0.5 * width - rounding, quad_segs=ARC)
    return np.asarray(shapely.buffer(_inside(inner, box, 0.5 * width + rounding), rounding, quad_segs=ARC))


def _minimum(raw: Shapes, box: shapely.Polygon, width: float, rounding: float, near: Near) -> Shapes:
    """Minimum width: cut away what is nearer than (width - gap)/2 to the outline where the gap is below the width.

    A straight way between two cut outlines crosses both raw ones, at points with gaps at most its middle part; what was
    cut adds the rest, so it is at least `width` long.
    """
    # Strategy: gaps at samples along the outlines; the depth of the cut is rounded up to one of a few levels, and at
    # each level the runs of samples that need it are cut by one strip.
    close = near.pairs[near.gap < width]
    first, rings = _rings(raw)
    begin, samples = _rings(shapely.segmentize(raw, SAMPLES * width))
    gap = np.full(len(samples), width)
    sample_gaps(samples, begin, rings, first, np.concatenate((close, close[:, ::-1])), gap)
    levels = np.ceil(LEVELS * (1.0 - gap / width) - 1e-9)
    owner = np.searchsorted(begin, np.arange(len(samples)), side="right") - 1
    strips, owners = [], []
    for level in range(1, LEVELS + 1):
        member = np.flatnonzero(levels >= level)
        if not len(member):
            break
        starts = np.append(True, (np.diff(member) > 1) | (np.diff(owner[member]) > 0))
        run = np.cumsum(starts) - 1
        twice = np.repeat(np.arange(len(member)), np.where(np.bincount(run)[run] > 1, 1, 2))
        lines = shapely.linestrings(samples[member[twice]], indices=run[twice])
        strips.append(shapely.buffer(lines, 0.5 * width * level / LEVELS, quad_segs=ARC))
        owners.append(owner[member[starts]])
    cut = raw.copy()
    if strips:
        every, mine = np.concatenate(strips), np.concatenate(owners)
        order = np.argsort(mine, kind="stable")
        shrunk, rows = np.unique(mine[order], return_index=True)
        for index, own in zip(shrunk, np.split(every[order], rows[1:]), strict=True):
            cut[index] = shapely.difference(raw[index], shapely.union_all(own))
    cut = _inside(cut, box, 0.5 * width)
    opened = shapely.buffer(shapely.buffer(cut, -rounding, quad_segs=ARC), rounding, quad_segs=ARC)
    return np.asarray(shapely.buffer(shapely.buffer(opened, rounding, quad_segs=ARC), -rounding, quad_segs=ARC))


def _rings(shapes: Shapes) -> tuple[NDArray[np.int64], Floats]:
    """Nodes of the exteriors of polygons (p,), the first one repeated at the end of each, and where each begins."""
    nodes, owner = shapely.get_coordinates(shapely.get_exterior_ring(shapes), return_index=True)
    return np.searchsorted(owner, np.arange(len(shapes) + 1)), nodes


@njit(cache=True, error_model="numpy")
def sample_gaps(
    samples: Floats,
    begin: NDArray[np.int64],
    rings: Floats,
    first: NDArray[np.int64],
    pairs: NDArray[np.int64],
    gap: Floats,
) -> None:
    """Distance of samples on one outline to another polygon, 0 inside of it.

    Parameters
    ----------
    samples : (s, 2) float64
        Samples of all outlines (model length).
    begin : (p + 1,) int64
        Samples begin[i] to begin[i + 1] are those of outline i.
    rings : (n, 2) float64
        Nodes of all polygons, the first one of each repeated at its end (model length).
    first : (p + 1,) int64
        Nodes first[i] to first[i + 1] are those of polygon i.
    pairs : (k, 2) int64
        Outline whose samples are measured, polygon they are measured to.
    gap : (s,) float64
        The largest distance looked for; lowered where something is nearer.
    """
    for row in range(len(pairs)):
        own, other = pairs[row, 0], pairs[row, 1]
        for i in range(begin[own], begin[own + 1]):
            x, y = samples[i, 0], samples[i, 1]
            best = gap[i] * gap[i]
            inside = False
            for n in range(first[other], first[other + 1] - 1):
                ax, ay, bx, by = rings[n, 0], rings[n, 1], rings[n + 1, 0], rings[n + 1, 1]
                _, wx, wy = nearest_on(x, y, ax, ay, bx, by)
                best = min(best, wx * wx + wy * wy)
                if (ay > y) != (by > y) and x < ax + (bx - ax) * (y - ay) / (by - ay):
                    inside = not inside
            gap[i] = 0.0 if inside else np.sqrt(best)


def sample_gaps_plain(
    samples: Floats,
    begin: NDArray[np.int64],
    rings: Floats,
    first: NDArray[np.int64],
    pairs: NDArray[np.int64],
    gap: Floats,
) -> None:
    """Plain twin of `sample_gaps`."""
    for own, other in pairs.tolist():
        mine = slice(begin[own], begin[own + 1])
        polygon = shapely.Polygon(rings[first[other] : first[other + 1]])
        gap[mine] = np.minimum(gap[mine], shapely.distance(shapely.points(samples[mine]), polygon))


RULES: dict[str, Callable[[Shapes, shapely.Polygon, float, float, Near], Shapes]] = {
    "offset": _offset,
    "minimum": _minimum,
}
"""The ways to give tubules their width."""


def _inside(shapes: Shapes, box: shapely.Polygon, margin: float) -> Shapes:
    """Cut off what comes nearer to the box's edges than a margin; all of it where the box is narrower."""
    x0, y0, x1, y1 = box.bounds
    if min(x1 - x0, y1 - y0) <= 2.0 * margin:
        return np.full(len(shapes), shapely.Polygon(), dtype=object)
    low, high = (x0 + margin, y0 + margin), (x1 - margin, y1 - margin)
    bounds = shapely.bounds(shapes)
    out = np.flatnonzero(((bounds[:, :2] < low) | (bounds[:, 2:] > high)).any(axis=1))
    result = shapes.copy()
    result[out] = shapely.intersection(shapes[out], shapely.box(*low, *high))
    return result
