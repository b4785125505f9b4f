"""Sweeps of eqs (2) and (3) over cells and matrix, by one thread of a team."""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from vasculo.pillars.cell_forces import cell_forces, room_for
from vasculo.pillars.coarse import coarse_speeds
from vasculo.springs.barrier import arrive

# Stable below 2 / sqrt(5): a node, and a pillar as a whole, weigh what the springs at them are stiff, which allows a
# square frequency of 2 each; the coarse grid is exact and adds 1.
TIME_STEP = 0.85
FIRST_DAMPING, LEAST_DAMPING, MOST_DAMPING = 0.2, 0.02, 1.0  # D / M
PIECE = 512  # matrix nodes whose work is added up together


@njit(cache=True, error_model="numpy", nogil=True)
def damping_of(sums):  # type: ignore[no-untyped-def]
    """Damping that is critical for the present motion, from sums over pillars and pieces; NaN if not finite."""
    curvature, weight = 0.0, 0.0
    for k in range(sums.shape[0]):
        curvature += sums[k, 0]
        weight += sums[k, 1]
    if not math.isfinite(curvature + weight):
        return math.nan
    if weight <= 0.0:
        return FIRST_DAMPING
    square = max(curvature / (TIME_STEP * weight), 0.0)
    return min(max(2.0 * math.sqrt(square), LEAST_DAMPING), MOST_DAMPING)


@njit(cache=True, error_model="numpy", nogil=True)
def _load(i, pulls, slot_starts, slots, force, old):  # type: ignore[no-untyped-def]
    """Add the matrix springs at node i to its force; returns the change since the last sweep."""
    fx, fy = force[0, i], force[1, i]
    for q in range(slot_starts[i], slot_starts[i + 1]):
        fx += pulls[slots[q], 0]
        fy += pulls[slots[q], 1]
    force[0, i], force[1, i] = fx, fy
    lost_x, lost_y = old[0, i] - fx, old[1, i] - fy
    old[0, i], old[1, i] = fx, fy
    return lost_x, lost_y


@njit(cache=True, error_model="numpy", nogil=True)
def _wave(body, hats, weights, waves):  # type: ignore[no-untyped-def]
    """Speed that the coarse grid gives a body."""
    vx, vy = 0.0, 0.0
    for k in range(4):
        g = hats[body, k]
        if g >= 0:
            vx += weights[body, k] * waves[2 * g]
            vy += weights[body, k] * waves[2 * g + 1]
    return vx, vy


@njit(cache=True, error_model="numpy", nogil=True)
def _look(i, x, y, origin, speed, force, push, look):  # type: ignore[no-untyped-def]
    """Note the largest squares of move, velocity and force."""
    if push[i] > 0.0:
        look[0] = max(look[0], (x[i] - origin[i, 0]) ** 2 + (y[i] - origin[i, 1]) ** 2)
        look[1] = max(look[1], speed[0, i] ** 2 + speed[1, i] ** 2)
        look[2] = max(look[2], force[0, i] ** 2 + force[1, i] ** 2)


@njit(cache=True, error_model="numpy", nogil=True)
def sweep(  # type: ignore[no-untyped-def]
    rank,
    threads,
    counter,
    count,
    origin,
    x,
    y,
    momentum,
    speed,
    force,
    old,
    push,
    starts,
    rigid,
    work,
    run_starts,
    runs,
    rest_starts,
    rest,
    share,
    membrane_rest,
    membrane_ratio,
    rest_areas,
    area_stiffness,
    bending,
    loads,
    springs,
    spring_rest,
    pulls,
    slot_starts,
    slots,
    sums,
    looks,
    whole,
    body_starts,
    bodies,
    values,
    hats,
    weights,
    factor,
):
    """Take sweeps as one thread of a team; returns how many, fewer when a number is not finite.

    Twin: `vasculo.pillars.relax_plain.relax_plain`.

    Parameters
    ----------
    rank, threads, counter
        See `vasculo.springs.motion.damped_steps`.
    count : int
        Sweeps to take.
    origin : (m, 2) float64
        Nodes at the start of the relaxation, membrane nodes first.
    x, y : (m,) float64
        Nodes now.
    momentum, speed, force, old : (2, m) float64
        M v, v, F and the F of the sweep before.
    push : (m,) float64
        One over the mass of each node; 0 for pinned ones.
    starts, rigid : (p + 1,) int32, (p, 4) float64
        Pillars; centre, one over the mass and one over the moment of inertia of each as a whole.
    work : (p + 1,) int64
        Work up to each pillar, to share the pillars out.
    run_starts, runs, rest_starts, rest, share
        See `vasculo.pillars.cell.Filaments`; `share` is empty without filaments.
    membrane_rest, membrane_ratio, rest_areas, area_stiffness, bending, loads, springs, spring_rest
        See `vasculo.pillars.relax.Network`.
    pulls : (2 s, 2) float64
        Overwritten: pull of each spring on its first node, then on its second.
    slot_starts, slots : (m + 1,), (2 s,) int32
        Pulls on each node.
    sums : (p + pieces, 2) float64
        v . K v and v . M v of the last sweep, in parts.
    looks : (p + pieces, 3) float64
        After the last sweep: largest squares of move, velocity and force in each part.
    whole : (3, p) float64
        Overwritten: momentum and angular momentum of each pillar.
    body_starts, bodies, values, hats, weights, factor
        See `vasculo.pillars.coarse.Coarse`.
    """
    # Strategy: first all forces in cells and all pulls of springs; after the team has met all momenta; after it has met
    # again all speeds and moves. Every number is made by one thread in one order, or by each in the same, so that their
    # number changes no bit.
    pillars, m, n, many = starts.size - 1, x.size, loads.shape[0], springs.shape[0]
    pieces = sums.shape[0] - pillars
    begin = np.searchsorted(work, work[-1] * rank // threads)
    end = np.searchsorted(work, work[-1] * (rank + 1) // threads) if rank + 1 < threads else pillars
    room = np.empty((7, room_for(starts)))
    waves = np.zeros(2 * (body_starts.size - 1))
    looks[begin:end] = 0.0
    for done in range(count):
        damping = damping_of(sums)
        if not math.isfinite(damping):
            return done
        for k in range(begin, end):
            a, b = starts[k], starts[k + 1]
            cell_forces(
                x[a:b],
                y[a:b],
                share[a:b] if share.size > 0 else share,
                runs[run_starts[k] : run_starts[k + 1]],
                rest[rest_starts[k] : rest_starts[k + 1]],
                membrane_rest[a:b],
                membrane_ratio,
                rest_areas[k],
                area_stiffness,
                bending,
                room,
                force[0, a:b],
                force[1, a:b],
            )
        for s in range(many * rank // threads, many * (rank + 1) // threads):
            i, j = springs[s, 0], springs[s, 1]
            dx, dy = x[j] - x[i], y[j] - y[i]
            g = 1.0 - spring_rest[s] / math.sqrt(dx * dx + dy * dy)
            pulls[s, 0], pulls[s, 1] = g * dx, g * dy
            pulls[many + s, 0], pulls[many + s, 1] = -g * dx, -g * dy
        if threads > 1:
            arrive(counter, threads * (3 * done + 1))
        keep, last = 1.0 / (1.0 + damping * TIME_STEP), done == count - 1
        for k in range(begin, end):
            curvature, weight, qx, qy, turn = 0.0, 0.0, 0.0, 0.0, 0.0
            cx, cy = rigid[k, 0], rigid[k, 1]
            for i in range(starts[k], starts[k + 1]):
                force[0, i] += loads[i, 0]
                force[1, i] += loads[i, 1]
                lost_x, lost_y = _load(i, pulls, slot_starts, slots, force, old)
                curvature += speed[0, i] * lost_x + speed[1, i] * lost_y
                weight += speed[0, i] * momentum[0, i] + speed[1, i] * momentum[1, i]
                mx = keep * (momentum[0, i] + TIME_STEP * force[0, i])  # eq. (2), times the mass
                my = keep * (momentum[1, i] + TIME_STEP * force[1, i])
                momentum[0, i], momentum[1, i] = mx, my
                qx += mx
                qy += my
                turn += (origin[i, 0] - cx) * my - (origin[i, 1] - cy) * mx
            whole[0, k], whole[1, k], whole[2, k] = qx, qy, turn
            sums[k, 0], sums[k, 1] = curvature, weight
        for piece in range(pieces * rank // threads, pieces * (rank + 1) // threads):
            curvature, weight = 0.0, 0.0
            for i in range(n + piece * PIECE, min(n + (piece + 1) * PIECE, m)):
                force[0, i], force[1, i] = 0.0, 0.0
                lost_x, lost_y = _load(i, pulls, slot_starts, slots, force, old)
                curvature += speed[0, i] * lost_x + speed[1, i] * lost_y
                weight += speed[0, i] * momentum[0, i] + speed[1, i] * momentum[1, i]
                momentum[0, i] = keep * (momentum[0, i] + TIME_STEP * force[0, i])
                momentum[1, i] = keep * (momentum[1, i] + TIME_STEP * force[1, i])
            sums[pillars + piece, 0], sums[pillars + piece, 1] = curvature, weight
        if threads > 1:
            arrive(counter, threads * (3 * done + 2))
        if waves.size > 0:
            coarse_speeds(momentum, whole[:2], n, body_starts, bodies, values, factor, waves)
        for k in range(begin, end):
            cx, cy = rigid[k, 0], rigid[k, 1]
            qx, qy, turn = whole[0, k] * rigid[k, 2], whole[1, k] * rigid[k, 2], whole[2, k] * rigid[k, 3]
            wx, wy = _wave(k, hats, weights, waves)
            qx += wx
            qy += wy
            for i in range(starts[k], starts[k + 1]):
                speed[0, i] = push[i] * momentum[0, i] + qx - turn * (origin[i, 1] - cy)
                speed[1, i] = push[i] * momentum[1, i] + qy + turn * (origin[i, 0] - cx)
                x[i] += TIME_STEP * speed[0, i]  # eq. (3), with the new velocity
                y[i] += TIME_STEP * speed[1, i]
                if last:
                    _look(i, x, y, origin, speed, force, push, looks[k])
        for piece in range(pieces * rank // threads, pieces * (rank + 1) // threads):
            part = pillars + piece
            if last:
                looks[part] = 0.0
            for i in range(n + piece * PIECE, min(n + (piece + 1) * PIECE, m)):
                wx, wy = _wave(pillars + i - n, hats, weights, waves)
                speed[0, i] = push[i] * momentum[0, i] + wx
                speed[1, i] = push[i] * momentum[1, i] + wy
                x[i] += TIME_STEP * speed[0, i]
                y[i] += TIME_STEP * speed[1, i]
                if last:
                    _look(i, x, y, origin, speed, force, push, looks[part])
        if threads > 1:
            arrive(counter, threads * (3 * done + 3))
    return count


@njit(cache=True, error_model="numpy")
def pulls_of(springs, nodes):  # type: ignore[no-untyped-def]
    """List the pulls on each node: slot_starts (nodes + 1,), slots (2 s,) int32; s + i is the second end of i."""
    many = springs.shape[0]
    starts = np.zeros(nodes + 1, dtype=np.int32)
    for s in range(many):
        starts[springs[s, 0] + 1] += 1
        starts[springs[s, 1] + 1] += 1
    for i in range(nodes):
        starts[i + 1] += starts[i]
    slots, filled = np.empty(2 * many, dtype=np.int32), starts.copy()
    for s in range(many):
        for end in range(2):
            i = springs[s, end]
            slots[filled[i]] = s + end * many
            filled[i] += 1
    return starts, slots
