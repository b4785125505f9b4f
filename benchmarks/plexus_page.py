"""Numbers of grown plexuses beside those of a real capillary network, by one and the same morphometry; and figures.

Grows each preset with several seeds, measures them and a segmented image, prints the table of docs/in-vitro.md and
draws its pictures: three sizes at three seeds, and the counterpart of the paper's Fig 2.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import shapely
from matplotlib.figure import Figure

from vasculo import measure
from vasculo.draw.springs import draw_springs, whole_tissue
from vasculo.geometry.outline import perimeter, signed_area
from vasculo.plexus.image import ImageExtraction
from vasculo.plexus.image_islands import find_islands, island_shapes
from vasculo.plexus.image_levels import grey_values, level_field
from vasculo.plexus.outlines import ring_nodes
from vasculo.plexus.survey import survey
from vasculo.store.read import Springs
from vasculo.study.picture_file import read_picture
from vasculo.tissue.lattice import lattice
from vasculo.tissue.vasculogenesis import Vasculogenesis, grow_plexus

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import NDArray

    from vasculo.measure import Cords
    from vasculo.springs.network import SpringNetwork

    Floats = NDArray[np.float64]

ROOT = Path(__file__).parents[1]
IMAGE = ROOT / "examples" / "images" / "capillaries.png"
PRESETS = ("fine", "medium", "coarse", "paper", "uniform")
RADIUS = 2.0  # equivalent radius of the smallest lacuna of the image, pixels


class Numbers(NamedTuple):
    """Morphology without a unit: lengths over the mean cord length."""

    lacunae: float
    lacuna_fraction: float
    lacuna_variation: float
    roundness: float
    cord_width: float
    cord_variation: float
    degree: float
    three_way: float
    neighbours: float


def numbers(outlines: list[Floats], graph: Cords, area: float) -> Numbers:
    """Numbers of a network from the outlines of its lacunae and the cords between them; cut lacunae do not count."""
    whole = [outline for outline, cut in zip(outlines, graph.at_border, strict=True) if not cut]
    areas = np.abs([signed_area(outline) for outline in whole])
    length = graph.lengths[graph.inner]
    return Numbers(
        len(outlines),
        float(np.sum(np.abs([signed_area(outline) for outline in outlines])) / area),
        float(areas.std() / areas.mean()),
        float(np.median([4.0 * np.pi * a / perimeter(o) ** 2 for a, o in zip(areas, whole, strict=True)])),
        graph.width / length.mean(),
        float(length.std() / length.mean()),
        float(graph.degrees.mean()),
        float(np.mean(graph.degrees == 3)),
        float(np.mean(graph.neighbours[~graph.at_border])),
    )


def of_plexus(network: SpringNetwork) -> Numbers:
    """Numbers of a grown plexus."""
    found = survey(network)
    outlines = [void.outline / found.length_unit for void in found.voids]
    return numbers(outlines, measure.plexus(network).graph, found.area / found.length_unit**2)


def of_image(path: Path) -> tuple[Numbers, list[Floats], Cords, Floats]:
    """Numbers, outlines, cords and grey values of a segmented picture, vessels dark."""
    grey = grey_values(read_picture(path)[0])
    height, width = grey.shape
    wanted = ImageExtraction(vessels="dark", smallest_radius=RADIUS)
    islands = find_islands(level_field(grey, wanted)[0], RADIUS)
    inside = shapely.intersection(island_shapes(islands, 1), shapely.box(0.0, 0.0, width, height))
    rings = [ring_nodes(shape) for shape in inside]
    frame = np.array([[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]])
    graph = measure.cords(rings, frame, spacing=0.5)
    return numbers(rings, graph, float(width * height)), rings, graph, grey


def show_plexus(axes: Axes, network: SpringNetwork, title: str) -> None:
    """Draw the springs, width and grey by force."""
    springs = Springs(network.points, network.velocities, network.springs, network.tensions())
    draw_springs(axes, springs, whole_tissue(), title)


def three_sizes(grown: dict[tuple[str, int], SpringNetwork], file: Path) -> None:
    """Draw a fine, the paper's and a coarse plexus at three seeds."""
    figure = Figure(figsize=(12, 12), layout="constrained")
    for row, preset in enumerate(("fine", "paper", "coarse")):
        for seed in range(3):
            network = grown[preset, seed]
            axes = figure.add_subplot(3, 3, 3 * row + seed + 1)
            show_plexus(axes, network, f"{preset}, seed {seed}: {measure.plexus(network).voids} voids")
    figure.savefig(file, dpi=110)


def figure_two(network: SpringNetwork, rings: list[Floats], graph: Cords, grey: Floats, file: Path) -> None:
    """Draw a real network beside a grown one, and the cords that were measured on both."""
    figure = Figure(figsize=(13, 12), layout="constrained")
    height, width = grey.shape
    axes = [figure.add_subplot(2, 2, place) for place in range(1, 5)]
    axes[0].imshow(grey, cmap="gray", extent=(0.0, width, 0.0, height), interpolation="nearest")
    axes[0].set_title("capillaries (segmented image)", loc="left")
    show_plexus(axes[1], network, "vasculo, preset uniform")
    for ring in rings:
        axes[2].fill(*ring.T, color="0.85")
    axes[2].set(xlim=(0.0, width), ylim=(0.0, height), aspect="equal")
    found = survey(network)
    for void in found.voids:
        axes[3].fill(*(void.outline / found.length_unit).T, color="0.85")
    mine = measure.plexus(network).graph
    axes[3].set(xlim=(0, 1 / found.length_unit), ylim=(0, 1 / found.length_unit), aspect="equal")
    for place, cords in ((axes[2], graph), (axes[3], mine)):
        for cord in range(len(cords)):
            place.plot(*cords.line(cord).T, color="k" if cords.inner[cord] else "0.6", linewidth=0.8)
        place.plot(*cords.junctions[cords.degrees == 3].T, ".", color="tab:blue", markersize=3)
        place.plot(*cords.junctions[cords.degrees > 3].T, ".", color="tab:red", markersize=4)
        place.set_title("cords; junctions of three (blue) and more (red)", loc="left")
    for each in axes:
        each.set(xticks=[], yticks=[])
    figure.savefig(file, dpi=110)


def main() -> None:
    """Grow, measure, print and draw."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--nodes", type=int, default=12_000)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--out", type=Path, default=ROOT / "docs" / "images")
    options = parser.parse_args()
    image, rings, graph, grey = of_image(IMAGE)
    grown: dict[tuple[str, int], SpringNetwork] = {}
    print(f"| | {' | '.join(Numbers._fields)} |\n|{'---|' * (len(Numbers._fields) + 1)}")
    for preset in PRESETS:
        rows = []
        for seed in range(options.seeds):
            grown[preset, seed] = grow_plexus(lattice(options.nodes, seed), Vasculogenesis.preset(preset), seed)
            rows.append(of_plexus(grown[preset, seed]))
        mean, spread = np.mean(rows, axis=0), np.std(rows, axis=0)
        print(f"| {preset} | " + " | ".join(f"{m:.2f} +- {s:.2f}" for m, s in zip(mean, spread, strict=True)) + " |")
    print("| image | " + " | ".join(f"{value:.2f}" for value in image) + " |")
    three_sizes(grown, options.out / "plexus_three_sizes.png")
    figure_two(grown["uniform", 1], rings, graph, grey, options.out / "plexus_beside_capillaries.png")


if __name__ == "__main__":
    main()
