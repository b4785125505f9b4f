"""The relaxation of `relax.py` in plain NumPy, next to the paper's equations; the reference in the tests."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.pillars.cell import pairs, ring
from vasculo.pillars.relax import CHECK_EVERY, DAMPING, TIME_STEP, Relaxed, node_masses

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.pillars.relax import Network


def forces_plain(points: NDArray[np.float64], network: Network) -> NDArray[np.float64]:
    """Force on every node: Hooke's law in filaments, membranes and matrix, area pressure, bending, loads.

    Parameters
    ----------
    points : (m, 2) float64
        R0.
    network : Network

    Returns
    -------
    (m, 2) float64
        Matrix spring stiffness times R0.
    """
    starts, n = network.starts, len(network.loads)
    force = np.zeros_like(points)
    force[:n] += network.loads
    previous, following = ring(starts)
    nodes = np.arange(n)
    first, second = pairs(network.interior)
    _add_springs(force, points, first, second, network.filament_rest, network.filament_stiffness)
    _add_springs(force, points, nodes, following, network.membrane_rest, 1.0)
    _add_springs(force, points, network.springs[:, 0], network.springs[:, 1], network.spring_rest, 1.0)

    before, here, after = points[previous], points[:n], points[following]
    cross = 0.5 * (here[:, 0] * after[:, 1] - after[:, 0] * here[:, 1])
    area = np.add.reduceat(cross, starts[:-1])
    pressure = network.area_stiffness * (network.rest_areas - area) / network.rest_areas
    chord = after - before
    outward = np.column_stack((chord[:, 1], -chord[:, 0]))
    force[:n] += 0.5 * np.repeat(pressure, np.diff(starts))[:, None] * outward

    bend = network.bending * (before - 2.0 * here + after)
    force[:n] += 2.0 * bend - bend[previous] - bend[following]
    return force


def relax_plain(points: NDArray[np.float64], network: Network, tolerance: float, max_sweeps: int = 20_000) -> Relaxed:
    """Give what `relax` gives."""
    r, v = points.copy(), np.zeros_like(points)
    mass = node_masses(network, points)[:, None]
    free = ~network.pinned
    first_force, force, converged, sweep = 0.0, np.zeros(1), False, 0
    while sweep < max_sweeps and not converged:
        sweep += 1
        total = forces_plain(r, network)
        v[free] = ((v + TIME_STEP / mass * total) / (1.0 + DAMPING * TIME_STEP))[free]  # (eq. 2), D = DAMPING * M
        r = r + v * TIME_STEP  # (eq. 3)
        force = np.hypot(*total[free].T)
        speed, shift = np.hypot(*v.T).max(), np.hypot(*(r - points).T).max()
        if sweep == 1:
            first_force = force.max()
            converged = bool(shift < 1e-12)
        elif sweep % CHECK_EVERY == 0 or sweep == max_sweeps:
            converged = bool(speed <= tolerance * shift)
    residual = float(force.max() / first_force) if first_force > 0.0 else 0.0
    return Relaxed(r, sweep, residual, converged)


def _add_springs(
    force: NDArray[np.float64],
    points: NDArray[np.float64],
    first: NDArray[np.integer],
    second: NDArray[np.integer],
    rest: NDArray[np.float64],
    stiffness: NDArray[np.float64] | float,
) -> None:
    """Add Hooke forces of the springs from `first` to `second`."""
    vector = points[second] - points[first]
    length = np.hypot(vector[:, 0], vector[:, 1])
    pull = (stiffness * (1.0 - rest / length))[:, None] * vector
    np.add.at(force, first, pull)
    np.subtract.at(force, second, pull)
