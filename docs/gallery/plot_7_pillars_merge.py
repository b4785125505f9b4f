"""
Pillars align and merge
=======================

A small array of pillars, as in Fig 5 of the paper. Each stretches along the stream that passes it,
and neighbours that come to touch become one: the first pieces of a vessel wall.
"""

import matplotlib.pyplot as plt

import vasculo as vc
from vasculo.draw.show import show
from vasculo.plexus.voronoi import voronoi_plexus

domain = voronoi_plexus(9, channel=0.5, seed=3)
steps = []
final = vc.remodel(domain, vc.Angiogenesis(steps=16, flow_spacing=1.0), watch=steps.append)

figure, axes = plt.subplots(1, 2, figsize=(8, 3), layout="constrained")
for ax, step in zip(axes, (steps[0], steps[-1]), strict=True):
    show(step.flow, axes=ax)
    count = len(step.domain.pillars)
    ax.set_title(f"step {step.step}: {count} pillars", fontsize=9)
plt.show()

# %%
# ``order`` is the mean cosine of twice the angle between a pillar and the flow: 0 for any
# direction, 1 when all lie along it. The events say which of them merged, and when.

print(f"order {vc.measure.order(domain):.2f} to {vc.measure.order(final):.2f}")
for step in steps:
    for event in step.events:
        names = " and ".join("+".join(map(str, group)) for group in event.pillars)
        print(f"step {event.step}: {event.kind} of {names}")
