"""The relaxation of `relax.py` in plain NumPy, next to the paper's equations; the reference in the tests."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.pillars.cell import filament_pairs, ring
from vasculo.pillars.coarse import coarse_grid, coarse_speeds_plain
from vasculo.pillars.relax import CHECK_EVERY, Relaxed, node_masses, rigid_masses
from vasculo.pillars.sweeps import FIRST_DAMPING, LEAST_DAMPING, MOST_DAMPING, TIME_STEP

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
    if network.filaments is not None:
        pairs, rest, stiffness = filament_pairs(starts, network.filaments)
        _add_springs(force, points, pairs[:, 0], pairs[:, 1], rest, stiffness)
    _add_springs(force, points, nodes, following, network.membrane_rest, network.membrane_ratio)
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
    r, momentum, v, old = points.copy(), np.zeros_like(points), np.zeros_like(points), np.zeros_like(points)
    first, n = network.starts[:-1], len(network.loads)
    rigid = np.repeat(rigid_masses(network, points), np.diff(network.starts), axis=0)
    arm = points[:n] - rigid[:, :2]
    turned = np.column_stack((-arm[:, 1], arm[:, 0]))
    centres = rigid_masses(network, points)[:, :2]
    coarse = coarse_grid(points, centres, network.starts, network.springs, network.spring_rest, network.pinned)
    under = np.where(coarse.hats >= 0, coarse.hats, 0)
    members = np.repeat(np.arange(len(first)), np.diff(network.starts))
    owner = np.concatenate((members, np.arange(len(first), len(under))))
    push = np.where(network.pinned, 0.0, 1.0 / node_masses(network, points))
    damping, first_force, converged, sweep = FIRST_DAMPING, 0.0, False, 0
    force = np.zeros(1)
    while sweep < max_sweeps and not converged:
        sweep += 1
        total = forces_plain(r, network)
        curvature, weight = (v * (old - total)).sum() / TIME_STEP, (v * momentum).sum()
        momentum = (momentum + TIME_STEP * total) / (1.0 + damping * TIME_STEP)  # (eq. 2) times M, D = damping * M
        v = push[:, None] * momentum
        per_pillar = np.add.reduceat(momentum[:n], first), np.add.reduceat((turned * momentum[:n]).sum(axis=1), first)
        whole, turn = (np.repeat(values, np.diff(network.starts), axis=0) for values in per_pillar)
        v[:n] += rigid[:, 2:3] * whole + (rigid[:, 3] * turn)[:, None] * turned
        if len(coarse.factor):
            waves = coarse_speeds_plain(momentum.T, np.add.reduceat(momentum[:n], first).T, n, coarse)
            v += (coarse.weights[:, :, None] * waves[under]).sum(axis=1)[owner]
        r = r + v * TIME_STEP  # (eq. 3)
        damping = FIRST_DAMPING
        if weight > 0.0:
            damping = float(np.clip(2.0 * np.sqrt(max(curvature / weight, 0.0)), LEAST_DAMPING, MOST_DAMPING))
        old = total
        force = np.hypot(*total[push > 0.0].T)
        speed, shift = np.hypot(*v.T).max(), np.hypot(*(r - points).T).max()
        if sweep == 1:
            first_force = force.max()
            converged = bool(shift < 1e-12)
        elif sweep % CHECK_EVERY == 0 or sweep == max_sweeps:
            converged = bool(2.0 * speed <= tolerance * damping * shift)
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
