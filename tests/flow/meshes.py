"""Irregular meshes for the flow tests, made without the package's mesher."""

import numpy as np
from scipy.spatial import Delaunay

from vasculo.mesh.triangulation import Triangulation

SIDES = ("bottom", "right", "top", "left")


def rectangle(width=1.0, height=1.0, across=8, seed=0, jitter=0.25, turn=0.0, columns=None):
    """Jittered rows of points and their Delaunay triangles; sides named; `turn` rotates it all about the origin."""
    ny = across
    nx = columns or max(3, round(width / height * across))
    x, y = np.meshgrid(np.linspace(0.0, width, nx + 1), np.linspace(0.0, height, ny + 1), indexing="ij")
    inside = (x > 0) & (x < width) & (y > 0) & (y < height)
    rng = np.random.default_rng(seed)
    x = x + np.where(inside, jitter * width / nx * rng.uniform(-1.0, 1.0, x.shape), 0.0)
    x = x + np.where(inside & (np.arange(ny + 1) % 2 == 1), 0.25 * width / nx, 0.0)
    y = y + np.where(inside, jitter * height / ny * rng.uniform(-1.0, 1.0, y.shape), 0.0)
    points = np.column_stack([x.ravel(), y.ravel()])
    triangles, _ = _delaunay(points, 1e-9 * width * height)
    return _tagged(_turned(points, turn), triangles, lambda middle: _side(_turned(middle, -turn), width, height))


def scattered(across, seed=0, sweeps=0):
    """Unit square with points thrown at random inside and evenly on its rim: slivers, and small beside large triangles.

    Each sweep moves the inner points to the centroids of the triangles around them (Lloyd), which evens the mesh out.
    About 2.3 `across`^2 triangles.
    """
    rim = _rim(across)
    inner = np.random.default_rng(seed).uniform(0.0, 1.0, (round(across**2 * 2.0 / np.sqrt(3.0)), 2))
    for k in range(sweeps + 1):
        points = np.concatenate([rim, inner])
        triangles, area = _delaunay(points, 1e-12)
        if k < sweeps:
            share = np.repeat(area, 3)
            moment = np.repeat(points[triangles].mean(axis=1), 3, axis=0) * share[:, None]
            x, y, total = (np.bincount(triangles.ravel(), part)[len(rim) :] for part in (*moment.T, share))
            inner = np.column_stack([x / total, y / total])
    return _tagged(points, triangles, lambda middle: _side(middle, 1.0, 1.0))


def fan(across=1, centre=(0.5, 0.5)):
    """Unit square cut into triangles around one point, inside or the corner (0, 0), `across` on each side."""
    rim = _rim(across)
    around = np.arange(4 * across)
    inside = min(centre) > 0.0
    points = np.concatenate([rim, [centre]]) if inside else rim
    hub = np.full(len(around), len(rim) if inside else 0)
    triangles = np.column_stack([hub, around, np.roll(around, -1)])
    if not inside:
        triangles = triangles[across:-across]  # without the sides that end in the corner
    return _tagged(points, triangles, lambda middle: _side(middle, 1.0, 1.0))


def annulus(across=6, around=40, inner=0.5, outer=1.0, seed=0, jitter=0.2):
    """Ring between two regular polygons inscribed in circles; the inner one is pillar 0, the outer side is "rim"."""
    shape = inner + (outer - inner) * np.linspace(0.0, 1.0, across + 1)
    radius = np.repeat(shape[:, None], around, axis=1)
    angle = np.repeat(2 * np.pi * np.arange(around)[None] / around, across + 1, axis=0)
    rng = np.random.default_rng(seed)
    radius[1:-1] += jitter * (outer - inner) / across * rng.uniform(-1, 1, radius[1:-1].shape)
    angle[1:-1] += jitter * 2 * np.pi / around * rng.uniform(-1, 1, angle[1:-1].shape)
    points = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1)
    middle = 0.5 * (inner + outer)
    return _tagged(
        points.reshape(-1, 2), _rings(points), lambda at: np.where(np.hypot(*at.T) < middle, 0, -1), names=("rim",)
    )


def cylinder_in_square(fraction, around=48, across=None, jitter=0.15, seed=0, exact_area=True):
    """Unit square with a regular polygon in its middle that stands for a cylinder of this solid fraction.

    The polygon has the circle's area, or (`exact_area=False`) its corners on the circle. `around` is a multiple of 8.
    """
    circle = np.sqrt(fraction / np.pi)
    turn = 2 * np.pi / around
    radius = circle * np.sqrt(turn / np.sin(turn)) if exact_area else circle
    angle = turn * np.arange(around)
    across = across or max(4, round((0.55 - circle) / (circle * turn) * 0.75))
    direction = np.column_stack([np.cos(angle), np.sin(angle)])
    square = direction * (0.5 / np.abs(direction).max(axis=1, keepdims=True))
    s = (np.linspace(0.0, 1.0, across + 1) ** 1.2)[:, None, None]
    points = (1.0 - s) * radius * direction + s * square
    rng = np.random.default_rng(seed)
    step = np.diff(points, axis=0)
    points[1:-1] += jitter * rng.uniform(-1, 1, (across - 1, around, 1)) * step[:-1]
    tag = len(SIDES)
    return _tagged(
        points.reshape(-1, 2) + 0.5, _rings(points), lambda at: np.where(
            np.abs(at - 0.5).max(axis=1) < 0.5 - 1e-9, tag, _side(at, 1.0, 1.0)), pillar=tag
    )  # fmt: skip


def _rim(across):
    """Points on the sides of the unit square, `across` a side, counter-clockwise from (0, 0)."""
    step = np.arange(across) / across
    level = np.zeros(across)
    sides = (step, level), (level + 1.0, step), (1.0 - step, level + 1.0), (level, 1.0 - step)
    return np.concatenate([np.column_stack(side) for side in sides])


def _delaunay(points, smallest):
    """Counter-clockwise Delaunay triangles with more than the smallest area, and their areas."""
    triangles = Delaunay(points).simplices
    corner = points[triangles]
    one, two = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    area = 0.5 * (one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0])
    kept = np.abs(area) > smallest
    return np.where((area < 0)[:, None], triangles[:, ::-1], triangles)[kept], np.abs(area[kept])


def _rings(points):
    """Triangles between closed rings of points, (rings, around, 2): quadrilaterals cut by their shorter diagonals."""
    rings, around, _ = points.shape
    k, j = np.meshgrid(np.arange(rings - 1), np.arange(around), indexing="ij")
    a, b = (k * around + j).ravel(), (k * around + (j + 1) % around).ravel()
    c, d = a + around, b + around
    at = points.reshape(-1, 2)
    first = (np.linalg.norm(at[a] - at[d], axis=1) < np.linalg.norm(at[b] - at[c], axis=1))[:, None]
    one = np.where(first, np.column_stack([a, c, d]), np.column_stack([a, c, b]))
    two = np.where(first, np.column_stack([a, d, b]), np.column_stack([b, c, d]))
    return np.concatenate([one, two])


def _turned(points, turn):
    c, s = np.cos(turn), np.sin(turn)
    return points @ np.array([[c, s], [-s, c]])


def _side(middle, width, height):
    """Number in SIDES of the side that a point lies on."""
    gap = np.column_stack([middle[:, 1], width - middle[:, 0], height - middle[:, 1], middle[:, 0]])
    return np.argmin(np.abs(gap), axis=1)


def _tagged(points, triangles, side_of, names=SIDES, pillar=None):
    """Find the boundary edges and tag them by their middles; `side_of` gives numbers of names, or of the pillar."""
    directed = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    key = directed[:, 0] * len(points) + directed[:, 1]
    edges = directed[~np.isin(directed[:, 1] * len(points) + directed[:, 0], key)]
    side = side_of(points[edges].mean(axis=1))
    if names != SIDES:
        return Triangulation(points, triangles, edges, side, names)
    order = tuple(sorted(names))
    tags = np.array([0 if s == pillar else -1 - order.index(names[s]) for s in side])
    return Triangulation(points, triangles, edges, tags, order)
