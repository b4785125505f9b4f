"""Repair of a mesh against a mesh made anew: time and quality after one move and after many.

Run with `python benchmarks/repair.py [moves]`; every pillar moves by a tenth of the edge length in a random direction.
"""

import sys
import time

import numpy as np
from mesh import plexus

from vasculo.errors import InputError
from vasculo.geometry.domain import Domain
from vasculo.mesh.generate import generate_mesh
from vasculo.mesh.repair.repair import repair_mesh
from vasculo.mesh.repair.transfer import transfer
from vasculo.mesh.triangulation import Triangulation

CASES = (
    (100, 0.055, None, 0.0),
    (100, 0.075, 0.04, 3.0),
    (1000, 0.18, None, 0.0),
    (1000, 0.24, 0.12, 2.0),
)
"""Pillars, edge length, wall edge length, triangles across: about 200,000 triangles each."""

REPEATS = 7
"""Timings of each, in turns; the shortest counts."""

SHARE = 0.1
"""Move over edge length."""


def moved(domain: Domain, length: float, rng: np.random.Generator) -> Domain:
    """Move all pillars by a length, each in its direction; draws again when they would touch."""
    while True:
        angles = 2.0 * np.pi * rng.random(len(domain.pillars))
        ways = length * np.column_stack((np.cos(angles), np.sin(angles)))
        try:
            return domain.with_pillars([pillar + way for pillar, way in zip(domain.pillars, ways, strict=True)])
        except InputError:
            continue


def shape(mesh: Triangulation) -> str:
    """Mean, first percentile and least quality."""
    quality = mesh.quality()
    return f"{quality.mean():.4f} {np.percentile(quality, 1):.3f} {quality.min():.3f}"


def main() -> None:
    """Print a block of lines a case."""
    moves = int(sys.argv[1]) if len(sys.argv) > 1 else 50
    for pillars, edge_length, wall, across in CASES:
        domain = plexus(pillars, 0.55)
        length = SHARE * (edge_length if wall is None else wall)
        rng = np.random.default_rng(1)
        mesh = generate_mesh(domain, edge_length, wall, across=across)
        after = moved(domain, length, rng)
        full = local = np.inf
        for _ in range(REPEATS):
            start = time.perf_counter()
            fresh = generate_mesh(after, edge_length, wall, across=across)
            full, start = min(full, time.perf_counter() - start), time.perf_counter()
            done = repair_mesh(mesh, domain, after, edge_length, wall, across=across)
            local = min(local, time.perf_counter() - start)
        start = time.perf_counter()
        bridge = transfer(mesh, done.mesh, done.triangle_origin)
        overlap = time.perf_counter() - start
        error = abs(bridge.amounts(mesh.areas).sum() / mesh.areas.sum() - 1.0)
        print(f"{len(domain.pillars)} pillars, {len(mesh.triangles)} triangles, moves of {length:.3g}")
        print(
            f"  anew {full:.3f} s, repaired {local:.3f} s: {full / local:.1f} times as fast; overlaps {overlap:.2f} s"
        )
        print(f"  {done.moved} moved, {done.inserted} in, {done.deleted} out, {done.flipped} flips, {error:.0e} lost")
        print(f"  quality (mean, 1 %, least) before {shape(mesh)}; repaired {shape(done.mesh)}; anew {shape(fresh)}")
        remeshed = light = 0
        for _ in range(moves):
            domain, mesh = after, done.mesh
            after = moved(domain, length, rng)
            done = repair_mesh(mesh, domain, after, edge_length, wall, across=across)
            light += len(done.mesh.triangles) == len(mesh.triangles)
            remeshed += done.remeshed
        fresh = generate_mesh(after, edge_length, wall, across=across)
        print(
            f"  after {moves} more moves, {light} of them only smoothed, {remeshed} made anew: "
            f"{len(done.mesh.triangles)} triangles {shape(done.mesh)}; "
            f"anew {len(fresh.triangles)} triangles {shape(fresh)}",
            flush=True,
        )


if __name__ == "__main__":
    main()
