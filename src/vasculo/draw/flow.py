"""Speed with linear interpolation from node to node, and the mesh it was computed on, as in the paper's Fig 3."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from vasculo.draw.canvas import ACCENT, INK, PILLAR, PRESSURE, SPEED, panel
from vasculo.draw.pillars import add, draw_pillars

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from vasculo.draw.canvas import Box
    from vasculo.flow.solution import Flow
    from vasculo.mesh.triangulation import Triangulation
    from vasculo.store.read import FlowFields, Run

CLIP = 99.5  # percentile of the node speeds that is drawn brightest
GAMMA = 0.5  # lifts slow passages out of the dark; a single pillar in a wide channel needs none


def node_speed(flow: FlowFields | Flow) -> NDArray[np.float64]:
    """Speed at the mesh nodes; (n,) float64, model length per time."""
    velocity = flow.node_velocity()
    return np.hypot(velocity[:, 0], velocity[:, 1])


def speed_scale(flow: FlowFields | Flow) -> float:
    """Speed that is drawn brightest."""
    return float(np.percentile(node_speed(flow), CLIP))


def mean_speed(flow: FlowFields) -> float:
    """Mean speed over the fluid."""
    speed = np.hypot(flow.velocity[:, 0], flow.velocity[:, 1])
    return float(speed @ flow.mesh.areas / flow.mesh.areas.sum())


def speed_words(run: Run, first: FlowFields) -> tuple[float, str]:
    """Speed that counts as 1 on a colour bar, and its caption: physical where the study names units.

    Otherwise speeds are told over their mean in the flow `first` of the first step.
    """
    if run.units.known("velocity"):
        return 1.0 / run.units.factor("velocity"), f"speed, {run.units.name('velocity')}"
    return mean_speed(first), f"speed over its mean at step {run.steps()[0]}"


def node_pressure(flow: FlowFields) -> NDArray[np.float64]:
    """Pressure at the mesh nodes: mean of the triangles around, by area; (n,) float64, model pressure."""
    mesh = flow.mesh
    corners, weights = mesh.triangles.ravel(), np.repeat(mesh.areas, 3)
    count = len(mesh.points)
    return np.bincount(corners, weights * np.repeat(flow.pressure, 3), count) / np.bincount(corners, weights, count)


def pressure_scale(flow: FlowFields) -> float:
    """Pressure that is drawn darkest: the highest."""
    return float(flow.pressure.max())


def fastest_point(flow: FlowFields) -> tuple[float, float]:
    """Centroid of the triangle with the highest speed."""
    speed = np.hypot(flow.velocity[:, 0], flow.velocity[:, 1])
    x, y = flow.mesh.centroids[int(np.argmax(speed))]
    return float(x), float(y)


def mesh_box(mesh: Triangulation) -> Box:
    """Bounding box xmin, ymin, xmax, ymax."""
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    return float(low[0]), float(low[1]), float(high[0]), float(high[1])


def draw_speed(
    axes: Any,
    flow: FlowFields,
    outlines: Sequence[NDArray[np.float64]],
    box: Box,
    title: str = "",
    scale: float | None = None,
) -> Any:
    """Draw the speed and the pillars; return the coloured mesh, for a colour bar.

    Parameters
    ----------
    axes : matplotlib Axes
        Where.
    flow : FlowFields
        The flow at one step.
    outlines : sequence of (k, 2) float64
        Pillars.
    box : tuple of float
        Region xmin, ymin, xmax, ymax; model length.
    title : str
        Caption.
    scale : float, optional
        Speed drawn brightest; by default the 99.5th percentile of the node speeds.
    """
    top = speed_scale(flow) if scale is None else scale
    colours = draw_field(axes, flow, top, GAMMA if len(outlines) > 1 else 1.0)
    draw_pillars(axes, outlines)
    panel(axes, box, title)
    return colours


def draw_field(axes: Any, flow: FlowFields | Flow, top: float, gamma: float) -> Any:
    """Draw the speed alone, `top` and more brightest, on a scale of speed to the power `gamma`."""
    from matplotlib.colors import PowerNorm  # noqa: PLC0415  # heavy, and only here

    colours = axes.tripcolor(
        flow.mesh.points[:, 0],
        flow.mesh.points[:, 1],
        node_speed(flow),
        triangles=flow.mesh.triangles,
        shading="gouraud",
        cmap=SPEED,
        norm=PowerNorm(gamma, 0.0, top if top > 0.0 else 1.0, clip=True),
        rasterized=True,
    )
    colours.set_in_layout(False)
    return colours


def draw_pressure(
    axes: Any,
    flow: FlowFields,
    outlines: Sequence[NDArray[np.float64]],
    box: Box,
    title: str = "",
    scale: float | None = None,
) -> Any:
    """Draw the pressure with ten lines of equal pressure, and the pillars; return the coloured mesh, for a colour bar.

    Parameters are those of `draw_speed`; `scale` is the pressure drawn darkest.
    """
    top = pressure_scale(flow) if scale is None else scale
    top = top if top > 0.0 else 1.0
    x, y = flow.mesh.points.T
    pressure = node_pressure(flow)
    colours = axes.tripcolor(
        x,
        y,
        pressure,
        triangles=flow.mesh.triangles,
        shading="gouraud",
        cmap=PRESSURE,
        vmin=0.0,
        vmax=top,
        rasterized=True,
    )
    levels = np.linspace(0.0, top, 22)[1:-1:2]
    lines = axes.tricontour(x, y, flow.mesh.triangles, pressure, levels=levels, colors=INK, linewidths=0.4, zorder=2)
    for shown in (colours, lines):
        shown.set_in_layout(False)
    draw_pillars(axes, outlines)
    panel(axes, box, title)
    return colours


def draw_mesh(
    axes: Any,
    mesh: Triangulation,
    outlines: Sequence[NDArray[np.float64]],
    box: Box,
    title: str = "",
) -> None:
    """Draw the triangles inside `box` and the pillars between them."""
    from matplotlib.collections import LineCollection  # noqa: PLC0415  # heavy, and only here

    centres = mesh.centroids
    margin = 2.0 * float(np.sqrt(mesh.areas.max()))
    seen = (
        (centres[:, 0] > box[0] - margin)
        & (centres[:, 0] < box[2] + margin)
        & (centres[:, 1] > box[1] - margin)
        & (centres[:, 1] < box[3] + margin)
    )
    width = 0.35 if np.count_nonzero(seen) < 6000 else 0.15
    draw_pillars(axes, outlines, face=PILLAR)
    edges = np.unique(np.sort(mesh.triangles[seen][:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)
    lines = LineCollection(list(mesh.points[edges]), colors=ACCENT, linewidths=width, zorder=4, rasterized=True)
    add(axes, lines)
    panel(axes, box, title)
