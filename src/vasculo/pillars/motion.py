"""One geometry step: forces from the sensed shear, equilibrium, a capped move of every pillar."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import ComputationError
from vasculo.pillars.cell import filaments, ring, side_lengths
from vasculo.pillars.gaps import gap_factors
from vasculo.pillars.matrix import Matrix, carry_over, is_flat, lay_matrix, no_matrix
from vasculo.pillars.parameters import REFERENCE_ACTIVATION
from vasculo.pillars.relax import Network, relax

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.geometry.domain import Domain
    from vasculo.pillars.parameters import Angiogenesis
    from vasculo.pillars.relax import Relaxed
    from vasculo.pillars.state import RemodelState

MAX_SWEEPS = 5_000
BALANCED = 1e-5  # force over the first at which soft cells that still quiver count as at rest
TOLERANCE = {"active": 2e-3, "hanging": 2e-4}  # way still to go over the largest displacement at rest


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

    Without memory filaments are laid anew at their present length in every step, so what they did before is kept as
    shape (ours: with filaments that remember the first shape a disk stops at an aspect ratio of 1.2 to 1.6).

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
    network = network_of(state, matrix, activation, loads, parameters)
    relaxed = relax(matrix.points / unit, network, TOLERANCE[parameters.cells], MAX_SWEEPS)
    check(relaxed, state, parameters)
    shift = relaxed.points * unit - matrix.points
    factors = cap_factors(shift[:n], state.points, starts, parameters.step_cap * parameters.membrane_spacing * unit)
    if parameters.is_hanging:
        factors[:] = factors.min()  # one matrix holds all pillars, so that all take the same part of their way
    capped = np.repeat(factors, np.diff(starts))[:, None] * shift[:n]
    near = gap_factors(state.points, starts, capped)
    factors *= near.min() if parameters.is_hanging else near
    factor = np.repeat(factors, np.diff(starts))
    moved = factor[:, None] * shift[:n]
    points = state.points + moved
    kept = None
    if parameters.remembers_matrix:
        around = matrix.points[n:] + factors.min() * shift[n:]
        kept = Matrix(
            np.concatenate((points, around)), matrix.reference, matrix.springs, matrix.triangles, matrix.pinned
        )
    displacement = float(np.hypot(moved[:, 0], moved[:, 1]).max()) / unit
    return Motion(points, kept, float(factor.mean()), displacement, relaxed.residual, relaxed.sweeps)


def network_of(
    state: RemodelState,
    matrix: Matrix,
    activation: NDArray[np.float64],
    loads: NDArray[np.float64],
    parameters: Angiogenesis,
) -> Network:
    """Gather the springs of one step; without interior the membranes remember what their matrix does."""
    unit, starts, n = state.length_unit, state.starts, len(state.points)
    hanging = parameters.is_hanging
    free = matrix.reference[:n] if hanging else state.reference
    strands, area_stiffness, bending = None, 0.0, 0.0
    if not hanging:
        strands = filaments(
            state.points / unit,
            state.reference / unit,
            starts,
            activation,
            parameters.activation,
            parameters.filament_ratio,
            parameters.filament_reach,
        )
        area_stiffness = parameters.area_stiffness
        scale = abs(parameters.activation) / REFERENCE_ACTIVATION
        bending = parameters.bending * scale / parameters.membrane_spacing**3
    return Network(
        starts=starts,
        filaments=strands,
        membrane_rest=side_lengths(free, starts) / unit,
        membrane_ratio=parameters.membrane_ratio,
        springs=matrix.springs,
        spring_rest=matrix.rest_lengths / unit,
        rest_areas=state.rest_areas / unit**2,
        area_stiffness=area_stiffness,
        bending=bending,
        loads=loads,
        pinned=matrix.pinned,
    )


def present_matrix(domain: Domain, state: RemodelState, parameters: Angiogenesis) -> Matrix:
    """Return the matrix of this step: free of stress, or with the stress that it remembers."""
    if parameters.matrix == "none":
        return no_matrix(state.points)
    spacing = parameters.matrix_spacing * state.length_unit
    if not parameters.remembers_matrix or len(state.matrix_points) == 0:
        return lay_matrix(domain, spacing)
    old = Matrix(
        state.matrix_points, state.matrix_reference, state.matrix_springs, state.matrix_triangles, state.matrix_pinned
    )
    same = np.array_equal(old.points[: len(state.points)], state.points)
    if same and not is_flat(old):
        return old
    return carry_over(old, lay_matrix(domain, spacing))


def cap_factors(
    shift: NDArray[np.float64], points: NDArray[np.float64], starts: NDArray[np.int32], cap: float
) -> NDArray[np.float64]:
    """Part of its shift that each pillar may take so that its outline moves by `cap` at most; (p,) float64, 0 to 1.

    What counts is the motion across the membrane: nodes that slide along it change no shape.
    """
    previous, following = ring(starts)
    along = points[following] - points[previous]
    across = np.abs(along[:, 0] * shift[:, 1] - along[:, 1] * shift[:, 0]) / np.hypot(along[:, 0], along[:, 1])
    largest = np.maximum.reduceat(across, starts[:-1])
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
    if not relaxed.converged and relaxed.residual > BALANCED:
        raise ComputationError(
            f"no equilibrium after {relaxed.sweeps} sweeps, residual "
            f"{relaxed.residual:.2g}: lower activation ({parameters.activation:g}) or traction "
            f"({parameters.traction:g})"
        )
