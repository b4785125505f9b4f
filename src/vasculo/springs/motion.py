"""The damped motion of a spring network (eqs. 1-3), with springs that break on the way.

Equation (3) as printed moves the nodes with the old velocity. That is stable only for dt < D / (m w^2), and never
without damping. Here the nodes move with the velocity just computed, which is stable for dt w < sqrt(4 + 2 D dt / m).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from vasculo.springs.barrier import arrive
from vasculo.springs.layout import PATCH, SLICE

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Ints = NDArray[np.int32]
    Floats = NDArray[np.float64]

APART = 8
"""Entries between the flags of two threads: each in a cache line of its own."""


@njit(cache=True, error_model="numpy", nogil=True)
def damped_steps(  # type: ignore[no-untyped-def]
    rank,
    threads,
    counter,
    flags,
    x,
    y,
    next_x,
    next_y,
    speed_x,
    speed_y,
    patch_start,
    halo_start,
    halo,
    first,
    second,
    spring,
    slice_start,
    slots,
    image_start,
    image_of,
    image_shift,
    stiffness,
    rest,
    limit,
    push,
    keep,
    tether,
    home_x,
    home_y,
    load_x,
    load_y,
    dt,
    factor,
    slope,
    steps,
    broken,
):
    """Take steps of eqs. (2) and (3) as one thread of a team; returns the steps done, fewer when a node is not finite.

    Overwrites the state, the second ends of springs that break (the first) and `broken`. After an even number
    of steps the positions are in x and y, after an odd one in next_x and next_y. After a step that left the finite
    numbers the state is of no use.

    Parameters
    ----------
    rank, threads : int
        Number of this thread, and how many there are. All are called with the same arrays.
    counter : ndarray of int64, shape (1,); flags : ndarray of int64, shape (2, 8 threads)
        Zeros at entry: the meetings of the team, and who saw a number that is not finite in the last two steps.
    x, y, next_x, next_y : ndarray of float64, shape (places + images,)
        Positions by place (model length).
    speed_x, speed_y : ndarray of float64, shape (places,)
        Velocities.
    patch_start, halo_start, halo, first, second, spring, slice_start, slots, image_start, image_of, image_shift
        See `vasculo.springs.layout.Layout`.
    stiffness : ndarray of float64, shape (rows,), or (1,) when all springs are alike
    rest, limit : ndarray of float64, shape (rows,)
        Rest length at factor 1, and the force above which the spring breaks.
    push, keep : ndarray of float64, shape (places,)
        dt / m and 1 / (1 + D dt / m) of each node; keep = 0 pins a node at rest.
    tether : float
        Stiffness of the tether of each node to its home.
    home_x, home_y : ndarray of float64, shape (places,) or, without tether, (0,)
    load_x, load_y : ndarray of float64, shape (places,) or, without external forces, (0,)
    dt : float
        Time step.
    factor, slope : float
        In step k = 0, 1, ... the rest lengths are multiplied by factor + slope k.
    steps : int
        Number of steps.
    broken : ndarray of bool, shape (m,)
        Set for springs that break.
    """
    # Strategy: two copies of the positions take turns, so that every node reads positions of one time, and the team
    # meets once a step. A patch first turns all its springs into pulls, in straight loops that the compiler makes
    # vectors of, and keeps each pull with both signs, x and y side by side; then its nodes add theirs, each row of 64
    # equally many. Patches that share a spring compute its tension with the same bits, so both break it in the same
    # step; a broken spring stays in its row with both ends at one place, where it pulls exactly nothing. Sums run in
    # the order of the spring numbers, on any number of threads.
    patches, slices, places = patch_start.size - 1, slice_start.size - 1, speed_x.size
    begin, end = patches * rank // threads, patches * (rank + 1) // threads
    most, widest = 0, 0
    for p in range(begin, end):
        most = max(most, patch_start[p + 1] - patch_start[p])
        widest = max(widest, halo_start[p + 1] - halo_start[p])
    near_x, near_y = np.empty(PATCH + widest), np.empty(PATCH + widest)
    arm_x, arm_y, pulls = np.empty(most), np.empty(most), np.empty((2 * most + 1, 2))
    force_x, force_y = np.empty(SLICE), np.empty(SLICE)
    uniform, common = stiffness.size == 1, stiffness[0]
    tethered, loaded = home_x.size > 0, load_x.size > 0
    for step in range(steps):
        scale = factor + slope * step
        lost = 0
        for p in range(begin, end):
            base = np.uint64(patch_start[p])
            count = np.uint64(patch_start[p + 1]) - base
            own = np.uint64(p * PATCH)
            for node in range(np.uint64(min(PATCH, places - p * PATCH))):
                near_x[node], near_y[node] = x[own + node], y[own + node]
            seen, met = np.uint64(PATCH), np.uint64(halo_start[p])
            for other in range(np.uint64(halo_start[p + 1]) - met):
                place = np.uint64(halo[met + other])
                near_x[seen + other], near_y[seen + other] = x[place], y[place]
            for s in range(count):
                i, j = np.uint64(first[base + s]), np.uint64(second[base + s])
                arm_x[s] = near_x[j] - near_x[i]
                arm_y[s] = near_y[j] - near_y[i]
            over = 0
            for s in range(count):
                length = np.sqrt(arm_x[s] * arm_x[s] + arm_y[s] * arm_y[s])
                strength = common if uniform else stiffness[base + s]
                tension = strength * (length - scale * rest[base + s])
                pull = tension / length if length > 0.0 else 0.0
                over += tension > limit[base + s]
                along_x, along_y = pull * arm_x[s], pull * arm_y[s]
                pulls[s, 0], pulls[s, 1] = along_x, along_y
                pulls[count + s, 0], pulls[count + s, 1] = -along_x, -along_y
            pulls[2 * count, 0] = pulls[2 * count, 1] = 0.0
            if over > 0:
                for s in range(count):
                    length = np.sqrt(arm_x[s] * arm_x[s] + arm_y[s] * arm_y[s])
                    strength = common if uniform else stiffness[base + s]
                    if strength * (length - scale * rest[base + s]) > limit[base + s]:
                        broken[spring[base + s]] = True
                        second[base + s] = first[base + s]
                        pulls[s, 0] = pulls[s, 1] = pulls[count + s, 0] = pulls[count + s, 1] = 0.0
            for q in range(p * (PATCH // SLICE), min((p + 1) * (PATCH // SLICE), slices)):
                place, column = np.uint64(q * SLICE), np.uint64(slice_start[q])
                width = (np.uint64(slice_start[q + 1]) - column) // np.uint64(SLICE)
                for lane in range(np.uint64(SLICE)):
                    at = place + lane
                    sum_x = load_x[at] if loaded else 0.0
                    sum_y = load_y[at] if loaded else 0.0
                    if tethered:
                        sum_x -= tether * (x[at] - home_x[at])
                        sum_y -= tether * (y[at] - home_y[at])
                    for row in range(width):
                        slot = np.uint64(slots[column + row * np.uint64(SLICE) + lane])
                        sum_x += pulls[slot, 0]
                        sum_y += pulls[slot, 1]
                    force_x[lane], force_y[lane] = sum_x, sum_y
                for lane in range(np.uint64(SLICE)):
                    at = place + lane
                    speed_x[at] = keep[at] * (speed_x[at] + push[at] * force_x[lane])
                    speed_y[at] = keep[at] * (speed_y[at] + push[at] * force_y[lane])
                    next_x[at] = x[at] + dt * speed_x[at]
                    next_y[at] = y[at] + dt * speed_y[at]
                    lost += (next_x[at] - next_x[at]) + (next_y[at] - next_y[at]) != 0.0
            for image in range(image_start[p], image_start[p + 1]):
                next_x[places + image] = next_x[image_of[image]] + image_shift[image, 0]
                next_y[places + image] = next_y[image_of[image]] + image_shift[image, 1]
        flags[step % 2, APART * rank] = lost
        if threads > 1:
            arrive(counter, threads * (step + 1))
        for mate in range(threads):
            if flags[step % 2, APART * mate] > 0:
                return step
        x, next_x = next_x, x
        y, next_y = next_y, y
    return steps


def damped_steps_plain(
    points: Floats,
    velocities: Floats,
    springs: Ints,
    shifts: Floats,
    stiffness: Floats,
    rest: Floats,
    limit: Floats,
    push: Floats,
    keep: Floats,
    tether: float,
    home: Floats,
    load: Floats,
    dt: float,
    factor: float,
    slope: float,
    steps: int,
    broken: NDArray[np.bool_],
) -> int:
    """NumPy twin of `damped_steps`, spring by spring and in the user's numbering; stops before a step that is lost.

    Arrays are those of the network: points (n, 2), springs (m, 2), shifts (m, 2), and so on.
    """
    for step in range(steps):
        arms = points[springs[:, 1]] - shifts - points[springs[:, 0]]
        length = np.sqrt(arms[:, 0] ** 2 + arms[:, 1] ** 2)
        tension = stiffness * (length - (factor + slope * step) * rest)
        over = tension > limit
        pull = np.where(over, 0.0, tension) / np.where(length > 0.0, length, 1.0)
        total = load - tether * (points - home)
        np.add.at(total, springs[:, 0], pull[:, None] * arms)
        np.add.at(total, springs[:, 1], -pull[:, None] * arms)
        speed = keep[:, None] * (velocities + push[:, None] * total)  # eq. (2)
        moved = points + dt * speed  # eq. (3), with the new velocity
        if not np.isfinite(moved).all():
            return step
        broken |= over
        stiffness[over], limit[over] = 0.0, np.inf
        points[:], velocities[:] = moved, speed
    return steps
