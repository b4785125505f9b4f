"""
Mesh, flow, and how sure it is
==============================

Between parallel walls creeping flow is a parabola, known exactly. That is the first thing to ask of
a solver, before it goes through a plexus. Around a pillar nothing is known exactly, but the numbers
must settle as the triangles get smaller.
"""

import matplotlib.pyplot as plt
import numpy as np

import vasculo as vc
from vasculo.draw.show import show

# %%
# A channel, two units long and one high. A pressure drop of 1 along it drives a fluid of
# viscosity 1 at the speed y (1 - y) / 4, and 1/24 of it passes in a unit of time. The solver fits
# parabolas, so that it is exact here: what is left is rounding, on the coarsest mesh as on the
# finest.

channel = vc.Domain.rectangle(2.0, 1.0)
ends = {"left": vc.Pressure(1.0), "right": vc.Pressure(0.0)}
for size in (0.2, 0.1, 0.05):
    mesh = vc.generate_mesh(channel, edge_length=size)
    flow = vc.solve_stokes(mesh, ends)
    y = mesh.centroids[:, 1]
    error = np.abs(flow.velocity[:, 0] - 0.25 * y * (1.0 - y)).max()
    wrong = abs(flow.flow_rate("right") - 1.0 / 24.0)
    print(f"{len(mesh.triangles):5} triangles: error of the speed {error:.0e}, of the flow {wrong:.0e}")

# %%
# Now with a round pillar in the way, and a mesh that is finer beside it. What flows in flows out,
# whatever the size: the scheme balances every triangle.

turn = np.linspace(0.0, 2.0 * np.pi, 48, endpoint=False)
disk = np.column_stack([0.9 + 0.2 * np.cos(turn), 0.45 + 0.2 * np.sin(turn)])
around = vc.Domain.rectangle(2.0, 1.0, [disk])
for size in (0.16, 0.08, 0.04):
    mesh = vc.generate_mesh(around, edge_length=size, wall_edge_length=0.5 * size)
    flow = vc.solve_stokes(mesh, ends)
    print(
        f"{len(mesh.triangles):5} triangles: flow {flow.flow_rate('right'):.5f}, "
        f"force on the pillar {flow.drag()[0, 0]:.4f}, out of balance by {flow.mass_imbalance:.0e}"
    )

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 2.6), layout="constrained")
show(vc.generate_mesh(around, edge_length=0.08, wall_edge_length=0.04), axes=left)
show(flow, axes=right)
plt.show()

# %%
# A mesh and a flow show themselves.

mesh

# %%
flow
