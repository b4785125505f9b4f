"""Delaunay triangulation: ours beside Qhull and, where it is installed, the `triangle` package.

Run with `python benchmarks/delaunay.py [points ...]`; one core is used. The points are sorted along Hilbert's curve
before any clock starts. Every result of ours is checked to be Delaunay with exact tests; `differ` are the triangles of
the others that ours has not: by rounding, or, in lattices, because there are many triangulations to choose from.
"""

import sys
import time
from collections.abc import Callable
from functools import partial
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import Delaunay

from vasculo.geometry.curve import curve_order
from vasculo.mesh.triangulate.delaunay import delaunay, fluid_triangles
from vasculo.mesh.triangulate.flips import restore_delaunay

try:
    import triangle
except ImportError:
    triangle = None

Result = TypeVar("Result")
Floats = NDArray[np.float64]
Ints = NDArray[np.int32]


def lattice(count: int) -> Floats:
    """Square lattice with a spacing of 0.001, which float64 has to round."""
    side = round(np.sqrt(count))
    return 0.001 * np.stack(np.divmod(np.arange(side * side), side), axis=1)


def disks(count: int) -> tuple[Floats, Ints]:
    """Nodes of a box with 400 round holes, about a quarter of them on the walls; and the walls, fluid on the left."""
    rng = np.random.default_rng(0)
    on_hole, on_side = count // 1_600, count // 100
    angle = -2.0 * np.pi * np.arange(on_hole) / on_hole
    hole = 0.36 * np.column_stack((np.cos(angle), np.sin(angle)))
    rings = [hole + np.array((i + 0.5, j + 0.5)) for i in range(20) for j in range(20)]
    along, zero = 20.0 * np.arange(on_side) / on_side, np.zeros(on_side)
    sides = ((along, zero), (zero + 20.0, along), (20.0 - along, zero + 20.0), (zero, 20.0 - along))
    rings.append(np.concatenate([np.column_stack(side) for side in sides]))
    first = np.cumsum([0] + [len(ring) for ring in rings])
    edges = [np.column_stack((np.arange(len(r)), (np.arange(len(r)) + 1) % len(r))) for r in rings]
    points = np.concatenate(rings)
    inner = 20.0 * rng.random((3 * count, 2))
    inner = inner[np.hypot(*(inner % 1.0 - 0.5).T) > 0.37][: count - len(points)]
    walls = np.concatenate([edge + k for edge, k in zip(edges, first, strict=False)])
    return np.concatenate((points, inner)), walls.astype(np.int32)


def best(call: Callable[[], Result], repeats: int) -> tuple[float, Result]:
    """Shortest time of some calls, and their result."""
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        result = call()
        times.append(time.perf_counter() - start)
    return min(times), result


def differ(ours: NDArray[np.integer], theirs: NDArray[np.integer], nodes: int) -> int:
    """Triangles of theirs that are not among ours."""
    one, other = (np.sort(rows, axis=1).astype(np.int64) @ (1, nodes, nodes * nodes) for rows in (ours, theirs))
    return int(np.count_nonzero(~np.isin(other, one)))


def is_delaunay(points: Floats, triangles: Ints, neighbours: Ints) -> bool:
    """Whether no edge has a node inside the circle beyond it, by exact tests, and the triangles cover the hull."""
    outer = int(np.count_nonzero(neighbours < 0))
    whole = len(triangles) == 2 * len(points) - 2 - outer
    dirty = np.ones(len(triangles), dtype=np.bool_)
    return whole and restore_delaunay(points, triangles.copy(), neighbours.copy(), dirty) == 0


def main() -> None:
    """Print one line a case."""
    counts = [int(word) for word in sys.argv[1:]] or [10_000, 100_000, 1_000_000]
    start = time.perf_counter()
    fluid_triangles(*disks(10_000))
    print(f"first call, with compilation where the cache is empty: {time.perf_counter() - start:.2f} s")
    print("points           n    ours  + sort   Qhull  Qhull/ours  differ  triangle  differ  ours is Delaunay")
    for count in counts:
        for name, points in (("random", np.random.default_rng(0).random((count, 2))), ("lattice", lattice(count))):
            points = points[curve_order(points)]  # noqa: PLW2901
            few = 3 if count < 500_000 else 1
            seconds, (triangles, neighbours) = best(partial(delaunay, points, presorted=True), 7)
            sorting, _ = best(partial(delaunay, points), 3)
            qhull, found = best(partial(Delaunay, points), few)
            line = f"{name:8s} {len(points):9d} {seconds:7.4f} {sorting:7.4f} {qhull:7.3f} {qhull / seconds:11.1f} "
            line += f"{differ(triangles, found.simplices, len(points)):7d} "
            if triangle:
                took, rows = best(partial(triangle.delaunay, points), few)
                line += f"{took:9.3f} {differ(triangles, rows, len(points)):7d}  "
            print(line + ("yes" if is_delaunay(points, triangles, neighbours) else "NO"))
    for count in counts:
        points, edges = disks(count)
        seconds, _ = best(partial(fluid_triangles, points, edges), 5)
        print(f"between 400 disks {len(points)} nodes, {len(edges)} walls: {seconds:.4f} s")


if __name__ == "__main__":
    main()
