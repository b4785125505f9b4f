"""Equilibrium of a spring network by damped motion with masses and damping of its own choice.

Equilibrium does not depend on the masses. Each node is given the mass at which its stiffest motion is just stable, and
the damping follows the slowest motion still going on, near its critical value (Underwood's dynamic relaxation, 1983).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import ComputationError
from vasculo.springs.forces import hooke_forces
from vasculo.springs.motion import damped_steps

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.springs.network import SpringNetwork

BLOCK = 20
"""Steps between two looks at the forces."""

MARGIN = 0.9
"""Share of the stability limit that is used (the limit of k dt^2 / m is 4)."""


def relax(network: SpringNetwork, tolerance: float, steps: int, forces: NDArray[np.float64]) -> int:
    """Relax a network in place until no free node feels more than the tolerance; returns the steps taken.

    See `SpringNetwork.relax`, which checks the arguments.
    """
    # Strategy: blocks of eq. (2) with dt = 1. The displacement of a block is mostly the slowest motion left, so the
    # drop of the force along it gives that motion's frequency, and the frequency the critical damping.
    rows = network.half_springs()
    stiffness, rest = network.stiffness[rows.spring], network.rest_lengths[rows.spring]
    free = ~network.pinned
    felt = np.bincount(network.springs.ravel(), np.repeat(network.stiffness, 2), len(network.points))
    mass = (2.0 * felt + network.tether) / (4.0 * MARGIN)
    mass[mass <= 0.0] = 1.0
    scale = float(np.mean(network.stiffness) * np.mean(network.lengths())) if len(network.springs) else 1.0
    goal = tolerance * scale
    limit, unbroken = np.full(stiffness.size, np.inf), np.full(len(network.springs), -1, dtype=np.int32)
    points, speed = network.points, np.zeros_like(network.points)
    network.velocities[:] = 0.0

    def total() -> NDArray[np.float64]:
        out = np.empty_like(points)
        hooke_forces(points, rows.start, rows.neighbour, stiffness, rest, out)
        out += forces - network.tether * (points - network.reference)
        out[~free] = 0.0
        return out

    before, force, friction = points.copy(), total(), 1.0
    taken = 0
    while (left := float(np.abs(force).max())) > goal:
        if taken >= steps:
            worst = int(np.argmax(np.abs(force).max(axis=1)))
            raise ComputationError(
                f"relaxation stopped after {taken} steps with force {left:.3g} on node {worst}, above {goal:.3g}: "
                "raise the tolerance or the steps"
            )
        keep = np.where(free, 1.0 / (1.0 + friction), 0.0)
        halves = (stiffness, rest, limit)
        fixed = (1.0 / mass, keep, network.tether, network.reference, forces, 1.0, 1.0, 0.0)
        _, bad = damped_steps(points, speed, *rows, *halves, *fixed, BLOCK, unbroken)
        if bad >= 0:
            raise ComputationError(f"relaxation: node {bad} leaves the finite numbers at {points[bad].tolist()}")
        taken += BLOCK
        last, force = force, total()
        moved = points - before
        before = points.copy()
        inertia = float(np.sum(mass[:, None] * moved * moved))
        if inertia > 0.0:
            slowest = max(float(np.sum(moved * (last - force))) / inertia, 0.0)
            friction = slowest + 2.0 * np.sqrt(slowest)
    return taken
