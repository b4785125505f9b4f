"""
Wall shear on the pillars
=========================

Pillars feel the blood as friction along their membranes. This is what they will react to: where it
is above its mean along a membrane the cell contracts, where it is below it stretches.
"""

import matplotlib.pyplot as plt
import numpy as np

import vasculo as vc
from vasculo.draw.pillars import draw_shear
from vasculo.plexus.voronoi import voronoi_plexus

# %%
# A block of rounded cells between mirror walls; the unit of length is the mean radius of a
# pillar.

domain = voronoi_plexus(9, seed=3)
mesh = vc.generate_mesh(domain, edge_length=0.35, wall_edge_length=0.15)
slip = {"top": vc.Slip(), "bottom": vc.Slip()}
flow = vc.solve_stokes(mesh, {"left": vc.Pressure(1.0), "right": vc.Pressure(0.0), **slip})

figure, ax = plt.subplots(figsize=(7, 4), layout="constrained")
lines = draw_shear(ax, flow, domain.pillars, domain.bounds)
figure.colorbar(lines, ax=ax, shrink=0.8, label="wall shear, pressure drops")
plt.show()

# %%
# The middle of the scale is the mean over all membranes. Each pillar by itself:

spread = vc.measure.shear_distribution(flow)
around = (spread.pillar_deviations / spread.pillar_means).mean()
print(f"mean wall shear                    {spread.mean:.4f}")
print(f"spread around a pillar             {around:.2f} of its mean")
print(f"mean of a pillar                   {spread.pillar_means.min():.4f} to {spread.pillar_means.max():.4f}")
drag = np.hypot(*flow.drag().T)
print(f"force on a pillar                  {drag.min():.3f} to {drag.max():.3f}")
