"""Where tracers start on a side: in the order of the flow that enters there."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import InputError
from vasculo.flow.read.conservative import CLOSED

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.flow.read.conservative import Conservative
    from vasculo.flow.solution import Flow


def seed_side(
    flow: Flow, field: Conservative, side: str, count: int
) -> tuple[NDArray[np.int32], NDArray[np.float64], NDArray[np.float64]]:
    """Spread tracers over the inflow of a side.

    With the inflow Q counted along the side, tracer i of N stands at Q (1 - cos((i + 1/2) pi / N)) / 2 and for the flow
    between its neighbours: near a wall times grow like one over the root of the flow to the wall, and means over the
    flow, taken so, converge fast all the same.

    Parameters
    ----------
    flow : Flow
    field : Conservative
    side : str
    count : int

    Returns
    -------
    triangle : (count,) int32
    shares : (count, 3) float64
        Barycentric coordinates, on the edge.
    weight : (count,) float64
        Their sum is the inflow.

    Raises
    ------
    InputError
        No such side, no inflow, or a count below 1.
    """
    if isinstance(count, bool) or not isinstance(count, (int, np.integer)) or count < 1:
        raise InputError(f"count of tracers is {count!r}: give a whole number from 1 up")
    mesh, faces = flow.mesh, flow.faces
    edges = _in_order(mesh.boundary_edges, mesh.edge_of(side))
    inflow = -flow.face_flux[faces.edge_face[edges]] * faces.edge_sign[edges]
    entering = inflow > CLOSED * field.passing
    if not entering.any():
        raise InputError(f"no fluid enters through {side!r}: its outflow is {flow.flow_rate(side):.3g}")
    edges, inflow = edges[entering], inflow[entering]
    bounds = np.concatenate([[0.0], np.cumsum(inflow)])
    angle = np.pi * np.arange(2 * count + 1) / (2 * count)
    target = 0.5 * bounds[-1] * (1.0 - np.cos(angle))
    chosen = np.clip(np.searchsorted(bounds, target[1::2], side="right") - 1, 0, len(edges) - 1)

    # On an edge the inflow per parameter is linear, from `one` at its start to `two` at its end.
    cell = mesh.boundary_triangles[edges[chosen]]
    opposite = np.argmax(_opposite(mesh.triangles[cell], mesh.boundary_edges[edges[chosen]]), axis=1)
    rows = np.arange(count)
    one, two = -field.outflow[cell, opposite].T
    part = np.clip(target[1::2] - bounds[chosen], 0.0, inflow[chosen])
    root = np.sqrt(np.maximum(one * one + 2.0 * (two - one) * part, 0.0))
    place = np.clip(2.0 * part / np.maximum(one + root, 1e-300), 0.0, 1.0)
    shares = np.zeros((count, 3))
    shares[rows, (opposite + 1) % 3], shares[rows, (opposite + 2) % 3] = 1.0 - place, place
    return cell, shares, np.diff(target[::2])


def _opposite(triangles: NDArray[np.int32], edges: NDArray[np.int32]) -> NDArray[np.bool_]:
    """Which corner is on neither end of the edge; (k, 3) bool."""
    return (triangles != edges[:, :1]) & (triangles != edges[:, 1:])


def _in_order(ends: NDArray[np.int32], edges: NDArray[np.int64]) -> NDArray[np.int64]:
    """Edges of a side, one chain after the other, each from its start to its end."""
    after = {int(ends[e, 0]): int(e) for e in edges}
    reached = {int(ends[e, 1]) for e in edges}
    ordered: list[int] = []
    for first in [e for e in edges if int(ends[e, 0]) not in reached] + list(edges):
        edge = after.pop(int(ends[first, 0]), None)
        while edge is not None:
            ordered.append(edge)
            edge = after.pop(int(ends[edge, 1]), None)
    return np.array(ordered, dtype=np.int64)
