"""Equilibrium of a spring network by damped motion with masses and damping of its own choice.

Equilibrium does not depend on the masses. Each node is given the mass at which its stiffest motion is just stable, and
the damping follows the slowest motion still going on, near its critical value (Underwood's dynamic relaxation, 1983).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import ComputationError
from vasculo.springs.engine import Drive
from vasculo.springs.stability import node_stiffness

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.springs.network import SpringNetwork

BLOCK = 20
"""Steps between two looks at the forces."""

MARGIN = 0.9
"""Share of the stability limit that is used (the limit of k dt^2 / m is 4)."""


def relax(network: SpringNetwork, tolerance: float, steps: int, load: NDArray[np.float64] | None) -> int:
    """Relax a network in place until no free node feels more than the tolerance; returns the steps taken.

    See `SpringNetwork.relax`, which checks the arguments.
    """
    # Strategy: blocks of eq. (2) with dt = 1. The displacement of a block is mostly the slowest motion left, so the
    # drop of the force along it gives that motion's frequency, and the frequency the critical damping.
    free = ~network.pinned
    mass = node_stiffness(network.springs, network.stiffness, len(network.points), network.tether) / (4.0 * MARGIN)
    mass[mass <= 0.0] = 1.0
    push: NDArray[np.float64] = 1.0 / mass
    network.velocities[:] = 0.0
    speed = np.zeros_like(network.points)

    def total() -> NDArray[np.float64]:
        forces = network.internal_forces()
        return np.where(free[:, None], forces if load is None else forces + load, 0.0)

    before, force, friction = network.points.copy(), total(), 1.0
    taken = 0
    while (left := float(np.hypot(*force.T).max())) > (goal := tolerance * network.force_scale()):
        if taken >= steps:
            worst = int(np.argmax(np.hypot(*force.T)))
            raise ComputationError(
                f"relaxation stopped after {taken} steps with force {left:.3g} on node {worst}, above {goal:.3g}: "
                "raise the tolerance or the steps"
            )
        keep = free / (1.0 + friction)
        count = min(BLOCK, steps - taken)
        drive = Drive(push, keep, network.tether, network.reference, load, 1.0)
        moved = network.engine().move(network.points, speed, drive, count)
        if moved.lost >= 0:
            raise ComputationError(
                f"relaxation: node {moved.lost} leaves the finite numbers after {taken + moved.done} steps, from a "
                f"residual of {left / goal * tolerance:.3g}"
            )
        taken += count
        last, force = force, total()
        shift = network.points - before
        before = network.points.copy()
        inertia = float(np.sum(mass[:, None] * shift * shift))
        if inertia > 0.0:
            slowest = max(float(np.sum(shift * (last - force))) / inertia, 0.0)
            friction = slowest + 2.0 * np.sqrt(slowest)
    return taken
