"""How busy a sweep keeps the processors: 32 runs of a shortened `small` on two workers, from the call to the report.

Usage: python benchmarks/sweep.py [--workers N] [--runs N] [--steps N]

Nothing else should run meanwhile. The reach is 85 % of two processors. Where other programs run all the same, look at
the last line: how much of the time the workers had a run in hand does not depend on them.
"""

from __future__ import annotations

import argparse
import resource
import tempfile
import time
from pathlib import Path

import numpy as np

import vasculo as vc
from vasculo.study.bars import Bars
from vasculo.study.sweep.sweep import sweep


def processor_time(who: int) -> float:
    """Seconds of processor time of this process, or of its children that have ended."""
    used = resource.getrusage(who)
    return used.ru_utime + used.ru_stime


def main() -> None:
    """Run the sweep and print what it took."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--runs", type=int, default=32)
    parser.add_argument("--steps", type=int, default=12)
    asked = parser.parse_args()
    plan = {
        "sweep": {"study": "small", "seeds": asked.runs // 4},
        "settings": {"angiogenesis.steps": asked.steps},
        "vary": {"vasculogenesis.damping": [5.0, 7.0], "vasculogenesis.tether": [0.01, 0.02]},
    }
    with tempfile.TemporaryDirectory() as folder:
        warm = {"angiogenesis.steps": 1, "output.figures": False}
        vc.run("small", out=Path(folder) / "warm", settings=warm)  # compiles what is not in the cache
        before, begin = [processor_time(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)], time.time()
        with Bars() as bars:
            found = sweep(plan, Path(folder) / "sweep", workers=asked.workers, progress=bars)
        wall = time.time() - begin
    own, workers = (
        processor_time(who) - old
        for who, old in zip((resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN), before, strict=True)
    )
    room = asked.workers * wall
    seconds = float(np.nansum(found.table["seconds"]))
    print(f"{len(found.plan.runs)} runs on {asked.workers} workers: {wall:.1f} s")
    print(f"processor time: {workers:.1f} s of the workers, {workers / room:.0%} of {asked.workers} processors")
    print(f"                {own:.1f} s of the sweep itself")
    print(f"runs in hand: {seconds:.1f} s = {seconds / room:.0%} of the time of the workers")


if __name__ == "__main__":
    main()
