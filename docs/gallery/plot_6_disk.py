"""
A disk becomes an ellipse
=========================

One round cell in a channel, as in Fig 4 of the paper. The blood is fast at its flanks and slow at
its poles, so the cell contracts across the flow and stretches along it.
"""

import matplotlib.pyplot as plt

import vasculo as vc
from vasculo.draw.show import show
from vasculo.plexus.voronoi import disk_domain

domain = disk_domain(width=8.0, height=6.0)
steps = []
final = vc.remodel(domain, vc.Angiogenesis(steps=8, flow_spacing=1.0), watch=steps.append)

figure, axes = plt.subplots(1, 2, figsize=(8, 3.2), layout="constrained")
for ax, step in zip(axes, (steps[0], steps[-1]), strict=True):
    show(step.flow, axes=ax)
    shape = vc.measure.pillars(step.domain)
    ax.set_title(f"step {step.step}: aspect ratio {shape.aspect_ratio[0]:.2f}", fontsize=9)
plt.show()

# %%
# Area and place are kept: the interior is a fluid that cannot be pressed together, and the matrix
# holds the cell.

before, after = vc.measure.pillars(domain), vc.measure.pillars(final)
print(f"area {before.area[0]:.4f} to {after.area[0]:.4f}")
print(f"long axis against the flow: {after.orientation[0]:.1f} degrees")
