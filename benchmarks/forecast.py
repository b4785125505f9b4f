"""How far built-in studies are from what `vasculo check` expects of them: time, memory and size of the record.

    python benchmarks/forecast.py [NAME]...

Each study runs in a process of its own on one thread; its time is that of the processor, without imports, so that other
work on the machine is no harm. Prints a table with the seconds of the stages beside those expected, by which the
constants of `vasculo.study.costs` are set.
"""

import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from vasculo.study.builtin import NAMES, builtin_path
from vasculo.study.costs import stage_seconds
from vasculo.study.forecast import foresee
from vasculo.study.pace import measure_pace
from vasculo.study.run import run
from vasculo.study.settings import read_study
from vasculo.study.watch import Silence

THREADS = {"VASCULO_THREADS": "1", "MKL_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}


class Clock(Silence):
    """Progress that notes the processor time of each stage."""

    def __init__(self):
        self.seconds = {}

    def begin(self, stage, _text):
        """Start the clock."""
        self.stage, self.start = stage, time.process_time()

    def end(self, _text):
        """Stop it."""
        self.seconds[self.stage] = time.process_time() - self.start


def measure(name):
    """Run a study in this process; seconds a stage, MB of memory and of the record."""
    clock = Clock()
    with tempfile.TemporaryDirectory() as folder:
        done = run(name, Path(folder) / "run", progress=clock)
        memory = max(stage["peak_mb"] for stage in done.facts("stages"))
        return {"seconds": clock.seconds, "memory": memory, "record": done.path.stat().st_size / 1e6}


def main(names):
    """Measure studies and print the table."""
    print("| study | s | expected | ratio | MB | expected | ratio | record | expected | ratio | stages: s / expected |")
    print("|---|---|---|---|---|---|---|---|---|---|---|")
    for name in names or NAMES:
        command = [sys.executable, __file__, "--one", name]
        said = subprocess.run(command, env=os.environ | THREADS, capture_output=True, text=True, check=True)
        was, found = json.loads(said.stdout), foresee(read_study(builtin_path(name)), measure_pace())
        stages = {stage: found.pace.factor * seconds for stage, seconds in stage_seconds(found.sizes).items()}
        pairs = [(sum(was["seconds"].values()), sum(stages.values()))]
        pairs += [(was["memory"], found.memory), (was["record"], found.record)]
        cells = [f"{one:.1f} | {other:.1f} | {one / other:.2f}" for one, other in pairs]
        told = [f"{stage} {seconds:.1f} / {stages.get(stage, 0.0):.1f}" for stage, seconds in was["seconds"].items()]
        print(f"| {name} | {' | '.join(cells)} | {', '.join(told)} |", flush=True)


if __name__ == "__main__":
    if sys.argv[1:2] == ["--one"]:
        print(json.dumps(measure(sys.argv[2])))
    else:
        main(sys.argv[1:])
