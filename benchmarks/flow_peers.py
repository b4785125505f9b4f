"""Accuracy for time: the flow solver, Taylor-Hood elements by scikit-fem, and by NGSolve, on the same meshes.

Run: python -m benchmarks.flow_peers [--arrays round sharp gaps] [--picture docs/images/flow_oracle_peers.png]
CPU seconds of assembly and solution, the best of `--rounds`, kernels compiled before; making the mesh and reading the
numbers are not in the clock. scikit-fem hands its matrix to PARDISO; "SuperLU" is what it does by itself.
NGSolve (pip install ngsolve) runs its own sparse Cholesky factor, for P3/P2 after condensation of the inner unknowns.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from time import process_time
from typing import TYPE_CHECKING, Any, NamedTuple

import ngsolve as ng
import numpy as np
from benchmarks.flow_oracle import SIDES, Numbers, Way, arrays, mesh_of, numbers, reference
from netgen import meshing
from scipy.sparse.linalg import splu
from tests.flow.taylor_hood import taylor_hood

from vasculo.draw.canvas import ACCENT, INK, MUTED, PILLAR_EDGE, new_figure, save
from vasculo.flow.stokes import solve_stokes

if TYPE_CHECKING:
    from collections.abc import Callable

    from vasculo.mesh.triangulation import Triangulation

ALONE = "scikit-fem P2/P1, SuperLU"
SMALL = 20_000  # triangles up to which SuperLU is tried
MESHES = {
    "round": [
        Way("default", 0, {"edge_length": 0.1}),
        Way("two edges a side", 0, {"edge_length": 0.15, "wall_edge_length": 0.04, "grading": 0.35}),
        Way("three edges a side", 0, {"edge_length": 0.12, "wall_edge_length": 0.025, "grading": 0.3}),
    ],
    "sharp": [
        Way("default", 0, {"edge_length": 0.08}),
        Way("curvature 200", 0, {"edge_length": 0.1, "curvature": 200, "grading": 0.5}),
        Way("curvature 1000", 0, {"edge_length": 0.1, "curvature": 1000, "grading": 0.5}),
        Way("curvature 10,000", 0, {"edge_length": 0.08, "curvature": 10_000, "grading": 0.4}),
    ],
}
MESHES["gaps"] = MESHES["sharp"]


class Result(NamedTuple):
    """Of one method on one mesh: what it found, its unknowns and its CPU seconds."""

    found: Numbers
    unknowns: int
    seconds: float


def ours(mesh: Triangulation) -> Result:
    """Solve by the package."""
    began = process_time()
    flow = solve_stokes(mesh, SIDES)
    seconds = process_time() - began
    return Result(numbers(flow), 3 * len(mesh.triangles), seconds)


def by_scikit_fem(mesh: Triangulation, factor: Callable[..., Any] | None = None) -> Result:
    """Solve by P2/P1 of scikit-fem; PARDISO unless another factor is given."""
    began = process_time()
    flow = taylor_hood(mesh, SIDES, factor=factor)
    seconds = process_time() - began
    return Result(numbers(flow), flow.unknowns, seconds)


def by_ngsolve(mesh: Triangulation, degree: int = 2) -> Result:
    """Solve by P2/P1 or P3/P2 of NGSolve."""
    grid = ngsolve_mesh(mesh)
    pillars = "pillar.*"
    began = process_time()
    along = ng.H1(grid, order=degree, dirichlet=pillars)
    across = ng.H1(grid, order=degree, dirichlet=f"{pillars}|left|right|top|bottom")
    space = along * across * ng.H1(grid, order=degree - 1)
    (u, v, p), (a, b, q) = space.TnT()
    system = ng.BilinearForm(space, symmetric=True, condense=degree > 2)
    system += (ng.grad(u) * ng.grad(a) + ng.grad(v) * ng.grad(b)) * ng.dx
    system += (-p * (ng.grad(a)[0] + ng.grad(b)[1]) - q * (ng.grad(u)[0] + ng.grad(v)[1]) - 1e-10 * p * q) * ng.dx
    load = ng.LinearForm(a * ng.ds("left"))
    system.Assemble()
    load.Assemble()
    flow = ng.GridFunction(space)
    if system.condense:
        load.vec.data += system.harmonic_extension_trans * load.vec
    free = space.FreeDofs(system.condense)
    flow.vec.data = system.mat.Inverse(free, inverse="sparsecholesky") * load.vec
    if system.condense:
        flow.vec.data += system.harmonic_extension * flow.vec
        flow.vec.data += system.inner_solve * load.vec
    seconds = process_time() - began
    outward, tangent = ng.specialcf.normal(2), ng.specialcf.tangential(2)
    slope = [ng.BoundaryFromVolumeCF(ng.grad(part)) * outward for part in flow.components[:2]]
    size = ng.Norm(slope[0] * tangent[0] + slope[1] * tangent[1])
    total, around = (
        np.array(ng.Integrate(part, grid, ng.BND, region_wise=True)) for part in (size, ng.CoefficientFunction(1.0))
    )
    mine = [k for k, name in enumerate(grid.GetBoundaries()) if name.startswith("pillar")]
    total, around = total[mine], around[mine]
    rate = ng.Integrate(flow.components[0] * ng.ds("right"), grid)
    return Result(Numbers(rate, total.sum() / around.sum(), total / around), space.ndof, seconds)


def ngsolve_mesh(mesh: Triangulation) -> ng.Mesh:
    """Hand a mesh to NGSolve; pillar k becomes the boundary "pillar<k>"."""
    made = meshing.Mesh(dim=2)
    nodes = [made.Add(meshing.MeshPoint(meshing.Pnt(float(x), float(y), 0.0))) for x, y in mesh.points]
    made.Add(meshing.FaceDescriptor(surfnr=1, domin=1, bc=1))
    for corners in mesh.triangles:
        made.Add(meshing.Element2D(1, [nodes[k] for k in corners]))
    tags = np.unique(mesh.boundary_tags)
    for ends, tag in zip(mesh.boundary_edges, mesh.boundary_tags, strict=True):
        made.Add(meshing.Element1D([nodes[k] for k in ends], index=int(np.searchsorted(tags, tag)) + 1))
    for k, tag in enumerate(tags):
        made.SetBCName(k, mesh.side_names[-1 - tag] if tag < 0 else f"pillar{tag}")
    return ng.Mesh(made)


METHODS: dict[str, Callable[[Triangulation], Result]] = {
    "vasculo": ours,
    "scikit-fem P2/P1": by_scikit_fem,
    ALONE: lambda mesh: by_scikit_fem(mesh, lambda matrix: splu(matrix.tocsc()).solve),
    "NGSolve P2/P1": by_ngsolve,
    "NGSolve P3/P2": lambda mesh: by_ngsolve(mesh, degree=3),
}


def main() -> None:
    """Print the table, and draw it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--arrays", nargs="+", choices=sorted(MESHES), default=list(MESHES))
    parser.add_argument("--rounds", type=int, default=2)
    parser.add_argument("--picture", type=Path)
    chosen = parser.parse_args()
    points = []
    for name in chosen.arrays:
        array = arrays()[name]
        best = reference(name)[0]
        for way in MESHES[name]:
            mesh = mesh_of(array.domain, way)
            for method, solve in METHODS.items():
                if method == ALONE and len(mesh.triangles) > SMALL:
                    continue
                results = [solve(mesh) for _ in range(chosen.rounds)]
                seconds = min(result.seconds for result in results)
                away = results[0].found.away(best)
                points.append((name, method, seconds, away))
                print(
                    f"| {name} | {way.name} | {len(mesh.triangles):,} | {method} | {results[0].unknowns:,} | "
                    f"{seconds:.2f} | {' | '.join(f'{a:+.2f}' for a in away)} |",
                    flush=True,
                )
    if chosen.picture:
        draw(points, chosen.picture)


def draw(points: list[tuple[str, str, float, tuple[float, ...]]], path: Path) -> None:
    """Draw errors in flow rate and mean shear against seconds, an array a column."""
    names = list(dict.fromkeys(name for name, *_ in points))
    figure = new_figure(3.2 * len(names), 5.2)
    panels = figure.subplots(2, len(names), sharex=True, sharey="row", squeeze=False)
    styles = {"vasculo": (ACCENT, "o"), "scikit-fem P2/P1": (PILLAR_EDGE, "s"),
              "NGSolve P2/P1": (MUTED, "^"), "NGSolve P3/P2": (INK, "D")}  # fmt: skip
    for row, what in enumerate(("flow rate", "mean wall shear")):
        for axes, name in zip(panels[row], names, strict=True):
            for method, (colour, marker) in styles.items():
                mine = sorted((seconds, abs(away[row])) for n, m, seconds, away in points if (n, m) == (name, method))
                axes.loglog(*zip(*mine, strict=True), marker=marker, color=colour, lw=1.0, ms=4.5, label=method)
            axes.set_title(f"{name}, {what}", fontsize=8.5, loc="left")
            axes.tick_params(labelsize=7)
            axes.grid(visible=True, lw=0.3)
    for axes in panels[1]:
        axes.set_xlabel("CPU seconds", fontsize=8)
    for axes in panels[:, 0]:
        axes.set_ylabel("off, percent", fontsize=8)
    panels[0, 0].legend(fontsize=6.5)
    save(figure, path)


if __name__ == "__main__":
    main()
