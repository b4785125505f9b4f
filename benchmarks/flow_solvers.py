"""Seconds, memory and accuracy of each linear solver of a flow, phase by phase, against the number of triangles.

Run: python -m benchmarks.flow_solvers [--triangles 20000 100000 300000 1000000] [--solvers direct compact splu]
The dense array is that of `flow_speed`: round pillars, about 280 triangles each. The open one has nine pillars, however
many triangles; there the factors fill more. Each row is a process of its own, after a small flow that compiles the
kernels. Seconds are those of the processor on one thread (`--threads`: of the clock on so many), memory is the peak of
the process. A row that would need more memory than `--memory` gigabytes says so.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
from time import perf_counter, process_time

import numpy as np
from benchmarks.flow_speed import SIDES, array

from vasculo.errors import ComputationError, InputError
from vasculo.flow.assemble import assemble
from vasculo.flow.faces import Faces, build_faces
from vasculo.flow.linear.choose import LEAST
from vasculo.flow.linear.solve import solve
from vasculo.geometry.domain import Domain
from vasculo.mesh.generate import generate_mesh

HEADS = ("array", "triangles", "solver", "analysis", "factor", "krylov", "all", "its", "residual", "imbalance",
         "factor B/cell", "peak MB")  # fmt: skip
EQUILATERAL = 0.433


def main() -> None:
    """Print the table, or one row of it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--triangles", type=int, nargs="+", default=[20_000, 100_000, 300_000, 1_000_000])
    parser.add_argument("--solvers", nargs="+", default=list(LEAST), choices=list(LEAST))
    parser.add_argument("--arrays", nargs="+", default=["dense", "open"], choices=["dense", "open"])
    parser.add_argument("--tolerance", type=float)
    parser.add_argument("--memory", type=float, default=16.0)
    parser.add_argument("--threads", type=int, default=0)
    parser.add_argument("--row", action="store_true", help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    if chosen.row:
        row(chosen)
        return
    print("".join(f"{head:>14}" for head in HEADS))
    number = str(max(1, chosen.threads))
    environment = {**os.environ, "MKL_NUM_THREADS": number, "VASCULO_THREADS": number}
    for name in chosen.arrays:
        for wanted in chosen.triangles:
            for solver in chosen.solvers:
                call = [sys.executable, "-m", "benchmarks.flow_solvers", "--row", "--arrays", name, "--solvers", solver]
                call += ["--triangles", str(wanted), "--memory", str(chosen.memory), "--threads", str(chosen.threads)]
                call += ["--tolerance", str(chosen.tolerance)] if chosen.tolerance else []
                subprocess.run(call, check=True, env=environment)


def open_array() -> Domain:
    """Nine round pillars in a channel, twice as far apart as they are wide."""
    angle = 2 * np.pi * np.arange(30) / 30
    circle = 0.3 * np.column_stack([np.cos(angle), np.sin(angle)])
    places = [circle + np.array([0.8 + 1.5 * i + 0.2 * (j % 2), 0.6 + 1.4 * j]) for i in range(3) for j in range(3)]
    return Domain.rectangle(6.0, 4.0, places)


def row(chosen: argparse.Namespace) -> None:
    """Measure one solver on one mesh."""
    name, wanted, solver = chosen.arrays[0], chosen.triangles[0], chosen.solvers[0]
    clock = perf_counter if chosen.threads else process_time
    small = generate_mesh(array(300), 0.15)
    around = build_faces(small, SIDES)
    solve(assemble(small, around, 1.0, np.zeros((len(small.triangles), 2))), small, solver=solver)
    domain = array(wanted) if name == "dense" else open_array()
    mesh = generate_mesh(domain, np.sqrt(domain.area / wanted / EQUILATERAL))
    faces, cells = build_faces(mesh, SIDES), len(mesh.triangles)
    system = assemble(mesh, faces, 1.0, np.zeros((cells, 2)))
    began = clock()
    try:
        found = solve(system, mesh, solver=solver, tolerance=chosen.tolerance, memory=1e9 * chosen.memory)
    except (InputError, ComputationError) as error:
        print(f"{name:>14}{cells:14d}{solver:>14}  {error}", flush=True)
        return
    seconds = clock() - began
    phases = np.array([found.analysis_seconds, found.factor_seconds, found.krylov_seconds])
    phases *= min(1.0, seconds / phases.sum())  # they are by the clock, which others may have had
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    flux = system.fluxes(found.unknowns)[:, 2]
    print(
        f"{name:>14}{cells:14d}{found.solver:>14}"
        + "".join(f"{part:14.2f}" for part in phases)
        + f"{seconds:14.2f}{found.iterations:14d}{found.residual:14.0e}{imbalance(faces, flux):14.0e}"
        f"{found.factor_bytes / cells:14.0f}{peak:14.0f}",
        flush=True,
    )


def imbalance(faces: Faces, flux: np.ndarray) -> float:
    """Net flux through the boundary or worst balance of a cell, whichever is greater, over the flow that passes."""
    inner, cells = faces.inner, int(faces.cells.max()) + 1
    balance = np.bincount(faces.cells[:, 0], flux, cells) - np.bincount(faces.cells[:inner, 1], flux[:inner], cells)
    rim = flux[inner:]
    return float(max(abs(rim.sum()), np.abs(balance).max()) / max(0.5 * np.abs(rim).sum(), np.abs(flux).max()))


if __name__ == "__main__":
    main()
