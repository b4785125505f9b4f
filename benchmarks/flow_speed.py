"""CPU seconds of the parts of a flow solution against the number of triangles.

Run: python benchmarks/flow_speed.py [--triangles 5000 30000 120000]
The array is open: a strip of round pillars on a square grid, pressure from left to right, mirror lines above and below.
The first line is a warm-up on a small mesh and shows the compile time (none if the kernels are cached).
"""

from __future__ import annotations

import argparse
import resource
from time import process_time
from typing import TYPE_CHECKING

import numpy as np

from vasculo.flow.assemble import assemble
from vasculo.flow.boundary import Pressure, Slip
from vasculo.flow.faces import build_faces
from vasculo.flow.fits.tables import face_tables
from vasculo.flow.linear.solve import solve
from vasculo.flow.stokes import solve_stokes
from vasculo.geometry.domain import Domain
from vasculo.mesh.generate import generate_mesh

if TYPE_CHECKING:
    from vasculo.mesh.triangulation import Triangulation

SIDES = {"left": Pressure(1.0), "right": Pressure(0.0), "top": Slip(), "bottom": Slip()}
ROWS = 4


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--triangles", type=int, nargs="+", default=[5_000, 30_000, 120_000])
    chosen = parser.parse_args()
    heads = (
        "triangles",
        "faces",
        "face fits",
        "assembly",
        "solve",
        "solver",
        "its",
        "residual",
        "nodes",
        "all",
        "peak MB",
    )
    print(("{:>10}" * len(heads)).format(*heads))
    for wanted in [500, *chosen.triangles]:
        _row(_array(wanted))


def _array(wanted: int) -> Triangulation:
    """Mesh with about this many triangles, 300 a pillar as in a dense plexus."""
    columns = max(1, round(wanted / 300 / ROWS))
    angle = 2 * np.pi * np.arange(24) / 24
    circle = 0.36 * np.column_stack([np.cos(angle), np.sin(angle)])
    pillars = [circle + np.array([1.0 + i, 0.5 + j]) for i in range(columns) for j in range(ROWS)]
    edge = np.sqrt((ROWS * (columns + 1) - 0.41 * columns * ROWS) / wanted / 0.433)
    return generate_mesh(Domain.rectangle(columns + 1.0, ROWS, pillars), edge)


def _row(mesh: Triangulation) -> None:
    """Time each part once."""
    _ = mesh.neighbours, mesh.areas, mesh.centroids
    times = [process_time()]
    faces = build_faces(mesh, SIDES)
    times.append(process_time())
    face_tables(mesh, faces, faces.opening)
    times.append(process_time())
    system = assemble(mesh, faces, 1.0, np.zeros((len(mesh.triangles), 2)))
    times.append(process_time())
    solution = solve(system.blocks(np.float64), system.right)
    times.append(process_time())
    flow = solve_stokes(mesh, SIDES)
    times.append(process_time())
    flow.node_velocity()
    times.append(process_time())
    connect, fits, both, solving, everything, nodes = np.diff(times)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(
        f"{len(mesh.triangles):10d}{connect:10.3f}{fits:10.3f}{both - fits:10.3f}{solving:10.3f}{solution.solver:>10}"
        f"{solution.iterations:10d}{solution.residual:10.0e}{nodes:10.3f}{everything:10.3f}{peak:10.0f}"
    )


if __name__ == "__main__":
    main()
