"""Flow on ugly meshes: ten arrays of seven sharp pillars, corners graded by 0 to 6 levels, three kinds of mesh.

Run: python -m benchmarks.flow_stress [--kinds jumps raw own] [--constants] [--picture docs/images/flow_stress.png]
"jumps": triangles by Shewchuk's Triangle with angles down to 5 degrees, and patches six times finer than what is
around them; "raw": Delaunay triangles of random points, not relaxed; "own": the package's mesher at its steepest
grading. A mesh is bad where flow rate or mean shear are more than 10 % off P3/P2 on a fine mesh, a speed is above 1.3
times the largest that P3/P2 has in the same triangles, or a pressure away from corners is off by half the drop.
`--constants` runs the same meshes with other constants of the scheme, each in a process that compiles the kernels anew.
"""

from __future__ import annotations

import argparse
import os
import pickle
import subprocess
import sys
import tempfile
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import shapely
import triangle
from benchmarks.flow_oracle import SIDES, Numbers, Way, graded, irregular, mesh_of, numbers
from numba import njit
from scipy.spatial import cKDTree
from tests.flow.taylor_hood import taylor_hood

from vasculo.draw.canvas import INK, SHEAR, new_figure, panel, save
from vasculo.errors import ComputationError
from vasculo.flow import assemble
from vasculo.flow.fits import data, functionals, rows
from vasculo.flow.stokes import Flow, solve_stokes
from vasculo.geometry.domain import Domain
from vasculo.mesh.generate import generate_mesh
from vasculo.mesh.quality import smallest_angles
from vasculo.mesh.triangulation import Triangulation

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

ARRAYS, LEVELS, KINDS = range(10), (0, 2, 4, 6), ("jumps", "raw", "own")
WIDTH, HEIGHT, GAP, EDGE = 4.4, 3.0, 0.05, 0.07
JUMP = 6  # times finer patches
MARK = 100  # lifts the tags of edges: to the mesher zero means none
CONSTANTS = {
    "SMOOTHING": (0.3, 1.0, 2.0, 4.0, 10.0),
    "FADING": (1.0, 1.5),
    "ALPHA": (1.5,),
    "RIM_ALPHA": (1.0, 2.0),
    "INNER_SHARE": (-100.0, 0.3, 0.7),
    "RIM_SHARE": (-100.0, 0.5, 1.0),
    "WALL_WEIGHT": (1.0, 4.0),
    "FRONT": (0.0, 0.6),
}


class Case(NamedTuple):
    """A mesh, and what P3/P2 gives: the numbers on a fine mesh, speed and pressure in the same triangles.

    `smooth` are triangles farther than an edge length from all corners, where the pressure has no singularity.
    """

    kind: str
    array: int
    levels: int
    mesh: Triangulation
    best: Numbers
    top_speed: float
    pressure: Floats
    smooth: NDArray[np.bool_]


class Verdict(NamedTuple):
    """Of a flow: percent off in flow rate and mean shear, and three signs of oscillation.

    `speed`: largest speed over that of P3/P2; `beyond`: largest difference in pressure away from corners, over the
    drop; `checkers`: part of that difference that a triangle does not share with its neighbours, root mean square.
    """

    flow_rate: float
    mean_shear: float
    speed: float
    beyond: float
    checkers: float

    @property
    def bad(self) -> bool:
        """Whether any of them is too large."""
        off = max(abs(self.flow_rate), abs(self.mean_shear))
        return not (off <= 10.0 and self.speed <= 1.3 and self.beyond <= 0.5)


def judge(case: Case, flow: Flow) -> Verdict:
    """Compare a flow with what P3/P2 gives."""
    flow_rate, mean_shear, _, _ = numbers(flow).away(case.best)
    off = flow.pressure - case.pressure
    inside = case.smooth & (case.mesh.neighbours >= 0).all(axis=1)
    alone = off[inside] - off[case.mesh.neighbours[inside]].mean(axis=1)
    speed = float(np.hypot(*flow.velocity.T).max()) / case.top_speed
    return Verdict(
        flow_rate, mean_shear, speed, float(np.abs(off[case.smooth]).max()), float(np.sqrt(np.mean(alone**2)))
    )


def seven_pillars(seed: int) -> Domain:
    """Seven irregular polygons at random places."""
    rng = np.random.default_rng(seed)
    pillars: list[Floats] = []
    while len(pillars) < 7:
        pillar = irregular(rng, rng.uniform([1.2, 0.5], [WIDTH - 1.2, HEIGHT - 0.5]))
        near = shapely.MultiPolygon([shapely.Polygon(p) for p in pillars])
        inside = pillar[:, 1].min() > GAP and pillar[:, 1].max() < HEIGHT - GAP
        if inside and not near.distance(shapely.Polygon(pillar)) <= GAP:
            pillars.append(pillar)
    return Domain.rectangle(WIDTH, HEIGHT, pillars)


def ugly_mesh(domain: Domain, kind: str, seed: int) -> Triangulation:
    """Mesh without any grading but that of the outlines."""
    rng = np.random.default_rng(seed)
    fluid = shapely.Polygon(domain.outer, domain.pillars).buffer(-0.15 * EDGE)
    density = 1.0 / (0.87 * EDGE**2)
    points = rng.uniform([0.0, 0.0], [WIDTH, HEIGHT], (round(density * WIDTH * HEIGHT), 2))
    if kind == "jumps":
        for centre in rng.uniform([1.0, 0.5], [WIDTH - 1.0, HEIGHT - 0.5], (3, 2)):
            corner, step = centre - 0.3, EDGE / JUMP
            patch = corner + step * np.stack(np.mgrid[0.0 : 0.6 / step, 0.0 : 0.6 / step], axis=-1).reshape(-1, 2)
            points = points[np.abs(points - centre).max(axis=1) > 0.3 + 0.3 * step]
            points = np.concatenate([points, patch + rng.uniform(-0.3, 0.3, patch.shape) * step])
    points = points[shapely.contains_xy(fluid, *points.T)]
    nodes, segments, tags, count = [points], [], [], len(points)
    for k, ring in enumerate([*domain.pillars, domain.outer]):
        ends = np.roll(ring, -1, axis=0)
        for j, (start, end) in enumerate(zip(ring, ends, strict=True)):
            pieces = max(1, round(float(np.hypot(*(end - start))) / EDGE))
            nodes.append(start + np.linspace(0.0, 1.0, pieces, endpoint=False)[:, None] * (end - start))
            tag = k if k < len(domain.pillars) else -1 - domain.side_names.index(domain.sides[j])
            tags += [tag] * pieces
        total = sum(map(len, nodes)) - count
        around = count + np.arange(total)
        segments.append(np.column_stack([around, np.roll(around, -1)]))
        count += total
    holes = [shapely.Polygon(p).representative_point().coords[0] for p in domain.pillars]
    made = triangle.triangulate(
        {
            "vertices": np.concatenate(nodes),
            "segments": np.concatenate(segments),
            "segment_markers": np.array(tags)[:, None] + MARK,
            "holes": np.array(holes),
        },
        "pjq5" if kind == "jumps" else "pj",
    )
    directed = made["triangles"][:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2).astype(np.int64)
    there, back = directed @ [count**2, 1], directed @ [1, count**2]
    edges = directed[~np.isin(there, back)]
    order = np.argsort(np.sort(made["segments"], axis=1) @ [count**2, 1])
    tags_of = made["segment_markers"].ravel()[order] - MARK
    edges = edges[np.argsort(np.sort(edges, axis=1) @ [count**2, 1])]
    return Triangulation(made["vertices"], made["triangles"], edges, tags_of, domain.side_names)


def build_cases(kinds: list[str]) -> list[Case]:
    """Make all meshes, and solve on them by P3/P2."""
    found = []
    for k in ARRAYS:
        domain = seven_pillars(k)
        fine = Way("", 9, {"edge_length": 0.2, "across": 4, "grading": 0.5})
        corners = cKDTree(np.concatenate(domain.pillars))
        best = numbers(taylor_hood(mesh_of(domain, fine), SIDES, degree=3))
        for kind, levels in product(kinds, LEVELS):
            around = graded(domain, levels)
            mesh = generate_mesh(around, EDGE, grading=0.5) if kind == "own" else ugly_mesh(around, kind, k)
            velocity, pressure = taylor_hood(mesh, SIDES, degree=3).at_centroids()
            smooth = corners.query(mesh.centroids)[0] > EDGE
            found.append(Case(kind, k, levels, mesh, best, float(np.hypot(*velocity.T).max()), pressure, smooth))
    return found


def set_constant(name: str, value: float) -> None:
    """Change a constant of the scheme wherever it is known, before any kernel of the flow is compiled."""
    if name == "FADING":
        data.fading = njit(lambda away: away**-value)
        return
    knowing = [module for module in (assemble, data, functionals, rows) if hasattr(module, name)]
    if not knowing:
        raise ValueError(f"the scheme has no constant {name}")
    for module in knowing:
        setattr(module, name, value)


def verdicts(cases: list[Case]) -> list[Verdict]:
    """Solve and judge; a flow that could not be solved is off by everything."""
    found = []
    for case in cases:
        try:
            found.append(judge(case, solve_stokes(case.mesh, SIDES)))
        except ComputationError:
            found.append(Verdict(*[np.inf] * 5))
    return found


def print_row(name: str, cases: list[Case], found: list[Verdict]) -> None:
    """Print counts and sizes, all levels of grading together; accuracy as root mean square over graded meshes."""
    bad = [sum(v.bad for v, c in zip(found, cases, strict=True) if c.kind == kind) for kind in KINDS]
    table = np.array(found)
    fine = table[[c.levels > 2 and c.kind == "own" for c in cases], :2]
    worst = [*np.abs(table[:, :2]).max(axis=0), *table[:, 2:].max(axis=0)]
    print(
        f"| {name} | {' | '.join(map(str, bad))} | {' | '.join(f'{w:.3g}' for w in worst)} | "
        f"{' | '.join(f'{x:.2f}' for x in np.sqrt(np.mean(fine**2, axis=0)))} |",
        flush=True,
    )


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kinds", nargs="+", choices=KINDS, default=list(KINDS))
    parser.add_argument("--constants", action="store_true", help="run other values of the constants too")
    parser.add_argument("--picture", type=Path, help="where to draw the pressure on the worst mesh")
    parser.add_argument("--cases", type=Path, help=argparse.SUPPRESS)
    parser.add_argument("--set", nargs=2, help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    if chosen.set:
        set_constant(chosen.set[0], float(chosen.set[1]))
        cases = pickle.loads(chosen.cases.read_bytes())  # noqa: S301  # written by the process that called this one
        print_row(" ".join(chosen.set), cases, verdicts(cases))
        return
    cases = build_cases(chosen.kinds)
    found = verdicts(cases)
    for kind, levels in product(chosen.kinds, LEVELS):
        mine = [k for k, case in enumerate(cases) if (case.kind, case.levels) == (kind, levels)]
        size = np.mean([len(cases[k].mesh.triangles) for k in mine])
        angle = min(smallest_angles(cases[k].mesh.points, cases[k].mesh.triangles).min() for k in mine)
        table = np.abs([found[k] for k in mine])
        middle, worst = np.median(table[:, :2], axis=0), table.max(axis=0)
        print(
            f"| {kind} | {levels} | {size:.0f} | {angle:.2f} | {sum(found[k].bad for k in mine)} | "
            f"{middle[0]:.2f} | {worst[0]:.2f} | {middle[1]:.2f} | {worst[1]:.2f} | "
            f"{' | '.join(f'{w:.3g}' for w in worst[2:])} |",
            flush=True,
        )
    print_row("as they are", cases, found)
    if chosen.constants:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "cases"
            path.write_bytes(pickle.dumps(cases))
            for name, values in CONSTANTS.items():
                for value in values:
                    call = [sys.executable, "-m", "benchmarks.flow_stress", "--cases", str(path)]
                    kept = {**os.environ, "NUMBA_CACHE_DIR": f"{folder}/{name}{value}"}
                    subprocess.run([*call, "--set", name, str(value)], check=True, env=kept)
    if chosen.picture:
        draw(cases, found, chosen.picture)


def draw(cases: list[Case], found: list[Verdict], path: Path) -> None:
    """Draw the pressure around the worst triangle of the worst mesh of each kind, and that of P3/P2."""
    kinds = list(dict.fromkeys(case.kind for case in cases))
    figure = new_figure(6.4, 3.0 * len(kinds))
    panels = figure.subplots(len(kinds), 2, squeeze=False)
    for pair, kind in zip(panels, kinds, strict=True):
        mine = [k for k, case in enumerate(cases) if case.kind == kind]
        case = cases[max(mine, key=lambda k: found[k].beyond)]
        mesh, pressure = case.mesh, solve_stokes(case.mesh, SIDES).pressure
        x, y = mesh.centroids[np.argmax(np.abs(pressure - case.pressure) * case.smooth)]
        box = (x - 1.5 * EDGE, y - 1.5 * EDGE, x + 1.5 * EDGE, y + 1.5 * EDGE)
        names = (f"{kind}, {case.levels} levels:", "the same, P3/P2:")
        for axes, values, name in zip(pair, (pressure, case.pressure), names, strict=True):
            axes.tripcolor(*mesh.points.T, mesh.triangles, facecolors=values, edgecolors=INK, lw=0.3, cmap=SHEAR,
                           vmin=-0.5, vmax=1.5)  # fmt: skip
            panel(axes, box, f"{name} {values.min():.2g} to {values.max():.2g}")
    save(figure, path)


if __name__ == "__main__":
    main()
