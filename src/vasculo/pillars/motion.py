"""One geometry step: forces from the sensed shear, equilibrium, a capped move of every pillar."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import ComputationError
from vasculo.pillars.cell import filaments, side_lengths
from vasculo.pillars.matrix import Matrix, carry_over, is_flat, lay_matrix
from vasculo.pillars.parameters import REFERENCE_ACTIVATION
from vasculo.pillars.relax import Network, relax

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.geometry.domain import Domain
    from vasculo.pillars.parameters import Angiogenesis
    from vasculo.pillars.relax import Relaxed
    from vasculo.pillars.state import RemodelState

TOLERANCE = {"active": 2e-3, "hanging": 2e-4}  # velocity over displacement at rest


@dataclass(frozen=True, slots=True)
class Motion:
    """A move of the membranes.

    Attributes
    ----------
    points : (n, 2) float64
        Membrane nodes after it, model length.
    matrix : Matrix or None
        The elastic matrix after it; None when the matrix is laid anew every step.
    share : float
        Mean of the cap factors over the membrane nodes, 0 to 1.
    displacement : float
        Largest move of a membrane node, R0.
    residual : float
        See `vasculo.pillars.relax.Relaxed`.
    sweeps : int
    """

    points: NDArray[np.float64]
    matrix: Matrix | None
    share: float
    displacement: float
    residual: float
    sweeps: int


def move(
    domain: Domain,
    state: RemodelState,
    activation: NDArray[np.float64],
    loads: NDArray[np.float64],
    parameters: Angiogenesis,
) -> Motion:
    """Bring membranes, filaments and matrix to equilibrium and move each pillar by a capped part of it.

    Filaments are laid anew at their present length in every step, so what they did before is kept as shape (ours: with
    filaments that remember the first shape a disk stops at an aspect ratio of 1.2 to 1.6).

    Parameters
    ----------
    domain : Domain
        With the pillars of `state`.
    state : RemodelState
    activation : (n,) float64
        Of the membrane nodes, -1 to 1.
    loads : (n, 2) float64
        Forces on them, matrix spring stiffness times R0.
    parameters : Angiogenesis

    Returns
    -------
    Motion

    Raises
    ------
    ComputationError
        If the relaxation does not come to rest or gives numbers that are not finite.
    """
    unit, starts, n = state.length_unit, state.starts, len(state.points)
    matrix = present_matrix(domain, state, parameters)
    scaled = state.points / unit
    interior, rest, stiffness, sums = starts[:1], np.zeros(0), np.zeros(0), np.zeros(n)
    area_stiffness = bending = 0.0
    if not parameters.is_hanging:
        interior = starts
        rest, stiffness, sums = filaments(
            scaled, starts, activation, parameters.activation, parameters.filament_ratio, parameters.filament_reach
        )
        area_stiffness = parameters.area_stiffness
        scale = abs(parameters.activation) / REFERENCE_ACTIVATION
        bending = parameters.bending * scale / parameters.membrane_spacing**3
    network = Network(
        starts,
        interior,
        rest,
        stiffness,
        sums,
        side_lengths(scaled, starts),
        matrix.springs,
        matrix.rest_lengths / unit,
        state.rest_areas / unit**2,
        area_stiffness,
        bending,
        loads,
        matrix.pinned,
    )
    relaxed = relax(matrix.points / unit, network, TOLERANCE[parameters.cells])
    check(relaxed, state, parameters)
    shift = relaxed.points * unit - matrix.points
    factors = cap_factors(shift[:n], starts, parameters.step_cap * parameters.membrane_spacing * unit)
    if parameters.is_hanging:
        factors[:] = factors.min()  # one matrix holds all pillars, so that all take the same part of their way
    factor = np.repeat(factors, np.diff(starts))
    moved = factor[:, None] * shift[:n]
    points = state.points + moved
    kept = None
    if parameters.is_hanging:
        around = matrix.points[n:] + factors[0] * shift[n:]
        kept = Matrix(
            np.concatenate((points, around)), matrix.reference, matrix.springs, matrix.triangles, matrix.pinned
        )
    displacement = float(np.hypot(moved[:, 0], moved[:, 1]).max()) / unit
    return Motion(points, kept, float(factor.mean()), displacement, relaxed.residual, relaxed.sweeps)


def present_matrix(domain: Domain, state: RemodelState, parameters: Angiogenesis) -> Matrix:
    """Return the matrix of this step: free of stress around active cells, elastic around hanging ones."""
    spacing = parameters.matrix_spacing * state.length_unit
    if not parameters.is_hanging or len(state.matrix_points) == 0:
        return lay_matrix(domain, spacing)
    old = Matrix(
        state.matrix_points, state.matrix_reference, state.matrix_springs, state.matrix_triangles, state.matrix_pinned
    )
    same = np.array_equal(old.points[: len(state.points)], state.points)
    if same and not is_flat(old):
        return old
    return carry_over(old, lay_matrix(domain, spacing))


def cap_factors(shift: NDArray[np.float64], starts: NDArray[np.int32], cap: float) -> NDArray[np.float64]:
    """Part of its shift that each pillar may take so that no node moves more than `cap`; (p,) float64, 0 to 1."""
    largest = np.maximum.reduceat(np.hypot(shift[:, 0], shift[:, 1]), starts[:-1])
    return np.minimum(1.0, cap / np.maximum(largest, cap))


def check(relaxed: Relaxed, state: RemodelState, parameters: Angiogenesis) -> None:
    """Raise ComputationError, with pillar and numbers, if a relaxation did not come to rest."""
    broken = np.flatnonzero(~np.isfinite(relaxed.points).all(axis=1))
    if broken.size:
        node = int(broken[0])
        pillar = int(np.searchsorted(state.starts, node, side="right")) - 1
        where = f"pillar {pillar}" if node < len(state.points) else "the matrix"
        raise ComputationError(
            f"{broken.size} nodes are not finite after {relaxed.sweeps} sweeps, "
            f"the first is node {node} in {where}: lower activation ({parameters.activation:g}) or traction "
            f"({parameters.traction:g})"
        )
    if not relaxed.converged:
        raise ComputationError(
            f"no equilibrium after {relaxed.sweeps} sweeps, residual "
            f"{relaxed.residual:.2g}: lower activation ({parameters.activation:g}) or traction "
            f"({parameters.traction:g})"
        )
