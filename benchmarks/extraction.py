"""Extraction: voids and their outlines against polygonised springs, and test rays against a tree of line strings.

Run with `python benchmarks/extraction.py [nodes]`; one core is used. Every time is the best of several calls in this
run, without compilation. The tissue is grown first (85,000 nodes give about a thousand voids).
"""

from __future__ import annotations

import sys
import time
from typing import TYPE_CHECKING, TypeVar

import numpy as np
import shapely

from vasculo.plexus.raycast import ray_directions, ray_distances, spring_grid
from vasculo.plexus.rays import mended, ray_agreement, ray_outlines, void_centres
from vasculo.plexus.survey import survey
from vasculo.plexus.voids import VOID_CUTOFF, intact_edges, interior_edges, joined
from vasculo.tissue.lattice import lattice
from vasculo.tissue.vasculogenesis import grow_plexus

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from vasculo.springs.network import SpringNetwork

    Floats = NDArray[np.float64]
    Ints = NDArray[np.int32]

Result = TypeVar("Result")
RAYS, CENTRES = 64, 1000


def best(call: Callable[[], Result], rounds: int) -> tuple[float, Result]:
    """Shortest time of some calls (s) and the last result."""
    times = []
    for _ in range(rounds):
        start = time.perf_counter()
        result = call()
        times.append(time.perf_counter() - start)
    return min(times), result


def polygonised(network: SpringNetwork, cutoff: float) -> NDArray[np.object_]:
    """Void polygons by shapely: line strings of the living springs, polygonised, faces above an area kept."""
    parts = shapely.get_parts(shapely.polygonize(shapely.linestrings(network.points[network.springs])))
    return np.asarray(parts[shapely.area(parts) > cutoff], dtype=object)


def by_tree(points: Floats, springs: Ints, centres: Floats, reach: Floats, predicate: str | None) -> Floats:
    """Distances (c, rays) by shapely: rays just long enough as line strings, bulk query, nearest intersection.

    With a predicate the tree itself tests the pairs; without one it compares boxes and NumPy does the rest.
    """
    tree = shapely.STRtree(shapely.linestrings(points[springs]))
    directions = np.tile(ray_directions(RAYS), (len(centres), 1))
    begin = np.repeat(centres, RAYS, axis=0)
    end = begin + np.repeat(reach, RAYS)[:, None] * directions
    ray, spring = tree.query(shapely.linestrings(np.stack([begin, end], axis=1)), predicate=predicate)
    a, b = points[springs[spring, 0]] - begin[ray], points[springs[spring, 1]] - begin[ray]
    d = directions[ray]
    side_a, side_b = d[:, 0] * a[:, 1] - d[:, 1] * a[:, 0], d[:, 0] * b[:, 1] - d[:, 1] * b[:, 0]
    crossed = side_a * side_b <= 0.0
    share = np.divide(side_a, side_a - side_b, out=np.zeros(len(a)), where=crossed & (side_a != side_b))
    away = ((a + share[:, None] * (b - a)) * d).sum(axis=1)
    away[~crossed | (away < 0.0)] = np.inf
    distances = np.full(len(begin), np.inf)
    np.minimum.at(distances, ray, away)
    return distances.reshape(-1, RAYS)


def main() -> None:
    """Print both comparisons."""
    nodes = int(sys.argv[1]) if len(sys.argv) > 1 else 85_000
    network = grow_plexus(lattice(nodes=nodes, seed=0), seed=0)
    found = survey(network)
    points, springs = network.points, found.springs
    print(f"{nodes} nodes, {len(network.springs)} living springs, {len(found.voids)} voids")

    print("\noutlines of the voids from the network")
    whole, _ = best(lambda: survey(network), 15)
    polygonising, polygons = best(lambda: polygonised(network, VOID_CUTOFF * found.triangle_area), 3)
    edges = interior_edges(network.triangles, len(points))
    intact = intact_edges(edges, springs)
    joining, _ = best(lambda: joined(edges, intact, len(network.triangles)), 15)
    print(
        f"  polygonize: line strings, polygonize, filter by area   {1e3 * polygonising:9.1f} ms {len(polygons)} voids"
    )
    print(
        f"  survey: all of it, with tables, loops, all counts      {1e3 * whole:9.1f} ms, {polygonising / whole:.0f} x"
    )
    print(f"  union-find of the triangles alone                      {1e3 * joining:9.1f} ms")

    outlines = [void.outline for void in found.voids]
    raw = mended(outlines)[:CENTRES]
    centres = void_centres(raw)
    reach = 1.001 * shapely.hausdorff_distance(raw, shapely.points(centres))
    print(f"\n{len(centres) * RAYS} rays, {RAYS} from each of {len(centres)} centres, with building of grid or tree")
    cast, (distances, _) = best(lambda: ray_distances(points, springs, centres, RAYS), 15)
    grid = spring_grid(points, springs)
    walk, _ = best(lambda: ray_distances(points, springs, centres, RAYS, grid), 15)
    print(f"  grid, with its building                                {1e3 * cast:9.1f} ms")
    print(f"  grid, walk alone                                       {1e3 * walk:9.1f} ms")
    for name, predicate in (("tree, tests pairs itself", "intersects"), ("tree of boxes, then NumPy", None)):
        queried, others = best(lambda predicate=predicate: by_tree(points, springs, centres, reach, predicate), 2)
        apart = np.abs(others - distances)[np.isfinite(others)].max() / found.length_unit
        print(f"  {name:<54} {1e3 * queried:9.1f} ms, {queried / cast:.0f} x; furthest apart {apart:.1e} L0")

    centres = void_centres(mended(outlines))
    inspected, loops = best(lambda: ray_outlines(points, springs, centres, RAYS), 5)
    agreed, overlap = best(lambda: ray_agreement(points, springs, outlines, RAYS), 3)
    exact = loops.same_nodes([void.nodes for void in found.voids]).mean()
    print(f"\nray outlines: {1e3 * inspected:.1f} ms, exact node set {exact:.3f}; agreement: {1e3 * agreed:.1f} ms")
    print(f"overlap above 0.95 in {np.mean(overlap > 0.95):.3f} of the voids, least {overlap.min():.4f}")


if __name__ == "__main__":
    main()
