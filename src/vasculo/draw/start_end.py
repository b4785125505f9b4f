"""Wall shear along the pillars at the first and the last step, and the flow beside its mesh before all remodelling."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vasculo.draw.canvas import fragment, new_figure
from vasculo.draw.flow import draw_mesh, draw_speed, fastest_point, mesh_box
from vasculo.draw.frames import cells_of
from vasculo.draw.pillars import draw_shear, shear_scale

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from vasculo.store.read import Run


def draw_flow(run: Run) -> Figure:
    """Draw the speed in a fragment, and the mesh of it, before any remodelling (Fig 3)."""
    first = run.steps("angiogenesis")[0]
    flow, outlines = run.flow(first), run.pillars(first).outlines
    box = mesh_box(flow.mesh)
    few = len(outlines) < 5
    part = fragment(box, fastest_point(flow), 0.8 if few else max(0.3, min(0.6, (16 / len(outlines)) ** 0.5)))
    inlet = run.settings["angiogenesis"].get("inlet", "left")
    figure = new_figure(9.6, 5.0)
    left, right = figure.subplots(1, 2)
    colours = draw_speed(left, flow, outlines, part, f"speed · step {first} · fragment, flow from the {inlet}")
    bar = figure.colorbar(colours, ax=left, location="bottom", shrink=0.6, aspect=40, pad=0.02)
    top = colours.norm.vmax
    bar.set_ticks([0.0, 0.1 * top, 0.3 * top, 0.6 * top, top], labels=[f"{k * top:.2g}" for k in (0, 0.1, 0.3, 0.6, 1)])
    bar.ax.tick_params(labelsize=7)
    bar.minorticks_off()
    bar.set_label("speed, model units", fontsize=7.5)
    draw_mesh(
        right, flow.mesh, outlines, part, f"the mesh of this fragment · {len(flow.mesh.triangles)} triangles in all"
    )
    return figure


def draw_wall_shear(run: Run) -> Figure:
    """Draw the wall shear on the pillars at the start and at the end, on one scale."""
    steps = sorted({run.steps("angiogenesis")[0], run.steps("angiogenesis")[-1]})
    flows = [run.flow(step) for step in steps]
    box = mesh_box(flows[0].mesh)
    figure, cells = cells_of(box, len(steps), 0.5)
    top = max(shear_scale(flow) for flow in flows)
    for axes, flow, step in zip(cells, flows, steps, strict=False):
        lines = draw_shear(axes, flow, run.pillars(step).outlines, box, f"step {step}", top)
    bar = figure.colorbar(
        lines, ax=cells[: len(steps)], location="bottom", shrink=0.5, aspect=50, pad=0.02, extend="max"
    )
    bar.ax.tick_params(labelsize=7)
    unit, factor = "model pressure", run.settings.get("units", {}).get("shear")
    if factor is not None:
        unit = "dyn/cm2"
        bar.ax.xaxis.set_major_formatter(lambda value, _: f"{value * factor:.3g}")
    bar.set_label(f"wall shear, {unit}; centre: the larger mean of the two", fontsize=7.5)
    return figure
