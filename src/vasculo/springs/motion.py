"""The damped motion of a spring network (eqs. 2, 3), with springs that break on the way.

Equation (3) as printed moves the nodes with the old velocity. That is stable only for dt < D / (m w^2), and never
without damping. Here the nodes move with the velocity just computed, which is stable for dt w < sqrt(4 + 2 D dt / m).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Ints = NDArray[np.int32]
    Floats = NDArray[np.float64]

CHUNK = 64
"""Nodes whose springs are computed together: their arms stay in the fastest cache."""


@njit(cache=True, error_model="numpy")
def damped_steps(  # type: ignore[no-untyped-def]
    points,
    velocities,
    start,
    neighbour,
    spring,
    stiffness,
    rest,
    limit,
    push,
    keep,
    tether,
    reference,
    forces,
    dt,
    factor,
    slope,
    steps,
    broken_at,
):
    """Take steps of eqs. (2) and (3); returns (steps done, first node that left the finite numbers or -1).

    Overwrites points and velocities, the limit and stiffness of half-springs that break (infinite, 0), and
    broken_at. When a node leaves the finite numbers, points, velocities and broken_at are those before that step.

    Parameters
    ----------
    points, velocities : ndarray of float64, shape (n, 2)
        State (model length, model length a time).
    start : ndarray of int32, shape (n + 1,)
        Half-springs of node i are the rows start[i] to start[i + 1].
    neighbour, spring : ndarray of int32, shape (h,)
        Other node and spring number of each half-spring.
    stiffness, rest, limit : ndarray of float64, shape (h,)
        Stiffness, rest length at factor 1, and the force above which the spring breaks.
    push, keep : ndarray of float64, shape (n,)
        dt / m and 1 / (1 + D dt / m) of each node; keep = 0 pins a node at rest.
    tether : float
        Stiffness of the tether of each node to its reference position.
    reference, forces : ndarray of float64, shape (n, 2)
        Reference positions and constant external forces.
    dt : float
        Time step.
    factor, slope : float
        In step k = 0, 1, ... the rest lengths are multiplied by factor + slope k.
    steps : int
        Number of steps.
    broken_at : ndarray of int32, shape (m,)
        Step in which each spring broke; -1, as at entry, for those that live.
    """
    # Strategy: two copies of the state take turns, so that every node reads positions of one time. The nodes go in
    # chunks: gather the arms of all half-springs, turn them into pulls in one straight loop (the compiler makes
    # vectors of it), sum them node by node. Both halves of a spring see the same tension to the last bit, so both
    # break in the same step; a broken half stays in its row with stiffness 0 and adds exactly nothing.
    nodes = start.size - 1
    longest = 0
    for first in range(0, nodes, CHUNK):
        longest = max(longest, start[min(first + CHUNK, nodes)] - start[first])
    arm_x, arm_y, pull = np.empty(longest), np.empty(longest), np.empty(longest)
    old, new = points, np.empty((nodes, 2))
    old_speed, new_speed = velocities, np.empty((nodes, 2))
    done, bad = steps, -1
    for step in range(steps):
        scale = factor + slope * step
        check = 0.0
        for first in range(0, nodes, CHUNK):
            last = min(first + CHUNK, nodes)
            base = np.uint64(start[first])
            count = np.uint64(0)
            for i in range(first, last):
                x, y = old[i, 0], old[i, 1]
                for h in range(np.uint64(start[i]), np.uint64(start[i + 1])):
                    j = np.uint64(neighbour[h])
                    arm_x[count] = old[j, 0] - x
                    arm_y[count] = old[j, 1] - y
                    count += np.uint64(1)
            over = 0
            for p in range(count):
                length = np.sqrt(arm_x[p] * arm_x[p] + arm_y[p] * arm_y[p])
                tension = stiffness[base + p] * (length - scale * rest[base + p])
                pull[p] = tension / length if length > 0.0 else 0.0
                over += tension > limit[base + p]
            if over > 0:
                for p in range(count):
                    length = np.sqrt(arm_x[p] * arm_x[p] + arm_y[p] * arm_y[p])
                    if stiffness[base + p] * (length - scale * rest[base + p]) > limit[base + p]:
                        broken_at[spring[base + p]] = step
                        stiffness[base + p] = 0.0
                        limit[base + p] = np.inf
                        pull[p] = 0.0
            row = np.uint64(0)
            for i in range(first, last):
                fx = forces[i, 0] - tether * (old[i, 0] - reference[i, 0])
                fy = forces[i, 1] - tether * (old[i, 1] - reference[i, 1])
                for _ in range(start[i], start[i + 1]):
                    fx += pull[row] * arm_x[row]
                    fy += pull[row] * arm_y[row]
                    row += np.uint64(1)
                vx = keep[i] * (old_speed[i, 0] + push[i] * fx)
                vy = keep[i] * (old_speed[i, 1] + push[i] * fy)
                new_speed[i, 0], new_speed[i, 1] = vx, vy
                new[i, 0], new[i, 1] = old[i, 0] + dt * vx, old[i, 1] + dt * vy
                check += (new[i, 0] - new[i, 0]) + (new[i, 1] - new[i, 1])
        if check != 0.0:
            done, bad = step, 0
            while np.isfinite(new[bad, 0]) and np.isfinite(new[bad, 1]):
                bad += 1
            for s in range(broken_at.size):
                if broken_at[s] == step:
                    broken_at[s] = -1
            break
        old, new = new, old
        old_speed, new_speed = new_speed, old_speed
    for i in range(nodes):
        for axis in range(2):
            points[i, axis] = old[i, axis]
            velocities[i, axis] = old_speed[i, axis]
    return done, bad


def damped_steps_plain(
    points: Floats,
    velocities: Floats,
    start: Ints,
    neighbour: Ints,
    spring: Ints,
    stiffness: Floats,
    rest: Floats,
    limit: Floats,
    push: Floats,
    keep: Floats,
    tether: float,
    reference: Floats,
    forces: Floats,
    dt: float,
    factor: float,
    slope: float,
    steps: int,
    broken_at: Ints,
) -> tuple[int, int]:
    """NumPy twin of `damped_steps`."""
    node = np.repeat(np.arange(len(points)), np.diff(start))
    for step in range(steps):
        arms = points[neighbour] - points[node]
        length = np.sqrt(arms[:, 0] ** 2 + arms[:, 1] ** 2)
        tension = stiffness * (length - (factor + slope * step) * rest)
        over = tension > limit
        pull = np.where(over, 0.0, tension) / np.where(length > 0.0, length, 1.0)
        total = forces - tether * (points - reference)
        for axis in range(2):
            total[:, axis] += np.bincount(node, weights=pull * arms[:, axis], minlength=len(points))
        speed = keep[:, None] * (velocities + push[:, None] * total)  # eq. (2)
        moved = points + dt * speed  # eq. (3), with the new velocity
        finite = np.isfinite(moved).all(axis=1)
        if not finite.all():
            return step, int(np.argmin(finite))
        broken_at[spring[over]] = step
        stiffness[over], limit[over] = 0.0, np.inf
        points[:], velocities[:] = moved, speed
    return steps, -1
