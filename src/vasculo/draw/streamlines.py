"""Streamlines of a recorded flow: level lines of its stream function, with the same flow between each two."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.store.read import FlowFields


def stream_values(flow: FlowFields) -> NDArray[np.float64]:
    """Stream function at the mesh nodes, from the recorded velocities; (n,) float64, area per time.

    The record holds no fluxes, so this is the continuous function, linear in each triangle and constant on each pillar,
    whose derivatives come nearest to the velocity: ``u = d psi/dy, v = -d psi/dx`` by least squares over the area. A
    picture needs no more; `vasculo.flow.read.stream` has the exact one of a solved flow. Zero at one node of each part
    of the fluid.
    """
    # Strategy: the normal equations are those of the Laplacian with linear elements. The nodes on a pillar share one
    # unknown, and one unknown of each part of the fluid is held.
    mesh = flow.mesh
    corners = mesh.points[mesh.triangles]
    # Twice the area times the gradient of the hat function of each corner.
    opposite = np.roll(corners, -2, axis=1) - np.roll(corners, -1, axis=1)
    slopes = np.stack((-opposite[..., 1], opposite[..., 0]), axis=2)
    wanted = np.stack((-flow.velocity[:, 1], flow.velocity[:, 0]), axis=1)
    number = np.arange(len(mesh.points))
    on_pillar = mesh.boundary_tags >= 0
    number[mesh.boundary_edges[on_pillar]] = len(mesh.points) + mesh.boundary_tags[on_pillar, None]
    names, number = np.unique(number, return_inverse=True)
    count, unknowns = len(names), number[mesh.triangles]
    loads = np.bincount(unknowns.ravel(), 0.5 * np.einsum("tkd,td->tk", slopes, wanted).ravel(), minlength=count)
    weights = np.einsum("tkd,tmd->tkm", slopes, slopes) / (4.0 * mesh.areas[:, None, None])
    places = (np.repeat(unknowns, 3, axis=1).ravel(), np.tile(unknowns, (1, 3)).ravel())
    matrix = sparse.coo_array((weights.ravel(), places), shape=(count, count)).tocsr()
    part = sparse.csgraph.connected_components(matrix, directed=False)[1]
    free = np.delete(np.arange(count), np.unique(part, return_index=True)[1])
    psi = np.zeros(count)
    if len(free):
        psi[free] = splu(matrix[free][:, free].tocsc()).solve(loads[free])
    return psi[number]


def draw_streamlines(axes: Any, flow: FlowFields, count: int, colour: str = "white", width: float = 0.5) -> Any:
    """Draw `count` lines with the same flow between each two, the outer ones half of it away from the border.

    Parameters
    ----------
    axes : matplotlib Axes
        Where.
    flow : FlowFields
        The flow at one step.
    count : int
        Number of lines; each stands for 1 / count of the flow.
    colour : str
        Their colour.
    width : float
        Their width, points.
    """
    psi = stream_values(flow)
    low, high = float(psi.min()), float(psi.max())
    if not high > low:
        return None
    levels = low + (high - low) * (np.arange(count) + 0.5) / count
    lines = axes.tricontour(
        flow.mesh.points[:, 0],
        flow.mesh.points[:, 1],
        flow.mesh.triangles,
        psi,
        levels=levels,
        colors=colour,
        linewidths=width,
        linestyles="solid",
        zorder=2.5,
    )
    lines.set_in_layout(False)
    return lines
