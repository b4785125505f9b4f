"""Equilibrium of spring networks: `relax` (eq. 2, damping near critical) beside FIRE, in steps to the same residual.

FIRE is that of Bitzek et al. 2006 (doi:10.1103/PhysRevLett.97.170201) with its published parameters, written with the
forces of the engine; a step of it costs at least one force evaluation and three sums over all nodes.
"""

from __future__ import annotations

import argparse
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from vasculo.tissue.lattice import lattice
from vasculo.tissue.vasculogenesis import Vasculogenesis, grow_plexus

if TYPE_CHECKING:
    from vasculo.springs.network import SpringNetwork

MOST = 20_000


def fire(network: SpringNetwork, tolerance: float) -> int:
    """Relax in place by FIRE; returns the steps, at most 20,000."""
    step = 0.5 * network.safe_limit()
    longest, mixing, good = 3.0 * step, 0.1, 0
    free = ~network.pinned
    speed, force = np.zeros_like(network.points), network.internal_forces()
    goal = tolerance * network.force_scale()
    for taken in range(MOST):
        force[~free] = 0.0
        if float(np.hypot(*force.T).max()) <= goal:
            return taken
        power = float(np.sum(force * speed))
        if power > 0.0:
            pull = np.linalg.norm(speed) / np.linalg.norm(force)
            speed = (1.0 - mixing) * speed + mixing * pull * force
            good += 1
            if good > 5:
                step, mixing = min(1.1 * step, longest), 0.99 * mixing
        else:
            step, mixing, good = 0.5 * step, 0.1, 0
            speed[:] = 0.0
        speed += step * force / network.masses[:, None]
        network.points += step * speed
        force = network.internal_forces()
    return MOST


def cases(nodes: int) -> dict[str, SpringNetwork]:
    """Networks away from equilibrium, a name each."""
    tissue = lattice(nodes, 1)
    stretched, torn, uneven = tissue.copy(), tissue.copy(), tissue.copy()
    stretched.rest_lengths *= 0.8
    torn.rest_lengths *= 0.8
    torn.remove_springs(np.hypot(*(torn.points[torn.springs].mean(axis=1) - 0.5).T) < 0.2)
    rng = np.random.default_rng(0)
    uneven.stiffness = 10.0 ** rng.uniform(-1.0, 1.0, len(uneven.springs))
    uneven.rest_lengths *= rng.uniform(0.6, 0.9, len(uneven.springs))
    plexus = grow_plexus(tissue, Vasculogenesis(tightening_time=1.0, settling_time=0.0), 1)
    loose = plexus.copy()
    loose.tether = 0.0
    return {
        "stretched by a quarter": stretched,
        "with a hole": torn,
        "stiffness over two decades": uneven,
        "plexus, tether 0.01": plexus,
        "plexus, no tether": loose,
    }


def main() -> None:
    """Relax and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--nodes", type=int, default=12_000)
    options = parser.parse_args()
    print("| network | residual before | tolerance | relax: steps | s | residual after | FIRE: steps |")
    print("|---|---:|---:|---:|---:|---:|---:|")
    for name, network in cases(options.nodes).items():
        for tolerance in (1e-4, 1e-9):
            ours, theirs = network.copy(), network.copy()
            begin = perf_counter()
            steps = ours.relax(tolerance)
            took = perf_counter() - begin
            other = fire(theirs, tolerance)
            print(
                f"| {name} | {network.residual():.2g} | {tolerance:g} | {steps} | {took:.2f} | {ours.residual():.2g} | "
                f"{other if other < MOST else f'over {MOST}'} |"
            )


if __name__ == "__main__":
    main()
