"""Plain twins of the kernels of a repair: edits as sets of triangles, sizes by trying all pairs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

Triangles = set[tuple[int, int, int]]


def turned(triangle: tuple[int, int, int]) -> tuple[int, int, int]:
    """Return the same triangle with its smallest node first."""
    k = triangle.index(min(triangle))
    return (triangle[k], triangle[(k + 1) % 3], triangle[(k + 2) % 3])


def triangle_set(triangles: NDArray[np.int32]) -> Triangles:
    """Triangles (t, 3) as a set; those whose first corner is negative are left out."""
    return {turned((int(a), int(b), int(c))) for a, b, c in triangles if a >= 0}


def cut_edge_plain(triangles: Triangles, start: int, end: int, node: int) -> Triangles:
    """Plain twin of `cut_edge`: put a node on the edge between two nodes."""
    result = set()
    for triangle in triangles:
        if start in triangle and end in triangle:
            for gone in (start, end):
                a, b, c = (node if corner == gone else corner for corner in triangle)
                result.add(turned((a, b, c)))
        else:
            result.add(triangle)
    return result


def draw_into_plain(triangles: Triangles, node: int, into: int) -> Triangles:
    """Plain twin of `draw_into`: a node becomes one of its neighbours."""
    result = set()
    for triangle in triangles:
        a, b, c = (into if corner == node else corner for corner in triangle)
        if len({a, b, c}) == 3:
            result.add(turned((a, b, c)))
    return result


def spread_sizes_plain(
    points: NDArray[np.float64], triangles: NDArray[np.int32], slope: float, sizes: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Plain twin of `spread_sizes`, with as many sweeps as it takes."""
    start, end = (
        np.concatenate([triangles[:, (k + turn) % 3] for k in range(3) for turn in pair]) for pair in ((0, 1), (1, 0))
    )
    way = slope * np.hypot(*(points[end] - points[start]).T)[:, None]
    result = sizes.copy()
    while True:
        before = result.copy()
        np.minimum.at(result, end, before[start] + way)
        if np.array_equal(result, before):
            return result


def nearest_wall_plain(points: NDArray[np.float64], edges: NDArray[np.int32]) -> NDArray[np.float64]:
    """Distance from every node to the nearest wall edge; the reference for `nearest_walls`."""
    start, step = points[edges[:, 0]], points[edges[:, 1]] - points[edges[:, 0]]
    away = points[:, None] - start
    along = np.clip((away * step).sum(axis=2) / (step**2).sum(axis=1), 0.0, 1.0)
    rest = away - along[:, :, None] * step
    return np.asarray(np.hypot(rest[:, :, 0], rest[:, :, 1]).min(axis=1))
