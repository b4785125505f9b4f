"""Wanted edge lengths read from a mesh itself: passages where the regions of two walls meet, graded along mesh edges.

The size field of `vasculo.mesh.size` searches every passage anew. A mesh that already follows the walls tells who faces
whom, so that all of it takes a few sweeps over the nodes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numba import njit

from vasculo.mesh.adjacency import stars
from vasculo.mesh.passages import DETOUR, FACING
from vasculo.mesh.repair.carry import layers_from
from vasculo.mesh.repair.work import wall_edges
from vasculo.mesh.size import BASE_LAYERS, LAYER, size_field, with_wall_edges

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from vasculo.geometry.arrays import Floats, Ints
    from vasculo.mesh.repair.work import Work
    from vasculo.mesh.size import SizeField
    from vasculo.mesh.walls import Walls

WALK = 64
"""Most steps along a wall to the place nearest to a point."""

REACH = 0.75
"""Nodes nearer to a wall than this share of the widest passage may lie in one."""

SWEEPS = 2
"""Sweeps over the nodes that grade the sizes: one away from the walls, one back."""


class Wanted(NamedTuple):
    """What is asked of the edge lengths, named as in `generate_mesh`."""

    edge_length: float
    wall_edge_length: float
    across: float
    grading: float
    curvature: float
    size: Callable[[NDArray[np.float64]], NDArray[np.float64]] | None

    def field(self, walls: Walls) -> SizeField:
        """Size field around some outlines."""
        return size_field(
            walls,
            self.edge_length,
            self.wall_edge_length,
            self.across,
            self.grading,
            curvature=self.curvature,
            size=self.size,
        )


def mesh_sizes(work: Work, walls: Walls, wanted: Wanted) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Wanted edge length at every node of a mesh that follows its walls.

    Parameters
    ----------
    work : Work
    walls : Walls
    wanted : Wanted

    Returns
    -------
    wished, sizes : (n,) float64, model length
        As the outlines and the passages ask for; and with the wall edges as they are, which inner edges go by.
    """
    points, triangles, neighbours = work.points, work.triangles, work.neighbours
    count = len(points)
    if wanted.curvature > 0.0 or wanted.size is not None:
        field = wanted.field(walls)
        return field.at(points), with_wall_edges(field, points, wall_edges(work)[0]).at(points)
    layers = max(wanted.across, BASE_LAYERS)
    widest = wanted.edge_length * layers / LAYER
    onward, own = np.full((count, 2), -1, dtype=np.int32), np.full(count, -1, dtype=np.int32)
    ring_walls(triangles, neighbours, onward, own)
    first, star = stars(triangles, count)
    layer, order = np.where(own >= 0, 0, -1).astype(np.int32), np.empty(count, dtype=np.int32)
    layers_from(triangles, first, star, np.zeros(count, dtype=np.bool_), count, layer, order)
    sizes, wall = np.full(count, wanted.edge_length), np.empty(count, dtype=np.int32)
    nearest_walls(points, triangles, first, star, onward, order, REACH * widest, wall)
    wish_passages(
        points, triangles, neighbours, wall, onward, own, walls.body, walls.facts, walls.segments,
        LAYER / layers, wanted.grading, sizes,
    )  # fmt: skip
    wished = sizes.copy()
    wish_walls(onward, own, np.minimum(wanted.wall_edge_length, walls.lengths), wished)
    wish_edges(points, triangles, neighbours, sizes)
    both = np.column_stack((wished, sizes))
    spread_sizes(points, triangles, first, star, order, wanted.grading, SWEEPS, both)
    return both[:, 0].copy(), both[:, 1].copy()


@njit(cache=True, error_model="numpy")
def ring_walls(triangles: Ints, neighbours: Ints, onward: Ints, own: Ints) -> None:
    """Next and previous wall node and the segment from here on, for every wall node.

    `neighbours` holds -1 - s at a wall edge on outline segment s. Overwrites `onward` (n, 2) and `own` (n,), given: -1.
    """
    for t in range(len(triangles)):
        for c in range(3):
            if neighbours[t, c] < 0:
                a = triangles[t, (c + 1) % 3]
                b = triangles[t, (c + 2) % 3]
                onward[a, 0] = b
                onward[b, 1] = a
                own[a] = -1 - neighbours[t, c]


@njit(cache=True, error_model="numpy")
def foot(points: Floats, onward: Ints, w: int, x: float, y: float) -> tuple[float, float, float]:
    """Squared distance from (x, y) to the wall edge from node w, and the nearest point on it."""
    v = onward[w, 0]
    dx = points[v, 0] - points[w, 0]
    dy = points[v, 1] - points[w, 1]
    t = ((x - points[w, 0]) * dx + (y - points[w, 1]) * dy) / (dx * dx + dy * dy)
    t = min(1.0, max(0.0, t))
    fx = points[w, 0] + t * dx
    fy = points[w, 1] + t * dy
    return (fx - x) ** 2 + (fy - y) ** 2, fx, fy


@njit(cache=True, error_model="numpy")
def slide(points: Floats, onward: Ints, w: int, x: float, y: float) -> int:
    """Walk along the wall from edge w while it comes nearer to (x, y); the edge at the end."""
    best = foot(points, onward, w, x, y)[0]
    for side in range(2):
        for _ in range(WALK):
            v = onward[w, side]
            square = foot(points, onward, v, x, y)[0]
            if square >= best:
                break
            best = square
            w = v
    return w


@njit(cache=True, error_model="numpy")
def nearest_walls(
    points: Floats, triangles: Ints, first: Ints, star: Ints, onward: Ints, order: Ints, widest: float, wall: Ints
) -> None:
    """Start node of the wall edge nearest to each node, -1 where it is further than `widest`; overwrites `wall` (n,).

    `order` lists the nodes breadth first from the walls.
    """
    for i in range(len(wall)):
        wall[i] = i if onward[i, 0] >= 0 else -1
    for q in range(len(order)):
        i = order[q]
        if onward[i, 0] >= 0:
            continue
        best = widest * widest
        found = np.int32(-1)
        for s in range(first[i], first[i + 1]):
            w = wall[triangles[star[s] // 3, (star[s] % 3 + 1) % 3]]
            if w < 0 or w == found:
                continue
            square = foot(points, onward, w, points[i, 0], points[i, 1])[0]
            if square < best:
                best = square
                found = w
        if found >= 0:
            wall[i] = slide(points, onward, found, points[i, 0], points[i, 1])


@njit(cache=True, error_model="numpy")
def faces(
    own: Ints, body: Ints, facts: Floats, segments: Floats,
    a: int, ax: float, ay: float, b: int, bx: float, by: float,
) -> bool:  # fmt: skip
    """Whether two places on the wall edges from nodes a and b are the two banks of a passage.

    Two outlines always are; parts of one are under the conditions of `vasculo.mesh.passages`.
    """
    s = own[a]
    r = own[b]
    if body[s] != body[r]:
        return True
    here = facts[s, 0] + np.hypot(ax - segments[s, 0], ay - segments[s, 1])
    there = facts[r, 0] + np.hypot(bx - segments[r, 0], by - segments[r, 1])
    away = abs(here - there)
    away = min(away, facts[s, 2] - away)
    wx = bx - ax
    wy = by - ay
    gap = np.hypot(wx, wy)
    dx = segments[s, 2] - segments[s, 0]
    dy = segments[s, 3] - segments[s, 1]
    ex = segments[r, 2] - segments[r, 0]
    ey = segments[r, 3] - segments[r, 1]
    meet = (
        s == r
        or (segments[s, 2] == segments[r, 0] and segments[s, 3] == segments[r, 1])
        or (segments[r, 2] == segments[s, 0] and segments[r, 3] == segments[s, 1])
    )
    return (
        not meet
        and away > DETOUR * gap
        and dx * wy - dy * wx >= FACING * gap * facts[s, 1]
        and ey * wx - ex * wy >= FACING * gap * facts[r, 1]
    )


@njit(cache=True, error_model="numpy")
def wish_passages(
    points: Floats, triangles: Ints, neighbours: Ints, wall: Ints, onward: Ints, own: Ints,
    body: Ints, facts: Floats, segments: Floats, share: float, slope: float, sizes: Floats,
) -> None:  # fmt: skip
    """Lower `sizes` (n,) to `share` times the width of the passages, on both banks and half way across.

    `body` (m,), `facts` (m, 3: arc, length, length around) and `segments` (m, 4) belong to the outline segments.
    """
    # Strategy: a mesh edge whose ends have different walls nearest to them lies across the middle of a passage. From
    # its middle go to both banks, and from there to the nearest place opposite: that is the width for this bank.
    for t in range(len(triangles)):
        for c in range(3):
            if neighbours[t, c] < t:
                continue
            i = triangles[t, (c + 1) % 3]
            j = triangles[t, (c + 2) % 3]
            a = wall[i]
            b = wall[j]
            if a < 0 or b < 0 or a == b or onward[a, 0] == b or onward[b, 0] == a:
                continue
            mx = 0.5 * (points[i, 0] + points[j, 0])
            my = 0.5 * (points[i, 1] + points[j, 1])
            half = 0.5 * np.hypot(points[i, 0] - points[j, 0], points[i, 1] - points[j, 1])
            for _ in range(2):
                a = slide(points, onward, a, mx, my)
                _, ax, ay = foot(points, onward, a, mx, my)
                across = slide(points, onward, b, ax, ay)
                square, bx, by = foot(points, onward, across, ax, ay)
                if faces(own, body, facts, segments, a, ax, ay, across, bx, by):
                    size = share * np.sqrt(square)
                    for k in (a, onward[a, 0]):
                        sizes[k] = min(sizes[k], size + slope * np.hypot(points[k, 0] - ax, points[k, 1] - ay))
                    sizes[i] = min(sizes[i], size + slope * half)
                    sizes[j] = min(sizes[j], size + slope * half)
                a, b = b, a


@njit(cache=True, error_model="numpy")
def spread_sizes(
    points: Floats, triangles: Ints, first: Ints, star: Ints, order: Ints, slope: float, sweeps: int, sizes: Floats
) -> None:
    """Bound each column of the sizes (n, 2) by the values at the neighbours plus slope times the way to them.

    Sweeps go through the nodes in their `order`, forth and back.
    """
    for turn in range(sweeps):
        for q in range(len(order)):
            i = order[q] if turn % 2 == 0 else order[len(order) - 1 - q]
            one = sizes[i, 0]
            two = sizes[i, 1]
            for s in range(first[i], first[i + 1]):
                for k in range(1, 3):
                    j = triangles[star[s] // 3, (star[s] % 3 + k) % 3]
                    if sizes[j, 0] < one or sizes[j, 1] < two:
                        way = slope * np.sqrt((points[i, 0] - points[j, 0]) ** 2 + (points[i, 1] - points[j, 1]) ** 2)
                        one = min(one, sizes[j, 0] + way)
                        two = min(two, sizes[j, 1] + way)
            sizes[i, 0] = one
            sizes[i, 1] = two


@njit(cache=True, error_model="numpy")
def wish_walls(onward: Ints, own: Ints, at_wall: Floats, sizes: Floats) -> None:
    """Lower `sizes` (n,) at the wall nodes to the sizes (m,) of the outline segments that they lie on."""
    for i in range(len(onward)):
        if onward[i, 0] >= 0:
            sizes[i] = min(sizes[i], at_wall[own[i]], at_wall[own[onward[i, 1]]])


@njit(cache=True, error_model="numpy")
def wish_edges(points: Floats, triangles: Ints, neighbours: Ints, sizes: Floats) -> None:
    """Lower `sizes` (n,) at the wall nodes to the lengths of their wall edges."""
    for t in range(len(triangles)):
        for c in range(3):
            if neighbours[t, c] < 0:
                a = triangles[t, (c + 1) % 3]
                b = triangles[t, (c + 2) % 3]
                length = np.hypot(points[b, 0] - points[a, 0], points[b, 1] - points[a, 1])
                sizes[a] = min(sizes[a], length)
                sizes[b] = min(sizes[b], length)
