"""Edits of a mesh in place: edges cut in two, nodes drawn into a neighbour."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

if TYPE_CHECKING:
    from vasculo.geometry.arrays import Flags, Floats, Ints

LONG, SHORT = 1.6, 0.65
"""An inner edge is cut above, a node at its end taken out below, this many wanted lengths."""

WALL_LONG, WALL_SHORT = 1.4, 1.3
"""A wall edge is cut above this many wanted lengths; a cut goes when the edge without it is below the second."""

FEW = 4
"""A node with so many triangles goes even when an edge there is only shorter than wanted."""

DEAD = -1
"""First corner of a triangle that is gone."""

FLOOR = 0.5
"""A node is drawn into a neighbour if no triangle around it gets a mean ratio below this."""

STAR = 64
"""Most triangles around a node that may be drawn into a neighbour."""


@njit(cache=True, error_model="numpy")
def replace(neighbours: Ints, t: int, old: int, new: int) -> None:
    """Let triangle t (if it is one) have the neighbour `new` in place of `old`."""
    if t >= 0:
        for k in range(3):
            if neighbours[t, k] == old:
                neighbours[t, k] = new


@njit(cache=True, error_model="numpy")
def cut_edge(triangles: Ints, neighbours: Ints, dirty: Flags, t: int, c: int, node: int, count: int) -> int:
    """Put a node on the edge opposite to corner c of triangle t; new triangles follow behind `count`; the new count."""
    u = neighbours[t, c]
    p = triangles[t, c]
    a = triangles[t, (c + 1) % 3]
    b = triangles[t, (c + 2) % 3]
    beside_a = neighbours[t, (c + 2) % 3]
    beside_b = neighbours[t, (c + 1) % 3]
    other = count
    count += 1
    across = u
    across_other = u
    if u >= 0:
        j = 0
        while neighbours[u, j] != t:
            j += 1
        q = triangles[u, j]
        far_b = neighbours[u, (j + 2) % 3]
        far_a = neighbours[u, (j + 1) % 3]
        across = count
        count += 1
        # u becomes q, b, node; across is q, node, a
        triangles[u, 0], triangles[u, 1], triangles[u, 2] = q, b, node
        triangles[across, 0], triangles[across, 1], triangles[across, 2] = q, node, a
        neighbours[u, 0], neighbours[u, 1], neighbours[u, 2] = other, across, far_b
        neighbours[across, 0], neighbours[across, 1], neighbours[across, 2] = t, far_a, u
        replace(neighbours, far_a, u, across)
        dirty[u] = True
        dirty[across] = True
    # t becomes p, a, node; other is p, node, b
    triangles[t, 0], triangles[t, 1], triangles[t, 2] = p, a, node
    triangles[other, 0], triangles[other, 1], triangles[other, 2] = p, node, b
    neighbours[t, 0], neighbours[t, 1], neighbours[t, 2] = across, other, beside_a
    neighbours[other, 0], neighbours[other, 1], neighbours[other, 2] = across_other, beside_b, t
    replace(neighbours, beside_b, t, other)
    dirty[t] = True
    dirty[other] = True
    return count


@njit(cache=True, error_model="numpy")
def longest(
    points: Floats, sizes: Floats, triangles: Ints, neighbours: Ints, t: int, inner: bool, walls: bool
) -> tuple[int, float]:
    """Find the edge of t longest over its wanted length, among inner or wall edges or both: corner, squared ratio."""
    most = 0.0
    chosen = -1
    for c in range(3):
        if (neighbours[t, c] < 0 and walls) or (neighbours[t, c] >= 0 and inner):
            a = triangles[t, (c + 1) % 3]
            b = triangles[t, (c + 2) % 3]
            x = points[b, 0] - points[a, 0]
            y = points[b, 1] - points[a, 1]
            wanted = 0.5 * (sizes[a] + sizes[b])
            ratio = (x * x + y * y) / (wanted * wanted)
            if ratio > most:
                most = ratio
                chosen = c
    return chosen, most


@njit(cache=True, error_model="numpy")
def cut_long_edges(
    points: Floats, sizes: Floats, wall: Ints, triangles: Ints, neighbours: Ints, dirty: Flags,
    nodes: int, count: int, walls: bool,
) -> tuple[int, int]:  # fmt: skip
    """Cut the edges that are too long in their middles: those on the walls, or the inner ones.

    Overwrites all arrays, which have room behind the `nodes` nodes and `count` triangles. Returns the new numbers; ends
    early when the room is full.
    """
    # Strategy: an edge is cut when it is the longest of its triangles; from a triangle whose longest edge is not, go on
    # to the neighbour there, where the ratio is larger, even to a wall (Rivara 1984). So it ends, and no angle becomes
    # small.
    limit = (WALL_LONG if walls else LONG) ** 2
    t = 0
    while t < count and nodes < len(points) and count + 2 <= len(triangles):
        if triangles[t, 0] == DEAD:
            t += 1
            continue
        chosen, ratio = longest(points, sizes, triangles, neighbours, t, inner=not walls, walls=walls)
        if ratio <= limit:
            t += 1
            continue
        at = t
        if not walls:
            chosen, ratio = longest(points, sizes, triangles, neighbours, t, inner=True, walls=True)
        while neighbours[at, chosen] >= 0:
            u = neighbours[at, chosen]
            beyond, more = longest(points, sizes, triangles, neighbours, u, inner=True, walls=True)
            if more <= ratio:
                break
            at, chosen, ratio = u, beyond, more
        a = triangles[at, (chosen + 1) % 3]
        b = triangles[at, (chosen + 2) % 3]
        points[nodes, 0] = 0.5 * (points[a, 0] + points[b, 0])
        points[nodes, 1] = 0.5 * (points[a, 1] + points[b, 1])
        sizes[nodes] = 0.5 * (sizes[a] + sizes[b])
        wall[nodes] = max(-1, -1 - neighbours[at, chosen])
        count = cut_edge(triangles, neighbours, dirty, at, chosen, nodes, count)
        nodes += 1
    return nodes, count


@njit(cache=True, error_model="numpy")
def fan(triangles: Ints, neighbours: Ints, t: int, v: int, around: Ints) -> int:
    """Triangles around node v from triangle t on, counter-clockwise, as 3 t + corner of v into `around`.

    Around a wall node the list begins at the wall. Returns their number, 0 when they are more than the room.
    """
    start = t
    while True:
        k = 0
        while triangles[start, k] != v:
            k += 1
        before = neighbours[start, (k + 2) % 3]
        if before < 0 or before == t:
            break
        start = before
    if before >= 0:
        start = t
    count = 0
    u = start
    while u >= 0 and count < len(around):
        k = 0
        while triangles[u, k] != v:
            k += 1
        around[count] = 3 * u + k
        count += 1
        u = neighbours[u, (k + 1) % 3]
        if u == start:
            return count
    return count if u < 0 else 0


@njit(cache=True, error_model="numpy")
def draw_into(
    points: Floats, triangles: Ints, neighbours: Ints, dirty: Flags, around: Ints, number: int, w: int
) -> bool:
    """Draw a node into its neighbour w if all triangles around stay good; overwrites triangles, neighbours and dirty.

    `around` (with `number` entries) comes from `fan` of the node.
    """
    for n in range(number):
        t = around[n] // 3
        k = around[n] % 3
        a = triangles[t, (k + 1) % 3]
        b = triangles[t, (k + 2) % 3]
        if w in (a, b):
            if neighbours[t, k] < 0 and (neighbours[t, (k + 1) % 3] < 0 or neighbours[t, (k + 2) % 3] < 0):
                return False
            continue
        ux = points[a, 0] - points[w, 0]
        uy = points[a, 1] - points[w, 1]
        vx = points[b, 0] - points[w, 0]
        vy = points[b, 1] - points[w, 1]
        squares = ux * ux + uy * uy + vx * vx + vy * vy + (ux - vx) ** 2 + (uy - vy) ** 2
        if not 3.4641016151377544 * (ux * vy - uy * vx) >= FLOOR * squares:
            return False
    for n in range(number):
        t = around[n] // 3
        k = around[n] % 3
        a = triangles[t, (k + 1) % 3]
        b = triangles[t, (k + 2) % 3]
        if w not in (a, b):
            triangles[t, k] = w
            dirty[t] = True
            continue
        # the edge across from the node stays, the one across from w goes: what lies beyond them becomes neighbours
        beyond = neighbours[t, k]
        inner = neighbours[t, (k + 1) % 3] if w == a else neighbours[t, (k + 2) % 3]
        replace(neighbours, beyond, t, inner)
        replace(neighbours, inner, t, beyond)
        if inner >= 0:
            dirty[inner] = True
        if beyond >= 0:
            dirty[beyond] = True
        triangles[t, 0] = DEAD
        dirty[t] = False
    return True


@njit(cache=True, error_model="numpy")
def draw_short_edges(
    points: Floats, sizes: Floats, wall: Ints, triangles: Ints, neighbours: Ints, dirty: Flags, count: int, walls: bool
) -> int:
    """Take out nodes at the ends of edges that are too short: cuts on the walls, or inner nodes; how many went.

    Overwrites triangles, neighbours and dirty; the nodes are left without triangles.
    """
    around = np.empty(STAR, dtype=np.int32)
    degree = np.zeros(len(points), dtype=np.int32)
    for t in range(0 if walls else count):
        if triangles[t, 0] != DEAD:
            for c in range(3):
                degree[triangles[t, c]] += 1
    gone = 0
    for t in range(count):
        for c in range(3):
            if triangles[t, 0] == DEAD:
                break
            # an inner edge is looked at from one of its triangles, the second
            if (neighbours[t, c] >= 0) if walls else not 0 <= neighbours[t, c] <= t:
                continue
            a = triangles[t, (c + 1) % 3]
            b = triangles[t, (c + 2) % 3]
            if walls:
                if wall[a] < 0:
                    continue
                number = fan(triangles, neighbours, t, a, around)
                if number == 0:
                    continue
                last = around[0]
                z = triangles[last // 3, (last % 3 + 1) % 3]
                last = around[number - 1]
                y = triangles[last // 3, (last % 3 + 2) % 3]
                length = np.hypot(points[y, 0] - points[z, 0], points[y, 1] - points[z, 1])
                if length < WALL_SHORT * 0.5 * (sizes[y] + sizes[z]):
                    gone += draw_into(points, triangles, neighbours, dirty, around, number, b) or draw_into(
                        points, triangles, neighbours, dirty, around, number, y if b == z else z
                    )
                continue
            x = points[b, 0] - points[a, 0]
            y = points[b, 1] - points[a, 1]
            wanted = 0.5 * (sizes[a] + sizes[b])
            if x * x + y * y >= wanted * wanted:
                continue
            short = x * x + y * y < (SHORT * wanted) ** 2
            done = False
            for _ in range(2):
                if not done and wall[a] == -1 and (short or degree[a] <= FEW):
                    number = fan(triangles, neighbours, t, a, around)
                    done = number > 0 and draw_into(points, triangles, neighbours, dirty, around, number, b)
                a, b = b, a
            gone += done
    return gone
