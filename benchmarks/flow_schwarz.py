"""The two-level Schwarz solver against the number of pillars: iterations, size of the coarse space, memory, seconds.

Run: python benchmarks/flow_schwarz.py [--pillars 64 256 1024 4096] [--edge 0.15] [--most 10000] [--scipy] [--threads 1]
Dense Voronoi arrays, pressure from left to right, mirror lines above and below. Each solver of each size has a process
of its own, after a small flow that compiles the kernels. Bytes a triangle are the peak of the process while it factors
and solves, over what it had before: its matrix was there already. Seconds are those of the processor.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
from contextlib import nullcontext
from pathlib import Path
from time import process_time
from typing import TYPE_CHECKING
from unittest.mock import patch

import numpy as np

from vasculo.flow.assemble import System, assemble
from vasculo.flow.boundary import Pressure, Slip
from vasculo.flow.faces import build_faces
from vasculo.flow.linear.compact import compact_matrix
from vasculo.flow.linear.jacobi import inverse_diagonal, jacobi_step
from vasculo.flow.linear.krylov import refine
from vasculo.flow.linear.partition import partition
from vasculo.flow.linear.schwarz import SchwarzFactor
from vasculo.flow.linear.schwarz_blocks import local_factor
from vasculo.mesh.generate import generate_mesh
from vasculo.plexus.voronoi import voronoi_plexus

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray
    from scipy import sparse

SIDES = {"left": Pressure(1.0), "right": Pressure(0.0), "top": Slip(), "bottom": Slip()}
GOALS = (1e-4, 1e-6, 1e-8)
SOLVERS = ("schwarz", "compact", "direct")
WEIGHT = 0.4
LIBRARY = "vasculo.flow.linear.schwarz_blocks.library"
HEADS = ("pillars", "triangles", "solver", "parts", "largest", "coarse", "strip", "to 1e-4", "1e-6", "1e-8", "divide s",
         "factor s", "solve s", "krylov s", "B/triangle")  # fmt: skip


def main() -> None:
    """Print the table, or one row of it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pillars", type=int, nargs="+", default=[64, 256, 1024, 4096])
    parser.add_argument("--solvers", nargs="+", default=list(SOLVERS), choices=SOLVERS)
    parser.add_argument("--edge", type=float, default=0.15, help="of the triangles, over the radius of a pillar")
    parser.add_argument("--most", type=int, default=10_000, help="triangles of a part")
    parser.add_argument("--overlap", type=int, default=6)
    parser.add_argument("--scipy", action="store_true", help="SuperLU for the parts, even if PARDISO is there")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--row", action="store_true", help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    if chosen.row:
        with patch(LIBRARY, return_value=None) if chosen.scipy else nullcontext():
            row(chosen)
        return
    print("".join(f"{head:>11}" for head in HEADS))
    threads = str(chosen.threads)
    environment = {**os.environ, "MKL_NUM_THREADS": threads, "VASCULO_THREADS": threads}
    for pillars in chosen.pillars:
        for solver in chosen.solvers:
            call = [sys.executable, str(Path(__file__)), "--row", "--pillars", str(pillars), "--solvers", solver]
            call += ["--edge", str(chosen.edge), "--most", str(chosen.most), "--overlap", str(chosen.overlap)]
            subprocess.run(call + ["--scipy"] * chosen.scipy, check=True, env=environment)


def row(chosen: argparse.Namespace) -> None:
    """Measure one solver on one mesh."""
    solver = chosen.solvers[0]
    small, near = problem(16, 0.25)
    measure(small, near if solver != "direct" else small.blocks(), solver, 300, chosen.overlap)
    system, near = problem(chosen.pillars[0], chosen.edge)
    matrix = near if solver != "direct" else system.blocks()
    numbers = measure(system, matrix, solver, chosen.most, chosen.overlap)
    print(f"{chosen.pillars[0]:11d}{system.cells:11d}{solver:>11}" + "".join(f"{n:>11}" for n in numbers), flush=True)


def problem(pillars: int, edge: float) -> tuple[System, sparse.bsr_array]:
    """System of a dense array, and its compact matrix."""
    mesh = generate_mesh(voronoi_plexus(pillars), edge)
    faces = build_faces(mesh, SIDES)
    system = assemble(mesh, faces, 1.0, np.zeros((len(mesh.triangles), 2)))
    return system, compact_matrix(mesh, system)


def measure(system: System, matrix: sparse.bsr_array, solver: str, most: int, overlap: int) -> list[str]:
    """Parts, largest part, coarse size, share in the strip, iterations to the goals, seconds, bytes a triangle."""
    inverse = inverse_diagonal(system.blocks())
    before = forget_peak()
    times = [process_time()]
    if solver == "schwarz":
        part = partition(matrix.indptr, matrix.indices, most)
        times.append(process_time())
        with SchwarzFactor(matrix, part, overlap) as parts:
            seen = [str(part.max() + 1), str(np.bincount(part).max()), str(parts.coarse), f"{parts.strip:.3f}"]
            return [*seen, *use(system, parts.solve, inverse, times, before)]
    times.append(process_time())
    with local_factor(matrix) as whole:
        step = inverse if solver == "compact" else None
        return ["1", str(system.cells), "0", "0", *use(system, whole.solve, step, times, before)]


def use(
    system: System,
    solve: Callable[[NDArray[np.float64]], NDArray[np.float64]],
    inverse: NDArray[np.float32] | None,
    times: list[float],
    before: int,
) -> list[str]:
    """Count iterations to the goals, seconds since `times`, bytes a triangle since `before`."""

    def precondition(right: NDArray[np.float64]) -> NDArray[np.float64]:
        found = solve(right)
        if inverse is not None:
            jacobi_step(inverse, WEIGHT, right, system.apply(found), found)
        return found

    times.append(process_time())
    solve(system.right)
    times.append(process_time())
    size = (peak() - before) / system.cells
    taken = []
    for goal in GOALS:
        began = process_time()
        found = refine(system.apply, system.right, precondition, goal=goal, good=goal, steps=60, most=60)
        taken.append(str(found.iterations) if found.residual <= goal else "-")
    seconds = [*np.diff(times), process_time() - began]
    return [*taken, *(f"{value:.3f}" for value in seconds), f"{size:.0f}"]


def forget_peak() -> int:
    """Let the largest size of this process count from now on; return its size in bytes (Linux)."""
    Path("/proc/self/clear_refs").write_text("5", encoding="ascii")
    return peak()


def peak() -> int:
    """Largest size of this process, in bytes."""
    lines = Path("/proc/self/status").read_text(encoding="ascii").splitlines()
    return next(1024 * int(line.split()[1]) for line in lines if line.startswith("VmHWM"))


if __name__ == "__main__":
    main()
