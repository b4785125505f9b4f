"""Carrying nodes along: the moves of the walls, spread over a few layers of nodes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from vasculo.mesh.adjacency import stars

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.geometry.arrays import Flags, Floats, Ints

FADING = 3
"""Layers of nodes that are carried along with a wall, besides those for the length of the move."""

PER_EDGE = 3.0
"""Layers more for each wall edge length that a wall node moves."""

DEEPEST = 24
"""Most layers that are carried along."""

SWEEPS = 2
"""Sweeps that even the moves out."""

SMALL = 0.25
"""Moves of fewer wall edges than this are not evened out: the smoothing does."""


def carry_along(
    points: NDArray[np.float64],
    triangles: NDArray[np.int32],
    walls: NDArray[np.int32],
    on_wall: NDArray[np.bool_],
    places: NDArray[np.float64],
) -> tuple[NDArray[np.bool_], NDArray[np.int32], NDArray[np.int32]]:
    """Move the walls to their places and, over some layers, the nodes behind them; overwrites `points` (n, 2).

    Parameters
    ----------
    points : (n, 2) float64, model length
    triangles : (t, 3) int32
    walls : (b, 2) int32
        Wall edges.
    on_wall : (n,) bool
        Nodes that go nowhere but to their places.
    places : (n, 2) float64, model length
        Where the wall nodes belong; all others as they are.

    Returns
    -------
    touched : (n,) bool
        Nodes that were carried.
    first, star : (n + 1,) and (3 t,) int32
        Result of `stars`.
    """
    moves = places - points
    layer = np.where(moves.any(axis=1), 0, -1).astype(np.int32)
    first, star = stars(triangles, len(points))
    if not (layer == 0).any():
        return layer == 0, first, star
    ends = points[walls]
    length = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
    largest = float((np.hypot(*moves[walls[:, 0]].T) / length).max())
    most = min(DEEPEST, FADING + int(np.ceil(PER_EDGE * largest)))
    order = np.empty(len(layer), dtype=np.int32)
    count = layers_from(triangles, first, star, on_wall, most, layer, order)
    carry(triangles, first, star, layer, order, count, most, SWEEPS if largest > SMALL else 0, moves)
    points += moves
    points[on_wall] = places[on_wall]
    return layer >= 0, first, star


@njit(cache=True, error_model="numpy")
def layers_from(triangles: Ints, first: Ints, star: Ints, barred: Flags, most: int, layer: Ints, order: Ints) -> int:
    """Breadth first from the nodes of layer 0 (given; -1 elsewhere) up to layer `most`; `barred` nodes are not entered.

    Overwrites `layer` (n,) and `order` (n,): the nodes reached, layer after layer. Returns their number.
    """
    count = 0
    for i in range(len(layer)):
        if layer[i] == 0:
            order[count] = i
            count += 1
    done = 0
    while done < count:
        i = order[done]
        done += 1
        if layer[i] == most:
            break
        for s in range(first[i], first[i + 1]):
            t = star[s] // 3
            for c in range(3):
                j = triangles[t, c]
                if layer[j] < 0 and not barred[j]:
                    layer[j] = layer[i] + 1
                    order[count] = j
                    count += 1
    return count


@njit(cache=True, error_model="numpy")
def carry(
    triangles: Ints,
    first: Ints,
    star: Ints,
    layer: Ints,
    order: Ints,
    count: int,
    most: int,
    sweeps: int,
    moves: Floats,
) -> None:
    """Find the moves of all nodes from those of layer 0, fading over `most` layers; overwrites `moves` (n, 2).

    `layer` and `order` come from `layers_from`. Nodes outside it keep what they have (given: zero).
    """
    # Strategy: layer after layer, the mean over the neighbours nearer to the walls, a little less each layer; then each
    # node to the mean of all its neighbours, forth and back: a few Gauss-Seidel sweeps of Laplace's equation.
    begin = 0
    while begin < count and layer[order[begin]] == 0:
        begin += 1
    for turn in range(sweeps + 1):
        for q in range(begin, count):
            i = order[q] if turn % 2 == 0 else order[count - 1 - q + begin]
            x = 0.0
            y = 0.0
            number = 0
            for s in range(first[i], first[i + 1]):
                j = triangles[star[s] // 3, (star[s] % 3 + 1) % 3]
                if turn > 0 or (0 <= layer[j] < layer[i]):
                    x += moves[j, 0]
                    y += moves[j, 1]
                    number += 1
            if number == 0:
                continue
            fade = 1.0 if turn > 0 else (most + 1.0 - layer[i]) / (most + 2.0 - layer[i])
            moves[i, 0] = fade * x / number
            moves[i, 1] = fade * y / number


def carry_plain(
    triangles: NDArray[np.int32], layer: NDArray[np.int32], order: NDArray[np.int32], most: int, sweeps: int,
    moves: NDArray[np.float64],
) -> None:  # fmt: skip
    """Plain twin of `carry`; `order` holds the nodes reached and no others."""
    after: list[list[int]] = [[] for _ in moves]
    for p, q, r in triangles.tolist():
        after[p].append(q)
        after[q].append(r)
        after[r].append(p)
    inner = [int(i) for i in order if layer[i] > 0]
    for i in inner:
        near = [j for j in after[i] if 0 <= layer[j] < layer[i]]
        if near:
            moves[i] = (most + 1.0 - layer[i]) / (most + 2.0 - layer[i]) * moves[near].mean(axis=0)
    for turn in range(1, sweeps + 1):
        for i in inner[:: -1 if turn % 2 else 1]:
            moves[i] = moves[after[i]].mean(axis=0)


@njit(cache=True, error_model="numpy")
def mark_around(triangles: Ints, nodes: Flags, marked: Flags) -> None:
    """Mark the triangles that have one of the nodes (n,); overwrites `marked` (t,)."""
    for t in range(len(triangles)):
        marked[t] = nodes[triangles[t, 0]] or nodes[triangles[t, 1]] or nodes[triangles[t, 2]]


@njit(cache=True, error_model="numpy")
def mark_broken(points: Floats, triangles: Ints, least: float, broken: Flags) -> int:
    """Mark the triangles whose mean ratio 4 sqrt(3) area / (sum of squared edges) is below `least`; how many there are.

    Overwrites `broken` (t,). The mean ratio is 1 for an equilateral triangle and negative for one turned over.
    """
    found = 0
    for t in range(len(triangles)):
        a = triangles[t, 0]
        b = triangles[t, 1]
        c = triangles[t, 2]
        ux = points[b, 0] - points[a, 0]
        uy = points[b, 1] - points[a, 1]
        vx = points[c, 0] - points[a, 0]
        vy = points[c, 1] - points[a, 1]
        squares = ux * ux + uy * uy + vx * vx + vy * vy + (ux - vx) ** 2 + (uy - vy) ** 2
        broken[t] = not 3.4641016151377544 * (ux * vy - uy * vx) >= least * squares
        found += broken[t]
    return found


def mark_broken_plain(points: NDArray[np.float64], triangles: NDArray[np.int32], least: float) -> NDArray[np.bool_]:
    """Plain twin of `mark_broken`."""
    a, b, c = (points[triangles[:, k]] for k in range(3))
    twice = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    squares = ((b - a) ** 2 + (c - a) ** 2 + (c - b) ** 2).sum(axis=1)
    return np.asarray(~(2.0 * np.sqrt(3.0) * twice >= least * squares))
