"""Damped relaxation of membranes, filaments and matrix to equilibrium (eqs. 2 and 3).

All lengths are in R0 and all stiffnesses in that of a matrix spring.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vasculo.pillars.coarse import coarse_grid
from vasculo.pillars.sweeps import PIECE, damping_of, pulls_of, sweep
from vasculo.springs.threads import run_team

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.pillars.cell import Filaments

CHECK_EVERY = 10  # sweeps between two looks at the velocities
WORTH = 100_000  # filaments and springs that a thread is worth


@dataclass(frozen=True, slots=True)
class Network:
    """The springs of one relaxation; membrane nodes come first.

    Attributes
    ----------
    starts : (p + 1,) int32
        Membrane nodes of each pillar.
    filaments : Filaments or None
        None when the pillars have no interior.
    membrane_rest : (n,) float64
        Length free of stress of the side from each membrane node to the next.
    membrane_ratio : float
        Stiffness of these sides.
    springs : (s, 2) int32
        Matrix springs.
    spring_rest : (s,) float64
    rest_areas : (p,) float64
    area_stiffness, bending : float
        Pressure per relative loss of area; force per second difference of the membrane nodes.
    loads : (n, 2) float64
        Constant forces on the membrane nodes.
    pinned : (m,) bool
        Nodes that do not move; no membrane node is among them.
    """

    starts: NDArray[np.int32]
    filaments: Filaments | None
    membrane_rest: NDArray[np.float64]
    membrane_ratio: float
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


def node_masses(network: Network, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Sum of the stiffnesses that act on each node.

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
    mass[:n] += 2.0 * network.membrane_ratio + 8.0 * network.bending
    squares = np.add.reduceat(network.membrane_rest**2, starts[:-1])
    mass[:n] += np.repeat(network.area_stiffness * squares / network.rest_areas, np.diff(starts))
    if network.filaments is not None:
        mass[:n] += network.filaments.sums
    mass[mass == 0.0] = 1.0
    return mass


def rigid_masses(network: Network, points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Centre, inverse mass and inverse moment of inertia of each pillar as a whole.

    Nothing in a cell resists when it moves as a whole, so its mass is then only the sum of the stiffnesses of the
    matrix springs at it.

    Parameters
    ----------
    network : Network
    points : (m, 2) float64
        All nodes, R0.

    Returns
    -------
    (p, 4) float64
        Two coordinates, one over the mass, one over the moment of inertia; both 0 where no spring holds the pillar.
    """
    n, first = len(network.loads), network.starts[:-1]
    weight = np.bincount(network.springs.ravel(), minlength=n)[:n].astype(np.float64)
    mass = np.add.reduceat(weight, first)
    held = mass > 0.0
    safe = np.where(held, mass, 1.0)
    centre = np.add.reduceat(weight[:, None] * points[:n], first) / safe[:, None]
    arm = points[:n] - np.repeat(centre, np.diff(network.starts), axis=0)
    inertia = np.add.reduceat(weight * (arm**2).sum(axis=1), first)
    return np.column_stack((centre, held / safe, held / np.where(held, inertia, 1.0)))


def relax(points: NDArray[np.float64], network: Network, tolerance: float, max_sweeps: int = 20_000) -> Relaxed:
    """Let all nodes move by eqs (2) and (3) until they rest.

    Masses and damping are ours: the path to equilibrium is not physical, the equilibrium is. The mass of a node is the
    sum of the stiffnesses at it, that of a pillar as a whole the sum of those of the matrix springs at it; whole
    neighbourhoods move by the stiffness that the matrix gives them on a coarse grid, so that the number of sweeps
    hardly grows with that of the pillars. The damping of a sweep is critical for the present motion (adaptive dynamic
    relaxation, Underwood 1983). Equilibrium has come when the way still to go, the velocity over the frequency for
    which the damping is critical, is nowhere more than `tolerance` times the largest displacement.

    Parameters
    ----------
    points : (m, 2) float64
        All nodes at the start, R0; not changed.
    network : Network
    tolerance : float
        Distance to equilibrium over largest displacement.
    max_sweeps : int

    Returns
    -------
    Relaxed
        ``converged`` is False after `max_sweeps`, or when a number is not finite.
    """
    starts, m, n, p = network.starts, len(points), len(network.loads), len(network.starts) - 1
    origin = np.ascontiguousarray(points)
    x, y = origin.T.copy()
    parts = p + -(-(m - n) // PIECE)
    sums, looks = np.zeros((parts, 2)), np.zeros((parts, 3))
    none = np.zeros(p + 1, dtype=np.int32)
    interior = none, np.zeros((0, 3), dtype=np.int32), none.astype(np.int64), np.zeros(0), np.zeros(0)
    if network.filaments is not None:
        interior = network.filaments[:5]
    work = interior[2] + starts
    rigid = rigid_masses(network, points)
    arguments = (
        origin,
        x,
        y,
        *np.zeros((4, 2, m)),
        np.where(network.pinned, 0.0, 1.0 / node_masses(network, points)),
        starts,
        rigid,
        work,
        *interior,
        network.membrane_rest,
        float(network.membrane_ratio),
        network.rest_areas,
        float(network.area_stiffness),
        float(network.bending),
        np.ascontiguousarray(network.loads),
        network.springs,
        network.spring_rest,
        np.empty((2 * len(network.springs), 2)),
        *pulls_of(network.springs, m),
        sums,
        looks,
        np.empty((3, p)),
        *coarse_grid(origin, rigid[:, :2], starts, network.springs, network.spring_rest, network.pinned),
    )
    most = 1 + (int(work[-1]) + len(network.springs)) // WORTH
    first_force, force, converged, sweeps = 0.0, 0.0, False, 0
    while sweeps < max_sweeps and not converged:
        wanted = 1 if sweeps == 0 else min(CHECK_EVERY - sweeps % CHECK_EVERY, max_sweeps - sweeps)
        done = run_team(sweep, most, np.zeros(1, dtype=np.int64), wanted, *arguments)
        sweeps += done
        damping = damping_of(sums)
        if done < wanted or not np.isfinite(damping):
            break
        move, speed, force = (float(value) for value in np.sqrt(looks.max(axis=0)))
        if sweeps == 1:
            first_force = force
            converged = move < 1e-12
        else:
            converged = 2.0 * speed <= tolerance * damping * move
    residual = force / first_force if first_force > 0.0 else 0.0
    return Relaxed(np.column_stack((x, y)), sweeps, residual, converged)
