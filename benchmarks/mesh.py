"""Meshing beside gmsh (frontal-Delaunay) and Triangle: time and quality on the same domains, in turns.

Run with `python benchmarks/mesh.py [--repeats N] [--draw FILE] [--charges]`. gmsh and triangle come with the extra
`bench`; a peer that is not installed is left out.
"""

import argparse
import importlib.util
import resource
import time
from collections.abc import Callable

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.spatial import Voronoi

from vasculo.geometry.domain import Domain
from vasculo.geometry.outline import resample
from vasculo.mesh.generate import generate_mesh
from vasculo.mesh.matrix import matrix_springs
from vasculo.mesh.quality import smallest_angles, triangle_quality

Mesh = tuple[float, NDArray[np.float64], NDArray[np.int32]]


def plexus(count: int, gap: float, seed: int = 0, spacing: float = 0.18) -> Domain:
    """Make rounded, inset Voronoi cells, mean radius about 1, with outline nodes `spacing` and passages `gap` wide."""
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
    inset = [cell.buffer(-gap / 2 - 0.3).buffer(0.3, quad_segs=64) for cell in cells]
    outlines = [resample(np.array(cell.exterior.coords)[:-1], spacing) for cell in inset if cell.area > 0.1]
    outer = [(-1, 0), (side + 1, 0), (side + 1, side), (-1, side)]
    return Domain(outer, outlines, ("bottom", "right", "top", "left"))


def ours(domain: Domain, edge: float) -> Mesh:
    """Mesh with vasculo."""
    start = time.perf_counter()
    mesh = generate_mesh(domain, edge)
    return time.perf_counter() - start, mesh.points, mesh.triangles


def by_gmsh(domain: Domain, edge: float) -> Mesh:
    """Mesh with gmsh's frontal-Delaunay method; only its meshing is timed."""
    import gmsh  # noqa: PLC0415  optional

    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.option.setNumber("Mesh.Algorithm", 6)
    loops = []
    for outline in (domain.outer, *domain.pillars):
        nodes = [gmsh.model.geo.addPoint(x, y, 0.0, edge) for x, y in outline]
        lines = [gmsh.model.geo.addLine(a, b) for a, b in zip(nodes, nodes[1:] + nodes[:1], strict=True)]
        loops.append(gmsh.model.geo.addCurveLoop(lines))
    gmsh.model.geo.addPlaneSurface(loops)
    gmsh.model.geo.synchronize()
    start = time.perf_counter()
    gmsh.model.mesh.generate(2)
    seconds = time.perf_counter() - start
    names, places, _ = gmsh.model.mesh.getNodes()
    number = np.zeros(int(names.max()) + 1, dtype=np.int32)
    number[names.astype(np.int64)] = np.arange(len(names))
    triangles = number[gmsh.model.mesh.getElementsByType(2)[1].astype(np.int64)].reshape(-1, 3)
    gmsh.finalize()
    return seconds, places.reshape(-1, 3)[:, :2].copy(), triangles


def by_triangle(domain: Domain, edge: float, share: float = 1.0) -> Mesh:
    """Mesh with Triangle, no angle below 30 degrees, no area above `share` times an equilateral triangle's."""
    import triangle  # noqa: PLC0415  optional

    outlines = [domain.outer, *domain.pillars]
    first = np.cumsum([0] + [len(outline) for outline in outlines])
    segments = [
        start + np.column_stack((np.arange(len(outline)), np.roll(np.arange(len(outline)), -1)))
        for start, outline in zip(first, outlines, strict=False)
    ]
    holes = [shapely.Polygon(pillar).representative_point().coords[0] for pillar in domain.pillars]
    given = {"vertices": np.concatenate(outlines), "segments": np.concatenate(segments), "holes": np.array(holes)}
    area = share * np.sqrt(3.0) / 4.0 * edge**2
    start = time.perf_counter()
    made = triangle.triangulate(given, f"pq30a{area:.15f}")
    return time.perf_counter() - start, made["vertices"], made["triangles"]


def by_triangle_coarse(domain: Domain, edge: float) -> Mesh:
    """Mesh with Triangle and an area limit that gives about as many triangles as the others."""
    return by_triangle(domain, edge, 1.85)


PEERS: dict[str, Callable[[Domain, float], Mesh]] = {
    "vasculo": ours,
    "gmsh": by_gmsh,
    "triangle a": by_triangle,
    "triangle n": by_triangle_coarse,
}
"""`triangle a`: areas up to that of the equilateral triangle; `triangle n`: about as many triangles as we have."""


def compare(pillars: int, gap: float, edge: float, repeats: int) -> NDArray[np.float64]:
    """Print a line for each mesher; returns our qualities."""
    domain = plexus(pillars, gap, spacing=edge)
    best: dict[str, Mesh] = {}
    for _ in range(repeats):
        for name, peer in PEERS.items():
            if importlib.util.find_spec(name.split()[0]) is None:
                continue
            made = peer(domain, edge)
            if name not in best or made[0] < best[name][0]:
                best[name] = made
    for name, (seconds, points, triangles) in best.items():
        quality = np.abs(triangle_quality(points, triangles.astype(np.int32)))
        angle = smallest_angles(points, triangles.astype(np.int32)).min()
        ratio = seconds / best["vasculo"][0]
        print(
            f"{pillars:7d} {edge:6.4f} {name:>10} {len(triangles):9d} {seconds:8.3f} {ratio:8.2f} "
            f"{1e6 * seconds / len(triangles):9.3f} {quality.mean():.4f} {quality.min():6.3f} {angle:6.1f}",
            flush=True,
        )
    return triangle_quality(*best["vasculo"][1:])


def methods(edges: tuple[float, ...]) -> None:
    """Print what the three methods take: the cost of charges grows with the square of the nodes."""
    for method in ("truss", "charges"):
        generate_mesh(plexus(9, 0.55), 0.5, method=method)
    print("   method   nodes triangles  seconds  us a node   mean    min")
    for edge in edges:
        domain = plexus(9, 0.55)
        for method in ("advancing", "truss", "charges"):
            start = time.perf_counter()
            mesh = generate_mesh(domain, edge, method=method)
            seconds = time.perf_counter() - start
            quality = mesh.quality()
            print(
                f"{method:>9} {len(mesh.points):7d} {len(quality):9d} {seconds:8.3f} "
                f"{1e6 * seconds / len(mesh.points):10.1f} {quality.mean():.4f} {quality.min():6.3f}",
                flush=True,
            )


def layers() -> None:
    """Print a line for layers across the passages, and for the even mesh of the matrix."""
    print("pillars  gap  across  triangles  seconds  mean     min   angle")
    for count in (100, 1000):
        for gap in (0.55, 0.2):
            domain = plexus(count, gap)
            for across in (0, 2, 3):
                start = time.perf_counter()
                mesh = generate_mesh(domain, 0.7, 0.18, across=across)
                seconds = time.perf_counter() - start
                quality, angle = mesh.quality(), smallest_angles(mesh.points, mesh.triangles).min()
                print(
                    f"{len(domain.pillars):7d} {gap:4.2f} {across:7d} {len(quality):10d} {seconds:8.3f} "
                    f"{quality.mean():.4f} {quality.min():7.3f} {angle:6.1f}"
                )
            start = time.perf_counter()
            matrix = matrix_springs(domain, 0.45)
            seconds = time.perf_counter() - start
            print(f"{len(domain.pillars):7d} {gap:4.2f}  matrix {len(matrix.triangles):10d} {seconds:8.3f}")


def draw(qualities: dict[str, NDArray[np.float64]], path: str) -> None:
    """Draw the histogram of the qualities."""
    import matplotlib.pyplot as plt  # noqa: PLC0415  optional

    figure, axes = plt.subplots(figsize=(6.4, 3.6), layout="constrained")
    for name, quality in qualities.items():
        axes.hist(quality, np.linspace(0.5, 1.0, 101), histtype="step", log=True, label=name)
    axes.set(xlabel="quality 2 r_in / r_circ", ylabel="triangles", xlim=(0.5, 1.0))
    axes.legend(frameon=False, loc="upper left")
    figure.savefig(path, dpi=150)


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=3, help="rounds in turns; the shortest time counts")
    parser.add_argument("--draw", metavar="FILE", help="write the histogram of our qualities")
    parser.add_argument("--charges", action="store_true", help="compare our three methods instead")
    parser.add_argument("--layers", action="store_true", help="layers across passages and the matrix instead")
    given = parser.parse_args()
    generate_mesh(plexus(9, 0.5), 0.3, 0.18, across=2)
    if given.charges:
        methods((0.14, 0.1, 0.07))
        return
    if given.layers:
        matrix_springs(plexus(9, 0.5), 0.45)
        layers()
        return
    print("pillars   edge     mesher triangles  seconds over ours us a tri.   mean    min  angle")
    qualities = {}
    for pillars, edge in ((100, 0.0545), (1000, 0.1665), (100, 0.0243)):
        quality = compare(pillars, 0.55, edge, given.repeats)
        qualities[f"{pillars} pillars, {len(quality):,} triangles"] = quality
    print(f"peak memory {resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f} MB")
    if given.draw:
        draw(qualities, given.draw)


if __name__ == "__main__":
    main()
