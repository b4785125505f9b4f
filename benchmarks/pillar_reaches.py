"""How far the flow-driven stage reaches: 16 and 256 pillars, grown plexuses, finer meshes, smaller steps.

Run: python -m benchmarks.pillar_reaches [--only 1 2] [--seeds 8]
The reaches are: 1 sixteen pillars over some seeds, 2 the same with activation rolled at random, 3 an array of 256,
4 plexuses grown from a tissue of 12,000 nodes, 5 half the mesh with lengths of cap, merging and closing as they are,
6 half the cap at equal strain, 7 half the cap and half the activation. Each line says what was asked, what was
measured, and whether it holds; the seconds are processor time. The exit status is the number of reaches that fail.
"""

from __future__ import annotations

import argparse
import sys
from functools import cache, partial
from typing import TYPE_CHECKING

import numpy as np
from benchmarks.pillar_runs import Row, Run, mean_cosine, print_table, run

import vasculo as vc
from vasculo.plexus.voronoi import voronoi_plexus

if TYPE_CHECKING:
    from collections.abc import Callable

CHANNEL = 0.4  # width of the channels of the sixteen pillars (R0)
NODES = 12_000
GROWN_SEEDS = (0, 1, 2)
GROWN_STEPS = 60


@cache
def sixteen(seed: int, **changes: float | str) -> Run:
    """Remodel the sixteen pillars of a seed; each variant is run once."""
    parameters = vc.Angiogenesis(**{"steps": 40, **changes})  # type: ignore[arg-type]
    return run(voronoi_plexus(16, channel=CHANNEL, seed=seed), parameters)


def sixteen_pillars(seeds: int) -> list[Row]:
    """Reach 1: chains along the flow on every seed, and in the middle of all of them nearly perfect order."""
    rows = []
    for seed in range(seeds):
        found = sixteen(seed)
        name, count, order = f"seed {seed}: ", found.count, found.order
        rows += [
            Row(1, name + "pillars", "<= 10", f"{count[0]} to {count[-1]}", count[-1] <= 10),
            Row(1, name + "order", ">= 0.75", f"{order[0]:.2f} to {order[-1]:.3f}", order[-1] >= 0.75),
            Row(1, name + "merges along the flow", ">= 0.8", f"{found.along:.3f}", found.along >= 0.8),
            Row(1, name + "flow rate", ">= 2.5 x", f"{found.gain:.2f}", found.gain >= 2.5),
        ]
    middle = float(np.median([sixteen(seed).order[-1] for seed in range(seeds)]))
    return [*rows, Row(1, f"median order of {seeds}", ">= 0.9", f"{middle:.3f}", middle >= 0.9)]


def without_information(seeds: int) -> list[Row]:
    """Reach 2: the same values at random places on the membranes give no order, no chains and no flow."""
    rows = []
    for seed in range(seeds):
        found = sixteen(seed, sensing="rolled", roll_seed=seed)
        change = found.order[-1] - found.order[0]
        merges = found.merges / max(1, sixteen(seed).merges)
        name = f"seed {seed}, rolled: "
        rows += [
            Row(2, name + "merges", "<= 1/4 of sensing", f"{found.merges} of {sixteen(seed).merges}", merges <= 0.25),
            Row(2, name + "change of order", "< 0.3", f"{change:+.3f}", abs(change) < 0.3),
            Row(2, name + "flow rate", "< 1 x", f"{found.gain:.2f}", found.gain < 1.0),
        ]
    return rows


def array_of_256() -> list[Row]:
    """Reach 3: the array of 256 of the notes, 30 steps."""
    domain = voronoi_plexus(256, width=58.0, height=37.0, channel=0.58, seed=1)
    found = run(domain, vc.Angiogenesis(steps=30))
    count, order = found.count, found.order
    return [
        Row(3, "pillars", "<= 130", f"{count[0]} to {count[-1]}, flow x {found.gain:.2f}", count[-1] <= 130),
        Row(3, "order", ">= 0.8", f"{order[0]:.2f} to {order[-1]:.3f}", order[-1] >= 0.8),
        Row(3, "merges along the flow", ">= 0.8", f"{found.along:.3f}", found.along >= 0.8),
    ]


@cache
def grown(seed: int) -> vc.Domain:
    """Grow a tissue of 12,000 nodes to a plexus, and take its domain."""
    tissue = vc.grow_plexus(vc.lattice(nodes=NODES, seed=seed), vc.Vasculogenesis(), seed=seed)
    return vc.extract_domain(tissue, vc.Extraction())


def grown_plexus() -> list[Row]:
    """Reach 4: plexuses from a tissue; asked is the spread of the notes' runs, which took 40 to 60 steps."""
    rows = []
    for seed in GROWN_SEEDS:
        found = run(grown(seed), vc.Angiogenesis(steps=GROWN_STEPS))
        for step in (40, GROWN_STEPS):
            until = found.when <= step
            left, order, local = found.count[step] / found.count[0], found.order[step], found.alignment[step]
            along, with_flow = mean_cosine(found.angles[until]), mean_cosine(found.local[until])
            gain, ratio = found.flow[step] / found.flow[0], found.shear_ratio[step]
            name = f"seed {seed}, step {step}: "
            text = f"{found.count[0]} to {found.count[step]} ({left:.2f})"
            where = f"{along:.3f} ({with_flow:.3f})"
            rows += [
                Row(4, name + "pillars", "0.44 to 0.60", text, 0.44 <= left <= 0.60),
                Row(4, name + "order", ">= 0.45", f"{found.order[0]:.2f} to {order:.3f}", order >= 0.45),
                Row(4, name + "alignment", ">= 0.72", f"{found.alignment[0]:.2f} to {local:.3f}", local >= 0.72),
                Row(4, name + "flow rate", ">= 2.5 x", f"{gain:.2f}", gain >= 2.5),
                Row(4, name + "merges along x (local flow)", ">= 0.31", where, along >= 0.31),
                Row(4, name + "shear ratio", "<= 20", f"{ratio:.1f}", ratio <= 20.0),
            ]
    return rows


def same_picture(number: int, pairs: dict[str, tuple[Run, Run]]) -> list[Row]:
    """Compare the ends of runs that should tell the same, and their means over all seeds."""
    rows = []
    for name, (usual, other) in pairs.items():
        counts, orders = (usual.count[-1], other.count[-1]), (usual.order[-1], other.order[-1])
        near, alike = abs(int(counts[0] - counts[1])) <= 2, abs(orders[0] - orders[1]) <= 0.05
        rows += [
            Row(number, f"{name}: pillars", "within 2", f"{counts[0]} and {counts[1]}", near),
            Row(number, f"{name}: order", "within 0.05", f"{orders[0]:.3f} and {orders[1]:.3f}", alike),
        ]
    for what, margin in (("count", 2.0), ("order", 0.05)):
        one, two = (float(np.mean([getattr(p[k], what)[-1] for p in pairs.values()])) for k in (0, 1))
        text = f"{one:.3f} and {two:.3f}"
        rows.append(Row(number, f"mean {what} of {len(pairs)}", f"within {margin:g}", text, abs(one - two) <= margin))
    return rows


def finer_meshes(seeds: int) -> list[Row]:
    """Reach 5: membrane and flow mesh of half the size, to the same accumulated strain.

    Cap, merge gap, closing and the length over which the shear is smoothed stay as they are.
    """
    usual = vc.Angiogenesis()
    half = {
        "membrane_spacing": usual.membrane_spacing / 2,
        "flow_spacing": usual.flow_spacing / 2,
        "flow_across": usual.flow_across * 2,
        "step_cap": usual.step_cap * 2,
        "merge_gap": usual.merge_gap * 2,
        "closing": usual.closing * 2,
        "smoothing": usual.smoothing * 4,
        "steps": 200,
    }
    pairs = {}
    for seed in range(seeds):
        found = sixteen(seed)
        pairs[f"seed {seed}"] = (found, sixteen(seed, **half, strain_limit=float(found.time[-1])))
    return same_picture(5, pairs)


def smaller_steps(number: int, seeds: int, activation: float) -> list[Row]:
    """Reaches 6 and 7: half the cap, to the same accumulated strain.

    Half the activation as well makes every pillar take half its way in a step. Without that the pillars under the cap
    go half as far and the others as far as before, so that they change at other rates to each other.
    """
    pairs = {}
    for seed in range(seeds):
        found = sixteen(seed)
        changes = {"step_cap": vc.Angiogenesis().step_cap / 2, "activation": activation}
        other = sixteen(seed, steps=200, strain_limit=float(found.time[-1]), **changes)
        pairs[f"seed {seed}, {len(other.time) - 1} steps"] = (found, other)
    return same_picture(number, pairs)


def main() -> int:
    """Make the reaches that are asked for and print the table."""
    reaches: dict[int, Callable[..., list[Row]]] = {
        1: sixteen_pillars,
        2: without_information,
        3: array_of_256,
        4: grown_plexus,
        5: finer_meshes,
        6: partial(smaller_steps, 6, activation=vc.Angiogenesis().activation),
        7: partial(smaller_steps, 7, activation=vc.Angiogenesis().activation / 2),
    }
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", type=int, nargs="+", choices=reaches, default=list(reaches), help="reaches to make")
    parser.add_argument("--seeds", type=int, default=8, choices=range(1, 33), help="seeds of all but 3 and 4")
    options = parser.parse_args()
    seeded = {number: partial(reaches[number], seeds=options.seeds) for number in reaches if number not in (3, 4)}
    return print_table(reaches | seeded, options.only)


if __name__ == "__main__":
    sys.exit(main())
