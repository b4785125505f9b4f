"""Damped relaxation of membranes, filaments and matrix to equilibrium (eqs. 2 and 3).

All lengths are in R0 and all stiffnesses in that of a matrix spring.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numba import njit

if TYPE_CHECKING:
    from numpy.typing import NDArray

TIME_STEP = 0.7  # below sqrt(2): the mass of a node is the sum of the stiffnesses that act on it
DAMPING = 0.05  # D / M, near critical for a pillar that moves as a whole in the matrix
CHECK_EVERY = 10  # sweeps between two looks at the velocities


@dataclass(frozen=True, slots=True)
class Network:
    """The springs of one relaxation; membrane nodes come first.

    Attributes
    ----------
    starts : (p + 1,) int32
        Membrane nodes of each pillar.
    interior : (p + 1,) or (1,) int32
        `starts`, or only its first entry when the pillars have no filaments.
    filament_rest, filament_stiffness : (f,) float64
        As made by `vasculo.pillars.cell.filaments`.
    filament_sums : (n,) float64
        Stiffness of all filaments at each membrane node.
    membrane_rest : (n,) float64
        Length free of stress of the side from each membrane node to the next.
    springs : (s, 2) int32
        Matrix springs.
    spring_rest : (s,) float64
    rest_areas : (p,) float64
    area_stiffness, bending : float
        Pressure per relative loss of area; force per second difference of the membrane nodes.
    loads : (n, 2) float64
        Constant forces on the membrane nodes.
    pinned : (m,) bool
        Nodes that do not move.
    """

    starts: NDArray[np.int32]
    interior: NDArray[np.int32]
    filament_rest: NDArray[np.float64]
    filament_stiffness: NDArray[np.float64]
    filament_sums: NDArray[np.float64]
    membrane_rest: NDArray[np.float64]
    springs: NDArray[np.int32]
    spring_rest: NDArray[np.float64]
    rest_areas: NDArray[np.float64]
    area_stiffness: float
    bending: float
    loads: NDArray[np.float64]
    pinned: NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Relaxed:
    """Result of a relaxation.

    Attributes
    ----------
    points : (m, 2) float64
        Nodes in equilibrium, R0; not finite where the relaxation blew up.
    sweeps : int
    residual : float
        Largest force on a free node over the largest one at the start.
    converged : bool
    """

    points: NDArray[np.float64]
    sweeps: int
    residual: float
    converged: bool


# No fastmath: freshly compiled and cached code then sum in different orders, and a run does not repeat to the bit.
@njit(cache=True, error_model="numpy")
def _add_filaments(x, y, interior, rest, stiffness, fx, fy):  # type: ignore[no-untyped-def]
    q = 0
    for k in range(interior.size - 1):
        end = interior[k + 1]
        for i in range(interior[k], end):
            n = end - i - 1
            xs, ys, fxs, fys = x[i + 1 : end], y[i + 1 : end], fx[i + 1 : end], fy[i + 1 : end]
            ls, ks = rest[q : q + n], stiffness[q : q + n]
            xi, yi, sx, sy = x[i], y[i], 0.0, 0.0
            for j in range(n):
                dx = xs[j] - xi
                dy = ys[j] - yi
                g = ks[j] * (1.0 - ls[j] / math.sqrt(dx * dx + dy * dy))
                sx += g * dx
                sy += g * dy
                fxs[j] -= g * dx
                fys[j] -= g * dy
            fx[i] += sx
            fy[i] += sy
            q += n


@njit(cache=True, error_model="numpy")
def _add_membranes(x, y, starts, rest, rest_areas, area_stiffness, bending, fx, fy):  # type: ignore[no-untyped-def]
    for k in range(starts.size - 1):
        first, last = starts[k], starts[k + 1] - 1
        area = 0.0
        before = last
        for i in range(first, last + 1):
            area += 0.5 * (x[before] * y[i] - x[i] * y[before])
            before = i
        push = 0.5 * area_stiffness * (rest_areas[k] - area) / rest_areas[k]
        before = last
        for i in range(first, last + 1):
            after = i + 1 if i < last else first
            fx[i] += push * (y[after] - y[before])
            fy[i] -= push * (x[after] - x[before])
            bx = bending * (x[before] - 2.0 * x[i] + x[after])
            by = bending * (y[before] - 2.0 * y[i] + y[after])
            fx[i] += 2.0 * bx
            fy[i] += 2.0 * by
            dx = x[after] - x[i]
            dy = y[after] - y[i]
            g = 1.0 - rest[i] / math.sqrt(dx * dx + dy * dy)
            fx[i] += g * dx
            fy[i] += g * dy
            fx[after] -= g * dx + bx
            fy[after] -= g * dy + by
            fx[before] -= bx
            fy[before] -= by
            before = i


@njit(cache=True, error_model="numpy")
def _relax(  # type: ignore[no-untyped-def]
    points,
    mass,
    starts,
    interior,
    filament_rest,
    filament_stiffness,
    membrane_rest,
    springs,
    spring_rest,
    rest_areas,
    area_stiffness,
    bending,
    loads,
    pinned,
    tolerance,
    max_sweeps,
):
    m, n = points.shape[0], loads.shape[0]
    x, y, vx, vy, fx, fy = np.empty(m), np.empty(m), np.empty(m), np.empty(m), np.empty(m), np.empty(m)
    for i in range(m):
        x[i], y[i], vx[i], vy[i] = points[i, 0], points[i, 1], 0.0, 0.0
    scale = 1.0 / (1.0 + DAMPING * TIME_STEP)
    first_force, force, converged, sweep = 0.0, 0.0, False, 0
    while sweep < max_sweeps and not converged:
        sweep += 1
        for i in range(m):
            fx[i] = loads[i, 0] if i < n else 0.0
            fy[i] = loads[i, 1] if i < n else 0.0
        _add_filaments(x, y, interior, filament_rest, filament_stiffness, fx, fy)
        _add_membranes(x, y, starts, membrane_rest, rest_areas, area_stiffness, bending, fx, fy)
        for s in range(springs.shape[0]):
            i, j = springs[s, 0], springs[s, 1]
            dx = x[j] - x[i]
            dy = y[j] - y[i]
            g = 1.0 - spring_rest[s] / math.sqrt(dx * dx + dy * dy)
            fx[i] += g * dx
            fy[i] += g * dy
            fx[j] -= g * dx
            fy[j] -= g * dy
        check = sweep == 1 or sweep % CHECK_EVERY == 0 or sweep == max_sweeps
        force, speed, move, total = 0.0, 0.0, 0.0, 0.0
        for i in range(m):
            if pinned[i]:
                continue
            vx[i] = (vx[i] + TIME_STEP / mass[i] * fx[i]) * scale
            vy[i] = (vy[i] + TIME_STEP / mass[i] * fy[i]) * scale
            x[i] += TIME_STEP * vx[i]
            y[i] += TIME_STEP * vy[i]
            if check:
                force = max(force, fx[i] * fx[i] + fy[i] * fy[i])
                speed = max(speed, vx[i] * vx[i] + vy[i] * vy[i])
                move = max(move, (x[i] - points[i, 0]) ** 2 + (y[i] - points[i, 1]) ** 2)
                total += x[i] + y[i]
        if not math.isfinite(total):
            break
        if sweep == 1:
            first_force = force
            converged = move < 1e-24
        elif check:
            converged = speed <= tolerance * tolerance * move
    residual = math.sqrt(force / first_force) if first_force > 0.0 else 0.0
    result = np.empty((m, 2))
    for i in range(m):
        result[i, 0], result[i, 1] = x[i], y[i]
    return result, sweep, residual, converged


def node_masses(network: Network, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Sum of the stiffnesses that act on each node, which makes the relaxation stable at a time step below sqrt(2).

    Parameters
    ----------
    network : Network
    points : (m, 2) float64
        All nodes, R0.

    Returns
    -------
    (m,) float64
        Matrix spring stiffnesses.
    """
    starts, n = network.starts, len(network.loads)
    mass = np.bincount(network.springs.ravel(), minlength=len(points)).astype(np.float64)
    mass[:n] += 2.0 + 8.0 * network.bending
    squares = np.add.reduceat(network.membrane_rest**2, starts[:-1])
    mass[:n] += np.repeat(network.area_stiffness * squares / network.rest_areas, np.diff(starts))
    mass[:n] += network.filament_sums
    mass[mass == 0.0] = 1.0
    return mass


def relax(points: NDArray[np.float64], network: Network, tolerance: float, max_sweeps: int = 20_000) -> Relaxed:
    """Let all nodes move by eqs (2) and (3) until they rest.

    The mass of a node is the sum of the stiffnesses at it (ours): the path to equilibrium is not physical, the
    equilibrium is. It has come when no velocity exceeds `tolerance` times the largest displacement.

    Parameters
    ----------
    points : (m, 2) float64
        All nodes at the start, R0; not changed.
    network : Network
    tolerance : float
        Dimensionless.
    max_sweeps : int

    Returns
    -------
    Relaxed
        ``converged`` is False after `max_sweeps`, or when a number is not finite.
    """
    result, sweeps, residual, converged = _relax(
        np.ascontiguousarray(points),
        node_masses(network, points),
        network.starts,
        network.interior,
        network.filament_rest,
        network.filament_stiffness,
        network.membrane_rest,
        network.springs,
        network.spring_rest,
        network.rest_areas,
        float(network.area_stiffness),
        float(network.bending),
        np.ascontiguousarray(network.loads),
        network.pinned,
        float(tolerance),
        max_sweeps,
    )
    return Relaxed(result, int(sweeps), float(residual), bool(converged))
