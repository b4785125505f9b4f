"""Meshing: triangles a second and quality for arrays of 100 and 1000 rounded pillars.

Run with `python benchmarks/mesh.py [pillars ...]`; one core is used.
"""

import resource
import sys
import time
from collections.abc import Callable
from typing import TypeVar

import numpy as np
import shapely
from scipy.spatial import Voronoi

from vasculo.geometry.domain import Domain
from vasculo.geometry.outline import resample
from vasculo.mesh.generate import generate_mesh
from vasculo.mesh.matrix import matrix_springs
from vasculo.mesh.quality import smallest_angles

Result = TypeVar("Result")


def plexus(count: int, gap: float, seed: int = 0) -> Domain:
    """Make rounded, inset Voronoi cells, mean radius about 1, membrane nodes 0.18 apart, all passages `gap` wide."""
    side = np.sqrt(count * np.pi * (1.0 + 0.5 * gap) ** 2)
    points = np.random.default_rng(seed).random((count, 2)) * side
    for _ in range(3):
        images = [
            points,
            points * (-1, 1),
            points * (-1, 1) + (2 * side, 0),
            points * (1, -1),
            points * (1, -1) + (0, 2 * side),
        ]
        diagram = Voronoi(np.concatenate(images))
        cells = [shapely.Polygon(diagram.vertices[diagram.regions[diagram.point_region[i]]]) for i in range(count)]
        points = np.array([(cell.centroid.x, cell.centroid.y) for cell in cells])
    inset = [cell.buffer(-gap / 2 - 0.3).buffer(0.3) for cell in cells]
    outlines = [resample(np.array(cell.exterior.coords)[:-1], 0.18) for cell in inset if cell.area > 0.1]
    outer = [(-1, 0), (side + 1, 0), (side + 1, side), (-1, side)]
    return Domain(outer, outlines, ("bottom", "right", "top", "left"))


def best(call: Callable[..., Result], *arguments: object, **named: object) -> tuple[float, Result]:
    """Shortest time of three calls, and their result."""
    times = []
    for _ in range(3):
        start = time.perf_counter()
        result = call(*arguments, **named)
        times.append(time.perf_counter() - start)
    return min(times), result


def main() -> None:
    """Print one line a case."""
    counts = [int(word) for word in sys.argv[1:]] or [100, 1000]
    start = time.perf_counter()
    matrix_springs(plexus(9, 0.05), 0.45)
    generate_mesh(plexus(9, 0.5), 0.7)
    print(f"first calls, with compilation where the cache is empty: {time.perf_counter() - start:.2f} s")
    print("pillars  gap  across  triangles  seconds  triangles/s  mean   min    angle")
    for count in counts:
        for gap in (0.55, 0.2):
            domain = plexus(count, gap)
            for across in (0, 2, 3):
                seconds, mesh = best(generate_mesh, domain, 0.7, 0.18, across=across)
                quality = mesh.quality()
                angle = smallest_angles(mesh.points, mesh.triangles).min()
                print(
                    f"{len(domain.pillars):7d} {gap:4.2f} {across:7d} {len(quality):10d} {seconds:8.2f} "
                    f"{len(quality) / seconds:12.0f} {quality.mean():.3f} {quality.min():6.3f} {angle:6.1f}"
                )
            seconds, matrix = best(matrix_springs, domain, 0.45)
            print(f"{len(domain.pillars):7d} {gap:4.2f}  matrix {len(matrix.triangles):10d} {seconds:8.2f}")
    print(f"peak memory {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f} MB")


if __name__ == "__main__":
    main()
