"""Convergence of the flow solver to manufactured solutions, on three kinds of mesh.

Run: python -m benchmarks.flow_convergence [--finest 119] [--levels 4] [--order 2] [--seed 2]
[--plot docs/images/flow_convergence.png] [--slivers 200]
"""

from __future__ import annotations

import argparse
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from tests.flow.exact import AT_REST, MOVING, errors
from tests.flow.meshes import scattered

from vasculo.flow.boundary import Velocity
from vasculo.flow.stokes import solve_stokes
from vasculo.geometry.domain import Domain
from vasculo.mesh.generate import generate_mesh

if TYPE_CHECKING:
    from collections.abc import Callable
    from types import SimpleNamespace

    from vasculo.mesh.triangulation import Triangulation

NAMES = ("u", "p", "u at nodes", "wall shear", "its maximum")
PROBLEMS = {"velocity given all around": MOVING, "walls at rest, body force": AT_REST}


def main() -> None:
    """Print the tables, and draw them if asked to."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--finest", type=int, default=119, help="edges along a side of the finest mesh")
    parser.add_argument("--levels", type=int, default=4, help="meshes, each twice as fine as the one before")
    parser.add_argument("--order", type=int, default=2, choices=(1, 2), help="of the face fits")
    parser.add_argument("--seed", type=int, default=2, help="of the random points")
    parser.add_argument("--plot", help="file of a picture of the errors")
    parser.add_argument("--slivers", type=int, help="instead: the scatter of the errors on so many raw random meshes")
    chosen = parser.parse_args()
    if chosen.slivers:
        _scatter(chosen.slivers, chosen.order)
        return
    across = [round(chosen.finest / 2**k) for k in range(chosen.levels - 1, -1, -1)]
    found = {}
    for kind, make in _kinds(chosen.seed).items():
        meshes = [make(n) for n in across]
        print(f"\n{kind}, smallest angle {min(_smallest_angle(mesh) for mesh in meshes):.2g} degrees")
        for problem, exact in PROBLEMS.items():
            rows = [_errors(mesh, exact, chosen.order) for mesh in meshes]
            found[kind, problem] = np.array([len(mesh.triangles) for mesh in meshes]), np.array(rows)
            _table(problem, *found[kind, problem])
    if chosen.plot:
        _plot(found, chosen.plot)


def _kinds(seed: int) -> dict[str, Callable[[int], Triangulation]]:
    """Mesh makers of the unit square, from the number of edges along a side."""
    return {
        "random points, evened out": partial(scattered, seed=seed, sweeps=25),
        "the package's mesher": lambda across: generate_mesh(Domain.rectangle(1.0, 1.0), 1.0 / across),
        "raw random points": partial(scattered, seed=seed),
    }


def _errors(mesh: Triangulation, exact: SimpleNamespace, order: int) -> list[float]:
    """Errors of one flow, in the order of `NAMES`."""
    sides = dict.fromkeys(mesh.side_names, Velocity(exact.u, exact.v)) if exact is MOVING else {}
    return errors(mesh, solve_stokes(mesh, sides, force=exact.body_force, order=order), exact)


def _scatter(number: int, order: int) -> None:
    """Print how the errors scatter over raw random meshes of some 440 triangles, walls at rest."""
    rows = np.array([_errors(scattered(14, seed), AT_REST, order) for seed in range(number)])
    middle = np.median(rows, axis=0)
    for name, column, usual in zip(NAMES, rows.T, middle, strict=True):
        print(f"{name}: median {usual:.1e}, 9 of 10 below {np.quantile(column, 0.9):.1e}, largest {column.max():.1e}, "
              f"{np.count_nonzero(column > 3.0 * usual)} of {number} over three times the median")  # fmt: skip


def _smallest_angle(mesh: Triangulation) -> float:
    """Smallest angle of a mesh in degrees."""
    corners = mesh.points[mesh.triangles]
    length = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    sine = 2.0 * mesh.areas[:, None] * length / length.prod(axis=1)[:, None]
    return float(np.degrees(np.arcsin(np.clip(sine, 0.0, 1.0)).min()))


def _table(problem: str, cells: np.ndarray, rows: np.ndarray) -> None:
    """Print errors with the slope from level to level, and over all, against the edge length from the triangles."""
    names = NAMES[: rows.shape[1]]
    edge = -0.5 * np.log(cells)
    print(f"\n| {problem} | " + " | ".join(names) + " |")
    print("|---" * (len(names) + 1) + "|")
    for k, (number, row) in enumerate(zip(cells, rows, strict=True)):
        cell = [f"{error:.2e}" for error in row]
        if k:
            slope = np.log(row / rows[k - 1]) / (edge[k] - edge[k - 1])
            cell = [f"{text} ({s:.2f})" for text, s in zip(cell, slope, strict=True)]
        print(f"| {number} | " + " | ".join(cell) + " |")
    if len(cells) > 1:
        slopes = np.polyfit(edge, np.log(rows), 1)[0]
        print("| slope | " + " | ".join(f"{s:.2f}" for s in slopes) + " |")


def _plot(found: dict[tuple[str, str], tuple[np.ndarray, np.ndarray]], path: str) -> None:
    """Errors against the edge length, a panel a kind of mesh."""
    from matplotlib.figure import Figure  # noqa: PLC0415 - only for pictures

    kinds = list(dict.fromkeys(kind for kind, _ in found))
    figure = Figure(figsize=(10.5, 4.6), layout="constrained")
    panels = figure.subplots(1, len(kinds), sharey=True, sharex=True)
    for panel, kind in zip(panels, kinds, strict=True):
        for problem, style in zip(PROBLEMS, ("o--", "o-"), strict=True):
            cells, rows = found[kind, problem]
            for column, colour in ((0, "tab:blue"), (1, "tab:orange"), (3, "tab:green")):
                if column < rows.shape[1]:
                    label = f"{NAMES[column]}, {problem.split(',')[0]}"
                    panel.loglog(cells, rows[:, column], style, color=colour, ms=4, label=label)
        share = cells[[0, -1]] / cells[0]
        panel.loglog(cells[[0, -1]], 0.2 / share, "k:", lw=1, label="order 2")
        panel.loglog(cells[[0, -1]], 4e-5 / share**1.5, "k-.", lw=1, label="order 3")
        panel.set_title(kind, fontsize=10)
        panel.set_xlabel("triangles")
        panel.grid(visible=True, which="major", alpha=0.3)
    panels[0].set_ylabel("error, L2 or root mean square")
    figure.legend(*panels[0].get_legend_handles_labels(), fontsize=8, loc="outside lower center", ncols=4)
    figure.savefig(path, dpi=150)


if __name__ == "__main__":
    main()
