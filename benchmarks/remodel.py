"""Seconds a remodelling step takes, split into mesh, flow and cells, at 16, 64 and 146 pillars.

Run: python benchmarks/remodel.py [steps]
The first two steps of each run are left out: they compile or load the kernels.
"""

from __future__ import annotations

import sys

import numpy as np

from vasculo.pillars.angiogenesis import Angiogenesis, RemodelStep, remodel
from vasculo.plexus.voronoi import voronoi_plexus

WARM_UP = 2
SIZES = (16, 64, 146)


def main() -> None:
    """Print one line a size."""
    steps = int(sys.argv[1]) if len(sys.argv) > 1 else 6
    print(f"{'pillars':>8}{'nodes':>8}{'triangles':>11}{'mesh':>8}{'flow':>8}{'cells':>8}{'sum':>8}   s a step")
    for size in SIZES:
        rows: list[dict[str, float]] = []
        last: list[RemodelStep] = []

        def watch(step: RemodelStep, rows: list[dict[str, float]] = rows, last: list[RemodelStep] = last) -> None:
            last[:] = [step]
            if step.step >= WARM_UP:
                rows.append(step.seconds_by_part)

        remodel(voronoi_plexus(size, seed=0), Angiogenesis(steps=steps), watch)
        mesh, flow, cells = (float(np.median([row[part] for row in rows])) for part in ("mesh", "flow", "cells"))
        state = last[0].state
        print(
            f"{len(state.starts) - 1:>8}{len(state.points):>8}{len(last[0].mesh.triangles):>11}"
            f"{mesh:>8.3f}{flow:>8.3f}{cells:>8.3f}{mesh + flow + cells:>8.3f}",
            flush=True,
        )


if __name__ == "__main__":
    main()
