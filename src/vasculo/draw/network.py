"""The passages as lines along their middles: how much they carry, and where the Poiseuille network is wrong."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from vasculo.draw.canvas import ERROR, INK, SMALL, TEXT, WIDTH, panel
from vasculo.draw.pillars import draw_pillars
from vasculo.draw.sheet import bar_of, sheet

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.figure import Figure
    from numpy.typing import NDArray

    from vasculo.draw.canvas import Box
    from vasculo.geometry.domain import Domain
    from vasculo.measure.network import NetworkFlow
    from vasculo.measure.tubules import TubuleFlow

GROUND, PALE = "#20242c", "#efe6df"
"""Fluid and pillars: darker and lighter than the lines of the passages."""
WIDEST, THINNEST = 7.0, 0.6
"""Width of the line of the strongest and of the weakest passage, points."""
CLIP = 0.15
"""Relative error with the strongest colour."""


def relative_error(network: TubuleFlow, resolved: TubuleFlow) -> NDArray[np.float64]:
    """(network - resolved) / resolved flux of every passage; (k,) float64, NaN beside openings and without flow."""
    error = np.full(len(resolved), np.nan)
    flows = np.isfinite(resolved.flux) & (resolved.flux != 0.0)
    np.divide(network.flux - resolved.flux, resolved.flux, out=error, where=flows)
    return error


def middle_lines(flow: TubuleFlow) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Pieces of the middle lines of the passages, (s, 2, 2) float64, and the row of each, (s,)."""
    graph = flow.graph
    corners = graph.pieces.points[graph.pieces.triangles]
    middles = 0.5 * (np.roll(corners, -1, axis=1) + np.roll(corners, -2, axis=1))
    inside = (graph.row >= 0) & (graph.links.sum(axis=1) == 2)
    through = middles[inside][graph.links[inside]].reshape(-1, 2, 2)
    # Arm k of a junction runs between the corners k and k + 1, opposite to the corner k + 2.
    ends = np.roll(middles[graph.junctions], -2, axis=1)
    arms = np.stack((ends, np.broadcast_to(flow.junctions.place[:, None], ends.shape)), axis=2)
    listed = flow.junctions.rows >= 0
    return (
        np.concatenate((through, arms[listed])),
        np.concatenate((graph.row[inside], flow.junctions.rows[listed])),
    )


def draw_network(
    axes: Any,
    outlines: Sequence[NDArray[np.float64]],
    resolved: TubuleFlow,
    network: TubuleFlow,
    box: Box,
    title: str = "",
    clip: float = CLIP,
) -> Any:
    """Draw every passage as wide as its resolved flow, in the colour of the network's error; return the lines.

    Parameters
    ----------
    axes : matplotlib Axes
        Where.
    outlines : sequence of (k, 2) float64
        Pillars.
    resolved, network : TubuleFlow
        Flow through the same passages: of a solved flow, and estimated.
    box : tuple of float
        Region xmin, ymin, xmax, ymax; model length.
    title : str
        Caption.
    clip : float
        Relative error with the strongest colour.
    """
    from matplotlib.collections import LineCollection  # noqa: PLC0415  # heavy, and only here

    pieces, row = middle_lines(resolved)
    flow = np.nan_to_num(np.abs(resolved.flux))
    share = flow / flow.max() if flow.any() else flow
    width = THINNEST + (WIDEST - THINNEST) * share
    draw_pillars(axes, outlines, face=PALE)
    lines = LineCollection(list(pieces), cmap=ERROR, linewidths=width[row], capstyle="round", zorder=2, rasterized=True)
    lines.set_array(relative_error(network, resolved)[row])
    lines.set_clim(-clip, clip)
    axes.add_collection(lines)
    axes.set_facecolor(GROUND)
    panel(axes, box, title)
    return lines


def network_figure(
    domain: Domain,
    resolved: TubuleFlow,
    network: NetworkFlow,
    title: str = "",
    width: float = WIDTH,
    unit: tuple[float, str] | None = None,
) -> Figure:
    """Make a figure of the whole domain with `draw_network`, its colour bar, and the error of the flow rate.

    The scale bar is told in `unit`, as of `vasculo.draw.scale.length_unit`; by default in mean radii of the pillars.
    """
    box = domain.bounds
    made = sheet(box, width)
    flow = np.abs(resolved.flux[resolved.between_walls])
    error = np.abs(network.flux - resolved.flux)[resolved.between_walls].sum() / flow.sum()
    words = f"{len(flow):,} passages · mean error {100.0 * error:.1f} % of the mean flow"
    text = f"{title} · {words}" if title else words
    lines = draw_network(made.panels[0], domain.pillars, resolved, network, box, text)
    place = (0.0, made.row, 0.42, 0.09 / made.strip[1])
    bar = made.figure.colorbar(lines, cax=made.below.inset_axes(place), orientation="horizontal", extend="both")
    bar.ax.xaxis.set_major_formatter(lambda value, _: f"{100.0 * value:+.0f} %")
    bar.ax.tick_params(labelsize=SMALL)
    bar.ax.set_title("error of the Poiseuille network; width: flow", fontsize=TEXT, color=INK, loc="left", pad=4)
    bar_of(made, unit or (domain.mean_radius, "R₀"), 0.53, made.panels[0], box)
    return made.figure
