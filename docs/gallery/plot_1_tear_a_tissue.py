"""
Tear a tissue
=============

A mesh of elastic fibres is pinned at its border. Its fibres shorten slowly, as cells pull on the
matrix around them, until those that are stretched too far break. What is left is a plexus: cords
around voids. The voids will be the pillars of the vessels, the cords the ground in which the
vessels run.
"""

import matplotlib.pyplot as plt

import vasculo as vc
from vasculo.draw.show import show

# %%
# The tissue is a relaxed irregular mesh on the unit square, every spring at its rest length. In a
# notebook, an object on the last line of a cell shows itself.

tissue = vc.lattice(nodes=2_500, seed=1)
tissue

# %%
# ``grow_plexus`` leaves the tissue as it is and gives back the torn one. On its way it calls
# ``watch`` with a step that holds a copy of the network. Here one is kept each time the voids
# have grown by another seventh of the tissue.

kept = []


def keep(step):
    if step.void_fraction >= 0.15 * len(kept):
        kept.append(step)


growth = vc.Vasculogenesis(pillar_spacing=0.16)
plexus = vc.grow_plexus(tissue, growth, seed=1, watch=keep)

stages = [kept[1], kept[-1]]
figure, axes = plt.subplots(1, 3, figsize=(9, 3.1), layout="constrained")
for ax, step in zip(axes, stages, strict=False):
    show(step.network, axes=ax)
    ax.set_title(f"{step.void_fraction:.0%} void, {step.voids} voids", fontsize=9)
show(plexus, axes=axes[2])
axes[2].set_title(f"tightened: {len(plexus.springs):,} springs", fontsize=9)
plt.show()

# %%
# Springs are drawn as wide and as dark as they pull. In numbers, widths in mean spring lengths of
# the whole tissue:

numbers = vc.measure.plexus(plexus)
print(f"voids                {numbers.voids}")
print(f"share of voids       {numbers.void_fraction:.2f}")
print(f"width of a cord      {numbers.cord_width:.2f}")
