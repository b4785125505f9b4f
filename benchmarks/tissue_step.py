"""Time and memory of one mass-spring step (forces, damping, rupture test), and time of a whole vasculogenesis.

Prints milliseconds a step of the engine, of the same step written with `np.add.at` and with SciPy sparse products, the
bytes a node that the engine needs beside the network's own arrays, and the seconds of a whole `grow_plexus`. The best
of several repeats counts: run it on a quiet machine. `spring_step.py` compares with LAMMPS.
"""

from __future__ import annotations

import argparse
import tracemalloc
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import coo_array

from vasculo.tissue.lattice import lattice
from vasculo.tissue.vasculogenesis import Vasculogenesis, grow_plexus

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from vasculo.springs.network import SpringNetwork

    Floats = NDArray[np.float64]

DT, DAMPING = 0.2, 5.0
MOST_GROWN = 100_000  # nodes up to which a whole vasculogenesis is timed


def best(function: Callable[[], object], repeats: int) -> float:
    """Shortest time of several calls, seconds."""
    times = []
    for _ in range(repeats):
        begin = perf_counter()
        function()
        times.append(perf_counter() - begin)
    return min(times)


def plain_step(tissue: SpringNetwork, limits: Floats, gather: Callable[[Floats], Floats]) -> Floats:
    """One step of eqs. (2) and (3) in NumPy; `gather` sums the pulls (m, 2) of the springs into node forces."""
    first, second = tissue.springs.T
    arms = tissue.points[second] - tissue.points[first]
    length = np.hypot(arms[:, 0], arms[:, 1])
    tension = tissue.stiffness * (length - tissue.rest_lengths)
    tension[tension > limits] = 0.0
    forces = gather((tension / length)[:, None] * arms)
    speed = (tissue.velocities + DT * forces) / (1.0 + DAMPING * DT)
    speed[tissue.pinned] = 0.0
    return np.asarray(tissue.points + DT * speed)


def print_memory(tissue: SpringNetwork, limits: Floats) -> None:
    """Print what the engine allocates: tables that stay, and the most that a call needs on top of them."""
    tracemalloc.start()
    tissue.engine()
    tables = tracemalloc.get_traced_memory()[0]
    tracemalloc.reset_peak()
    tissue.advance(DT, 2, break_above=limits)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    names = (
        "points",
        "velocities",
        "reference",
        "masses",
        "pinned",
        "springs",
        "rest_lengths",
        "stiffness",
        "triangles",
    )
    own = sum(getattr(tissue, name).nbytes for name in names)
    nodes = len(tissue.points)
    print(
        f"memory             {tables / nodes:8.0f} bytes a node of tables, {peak / nodes:.0f} with a call; "
        f"the network's own arrays have {own / nodes:.0f}"
    )


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--nodes", type=int, default=12_000)
    parser.add_argument("--steps", type=int, default=200, help="steps a call")
    parser.add_argument("--repeats", type=int, default=20)
    options = parser.parse_args()

    tissue = lattice(options.nodes)
    tissue.rest_lengths *= 0.95
    tissue.damping = DAMPING
    springs, nodes = len(tissue.springs), len(tissue.points)
    limits = 10.0 * tissue.rest_lengths
    print(f"{nodes} nodes, {springs} springs, lattice in {best(lambda: lattice(options.nodes), 2):.2f} s")

    tissue.advance(DT, 1, break_above=limits)
    engine = best(lambda: tissue.advance(DT, options.steps, break_above=limits), options.repeats) / options.steps
    single = best(lambda: tissue.advance(DT, 1, break_above=limits), 20 * options.repeats)
    print(
        f"engine             {1e3 * engine:8.3f} ms a step in calls of {options.steps}, "
        f"{1e3 * single:.3f} ms in calls of one step"
    )

    first, second = tissue.springs.T

    def add_at(pulls: Floats) -> Floats:
        forces = np.zeros((nodes, 2))
        np.add.at(forces, first, pulls)
        np.add.at(forces, second, -pulls)
        return forces

    row = np.arange(springs)
    ends = coo_array(
        (np.repeat([1.0, -1.0], springs), (np.concatenate([first, second]), np.concatenate([row, row]))),
        shape=(nodes, springs),
    ).tocsr()
    for name, gather in (("np.add.at", add_at), ("SciPy sparse", lambda pulls: ends @ pulls)):
        time = best(lambda gather=gather: plain_step(tissue, limits, gather), 5 * options.repeats)
        print(f"{name:18s} {1e3 * time:8.3f} ms a step, {time / engine:.1f} times the engine")

    print_memory(tissue.copy(), limits)
    if options.nodes > MOST_GROWN:
        return
    tissue = lattice(options.nodes)
    whole = best(lambda: grow_plexus(tissue), 3)
    watched = best(lambda: grow_plexus(tissue, Vasculogenesis(), watch=lambda _: None), 2)
    print(f"grow_plexus        {whole:8.2f} s, with a watcher {watched:.2f} s")


if __name__ == "__main__":
    main()
