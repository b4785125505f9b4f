"""Wall shear along the pillars at the first and the last step, and the flow beside its mesh before all remodelling."""

from __future__ import annotations

from typing import TYPE_CHECKING

from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from vasculo.draw.canvas import ACCENT, PILLAR, PILLAR_EDGE, WIDTH, fragment
from vasculo.draw.flow import draw_mesh, draw_speed, fastest_point, mesh_box, speed_words
from vasculo.draw.frames import columns_of
from vasculo.draw.pillars import draw_shear, shear_scale
from vasculo.draw.sheet import Legend, key, sheet

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vasculo.store.read import Run


def draw_flow(run: Run, width: float = WIDTH) -> Figure:
    """Draw the speed in a fragment, and the mesh of it, before any remodelling (Fig 3)."""
    first = run.steps("angiogenesis")[0]
    flow, outlines = run.flow(first), run.pillars(first).outlines
    box = mesh_box(flow.mesh)
    few = len(outlines) < 5
    part = fragment(box, fastest_point(flow), 0.8 if few else max(0.3, min(0.6, (16 / len(outlines)) ** 0.5)))
    pillar = Patch(facecolor=PILLAR, edgecolor=PILLAR_EDGE, linewidth=0.5, label="pillar")
    legend = Legend((pillar, Line2D([], [], color=ACCENT, linewidth=0.8, label="triangle edge")))
    made = sheet(part, width, 2, columns_of(part, 2, width), legend=legend)
    left, right = made.panels
    shown = draw_speed(left, flow, outlines, part, f"speed at step {first}, fragment")
    draw_mesh(right, flow.mesh, outlines, part, f"its mesh · {len(flow.mesh.triangles):,} triangles")
    told, words = speed_words(run, flow)
    key(made, run, shown, words, told)
    return made.figure


def draw_wall_shear(run: Run, width: float = WIDTH) -> Figure:
    """Draw the wall shear on the pillars at the start and at the end, on one scale."""
    steps = sorted({run.steps("angiogenesis")[0], run.steps("angiogenesis")[-1]})
    flows = [run.flow(step) for step in steps]
    box = mesh_box(flows[0].mesh)
    made = sheet(box, width, len(steps), min(2, columns_of(box, len(steps), width)))
    top = max(shear_scale(flow) for flow in flows)
    for axes, flow, step in zip(made.panels, flows, steps, strict=True):
        shown = draw_shear(axes, flow, run.pillars(step).outlines, box, f"step {step}", top)
    key(made, run, shown, f"wall shear, {run.units.name('pressure')}", 1.0 / run.units.factor("pressure"))
    return made.figure
