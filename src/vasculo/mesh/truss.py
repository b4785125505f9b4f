"""The truss: mesh edges as springs a little longer than wanted, which push each other to their places."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

if TYPE_CHECKING:
    from collections.abc import Callable

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

    def push(force: NDArray[np.float64]) -> None:
        spring_forces(draft.points, springs, draft.sizes, PRESSURE, force, push_only=True)

    move_masses(draft, push)


def move_masses(draft: Draft, push: Callable[[NDArray[np.float64]], None]) -> None:
    """Move the free nodes of a draft by eqs. (2), (3) for `STEPS` steps, from rest; overwrites the points.

    Parameters
    ----------
    draft : Draft
    push : callable
        Adds the forces on the nodes as they are to the array (n, 2) that it is given.
    """
    least = FOLD * 0.5 * np.sqrt(3.0) * draft.sizes[draft.triangles].min(axis=1) ** 2
    velocities, force, old = np.zeros_like(draft.points), np.empty_like(draft.points), np.empty_like(draft.points)
    for _ in range(STEPS):
        force[:] = 0.0
        push(force)
        step_masses(draft.points, velocities, force, old, draft.triangles, draft.fixed, least, TIME_STEP, DAMPING)


def unique_edges(triangles: NDArray[np.int32], neighbours: NDArray[np.int32]) -> NDArray[np.int32]:
    """Each edge once; (e, 2) int32."""
    rows, corner = np.nonzero((neighbours < 0) | (neighbours > np.arange(len(triangles))[:, None]))
    return np.column_stack((triangles[rows, (corner + 1) % 3], triangles[rows, (corner + 2) % 3]))


def spring_forces_plain(
    points: NDArray[np.float64],
    edges: NDArray[np.int32],
    sizes: NDArray[np.float64],
    pressure: float,
    force: NDArray[np.float64],
    push_only: bool,
) -> None:
    """Plain twin of `spring_forces`."""
    a, b = edges.T
    wanted = 0.5 * (sizes[a] + sizes[b])
    way = points[b] - points[a]
    length = np.hypot(way[:, 0], way[:, 1])
    push = pressure * np.sqrt((length**2).sum() / (wanted**2).sum()) * wanted - length
    if push_only:
        push = np.maximum(push, 0.0)
    push = (push / length)[:, None] * way
    np.add.at(force, a, -push)
    np.add.at(force, b, push)


def step_masses_plain(
    points: NDArray[np.float64],
    velocities: NDArray[np.float64],
    force: NDArray[np.float64],
    triangles: NDArray[np.int32],
    fixed: NDArray[np.bool_],
    least: NDArray[np.float64],
    time_step: float,
    damping: float,
) -> None:
    """Plain twin of `step_masses`."""
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
def spring_forces(points: Floats, edges: Ints, sizes: Floats, pressure: float, force: Floats, push_only: bool) -> None:
    """Add the forces of springs of stiffness 1 along the edges to `force`.

    `sizes` are the wanted lengths at the nodes; rest lengths are scaled so that the springs act as if the nodes filled
    the domain `pressure` times too densely. With `push_only`, springs that are too long do not pull.
    """
    squares = 0.0
    wishes = 0.0
    for e in range(len(edges)):
        a = edges[e, 0]
        b = edges[e, 1]
        squares += (points[b, 0] - points[a, 0]) ** 2 + (points[b, 1] - points[a, 1]) ** 2
        wishes += (0.5 * (sizes[a] + sizes[b])) ** 2
    scale = pressure * np.sqrt(squares / wishes)
    for e in range(len(edges)):
        a = edges[e, 0]
        b = edges[e, 1]
        dx = points[b, 0] - points[a, 0]
        dy = points[b, 1] - points[a, 1]
        length = np.sqrt(dx * dx + dy * dy)
        push = scale * 0.5 * (sizes[a] + sizes[b]) - length
        if push_only and push < 0.0:
            continue
        push /= length
        force[a, 0] -= push * dx
        force[a, 1] -= push * dy
        force[b, 0] += push * dx
        force[b, 1] += push * dy


@njit(cache=True, error_model="numpy")
def step_masses(
    points: Floats,
    velocities: Floats,
    force: Floats,
    old: Floats,
    triangles: Ints,
    fixed: Flags,
    least: Floats,
    time_step: float,
    damping: float,
) -> None:
    """Move the nodes one step by eqs. (2), (3), mass 1; overwrites points and velocities.

    `fixed` nodes stay. `least` is twice the smallest area of each triangle: a node whose step would leave less stays.
    `old` (n, 2) is a buffer.
    """
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
            twice = (points[q, 0] - points[p, 0]) * (points[r, 1] - points[p, 1]) - (points[q, 1] - points[p, 1]) * (
                points[r, 0] - points[p, 0]
            )
            if twice < least[t]:
                for c in range(3):
                    i = triangles[t, c]
                    for k in range(2):
                        if points[i, k] != old[i, k]:
                            points[i, k] = old[i, k]
                            held = True
                        velocities[i, k] = 0.0
