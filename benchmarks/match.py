"""What the fit to a picture stands on: scales of the distance, sensitivities of the table, known settings found again.

`scales` prints the constants of `vasculo.measure.distance`, `sensitivity` the table of docs/match.md, `recover` grows a
plexus with known settings, paints it, fits it and prints the settings beside the ranges that were found.
"""

from __future__ import annotations

import argparse
from concurrent.futures import ProcessPoolExecutor
from itertools import combinations
from multiprocessing import get_context
from pathlib import Path

import numpy as np

from vasculo.measure.distance import ISLANDS, SCALES, difference, distance
from vasculo.measure.morphometry import Morphometry, morphometry, pooled
from vasculo.plexus.extract import extract_domain
from vasculo.plexus.image import ImageExtraction
from vasculo.plexus.parameters import Extraction
from vasculo.study.match.fit import match
from vasculo.study.match.painting import paint
from vasculo.study.match.sample import NODES, Wanted, grow_samples
from vasculo.study.match.settings import SEARCHED
from vasculo.study.match.words import sentences, setting_words
from vasculo.study.match.worker import begin_worker
from vasculo.tissue.lattice import lattice
from vasculo.tissue.spacing import expected_spacing
from vasculo.tissue.vasculogenesis import Vasculogenesis, grow_plexus

WANTED = Wanted(60.0, 1.0, 0.43, 0.075)
VARIED = (
    *((each.name, each.value(0.0), each.value(1.0)) for each in SEARCHED),
    ("threshold", 0.35, 0.65),
    ("tightening_damping", 0.1, 1.0),
    ("settling_time", 50.0, 400.0),
)
"""Settings whose influence is measured, between two values."""


def quarters(preset: str, seed: int) -> list[Morphometry]:
    """Tables of four windows of a plexus that has some four hundred pillars."""
    settings = Vasculogenesis.preset(preset)
    spacing = expected_spacing(lattice(400, seed), settings)
    nodes = round(NODES * (4 * ISLANDS + 120) * spacing**2)
    plexus = grow_plexus(lattice(nodes, seed), settings, seed)
    domain = extract_domain(plexus, Extraction(fluid_fraction=WANTED.vessel_fraction))
    nodes_of = np.concatenate(domain.pillars)
    low, high = nodes_of.min(axis=0) + 0.03, nodes_of.max(axis=0) - 0.03
    half = 0.5 * (high - low)
    corners = [low + half * (i, j) for i in (0, 1) for j in (0, 1)]
    return [morphometry(domain, window=(*corner, *(corner + half))) for corner in corners]


def scales(seeds: int) -> None:
    """Print the scales of the distance: root mean square differences between windows of two seeds."""
    squares: dict[str, list[float]] = {name: [] for name in SCALES}
    for preset in ("fine", "medium", "coarse", "uniform"):
        tables = [quarters(preset, seed) for seed in range(seeds)]
        for name in SCALES:
            pairs = combinations(tables, 2)
            squares[name].append(
                float(np.mean([difference(a, b, name) ** 2 for one, two in pairs for a in one for b in two]))
            )
        islands = np.mean([table.islands for each in tables for table in each])
        print(
            preset,
            f"{islands:.0f} islands",
            {name: float(f"{values[-1] ** 0.5:.3g}") for name, values in squares.items()},
        )
    print({name: float(f"{np.sqrt(np.mean(values)):.3g}") for name, values in squares.items()})


def table_of(settings: Vasculogenesis, seeds: range) -> Morphometry | str:
    """Return the common table of some seeds, or why there is none."""
    try:
        return pooled([sample.table for sample in grow_samples(settings, WANTED, seeds)])
    except (RuntimeError, ValueError) as error:
        return str(error)


def sensitivity(seeds: int, workers: int) -> None:
    """Print how much each term changes from one end of each range to the other, in units of chance."""
    ends = [Vasculogenesis(**{name: value}) for name, low, high in VARIED for value in (low, high)]
    mine, others = range(seeds), range(seeds, 2 * seeds)
    usual = Vasculogenesis()
    jobs = [*((each, mine) for each in ends), (usual, mine), (usual, others)]
    with ProcessPoolExecutor(workers, get_context("spawn"), begin_worker) as pool:
        tables = list(pool.map(table_of, *zip(*jobs, strict=True)))
    varied = [*VARIED, ("other seeds", 0.0, 0.0)]
    print(f"| setting | from | to | {' | '.join(SCALES)} | distance |\n|{'---|' * (len(SCALES) + 4)}")
    for (name, low, high), one, two in zip(varied, tables[::2], tables[1::2], strict=True):
        if isinstance(one, str) or isinstance(two, str):
            print(f"| {name} | {low:g} | {high:g} | {one if isinstance(one, str) else two} |")
            continue
        far = distance(one, two)
        cells = " | ".join(f"{far.differences[term]:.1f}" for term in SCALES)
        print(f"| {name} | {low:g} | {high:g} | {cells} | {far.value:.1f} |")


def recover(out: Path, budget: int, workers: int) -> None:
    """Fit the picture of a plexus with known settings."""
    settings = Vasculogenesis(
        growth_rate=0.004,
        tether=0.01,
        stop_void_fraction=0.4,
        threshold_spread=0.3,
        threshold_correlation=3.0,
        final_rest_factor=0.3,
    )
    (sample,) = grow_samples(settings, WANTED.of(110.0), [1001])
    picture = paint(sample.domain, sample.table.window, (400, 400))
    found = match(picture, out, ImageExtraction(vessels="dark"), budget=budget, workers=workers, tell=print)
    print(*sentences(found), sep="\n")
    print("| setting | known | best | range of those as near |\n|---|---|---|---|")
    for each in found.ranges:
        value = getattr(settings, each.name)
        inside = each.low <= value <= each.high
        print(f"| {each.name} | {value:g} | {each.best:g} | {setting_words(each)}{'' if inside else ' (outside)'} |")


def main() -> None:
    """Measure what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", choices=("scales", "sensitivity", "recover"))
    parser.add_argument("--seeds", type=int, default=6)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--budget", type=int, default=96)
    parser.add_argument("--out", type=Path, default=Path("matches/known"))
    options = parser.parse_args()
    if options.what == "scales":
        scales(options.seeds)
    elif options.what == "sensitivity":
        sensitivity(options.seeds, options.workers)
    else:
        recover(options.out, options.budget, options.workers)


if __name__ == "__main__":
    main()
