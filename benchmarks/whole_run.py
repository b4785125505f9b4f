"""Whole runs of a built-in study from nothing: wall time and peak memory, first with nothing compiled, then again.

Usage: python benchmarks/whole_run.py [STUDY]
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import vasculo as vc


def timed(study: str, out: Path, cache: Path) -> float:
    """Run a study in a process of its own; wall time in seconds."""
    begin = time.perf_counter()
    command = [sys.executable, "-m", "vasculo", "run", study, "--out", str(out), "--quiet"]
    subprocess.run(command, check=True, env=os.environ | {"NUMBA_CACHE_DIR": str(cache)})
    return time.perf_counter() - begin


def main() -> None:
    """Run the study twice and print what it led to."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("study", nargs="?", default="paper")
    study = parser.parse_args().study
    with tempfile.TemporaryDirectory() as folder:
        for state in ("cold", "warm"):
            seconds = timed(study, Path(folder) / state, Path(folder) / "cache")
            peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024.0
            print(f"{study}, {state}: {seconds:.1f} s, peak {peak:.0f} MB")
        metrics = vc.open_run(Path(folder) / "warm").metrics
    rows = [i for i, stage in enumerate(metrics["stage"]) if stage == "angiogenesis"]
    if rows:
        first, last = rows[0], rows[-1]
        flow = metrics["permeability"][last] / metrics["permeability"][first]
        print(f"pillars {metrics['pillars'][first]:.0f} to {metrics['pillars'][last]:.0f}, permeability x {flow:.2f}")
        for name in ("order", "alignment", "aspect_ratio"):
            print(f"{name} {metrics[name][first]:.2f} to {metrics[name][last]:.2f}")


if __name__ == "__main__":
    main()
