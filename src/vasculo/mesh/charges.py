"""The paper's first way: masses that carry charges and all repel each other, held by springs of the wanted lengths."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from vasculo.mesh.truss import move_masses, spring_forces, unique_edges
from vasculo.springs.threads import run_team

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.geometry.arrays import Flags, Floats
    from vasculo.mesh.draft import Draft

STRENGTH = 0.01
"""Repulsion of two charges one wanted length apart, over the force of a spring that is twice as long as wanted."""

MOST_CHARGES = 20_000
"""Most masses: ten rounds then take one to two minutes."""

FEWEST = 500
"""Fewest masses of one thread."""


def relax_charges(draft: Draft) -> None:
    """Let the masses of a draft repel each other for `STEPS` steps, from rest; overwrites the points.

    Notes
    -----
    Szczerba & Szekely 2005, section 3: "each spring is assigned a rest length being a desired mesh edge length", then
    "the masses are charged electrically and allowed to evolve". They replaced the charges by the internal pressure of
    the truss because of the "N^2 cost of electromagnetic interactions". A charge grows with the wanted length h as
    h^(3/2), so that Coulomb's force between neighbours is `STRENGTH` h whatever h is; walls are charged too. All
    constants are ours.
    """
    springs = unique_edges(draft.triangles, draft.neighbours)
    charges = np.sqrt(STRENGTH) * draft.sizes**1.5

    def push(force: NDArray[np.float64]) -> None:
        spring_forces(draft.points, springs, draft.sizes, 1.0, force, push_only=False)
        run_team(repel, len(charges) // FEWEST + 1, draft.points, charges, draft.fixed, force)

    move_masses(draft, push)


def repel_plain(
    points: NDArray[np.float64], charges: NDArray[np.float64], fixed: NDArray[np.bool_], force: NDArray[np.float64]
) -> None:
    """Plain twin of `repel`."""
    for i in np.flatnonzero(~fixed):
        way = points[i] - points
        cubed = (way**2).sum(axis=1) ** 1.5
        cubed[i] = np.inf
        force[i] += charges[i] * ((charges / cubed)[:, None] * way).sum(axis=0)


@njit(cache=True, error_model="numpy", nogil=True)
def repel(rank: int, threads: int, points: Floats, charges: Floats, fixed: Flags, force: Floats) -> int:
    """Add Coulomb's repulsion q_i q_j / r^2 by all others to the `force` on each free charge of this thread's share."""
    for i in range(rank, len(points), threads):
        if fixed[i]:
            continue
        x = points[i, 0]
        y = points[i, 1]
        fx = 0.0
        fy = 0.0
        for j in range(len(points)):
            dx = x - points[j, 0]
            dy = y - points[j, 1]
            square = dx * dx + dy * dy
            if square > 0.0:
                strength = charges[j] / (square * np.sqrt(square))
                fx += strength * dx
                fy += strength * dy
        force[i, 0] += charges[i] * fx
        force[i, 1] += charges[i] * fy
    return 0
