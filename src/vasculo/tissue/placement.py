"""Where the nodes of an initial tissue stand: relaxed, on a jittered lattice, or as Poisson disks."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np
from numba import njit

from vasculo.errors import ComputationError
from vasculo.tissue.nearest import add_to_nearest, find_close_pairs, find_nearest, sort_into_cells

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

Kind = Literal["relaxed", "jittered", "poisson"]

SWEEPS = 3
"""Sweeps of Lloyd's method: even spacing, still irregular."""

SAMPLES = 20
"""Random samples a node by which a sweep finds the middle of each node's cell."""

AT_ONCE = 2_000_000
"""Samples that are drawn at once."""

CLEARANCE = 0.45
"""Least distance of an interior node from the frame and from other nodes, in spacings of a regular lattice."""

PUSHES = 50
"""Most rounds in which nodes that are too close are pushed apart."""

CROWDING = 0.64
"""Nodes times squared disk radius: 0.70 is where random disks jam, so that throwing more of them never ends."""

THROWS = 2_000
"""Most throws a node, on average, before a tissue of Poisson disks is given up."""


def relaxed(number: int, frame: Floats, spacing: float, rng: np.random.Generator, _jitter: float) -> Floats:
    """Nodes from random ones by Lloyd's method: each moves to the middle of the samples nearest to it; no frame moves.

    Parameters
    ----------
    number : int
        Nodes to place.
    frame : ndarray of float64, shape (f, 2)
        Nodes on the boundary of the unit square; none: the square is a torus.
    spacing : float
        Of a regular triangular lattice with as many nodes (model length).
    rng : numpy Generator
        Source of chance.
    """
    inner, torus = rng.random((number, 2)), len(frame) == 0
    for _ in range(SWEEPS):
        points = np.concatenate([inner, frame])
        cells = sort_into_cells(points, torus)
        total, count = np.zeros_like(points), np.zeros(len(points), dtype=np.int64)
        left = SAMPLES * len(points)
        while left > 0:
            now = min(left, AT_ONCE)
            samples = rng.random((now, 2))
            add_to_nearest(samples, points, find_nearest(samples, points, cells), torus, total, count)
            left -= now
        middle = total[:number] / np.maximum(count[:number], 1)[:, None]
        inner = np.where(count[:number, None] > 0, middle, inner)
        if torus:
            inner = _into_square(inner)
    return apart(inner, CLEARANCE * spacing, torus=torus)


def jittered(number: int, frame: Floats, spacing: float, rng: np.random.Generator, jitter: float) -> Floats:
    """Nodes of a triangular lattice, each shifted by up to `jitter` spacings in x and in y; arguments as in `relaxed`.

    Rows lie along x. Their number is the best for equilateral triangles, and they have the same number of nodes or one
    more or less, so that any number of nodes finds its place.
    """
    torus = len(frame) == 0
    margin = 0.0 if torus else 0.75 * spacing
    size = 1.0 - 2.0 * margin
    rows = max(1, round(size / (spacing * np.sqrt(0.75))))
    if torus and rows > 1:
        rows -= rows % 2  # the shift of every other row has to close
    row = np.arange(number) * rows // number
    start = -(-np.arange(rows) * number // rows)
    many = np.diff(np.append(start, number))
    x = (np.arange(number) - start[row] + 0.25 + 0.5 * (row % 2)) / many[row]
    points = margin + size * np.column_stack([x, (row + 0.5) / rows])
    points += spacing * jitter * rng.uniform(-1.0, 1.0, points.shape)
    if torus:
        points = _into_square(points)
    return apart(points, CLEARANCE * spacing, torus=torus)


def poisson(number: int, frame: Floats, spacing: float, rng: np.random.Generator, _jitter: float) -> Floats:
    """Nodes thrown at random, each kept if no other is within a radius, until there are enough; see `relaxed`.

    Raises
    ------
    ComputationError
        When the square is full before; with the radius chosen here that does not happen.
    """
    torus = len(frame) == 0
    radius = float(np.sqrt(CROWDING / (number + len(frame))))
    margin = 0.0 if torus else CLEARANCE * spacing
    cells = max(3, int(1.0 / radius))
    points = np.concatenate([frame, np.empty((number, 2))])
    grid = np.full((cells, cells, 8), -1, dtype=np.int32)
    most = THROWS * number
    placed = throw_disks(rng, points, len(frame), radius, margin, torus, grid, most)
    if placed < len(points):
        raise ComputationError(
            f"{placed - len(frame)} of {number} nodes found room at a distance of {radius:.3g} from all others in "
            f"{most} throws: try another seed, or kind = 'relaxed'"
        )
    return points[len(frame) :]


PLACEMENTS: Mapping[Kind, Callable[[int, Floats, float, np.random.Generator, float], Floats]] = {
    "relaxed": relaxed,
    "jittered": jittered,
    "poisson": poisson,
}
"""How nodes are placed, by the name of the kind."""


def apart(inner: Floats, least: float, *, torus: bool) -> Floats:
    """Push nodes apart that are closer than `least`, half of the way each, and all away from the frame."""
    for _ in range(PUSHES):
        inner = _into_square(inner) if torus else np.clip(inner, least, 1.0 - least)
        pairs = find_close_pairs(inner, 0.999 * least, torus)
        if len(pairs) == 0:
            break
        arms = inner[pairs[:, 1]] - inner[pairs[:, 0]]
        if torus:
            arms -= np.round(arms)
        length = np.hypot(arms[:, 0], arms[:, 1])
        same = length < 1e-3 * least  # met in a corner: part towards the middle of the square
        arms[same] = np.where(inner[pairs[same, 0]] < 0.5, least, -least)
        length[same] = least / 2.0
        push = (0.5 * (least - length) / length)[:, None] * arms
        np.add.at(inner, pairs[:, 1], push)
        np.add.at(inner, pairs[:, 0], -push)
    return inner


def _into_square(points: Floats) -> Floats:
    """Images of points of the torus in [0, 1)."""
    inside = points - np.floor(points)
    return np.where(inside < 1.0, inside, 0.0)  # what was just below zero


@njit(cache=True, error_model="numpy")
def throw_disks(rng, points, placed, radius, margin, wrap, grid, most):  # type: ignore[no-untyped-def]
    """Throw nodes into the unit square until all have found room; returns how many have, those given included.

    Parameters
    ----------
    rng : numpy Generator
        Two numbers a throw.
    points : ndarray of float64, shape (n, 2)
        The first `placed` are given; overwrites the others.
    radius : float
        Least distance of two nodes.
    margin : float
        Least distance from the boundary.
    wrap : bool
        Whether the square is a torus.
    grid : ndarray of int32, shape (c, c, 8)
        All -1 at entry, c at most 1 / radius: the nodes of each cell; overwritten.
    most : int
        Most throws.
    """
    side = grid.shape[0]
    for i in range(placed):
        x, y = min(int(points[i, 0] * side), side - 1), min(int(points[i, 1] * side), side - 1)
        slot = 0
        while grid[x, y, slot] >= 0:
            slot += 1
        grid[x, y, slot] = i
    for _ in range(most):
        if placed == points.shape[0]:
            break
        x = margin + (1.0 - 2.0 * margin) * rng.random()
        y = margin + (1.0 - 2.0 * margin) * rng.random()
        own_x, own_y = min(int(x * side), side - 1), min(int(y * side), side - 1)
        free = True
        for cell_x in range(own_x - 1, own_x + 2):
            for cell_y in range(own_y - 1, own_y + 2):
                if not wrap and (cell_x < 0 or cell_x >= side or cell_y < 0 or cell_y >= side):
                    continue
                for slot in range(8):
                    j = grid[cell_x % side, cell_y % side, slot]
                    if j < 0:
                        break
                    dx, dy = points[j, 0] - x, points[j, 1] - y
                    if wrap:
                        dx, dy = dx - np.round(dx), dy - np.round(dy)
                    free = free and dx * dx + dy * dy > radius * radius
        if free:
            points[placed, 0], points[placed, 1] = x, y
            slot = 0
            while grid[own_x, own_y, slot] >= 0:
                slot += 1
            grid[own_x, own_y, slot] = placed
            placed += 1
    return placed


def throw_disks_plain(
    rng: np.random.Generator, points: Floats, placed: int, radius: float, margin: float, wrap: bool, most: int
) -> int:
    """NumPy twin of `throw_disks`: every throw is held against all nodes."""
    for _ in range(most):
        if placed == len(points):
            break
        thrown = margin + (1.0 - 2.0 * margin) * np.array([rng.random(), rng.random()])
        arms = points[:placed] - thrown
        if wrap:
            arms -= np.round(arms)
        if (np.sum(arms * arms, axis=1) > radius * radius).all():
            points[placed] = thrown
            placed += 1
    return placed
