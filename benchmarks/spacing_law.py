"""The law behind `pillar_spacing`: grow many tissues with drawn settings, count their voids, fit the spacing.

Prints the fit as it stands in `vasculo.tissue.spacing`, its scatter, and how well spacings that are asked for are met.
About ten minutes on two cores with the default number of runs.
"""

from __future__ import annotations

import argparse
import itertools
import json
from multiprocessing import get_context
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure
from scipy.stats import qmc

from vasculo import measure
from vasculo.errors import ComputationError
from vasculo.plexus.voids import void_fraction
from vasculo.springs.threads import set_threads
from vasculo.tissue.lattice import lattice
from vasculo.tissue.spacing import terms
from vasculo.tissue.vasculogenesis import Vasculogenesis, grow_plexus

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

NODES = 12_000
RANGES = {  # lowest, highest, drawn evenly in the logarithm
    "load": (0.001, 0.06, True),
    "threshold": (0.3, 0.7, True),
    "threshold_spread": (0.05, 0.4, False),
    "tether": (0.0, 0.1, False),
    "stop_void_fraction": (0.25, 0.5, False),
    "jitter": (0.1, 0.5, False),
}


def grow(case: dict[str, Any]) -> dict[str, Any]:
    """Grow one tissue; returns the case with the spacing of its voids in mean spring lengths, nan where it failed."""
    set_threads(1)
    values = dict(case)
    tissue = lattice(NODES, values.pop("seed"), kind=values.pop("kind"), jitter=values.pop("jitter"))
    length = tissue.lengths()
    damping = values.pop("damping")
    keys = Vasculogenesis(growth_rate=values.pop("load") / damping, damping=damping, **values)
    case |= {"variation": float(length.std() / length.mean())}
    try:
        fraction, voids = void_fraction(grow_plexus(tissue, keys, case["seed"]))
    except ComputationError as error:
        return case | {"spacing": float("nan"), "error": str(error)}
    return case | {"spacing": float(1.0 / np.sqrt(voids) / length.mean()), "voids": voids, "fraction": fraction}


def drawn(runs: int, seed: int) -> list[dict[str, Any]]:
    """Draw the settings of the runs: half vary the load alone, half everything (Latin hypercube)."""
    rng = np.random.default_rng(seed)
    cases = []
    for u in qmc.LatinHypercube(len(RANGES), rng=rng).random(runs):
        case: dict[str, Any] = {"seed": len(cases), "damping": 5.0, "kind": "relaxed"}
        for (name, (low, high, logarithmic)), share in zip(RANGES.items(), u, strict=True):
            case[name] = float(low * (high / low) ** share if logarithmic else low + (high - low) * share)
        case["tether"] = 0.1 * (case["tether"] / 0.1) ** 3  # most of them weak
        if len(cases) % 2:
            case |= {"threshold": 0.5, "threshold_spread": 0.2, "tether": 0.01, "stop_void_fraction": 0.4}
        else:
            case["kind"] = str(rng.choice(["relaxed", "jittered", "poisson"]))
            case["damping"] = float(rng.choice([1.0, 2.5, 5.0, 10.0]))
        cases.append(case)
    return cases


def columns(rows: list[dict[str, Any]]) -> dict[str, Floats]:
    """Terms of the law for the runs, and the logarithm of their spacing."""
    names = ("load", "threshold", "threshold_spread", "tether", "stop_void_fraction", "variation")
    return terms(*(np.array([row[name] for row in rows]) for name in names))


def fit(rows: list[dict[str, Any]]) -> dict[str, float]:
    """Fit the law: its dependence on the load from runs that vary nothing else, the other terms from the rest."""
    spacing = np.log([row["spacing"] for row in rows])
    found = columns(rows)
    plain = np.array([row["threshold"] == 0.5 and row["tether"] == 0.01 for row in rows])
    line = ("1", "load", "load*load")
    law: dict[str, float] = {}
    for names, chosen in ((line, plain), (tuple(name for name in found if name not in line), ~plain)):
        matrix = np.column_stack([found[name][chosen] for name in names])
        left = spacing[chosen] - sum(law[name] * found[name][chosen] for name in law)
        law |= dict(zip(names, np.linalg.lstsq(matrix, left, rcond=None)[0].tolist(), strict=True))
    off = spacing - sum(law[name] * found[name] for name in law)
    print(f"{len(rows)} runs; scatter of ln(spacing): load alone {off[plain].std():.3f}, all {off[~plain].std():.3f}")
    for name, value in law.items():
        print(f'        "{name}": {value:.4f},')
    for low, high in itertools.pairwise((0.001, 0.002, 0.004, 0.008, 0.016, 0.03, 0.06)):
        inside = plain & np.array([low <= row["load"] < high for row in rows])
        mean, spread = np.exp(spacing[inside]).mean(), np.exp(spacing[inside]).std()
        print(f"load {low:g} to {high:g}: spacing {mean:.2f} +- {spread:.2f} L0, {inside.sum()} runs")
    return law


def draw(rows: list[dict[str, Any]], law: dict[str, float], file: Path) -> None:
    """Draw spacing over load: the runs that vary the load alone, the others moved to it by the law, and the fit."""
    figure = Figure(figsize=(8, 4.5), layout="constrained")
    axes = figure.add_subplot()
    found, spacing = columns(rows), np.array([row["spacing"] for row in rows])
    others = sum(value * found[name] for name, value in law.items() if name not in {"1", "load", "load*load"})
    load = np.array([row["load"] for row in rows])
    plain = np.array([row["threshold"] == 0.5 and row["tether"] == 0.01 for row in rows])
    axes.plot(
        load[~plain], (spacing / np.exp(others))[~plain], "+", color="0.6", label="all settings, moved by the law"
    )
    axes.plot(load[plain], spacing[plain], ".", color="k", markersize=4, label="load alone")
    x = np.geomspace(0.001, 0.06, 100)
    depth = np.log(x / 0.0045)
    axes.plot(x, np.exp(law["1"] + law["load"] * depth + law["load*load"] * depth**2), color="tab:red", label="fit")
    axes.set(xscale="log", yscale="log", xlabel="load D rho  (k, m, sqrt(m / k))", ylabel="spacing of voids  (L0)")
    axes.set_yticks([4, 5, 6, 8, 10, 12, 15], labels=["4", "5", "6", "8", "10", "12", "15"], minor=False)
    axes.set_yticks([], minor=True)
    axes.legend(frameon=False)
    figure.savefig(file, dpi=120)


def ask(case: tuple[float, int, int, dict[str, Any]]) -> tuple[float, float, float, float]:
    """Ask for a spacing; returns those measured: spacing, void fraction, variation and mean diameter over spacing."""
    set_threads(1)
    spacing, nodes, seed, options = case
    plexus = grow_plexus(lattice(nodes, seed), Vasculogenesis(pillar_spacing=spacing, **options), seed)
    found = measure.plexus(plexus)
    unit = float(np.mean(lattice(nodes, seed).rest_lengths))
    return found.spacing * unit, found.void_fraction, found.variation, found.mean_diameter / found.spacing


def check(workers: int) -> None:
    """Print spacings asked for and met: other seeds, other numbers of nodes, other time steps."""
    cases = [
        (spacing, nodes, options)
        for spacing, nodes, options in (
            *((spacing, 12_000, {}) for spacing in (0.055, 0.065, 0.08, 0.1, 0.12)),
            *((0.08, nodes, {}) for nodes in (6_000, 9_000, 18_000, 26_000)),
            *((0.08 * (12_000 / nodes) ** 0.5, nodes, {}) for nodes in (3_000, 48_000, 192_000)),  # 7.8 L0 each
            *((0.08, 12_000, {"time_step": step}) for step in (0.05, 0.1, 0.4)),
            (0.08, 12_000, {"tether": 0.0}),
            (0.08, 12_000, {"tether": 0.05, "stop_void_fraction": 0.3}),
            (0.08, 12_000, {"threshold": 0.35, "threshold_spread": 0.3}),
        )
    ]
    seeds = range(1000, 1005)
    print("| asked | nodes | other settings | met | met / asked | void fraction | variation of area | d_A / spacing |")
    print("|---:|---:|---|---:|---:|---:|---:|---:|")
    with get_context("spawn").Pool(workers) as pool:
        for spacing, nodes, options in cases:
            found = np.array(pool.map(ask, [(spacing, nodes, seed, options) for seed in seeds]))
            mean, spread = found.mean(axis=0), found.std(axis=0)
            words = ", ".join(f"{name} {value:g}" for name, value in options.items()) or "none"
            print(
                f"| {spacing:.4g} | {nodes} | {words} | {mean[0]:.4f} +- {spread[0]:.4f} | {mean[0] / spacing:.3f} | "
                + " | ".join(f"{one:.2f} +- {other:.2f}" for one, other in zip(mean[1:], spread[1:], strict=True))
                + " |",
                flush=True,
            )


def main() -> None:
    """Grow or read, and fit."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=int, default=400)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--data", type=Path, default=Path("spacing_law.json"), help="kept here, read if it is there")
    parser.add_argument("--figure", type=Path, help="picture of the fit")
    parser.add_argument("--check", action="store_true", help="ask for spacings instead, and see what is met")
    options = parser.parse_args()
    if options.check:
        check(options.workers)
        return
    if options.data.exists():
        rows = json.loads(options.data.read_text())
    else:
        with get_context("spawn").Pool(options.workers) as pool:
            rows = list(pool.imap(grow, drawn(options.runs, options.seed), chunksize=4))
        options.data.write_text(json.dumps(rows))
    good = [row for row in rows if np.isfinite(row["spacing"])]
    for row in rows:
        if "error" in row:
            print(f"seed {row['seed']}: {row['error']}")
    law = fit(good)
    if options.figure is not None:
        draw(good, law, options.figure)


if __name__ == "__main__":
    main()
