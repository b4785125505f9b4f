"""Flow through random arrays against Taylor-Hood elements: round pillars, sharp ones, sharp ones with narrow gaps.

Run: python -m benchmarks.flow_oracle [--arrays round plexus sharp gaps] [--picture docs/images/flow_oracle.png]
The reference of each array is P3/P2 on a mesh graded into all corners, its error the difference to a coarser one. All
arrays: pressure from left to right, mirror lines above and below. Memory up to 3 GB.
"""

from __future__ import annotations

import argparse
from functools import cache
from pathlib import Path
from time import process_time
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import shapely
from tests.flow.taylor_hood import TaylorHood, taylor_hood

from vasculo.flow.boundary import Pressure, Slip
from vasculo.flow.stokes import Flow, solve_stokes
from vasculo.geometry.domain import Domain
from vasculo.mesh.generate import generate_mesh
from vasculo.plexus.voronoi import BLOCK_ASPECT, _cells, voronoi_plexus

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.mesh.triangulation import Triangulation

    Floats = NDArray[np.float64]

SIDES = {"left": Pressure(1.0), "right": Pressure(0.0), "top": Slip(), "bottom": Slip()}
SHARP = 30.0  # a pillar that turns by more degrees than this at a node has a sharp corner there
RATIO = 0.4  # of one level of grading to the next


class Numbers(NamedTuple):
    """What is compared: flow rate, mean size of the wall shear over all pillars, and of each pillar."""

    flow_rate: float
    mean_shear: float
    pillar_shear: Floats

    def away(self, reference: Numbers) -> tuple[float, float, float, float]:
        """Differences in percent: flow rate, mean shear, worst pillar, root mean square of the pillars."""
        pillars = 100.0 * (self.pillar_shear / reference.pillar_shear - 1.0)
        return (
            100.0 * (self.flow_rate / reference.flow_rate - 1.0),
            100.0 * (self.mean_shear / reference.mean_shear - 1.0),
            float(np.abs(pillars).max()),
            float(np.sqrt(np.mean(pillars**2))),
        )


class Way(NamedTuple):
    """A mesh: its name, the levels of grading into sharp corners, and the arguments of `generate_mesh`."""

    name: str
    levels: int
    options: dict[str, float]


class Array(NamedTuple):
    """An array, the two meshes of its reference (the better one last), and the meshes that are judged."""

    domain: Domain
    references: tuple[Way, Way]
    ways: list[Way]


def numbers(flow: Flow | TaylorHood) -> Numbers:
    """Take the numbers from a flow."""
    mesh = flow.mesh
    pillars = mesh.boundary_tags >= 0
    owner = mesh.boundary_tags[pillars]
    lengths = np.hypot(*np.diff(mesh.points[mesh.boundary_edges[pillars]], axis=1)[:, 0].T)
    around = np.bincount(owner, lengths)
    if isinstance(flow, Flow):
        each = np.bincount(owner, lengths * np.abs(flow.wall_shear[flow.wall_pillar >= 0])) / around
    else:
        each = flow.pillar_shear()
    return Numbers(flow.flow_rate("right"), float(each @ around / around.sum()), each)


def round_array(corners: int = 30, columns: int = 10, rows: int = 10, seed: int = 5) -> Domain:
    """Regular polygons of radius 0.28 to 0.40 on a grid of spacing 1, each moved a little."""
    rng = np.random.default_rng(seed)
    pillars = []
    for i in range(columns):
        for j in range(rows):
            radius = rng.uniform(0.28, 0.40)
            centre = np.array([1.5 + i, 0.5 + j]) + rng.uniform(-1.0, 1.0, 2) * min(0.08, 0.47 - radius)
            pillars.append(centre + radius * _circle(rng.uniform(0.0, 6.0) + 2 * np.pi * np.arange(corners) / corners))
    return Domain.rectangle(columns + 2.0, rows, pillars)


def sharp_array(columns: int = 6, rows: int = 5, seed: int = 3, gap: float = 0.06) -> Domain:
    """Irregular polygons of 5 to 8 corners, at least `gap` apart."""
    rng = np.random.default_rng(seed)
    pillars: list[Floats] = []
    for i in range(columns):
        for j in range(rows):
            near = shapely.MultiPolygon([shapely.Polygon(p) for p in pillars])
            while True:
                pillar = irregular(rng, np.array([1.5 + i, 0.5 + j]) + rng.uniform(-0.08, 0.08, 2))
                inside = gap / 2 <= pillar[:, 1].min() and pillar[:, 1].max() <= rows - gap / 2
                if inside and not near.distance(shapely.Polygon(pillar)) <= gap:
                    break
            pillars.append(pillar)
    return Domain.rectangle(columns + 2.0, rows, pillars)


def irregular(rng: np.random.Generator, centre: Floats) -> Floats:
    """Make a polygon of 5 to 8 corners, 0.3 to 0.5 from its centre."""
    corners = rng.integers(5, 9)
    angle = 2 * np.pi * (np.arange(corners) + rng.uniform(-0.3, 0.3, corners)) / corners + rng.uniform(0.0, 6.0)
    return np.asarray(centre + rng.uniform(0.30, 0.50, corners)[:, None] * _circle(angle))


def narrow_array(pillars: int = 16, gap: float = 0.25, seed: int = 1) -> Domain:
    """Voronoi cells with sharp corners, parted by straight channels of one width (mean radius of a pillar about 1)."""
    block = 1.9 * np.sqrt(pillars * np.array([BLOCK_ASPECT, 1.0 / BLOCK_ASPECT]))
    outlines = []
    for cell in _cells(pillars, block, np.random.default_rng(seed)):
        shape = shapely.Polygon(cell).buffer(-0.5 * gap, join_style="mitre", mitre_limit=10.0).simplify(0.08)
        outlines.append(np.asarray(shape.exterior.coords)[:-1] + np.array([1.5, 0.0]))
    return Domain.rectangle(float(block[0] + 3.0), float(block[1]), outlines)


def graded(domain: Domain, levels: int) -> Domain:
    """Give the pillars more nodes beside their sharp corners, at half a side times `RATIO` to the power 1, 2, ..."""
    if levels == 0:
        return domain
    steps = 0.5 * RATIO ** np.arange(levels, 0, -1)
    pillars = []
    for outline in domain.pillars:
        side = np.roll(outline, -1, axis=0) - outline
        before = np.roll(side, 1, axis=0)
        turn = np.arctan2(before[:, 0] * side[:, 1] - before[:, 1] * side[:, 0], (before * side).sum(axis=1))
        sharp = turn > np.radians(SHARP)
        nodes = []
        for k, corner in enumerate(outline):
            first = steps if sharp[k] else steps[:0]
            last = 1.0 - steps[::-1] if sharp[(k + 1) % len(outline)] else steps[:0]
            nodes.append(corner + np.concatenate([[0.0], first, last])[:, None] * side[k])
        pillars.append(np.concatenate(nodes))
    return domain.with_pillars(pillars)


def mesh_of(domain: Domain, way: Way) -> Triangulation:
    """Mesh a domain in a way."""
    return generate_mesh(graded(domain, way.levels), **way.options)


@cache
def arrays() -> dict[str, Array]:
    """All arrays by name."""
    smooth = [
        Way("default", 0, {"edge_length": 0.065}),
        Way("two edges a side", 0, {"edge_length": 0.15, "wall_edge_length": 0.04, "grading": 0.35}),
        Way("the same, finer inside", 0, {"edge_length": 0.15, "wall_edge_length": 0.04}),
        Way("curvature 60", 0, {"edge_length": 0.2, "curvature": 60, "grading": 0.35}),
        Way("default", 0, {"edge_length": 0.045}),
    ]
    corners = [
        Way("default", 0, {"edge_length": 0.1}),
        Way("default", 0, {"edge_length": 0.05}),
        Way("fine walls", 0, {"edge_length": 0.1, "wall_edge_length": 0.025}),
        Way("curvature 200", 0, {"edge_length": 0.1, "curvature": 200, "grading": 0.5}),
        Way("curvature 1000", 0, {"edge_length": 0.1, "curvature": 1000, "grading": 0.5}),
        Way("0.4^4", 4, {"edge_length": 0.1, "grading": 0.35}),
        Way("0.4^6", 6, {"edge_length": 0.1, "grading": 0.5}),
    ]
    smooth_references = (
        Way("", 0, {"edge_length": 0.15, "wall_edge_length": 0.045, "grading": 0.35}),
        Way("", 0, {"edge_length": 0.15, "wall_edge_length": 0.03, "grading": 0.35}),
    )
    corner_references = (
        Way("", 8, {"edge_length": 0.2, "across": 4, "grading": 0.5}),
        Way("", 11, {"edge_length": 0.2, "across": 4, "grading": 0.5}),
    )
    plexus = [
        Way("default", 0, {"edge_length": 0.18}),
        Way("three across", 0, {"edge_length": 0.18, "across": 3}),
        Way("two edges a side", 0, {"edge_length": 0.18, "wall_edge_length": 0.1, "grading": 0.35}),
        Way("curvature 60", 0, {"edge_length": 0.18, "curvature": 60, "grading": 0.35}),
        Way("default, fine", 0, {"edge_length": 0.1}),
    ]
    plexus_references = (
        Way("", 0, {"edge_length": 0.12, "wall_edge_length": 0.1}),
        Way("", 0, {"edge_length": 0.12, "wall_edge_length": 0.065, "grading": 0.35}),
    )
    return {
        "round": Array(round_array(), smooth_references, smooth),
        "rounder": Array(round_array(60), smooth_references, smooth),
        "plexus": Array(voronoi_plexus(100, channel=0.58, pad=1.5), plexus_references, plexus),
        "sharp": Array(sharp_array(), corner_references, corners),
        "gaps": Array(narrow_array(), corner_references, corners),
    }


@cache
def reference(name: str) -> tuple[Numbers, tuple[float, float, float, float], int]:
    """Solve an array by P3/P2: the numbers, what a coarser mesh is away from them in percent, and the unknowns."""
    array = arrays()[name]
    coarse, fine = (taylor_hood(mesh_of(array.domain, way), SIDES, degree=3) for way in array.references)
    best = numbers(fine)
    return best, numbers(coarse).away(best), fine.unknowns


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--arrays", nargs="+", choices=sorted(arrays()), default=list(arrays()))
    parser.add_argument("--picture", type=Path, help="where to draw the sharp array")
    chosen = parser.parse_args()
    for name in chosen.arrays:
        array = arrays()[name]
        best, doubt, unknowns = reference(name)
        corners = sum(len(pillar) for pillar in array.domain.pillars)
        print(
            f"{name}: {len(array.domain.pillars)} pillars, {corners} corners, fluid "
            f"{array.domain.area / np.prod(array.domain.bounds[2:]):.3f}; reference of {unknowns} unknowns, flow rate "
            f"{best.flow_rate:.6g}, mean shear {best.mean_shear:.6g}, in doubt by {_percent(doubt)}"
        )
        for way in array.ways:
            mesh = mesh_of(array.domain, way)
            began = process_time()
            flow = solve_stokes(mesh, SIDES)
            _row(way.name, len(mesh.triangles), process_time() - began, numbers(flow).away(best))
            if way is array.ways[0]:
                began = process_time()
                other = taylor_hood(mesh, SIDES)
                _row("Taylor-Hood", len(mesh.triangles), process_time() - began, numbers(other).away(best))


def _row(name: str, triangles: int, seconds: float, away: tuple[float, ...]) -> None:
    print(f"| {name} | {triangles:,} | {seconds:.2f} | {' | '.join(f'{a:+.2f}' for a in away)} |", flush=True)


def _percent(away: tuple[float, ...]) -> str:
    return ", ".join(f"{a:+.3f}" for a in away) + " % (flow rate, mean shear, worst pillar, rms of pillars)"


def _circle(angle: Floats) -> Floats:
    return np.column_stack([np.cos(angle), np.sin(angle)])


if __name__ == "__main__":
    main()
