"""
A response of your own
======================

What a cell does with the shear it feels is a law of a few lines. These cells only contract where
the shear is high; they do not stretch where it is low, as those of the paper do as well.
"""

import matplotlib.pyplot as plt
import numpy as np

import vasculo as vc
from vasculo.plexus.voronoi import disk_domain


@vc.cell_response("contract-only")
def contract_only(shear, mean, position):
    """Give the relative difference to the mean, 1 for full contraction, and nothing below the mean."""
    return np.maximum(shear / mean - 1.0, 0.0)


# %%
# A law is used by its name, in Python as in a study file.

ratios = {}
for response in ("linear", "contract-only"):
    steps = []
    cell = vc.Angiogenesis(steps=6, flow_spacing=1.2, response=response)
    vc.remodel(disk_domain(width=8.0, height=6.0), cell, watch=steps.append)
    ratios[response] = [vc.measure.pillars(step.domain).aspect_ratio[0] for step in steps]

figure, ax = plt.subplots(figsize=(4.6, 3.2), layout="constrained")
for (response, values), colour in zip(ratios.items(), ("#1f6f8b", "#b0331f"), strict=True):
    ax.plot(values, "o-", color=colour, label=response)
ax.set(xlabel="step", ylabel="aspect ratio of the disk")
ax.legend(frameon=False)
plt.show()

# %%
# Stretching matters: without it the disk takes the same way more slowly.

for response, values in ratios.items():
    print(f"{response:14} {values[-1]:.3f}")
