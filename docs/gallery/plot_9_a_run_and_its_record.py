"""
Watch a run, and read it again
==============================

``vc.run`` does what the command ``vasculo run`` does: all stages of a study, with everything kept
in one folder. While it goes on, watchers are told of every step; afterwards every step can be read.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt

import vasculo as vc
from vasculo.draw.show import show


class Shape:
    """Told of every step of the remodelling: how long the disk is by now."""

    def __init__(self):
        self.seen = []

    def remodel(self, step):
        self.seen.append(vc.measure.pillars(step.domain).aspect_ratio[0])


shape = Shape()
folder = Path(tempfile.mkdtemp()) / "disk"
changes = {
    "angiogenesis.steps": 6,
    "angiogenesis.flow_spacing": 1.0,
    "output.figures": False,
}
run = vc.run("disk", out=folder, settings=changes, watchers=[shape])
print("told on the way:", ", ".join(f"{ratio:.2f}" for ratio in shape.seen))

# %%
# The folder can be opened again at any time, by anyone.

run = vc.open_run(folder)
run

# %%
# ``metrics`` is the table of numbers, ``flow``, ``pillars`` and ``domain`` give what was recorded
# of a step.

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.2), layout="constrained", width_ratios=(1.3, 1))
show(run.flow(6), axes=left)
right.plot(run.metrics["step"], run.metrics["mean_wall_shear"], "o-", color="#1f6f8b")
right.set(xlabel="step", ylabel="mean wall shear, model pressure")
plt.show()
