"""The truss: mesh edges as springs a little longer than wanted, which push each other to their places."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.geometry.arrays import Flags, Floats, Ints
    from vasculo.mesh.draft import Draft

PRESSURE = 1.2
"""Rest lengths over wanted lengths: the 'internal pressure' (Persson & Strang 2004)."""

TIME_STEP = 0.4
"""Step of eqs. (2), (3) with stiffness and mass 1; the limit of a node with eight springs is 0.5."""

DAMPING = 1.5
"""D of eq. (2) with stiffness and mass 1: close to critical."""

FOLD = 0.1
"""A step may not leave a triangle with less than this share of the area that its size asks for."""


STEPS = 8
"""Steps of motion between two triangulations."""


def relax_truss(draft: Draft) -> None:
    """Let the springs of a draft push its free nodes for `STEPS` steps, from rest; overwrites the points."""
    springs = unique_edges(draft.triangles, draft.neighbours)
    points, triangles = draft.points, draft.triangles
    least = FOLD * 0.5 * np.sqrt(3.0) * draft.sizes[triangles].min(axis=1) ** 2
    work = np.zeros_like(points), np.empty_like(points), np.empty_like(points)
    relax(
        points, *work, springs, triangles, draft.sizes, draft.fixed, least,
        STEPS, PRESSURE, TIME_STEP, DAMPING,
    )  # fmt: skip


def unique_edges(triangles: NDArray[np.int32], neighbours: NDArray[np.int32]) -> NDArray[np.int32]:
    """Each edge once; (e, 2) int32."""
    rows, corner = np.nonzero((neighbours < 0) | (neighbours > np.arange(len(triangles))[:, None]))
    return np.column_stack((triangles[rows, (corner + 1) % 3], triangles[rows, (corner + 2) % 3]))


def relax_plain(
    points: NDArray[np.float64],
    velocities: NDArray[np.float64],
    edges: NDArray[np.int32],
    triangles: NDArray[np.int32],
    sizes: NDArray[np.float64],
    fixed: NDArray[np.bool_],
    least: NDArray[np.float64],
    steps: int,
    pressure: float,
    time_step: float,
    damping: float,
) -> None:
    """Plain twin of `relax`."""
    a, b = edges.T
    wanted = 0.5 * (sizes[a] + sizes[b])
    for _ in range(steps):
        way = points[b] - points[a]
        length = np.hypot(way[:, 0], way[:, 1])
        rest = pressure * np.sqrt((length**2).sum() / (wanted**2).sum()) * wanted
        push = (np.maximum(rest - length, 0.0) / length)[:, None] * way
        force = np.zeros_like(points)
        np.add.at(force, a, -push)
        np.add.at(force, b, push)
        velocities[:] = (velocities + time_step * force) / (1.0 + damping * time_step)
        velocities[fixed] = 0.0
        old = points.copy()
        points += time_step * velocities
        held = True
        while held:
            held = False
            for corners, limit in zip(triangles, least, strict=True):
                p, q, r = points[corners]
                if (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]) < limit:
                    held |= bool((points[corners] != old[corners]).any())
                    points[corners] = old[corners]
                    velocities[corners] = 0.0


@njit(cache=True, error_model="numpy")
def relax(
    points: Floats,
    velocities: Floats,
    force: Floats,
    old: Floats,
    edges: Ints,
    triangles: Ints,
    sizes: Floats,
    fixed: Flags,
    least: Floats,
    steps: int,
    pressure: float,
    time_step: float,
    damping: float,
) -> None:
    """Move the nodes `steps` steps by eqs. (2), (3) under springs that only push; overwrites points and velocities.

    `fixed` nodes stay. `sizes` are the wanted lengths at the nodes; rest lengths are scaled so that the springs
    push as if the nodes filled the domain `pressure` times too densely. `least` is twice the
    smallest area of each triangle: a node whose step would leave less stays. `force` and `old` (n, 2) are buffers.
    """
    for _ in range(steps):
        squares = 0.0
        wishes = 0.0
        for e in range(len(edges)):
            a = edges[e, 0]
            b = edges[e, 1]
            squares += (points[b, 0] - points[a, 0]) ** 2 + (points[b, 1] - points[a, 1]) ** 2
            wishes += (0.5 * (sizes[a] + sizes[b])) ** 2
        scale = pressure * np.sqrt(squares / wishes)
        for i in range(len(points)):
            force[i, 0] = 0.0
            force[i, 1] = 0.0
        for e in range(len(edges)):
            a = edges[e, 0]
            b = edges[e, 1]
            dx = points[b, 0] - points[a, 0]
            dy = points[b, 1] - points[a, 1]
            length = np.sqrt(dx * dx + dy * dy)
            push = max(scale * 0.5 * (sizes[a] + sizes[b]) - length, 0.0) / length
            force[a, 0] -= push * dx
            force[a, 1] -= push * dy
            force[b, 0] += push * dx
            force[b, 1] += push * dy
        for i in range(len(points)):
            for k in range(2):
                old[i, k] = points[i, k]
                if not fixed[i]:
                    velocities[i, k] = (velocities[i, k] + time_step * force[i, k]) / (1.0 + damping * time_step)
                    points[i, k] += time_step * velocities[i, k]
        held = True
        while held:
            held = False
            for t in range(len(triangles)):
                p = triangles[t, 0]
                q = triangles[t, 1]
                r = triangles[t, 2]
                twice = (points[q, 0] - points[p, 0]) * (points[r, 1] - points[p, 1]) - (
                    points[q, 1] - points[p, 1]
                ) * (points[r, 0] - points[p, 0])
                if twice < least[t]:
                    for c in range(3):
                        i = triangles[t, c]
                        for k in range(2):
                            if points[i, k] != old[i, k]:
                                points[i, k] = old[i, k]
                                held = True
                            velocities[i, k] = 0.0
