"""Seconds and memory of the first solution of a flow, part by part, against the number of triangles.

Run: python benchmarks/flow_speed.py [--triangles 20000 100000 300000 1000000] [--solver auto]
The array: round pillars on a square grid, 300 triangles each as in a dense plexus, 1.4 times as long as high,
pressure from left to right, mirror lines above and below. Each size runs in a process of its own, after a small flow
that compiles the kernels; seconds are those of the clock, memory is the peak of the process.
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys
from pathlib import Path
from time import perf_counter

import numpy as np

from vasculo.flow.assemble import assemble
from vasculo.flow.boundary import Pressure, Slip
from vasculo.flow.faces import build_faces
from vasculo.flow.stokes import solve_stokes
from vasculo.geometry.domain import Domain
from vasculo.mesh.generate import generate_mesh

SIDES = {"left": Pressure(1.0), "right": Pressure(0.0), "top": Slip(), "bottom": Slip()}
PER_PILLAR = 300
RADIUS = 0.36
HEADS = ("triangles", "mesh", "faces", "assemble", "blocks", "product", "first solve", "solver", "its", "residual",
         "imbalance", "nodes", "peak MB")  # fmt: skip


def main() -> None:
    """Print the table, or one row of it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--triangles", type=int, nargs="+", default=[20_000, 100_000, 300_000, 1_000_000])
    parser.add_argument("--solver", default="auto")
    parser.add_argument("--row", action="store_true", help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    if chosen.row:
        row(chosen.triangles[0], chosen.solver)
        return
    print(("{:>12}" * len(HEADS)).format(*HEADS))
    for wanted in chosen.triangles:
        call = [sys.executable, str(Path(__file__)), "--row", "--triangles", str(wanted), "--solver", chosen.solver]
        subprocess.run(call, check=True)


def array(wanted: int) -> Domain:
    """Domain that a mesh of edge `edge_length(wanted)` cuts into about so many triangles."""
    pillars = max(1.0, wanted / PER_PILLAR)
    rows = max(1, round(np.sqrt(pillars / 1.4)))
    columns = max(1, round(pillars / rows))
    angle = 2 * np.pi * np.arange(24) / 24
    circle = RADIUS * np.column_stack([np.cos(angle), np.sin(angle)])
    places = [circle + np.array([1.0 + i, 0.5 + j]) for i in range(columns) for j in range(rows)]
    return Domain.rectangle(columns + 1.0, rows, places)


def row(wanted: int, solver: str) -> None:
    """Measure one size."""
    solve_stokes(generate_mesh(array(300), 0.15), SIDES, solver=solver).node_velocity()
    domain = array(wanted)
    times = [perf_counter()]

    def lap() -> float:
        times.append(perf_counter())
        return times[-1] - times[-2]

    mesh = generate_mesh(domain, np.sqrt(domain.area / wanted / 0.433))
    meshing = lap()
    flow = solve_stokes(mesh, SIDES, solver=solver)
    solving = lap()
    flow.node_velocity()
    nodes = lap()
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    report, residual, imbalance = flow.report, flow.residual, flow.mass_imbalance
    del flow
    lap()
    faces = build_faces(mesh, SIDES)
    connecting = lap()
    system = assemble(mesh, faces, 1.0, np.zeros((len(mesh.triangles), 2)))
    assembling = lap()
    system.blocks()
    blocking = lap()
    system.apply(system.right)
    print(
        f"{len(mesh.triangles):12d}{meshing:12.3f}{connecting:12.3f}{assembling:12.3f}{blocking:12.3f}{lap():12.4f}"
        f"{solving:12.2f}{report['solver']:>12}{report['iterations']:12d}{residual:12.0e}{imbalance:12.0e}{nodes:12.3f}"
        f"{peak:12.0f}",
        flush=True,
    )


if __name__ == "__main__":
    main()
