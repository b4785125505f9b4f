"""Hand-made networks: a grid of triangles from which springs are cut."""

from itertools import pairwise

import numpy as np
import pytest
import shapely
from numpy.random import default_rng

from vasculo.springs.network import SpringNetwork


def grid(columns, rows, jitter=0.0, seed=0):
    """Points, triangles and edges of a unit grid, each square cut by a diagonal; jitter moves inner nodes."""
    x, y = np.meshgrid(np.arange(columns + 1.0), np.arange(rows + 1.0))
    points = np.stack([x.ravel(), y.ravel()], axis=1)
    inner = (points > 0.0).all(axis=1) & (points < (columns, rows)).all(axis=1)
    points[inner] += jitter * default_rng(seed).uniform(-1.0, 1.0, (int(inner.sum()), 2))
    corner = (np.arange(columns)[None, :] + (columns + 1) * np.arange(rows)[:, None]).ravel()
    a, b, c, d = corner, corner + 1, corner + columns + 2, corner + columns + 1
    triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)]).astype(np.int32)
    pairs = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    return points, triangles, np.unique(pairs, axis=0).astype(np.int32)


def carve(columns, rows, holes, keep=(), move=None, triangles=True, jitter=0.0):
    """Grid network without the springs whose middle lies strictly inside a hole.

    keep: paths of lattice nodes [(x, y), ...] whose springs stay; move: {(x, y): new position} after carving.
    """
    points, corners, edges = grid(columns, rows, jitter)
    flat, _, _ = grid(columns, rows)
    middle = shapely.points(flat[edges].mean(axis=1))
    gone = np.zeros(len(edges), dtype=bool)
    for hole in holes:
        gone |= shapely.contains_properly(shapely.Polygon(hole), middle)

    def node(place):
        return int(place[0]) + (columns + 1) * int(place[1])

    kept = {tuple(sorted((node(p), node(q)))) for path in keep for p, q in pairwise(path)}
    gone &= np.array([tuple(edge) not in kept for edge in edges.tolist()])
    network = SpringNetwork(points, edges[~gone], triangles=corners if triangles else None)
    for place, target in (move or {}).items():
        network.points[node(place)] = target
    return network


def box(x0, y0, x1, y1):
    """Corners of a rectangle."""
    return [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]


ZOO = {
    "plain": box(2, 2, 8, 8),
    "dangling": box(10, 2, 18, 8),
    "island": box(20, 2, 28, 8),
    "left of cord": box(2, 11, 8, 17),
    "right of cord": box(8, 11, 14, 17),
    "at the frame": box(16, 14, 22, 20),
    "second loop": box(24, 11, 32, 19),
    "folded": box(34, 2, 40, 8),
    "coincident": box(34, 11, 40, 17),
}


@pytest.fixture
def zoo():
    """Return a maker of a network with every degenerate case, with or without its triangles."""

    def make(triangles=True):
        keep = [
            [(10, 5), (11, 5), (12, 5), (13, 5)],  # a chain that dangles into its void
            [(23, 4), (24, 4), (24, 5), (23, 5), (23, 4)],  # an island in the middle of its void
            [(8, y) for y in range(11, 18)],  # two voids with one spring between them
            [(24, 15), (25, 15), (26, 15)],  # a bridge ...
            [(x, 13) for x in range(26, 31)] + [(30, y) for y in range(14, 18)],  # ... to a ring in the void
            [(26, y) for y in range(13, 18)] + [(x, 17) for x in range(27, 31)],
        ]
        move = {
            (37, 5): (39.6, 5.2),  # a loose node inside its void: triangles around it fold
            (40, 14): (40.0, 13.0),  # a node of an outline on top of its neighbour: a spring without length
            (34, 14): (34.0, 13.0),
        }
        return carve(42, 20, ZOO.values(), keep, move, triangles)

    return make


@pytest.fixture
def carver():
    """Return the carving function itself."""
    return carve
