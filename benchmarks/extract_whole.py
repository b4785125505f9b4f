"""Extraction as a whole: seconds for a thousand voids, and predicted against real flow meshes.

Run with `python benchmarks/extract_whole.py [NODES]`; one core is used. Networks are grown once and kept in the folder
for temporary files.
"""

import sys
import tempfile
import time
from functools import partial
from pathlib import Path

import numpy as np
import shapely

import vasculo as vc
from vasculo import measure
from vasculo.plexus.budget import laid_out_for
from vasculo.plexus.extract import extract
from vasculo.plexus.outlines import repaired
from vasculo.plexus.passages import find_passages
from vasculo.plexus.rays import ray_agreement
from vasculo.plexus.rules import near_pairs
from vasculo.plexus.survey import survey
from vasculo.plexus.voronoi import voronoi_plexus
from vasculo.plexus.width import WIDTH_RANGE, choose_width, cleared_at
from vasculo.tissue.parameters import PRESETS

LARGE = 85_000
"""Nodes of a tissue with a thousand voids."""


def plexus(nodes: int, seed: int, preset: str = "medium") -> vc.SpringNetwork:
    """Grow a plexus, or take the one that was grown before."""
    file = Path(tempfile.gettempdir()) / f"vasculo-plexus-{nodes}-{seed}-{preset}.npz"
    if not file.exists():
        grown = vc.grow_plexus(vc.lattice(nodes=nodes, seed=seed), PRESETS[preset], seed=seed)
        np.savez(file, points=grown.points, reference=grown.reference, springs=grown.springs, triangles=grown.triangles)
    with np.load(file) as kept:
        network = vc.SpringNetwork(kept["reference"], kept["springs"], triangles=kept["triangles"])
        network.points[:] = kept["points"]
    return network


def best(call, times=3):  # any call
    """Shortest time of a few calls, and the result of the last."""
    seconds = []
    for _ in range(times):
        start = time.perf_counter()
        result = call()
        seconds.append(time.perf_counter() - start)
    return min(seconds), result


def whole(network: vc.SpringNetwork) -> None:
    """Time `extract` and its parts."""
    print("asked for                      seconds  pillars  width  from            merged  predicted")
    for asked in (
        {},
        {"lumen_width": 0.75},
        {"minimum_width": 1.0},
        {"lumen_width": 0.75, "triangle_budget": 150 * len(network.points) // 85},
    ):
        seconds, found = best(partial(extract, network, vc.Extraction(**asked)))
        words = ", ".join(f"{name} {value}" for name, value in asked.items()) or "nothing"
        report = found.report
        print(
            f"{words:<45} {seconds:6.2f} {report.pillars:8d} {report.tubule_width_l0:6.3f}  {report.width_from:<15} "
            f"{report.merged:6d} {report.predicted_triangles:10d}"
        )


def parts(network: vc.SpringNetwork) -> None:
    """Time the parts of a default extraction."""
    wanted = vc.Extraction()
    times = {}
    times["survey"], found = best(lambda: survey(network))
    unit, box = found.length_unit, shapely.box(*found.bounds)
    times["valid polygons"], mended = best(lambda: [repaired(void.outline)[0] for void in found.voids])
    raw = np.array(mended, dtype=object)
    times["pairs of voids"], near = best(lambda: near_pairs(raw, WIDTH_RANGE[1] * unit))
    cleared = partial(cleared_at, raw, near, box, unit=unit, wanted=wanted)
    times["width for a fluid fraction"], (width, _) = best(lambda: choose_width(cleared, box.area, unit, wanted))
    shapes = cleared(width).shapes
    times["even outlines and passages"], end = best(lambda: laid_out_for(shapes, width, found.bounds, unit, wanted))
    edge = end.passages.edge_length
    times["  of this passages"], _ = best(lambda: find_passages(end.outlines, end.outer, end.sides, edge, 3))
    times["domain"], _ = best(lambda: vc.Domain(end.outer, end.outlines, end.sides))
    outlines = [void.outline for void in found.voids]
    times["rays"], _ = best(lambda: ray_agreement(network.points, found.springs, outlines, wanted.rays))
    for name, seconds in times.items():
        print(f"{name:<28} {seconds:6.3f} s")


def predictions() -> None:
    """Print predicted and real triangles of many plexuses."""
    domains = {}
    for preset in ("fine", "medium", "coarse", "uniform"):
        network = plexus(12_000, 0, preset)
        for width in (0.4, 0.75, 1.25):
            domains[f"{preset}, lumen {width}"] = vc.extract_domain(network, vc.Extraction(lumen_width=width))
        domains[f"{preset}, minimum 1"] = vc.extract_domain(network, vc.Extraction(minimum_width=1.0))
    domains["Voronoi, 100 pillars"] = voronoi_plexus(pillars=100, channel=0.4, seed=0)
    ratios = []
    print("plexus                edge/R0  across  predicted     real  ratio")
    for name, domain in domains.items():
        for plain, across in ((0.7, 0), (0.7, 2), (0.7, 3), (0.7, 5), (0.4, 2), (0.4, 3)):
            edge = plain * domain.mean_radius
            predicted = measure.passages(domain, edge, across).total
            real = len(vc.generate_mesh(domain, edge, across=across).triangles)
            ratios.append(predicted / real)
            print(f"{name:<22} {plain:6.1f} {across:7d} {predicted:10.0f} {real:8d} {ratios[-1]:6.3f}")
    print(f"ratio: {min(ratios):.3f} to {max(ratios):.3f}, mean {np.mean(ratios):.3f}, deviation {np.std(ratios):.3f}")


def main() -> None:
    """Print all tables."""
    nodes = int(sys.argv[1]) if sys.argv[1:] else LARGE
    extract(plexus(3000, 0))
    network = plexus(nodes, 1)
    print(f"{nodes} nodes, {len(network.springs)} springs")
    whole(network)
    parts(network)
    predictions()


if __name__ == "__main__":
    main()
