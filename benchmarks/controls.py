"""Controls of the flow-driven stage: one thing changed at a time, on the same plexuses, and what comes of it.

Run: python -m benchmarks.controls [--only rolled hanging] [--seeds 0 1 2] [--picture docs/images/controls.png]
Prints a markdown table. Each control is a switch of `Angiogenesis` (or a mirrored or turned layout) on
`voronoi_plexus(16, channel=0.4, seed=...)`, 40 steps; numbers are means over the seeds, merges and their direction are
pooled; a run that fails on the way is counted up to there. Some controls must do something for the rule to be believed:
the table says what, and the exit status is the number of those that do not.
"""

from __future__ import annotations

import argparse
import sys
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from benchmarks.pillar_runs import Run, mean_cosine, mirrored, run, turned

import vasculo as vc
from vasculo.draw.canvas import INK, new_figure, panel, save
from vasculo.draw.pillars import draw_pillars
from vasculo.plexus.voronoi import voronoi_plexus

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

CHANNEL, SEEDS = 0.4, (0, 1, 2)
COLUMNS = 5  # of the picture


class Outcome(NamedTuple):
    """A control over all seeds: counts and values of start and end, a seed an entry, and the merges of all."""

    runs: list[Run]

    def ends(self, name: str) -> tuple[Floats, Floats]:
        """First and last value of a number in every run."""
        values = [getattr(run, name) for run in self.runs]
        return np.array([v[0] for v in values]), np.array([v[-1] for v in values])

    @property
    def gain(self) -> float:
        """Flow rate of the end over that of the start, mean."""
        return float(np.mean([run.gain for run in self.runs]))

    @property
    def merges(self) -> int:
        """Merges of all runs."""
        return sum(run.merges for run in self.runs)

    @property
    def along(self) -> float:
        """Mean cos 2 phi of all merges; NaN without."""
        return mean_cosine(np.concatenate([run.angles for run in self.runs]))

    @property
    def turned(self) -> float:
        """Largest change of order."""
        first, last = self.ends("order")
        return float(np.abs(last - first).max())


def makes_chains(found: Outcome) -> bool:
    """Whether the pillars align and merge along the flow, and the flow grows."""
    order = found.ends("order")[1].mean()
    return bool(order >= 0.75 and found.along >= 0.8 and found.gain >= 2.5)


def no_chains(found: Outcome) -> bool:
    """Whether order stays as it is and the flow does not grow."""
    return found.turned < 0.3 and found.gain < 1.05


def aimless(found: Outcome) -> bool:
    """Whether neither pillars nor merges are along the flow, and it does not grow."""
    order = found.ends("order")[1].mean()
    return bool(order < 0.3 and (not found.merges or found.along < 0.3) and found.gain < 1.05)


def across(found: Outcome) -> bool:
    """Whether the pillars turn and merge across the flow and close it."""
    return bool(found.ends("order")[1].mean() < -0.5 and found.along < -0.5 and found.gain < 0.5)


def stands_still(found: Outcome) -> bool:
    """Whether nothing changes."""
    first, last = found.ends("ratio")
    return bool(np.abs(last - first).max() < 0.01 and not found.merges)


def stalls(found: Outcome) -> bool:
    """Whether the last ten steps change the mean aspect ratio by less than 2 %, without chains."""
    late = np.array([run.ratio[-1] / run.ratio[-11] - 1.0 for run in found.runs])
    return bool(np.abs(late).max() < 0.02 and not makes_chains(found))


def pushed(found: Outcome) -> bool:
    """Whether all pillars are pushed downstream, keep their distances and do not merge."""
    if found.merges:
        return False
    shifts = [
        np.mean(vc.measure.pillars(r.last).centroid - vc.measure.pillars(r.first).centroid, axis=0) for r in found.runs
    ]
    return no_chains(found) and all(x > 0.0 and abs(y) < 0.1 * x for x, y in shifts)


@dataclass(frozen=True)
class Control:
    """One change: parameters, the layout if it is another, direction of the flow (degrees), and what must be seen."""

    name: str
    changes: dict[str, Any] = field(default_factory=dict)
    layout: Callable[[vc.Domain], vc.Domain] = lambda domain: domain
    toward: float = 0.0
    must: tuple[str, Callable[[Outcome], bool]] | None = None

    def outcome(self, seeds: list[int]) -> Outcome:
        """Run it on every seed."""
        parameters = vc.Angiogenesis(**{"steps": 40, **self.changes})
        layouts = [self.layout(voronoi_plexus(16, channel=CHANNEL, seed=seed)) for seed in seeds]
        return Outcome([run(layout, parameters, self.toward, may_stop=True) for layout in layouts])


CHAINS = ("chains", makes_chains)
NO_CHAINS = ("no order, no flow", no_chains)
PUSHED = ("pushed aside together", pushed)
CONTROLS = (
    Control("the rule", must=CHAINS),
    Control("activation zero", {"activation": 0.0}, must=("stands still", stands_still)),
    Control("rolled", {"sensing": "rolled"}, must=NO_CHAINS),
    Control("turned round", {"activation": -0.08}, must=("closes the flow", across)),
    Control("hanging", {"cells": "hanging", "traction": 0.005}, must=PUSHED),
    Control("hanging, full force", {"cells": "hanging", "traction": 0.005, "traction_part": "full"}),
    Control("flow reversed", {"pressure_drop": -1.0}, must=CHAINS),
    Control("mirrored", layout=lambda domain: mirrored(domain, 1), must=CHAINS),
    Control("turned, from below", {"inlet": "bottom", "outlet": "top"}, turned, 90.0, CHAINS),
    Control("flow from below", {"inlet": "bottom", "outlet": "top"}, toward=90.0),
    Control("elastic filaments", {"filament_memory": 1.0}, must=("stalls", stalls)),
    Control("elastic, strain 0.6", {"filament_memory": 1.0, "activation": 0.6}),
    Control("Maxwell, memory 0.7", {"filament_memory": 0.7}),
    Control("filaments off", {"filament_ratio": 0.0}, must=("no direction", aimless)),
    Control("membrane off", {"membrane_ratio": 0.0}),
    Control("bending off", {"bending": 0.0}),
    Control("area pressure off", {"area_stiffness": 0.0}),
    Control("elastic matrix", {"matrix": "elastic"}),
    Control("no matrix", {"matrix": "none"}),
    Control("traction as well", {"traction": 0.02}),
    Control("full force as well", {"traction": 0.02, "traction_part": "full"}),
    Control("no-slip walls", {"walls": "no-slip"}),
    Control("border joining off", {"border_joining": False}),
    Control("erosion", {"erosion": 0.05, "erosion_radius": 0.6}),
    Control("logarithm", {"response": "logarithm"}, must=CHAINS),
    Control("sign", {"response": "sign"}, must=CHAINS),
)


def line(control: Control, found: Outcome) -> str:
    """Write a control as a row of the table."""
    ends = [f"{run.count[-1]}" + f" (step {len(run.time) - 1})" * bool(run.stopped) for run in found.runs]
    cells = [control.name, f"{found.runs[0].count[0]} to {', '.join(ends)}", f"{found.merges}"]
    cells.append(f"{found.along:.2f}" if found.merges else "")
    for name in ("ratio", "order", "alignment"):
        start, end = (values.mean() for values in found.ends(name))
        cells.append(f"{start:.2f} to {end:.2f}")
    cells.append(f"{found.gain:.2f}")
    cells.append(" to ".join(f"{values.mean():.2f}" for values in found.ends("spread")))
    if control.must is None:
        cells.append("")
    else:
        what, holds = control.must
        cells.append(what if holds(found) else f"**not**: {what}")
    return "| " + " | ".join(cells) + " |"


def picture(ends: dict[str, vc.Domain], path: Path) -> None:
    """Draw the last state of every control on the first seed."""
    rows = -(-len(ends) // COLUMNS)
    figure = new_figure(6.875, 0.98 * rows + 0.1)
    grid = figure.subplots(rows, COLUMNS, squeeze=False).ravel()
    for axes in grid[len(ends) :]:
        axes.set_visible(False)
    for axes, (name, domain) in zip(grid, ends.items(), strict=False):
        draw_pillars(axes, domain.pillars)
        panel(axes, domain.bounds)
        axes.set_title(name, fontsize=6.5, color=INK, loc="left", pad=2)
    save(figure, path)


def main() -> int:
    """Run the controls that are asked for, print the table and draw the picture."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", nargs="+", choices=[c.name for c in CONTROLS], metavar="NAME", help="by their names")
    parser.add_argument("--seeds", type=int, nargs="+", default=list(SEEDS))
    parser.add_argument("--picture", type=Path)
    options = parser.parse_args()
    print("| control | pillars | merges | cos 2φ | aspect ratio | order | alignment | flow rate | sd(a) | must |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    clock, failing, ends = time.process_time(), 0, {}
    stops: dict[str, str] = {}
    for control in CONTROLS:
        if options.only and control.name not in options.only:
            continue
        found = control.outcome(options.seeds)
        print(line(control, found), flush=True)
        failing += control.must is not None and not control.must[1](found)
        if control.layout is not turned:  # the same picture, only upright
            ends[control.name] = found.runs[0].last
        for seed, one in zip(options.seeds, found.runs, strict=True):
            if one.stopped:
                stops[f"{control.name}, seed {seed}"] = one.stopped
    for name, why in stops.items():
        print(f"\n{name}: {why}")
    print(f"\n{time.process_time() - clock:.0f} s of processor time")
    if options.picture:
        picture(ends, options.picture)
    return failing


if __name__ == "__main__":
    sys.exit(main())
