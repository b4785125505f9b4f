"""Cost of a remodelling step against the number of pillars: seconds by part, sizes, memory, and whether it is linear.

Run: python benchmarks/remodel_cost.py [--pillars 100 250 500 1000 2500 5000] [--steps 5] [--across 2] [--picture FILE]
The pillars are those of the ideal plexus (`voronoi_plexus`, channel 0.6). Each size runs in a process of its own; MB is
its peak memory. Seconds are medians over the steps from the second on, on the clock ("wall") and of the processors
("cpu", all threads together; VASCULO_THREADS and MKL_NUM_THREADS say how many there are). "cells" is all but the mesh
and the flow. The last column is the processors' time a pillar over that of the smallest size. The picture shows the
last step of the largest size.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
from pathlib import Path
from time import perf_counter, process_time

import numpy as np

from vasculo import measure
from vasculo.pillars import angiogenesis, sense
from vasculo.pillars.angiogenesis import Angiogenesis, RemodelStep, remodel
from vasculo.plexus.voronoi import voronoi_plexus

SIZES = [100, 250, 500, 1000, 2500, 5000]
PARTS = ("mesh", "flow", "cells")
WARM_UP = 2  # steps 0 and 1 load the kernels


def main() -> None:
    """Print the table, or measure one row of it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pillars", type=int, nargs="+", default=SIZES)
    parser.add_argument("--steps", type=int, default=5, help="geometry steps, 2 or more")
    parser.add_argument("--across", type=int, default=2, help="triangles across a passage")
    parser.add_argument("--picture", type=Path)
    parser.add_argument("--row", action="store_true", help=argparse.SUPPRESS)
    chosen = parser.parse_args()
    if chosen.steps < WARM_UP:
        parser.error(f"--steps {chosen.steps} leaves nothing to measure: {WARM_UP} or more")
    if chosen.row:
        print(json.dumps(row(chosen.pillars[0], chosen.steps, chosen.across, chosen.picture)))
        return
    heads = ["pillars", "left", "nodes", "triangles"]
    heads += [f"{part} {clock}" for part in (*PARTS, "step") for clock in ("wall", "cpu")] + ["MB", "ratio"]
    print(("{:>11}" * len(heads)).format(*heads))
    first = 0.0
    for size in chosen.pillars:
        call = [sys.executable, __file__, "--row", "--pillars", str(size), "--steps", str(chosen.steps)]
        call += ["--across", str(chosen.across)]
        if chosen.picture and size == max(chosen.pillars):
            call += ["--picture", str(chosen.picture)]
        found = json.loads(subprocess.run(call, check=True, stdout=subprocess.PIPE, text=True).stdout)
        seconds = [found[part] for part in PARTS]
        seconds.append([sum(column) for column in zip(*seconds, strict=True)])
        each = seconds[-1][1] / found["pillars"]
        first = first or each
        print(
            f"{found['pillars']:11d}{found['left']:11d}{found['nodes']:11d}{found['triangles']:11d}"
            + "".join(f"{value:11.3f}" for pair in seconds for value in pair)
            + f"{found['peak']:11.0f}{each / first:11.3f}",
            flush=True,
        )


def row(size: int, steps: int, across: int, picture: Path | None) -> dict[str, object]:
    """Run one size; sizes are means and seconds medians over the measured steps, seconds as [wall, processors]."""
    # Both clocks at once: the loop subtracts and adds what its clock gives, so it may give arrays.
    for module in (angiogenesis, sense):
        vars(module)["perf_counter"] = lambda: np.array([perf_counter(), process_time()])
    domain = voronoi_plexus(size, channel=0.6, seed=0)
    seconds: list[list[np.ndarray]] = []
    counts: list[tuple[int, int]] = []
    last: list[RemodelStep] = []

    def watch(step: RemodelStep) -> None:
        last[:] = [step]
        if step.step >= WARM_UP:
            seconds.append([np.asarray(step.seconds_by_part[part]) for part in PARTS])
            counts.append((len(step.state.points), len(step.mesh.triangles)))

    remodel(domain, Angiogenesis(steps=steps, flow_across=across), watch)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    if picture:
        draw(last[0], picture)
    nodes, triangles = (round(value) for value in np.mean(counts, axis=0))
    sizes = {"pillars": len(domain.pillars), "left": len(last[0].domain.pillars), "nodes": nodes}
    parts = dict(zip(PARTS, np.median(seconds, axis=0).tolist(), strict=True))
    return sizes | {"triangles": triangles, "peak": peak} | parts


def draw(step: RemodelStep, path: Path) -> None:
    """Draw the speed and the pillars of a step, the whole and a piece of it."""
    from vasculo.draw.canvas import fragment, new_figure, save  # noqa: PLC0415
    from vasculo.draw.flow import draw_speed, fastest_point, mesh_box  # noqa: PLC0415

    box = mesh_box(step.mesh)
    figure = new_figure(15.0, 7.0)
    whole, piece = figure.subplots(1, 2, width_ratios=[1.44, 1.0])
    merged = measure.chains(step.domain, step.lineage).fraction
    title = f"step {step.step}: {len(step.domain.pillars)} pillars, {len(step.mesh.triangles)} triangles, "
    draw_speed(whole, step.flow, step.domain.pillars, box, f"{title}{merged:.0%} of the first ones in chains")
    close = fragment(box, fastest_point(step.flow), 0.2)
    draw_speed(piece, step.flow, step.domain.pillars, close, "a piece of it")
    save(figure, path)


if __name__ == "__main__":
    main()
