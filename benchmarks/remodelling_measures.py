"""Measures of the remodelling at its start, middle and end, as a table: ideal plexuses, and one grown by the tissue.

python benchmarks/remodelling_measures.py            # 16 and 256 pillars, and a tissue of 12,000 nodes
python benchmarks/remodelling_measures.py 16 grown
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import vasculo as vc
from vasculo import measure
from vasculo.plexus.voronoi import voronoi_plexus

if TYPE_CHECKING:
    from vasculo.pillars.state import RemodelStep

STEPS = (0, 20, 40)


def plexus(name: str) -> vc.Domain:
    """Make a block of so many pillars, or grow a plexus."""
    if name != "grown":
        return voronoi_plexus(int(name), channel=0.4, seed=0)
    tissue = vc.grow_plexus(vc.lattice(nodes=12_000, seed=0), vc.Vasculogenesis(), seed=0)
    return vc.extract_domain(tissue)


def numbers(step: RemodelStep, unit: float) -> dict[str, str]:
    """All measures of one step; lengths in `unit`."""
    domain, flow = step.domain, step.flow
    angles, friction = measure.local_angles(domain, flow), measure.local_angles(domain, flow, "friction")
    chains, shear, lanes = (
        measure.chains(domain, step.lineage),
        measure.shear_distribution(flow),
        measure.corridors(domain, flow),
    )
    low, middle, high = shear.percentiles() / shear.mean
    return {
        "pillars": f"{len(domain.pillars)}",
        "`order`": f"{measure.order(domain):.2f}",
        "`alignment`": f"{measure.alignment(domain, flow):.2f}",
        "local angle": text(angles.summary()),
        "... weighted by area": text(angles.summary("area")),
        "... aspect ratio above 1.5": text(angles.summary(elongated=1.5)),
        "... of chains": text(angles.summary(only=chains.is_chain)),
        "... to the friction": text(friction.summary()),
        "chains": f"{chains.count}",
        "originals in the largest": f"{chains.largest}",
        "share in chains": f"{chains.fraction:.2f}",
        "longest middle line, $R_0$": f"{chains.path_lengths.max() / unit:.1f}",
        "straightness": f"{chains.mean_straightness:.3f}" if chains.count else "",
        "permeability, $10^{-3} R_0^2$": f"{1e3 * measure.permeability(domain, flow) / unit**2:.1f}",
        "shear over its mean: 5, 50, 95 %": f"{low:.2f}, {middle:.2f}, {high:.2f}",
        "variation, all wall": f"{shear.variation:.2f}",
        "... within pillars": f"{shear.within:.2f}",
        "... between pillars": f"{shear.between:.2f}",
        "shear ratio": f"{shear.ratio:.1f}",
        "lanes": f"{lanes.count:.1f}",
        "lanes that carry the flow": f"{lanes.effective_count:.1f}",
        "their width, $R_0$": f"{lanes.mean_width / unit:.2f}",
        "their run, $R_0$": f"{lanes.mean_run / unit:.1f}",
    }


def text(found: measure.AngleSummary) -> str:
    """Mean, deviation and median of angles."""
    return f"{found.mean:.1f} ± {found.deviation:.1f}; {found.median:.1f}" if found.pillars else ""


def main(names: list[str]) -> None:
    """Run and print."""
    columns: dict[str, dict[str, str]] = {}
    for name in names:
        domain = plexus(name)

        def watch(step: RemodelStep, name: str = name, unit: float = domain.mean_radius) -> None:
            if step.step in STEPS:
                columns[f"{name}, step {step.step}"] = numbers(step, unit)

        vc.remodel(domain, vc.Angiogenesis(steps=max(STEPS)), watch)
    print("|", *(f"| {head}" for head in columns), "|")
    print("|---" * (len(columns) + 1) + "|")
    for row in next(iter(columns.values())):
        print(f"| {row}", *(f"| {column[row]}" for column in columns.values()), "|")


if __name__ == "__main__":
    main(sys.argv[1:] or ["16", "256", "grown"])
