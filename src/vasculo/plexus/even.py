"""Even outlines of many rounded shapes at once: the fast way to what `resample` does with corners and areas kept."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from vasculo.geometry.outline import following, resample

if TYPE_CHECKING:
    from collections.abc import Sequence

    from vasculo.geometry.arrays import Flags, Floats, Longs

CORNER = 60.0
"""Nodes of a pillar that turn by more than this (degrees) stay nodes."""
EQUALISATIONS = 2
"""Rounds that make the distances between nodes alike, as in `resample`."""


def even_rings(rings: Sequence[Floats], spacing: float, minimum: int) -> list[Floats]:
    """Nodes evenly spaced along each ring, with its corners and its area kept.

    Parameters
    ----------
    rings : sequence of ndarray of float64, shape (k_i, 2)
        Counter-clockwise, at least one (model length).
    spacing : float
        Wanted distance between nodes (model length).
    minimum : int
        Smallest number of nodes.

    Returns
    -------
    list of ndarray of float64, shape (n_i, 2)
        What `resample(ring, spacing, minimum=minimum, corners=CORNER, keep_area=True)` gives, but that a ring that
        comes out crossing itself is not made finer.
    """
    counts = np.array([len(ring) for ring in rings])
    first = np.concatenate(([0], np.cumsum(counts)))
    nodes = np.concatenate(rings)
    step = nodes[following(counts)] - nodes
    around = np.add.reduceat(np.hypot(step[:, 0], step[:, 1]), first[:-1])
    fresh = np.maximum(np.rint(around / spacing), minimum).astype(np.int64)
    start = np.concatenate(([0], np.cumsum(fresh)))
    places = np.empty((start[-1], 2))
    cornered = np.zeros(len(rings), dtype=bool)
    spread_evenly(nodes, first, start, np.radians(CORNER), places, cornered)
    even = np.split(places, start[1:-1])
    for ring in np.flatnonzero(cornered).tolist():
        even[ring] = resample(rings[ring], spacing, minimum=minimum, corners=CORNER, keep_area=True)
    return even


@njit(cache=True, error_model="numpy")
def spread_evenly(nodes: Floats, first: Longs, start: Longs, corner: float, places: Floats, cornered: Flags) -> None:
    """Put nodes at equal distances along closed rings, from the first node of each on, and keep the areas.

    Ring i has nodes first[i] to first[i + 1]; its fresh ones go to rows start[i] to start[i + 1] of `places`. A ring
    with a node that turns by more than `corner` (radians, between chords of half a spacing) is only marked in
    `cornered`.
    """
    # Strategy: equal arc lengths first; then the lengths of the chords are measured and shared out again, twice. At
    # last all nodes move along their normals by one distance, the root of a quadratic, so that the area comes back.
    for ring in range(len(first) - 1):
        mine = nodes[first[ring] : first[ring + 1]]
        fresh = places[start[ring] : start[ring + 1]]
        k, n = len(mine), len(fresh)
        arc = np.zeros(k + 1)
        area = 0.0
        for i in range(k):
            j = (i + 1) % k
            dx, dy = mine[j, 0] - mine[i, 0], mine[j, 1] - mine[i, 1]
            arc[i + 1] = arc[i] + np.sqrt(dx * dx + dy * dy)
            area += 0.5 * ((mine[i, 0] - mine[0, 0]) * dy - (mine[i, 1] - mine[0, 1]) * dx)
        half = 0.5 * arc[k] / n
        for i in range(k):
            bx, by = along(mine, arc, arc[i] - half)
            ax, ay = along(mine, arc, arc[i] + half)
            one_x, one_y, two_x, two_y = mine[i, 0] - bx, mine[i, 1] - by, ax - mine[i, 0], ay - mine[i, 1]
            turn = np.arctan2(one_x * two_y - one_y * two_x, one_x * two_x + one_y * two_y)
            if abs(turn) > corner:
                cornered[ring] = True
        if cornered[ring]:
            continue
        place = arc[k] * np.arange(n + 1) / n
        passed = np.zeros(n + 1)
        for sweep in range(EQUALISATIONS + 1):
            for i in range(n):
                fresh[i, 0], fresh[i, 1] = along(mine, arc, place[i])
            if sweep == EQUALISATIONS:
                break
            for i in range(n):
                j = (i + 1) % n
                passed[i + 1] = passed[i] + np.hypot(fresh[j, 0] - fresh[i, 0], fresh[j, 1] - fresh[i, 1])
            place = np.interp(passed[n] * np.arange(n + 1) / n, passed, place)
        give_area_back(fresh, area)


@njit(cache=True, error_model="numpy")
def along(ring: Floats, arc: Floats, place: float) -> tuple[float, float]:
    """Point at a place along a closed ring, which may lie outside of one turn."""
    k = len(ring)
    place %= arc[k]
    i = int(np.searchsorted(arc, place, side="right")) - 1
    i = min(i, k - 1)
    share = (place - arc[i]) / (arc[i + 1] - arc[i])
    j = (i + 1) % k
    return ring[i, 0] + share * (ring[j, 0] - ring[i, 0]), ring[i, 1] + share * (ring[j, 1] - ring[i, 1])


@njit(cache=True, error_model="numpy")
def give_area_back(ring: Floats, area: float) -> None:
    """Move all nodes of a ring by one distance along their normals so that it has an area, where that can be."""
    n = len(ring)
    normal = np.empty((n, 2))
    linear = square = missing = 0.0
    for i in range(n):
        ax, ay = ring[(i + 1) % n, 0] - ring[i - 1, 0], ring[(i + 1) % n, 1] - ring[i - 1, 1]
        size = max(np.sqrt(ax * ax + ay * ay), 1e-300)
        normal[i, 0], normal[i, 1] = ay / size, -ax / size
        linear += 0.5 * size
    for i in range(n):
        j = (i + 1) % n
        square += 0.5 * (normal[i, 0] * normal[j, 1] - normal[i, 1] * normal[j, 0])
        dx, dy = ring[j, 0] - ring[i, 0], ring[j, 1] - ring[i, 1]
        missing += 0.5 * ((ring[i, 0] - ring[0, 0]) * dy - (ring[i, 1] - ring[0, 1]) * dx)
    missing -= area
    root = linear * linear - 4.0 * square * missing
    if root > 0.0:
        ring -= 2.0 * missing / (linear + np.sqrt(root)) * normal
