"""The stream function at the nodes, added up from the fluxes through the mesh edges."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit
from scipy import sparse

from vasculo.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.flow.solution import Flow
    from vasculo.geometry.arrays import Floats, Ints, Longs

SINGLE = 1e-6  # of the passing flow: two ways to a node may differ by this much


def stream_function(flow: Flow) -> NDArray[np.float64]:
    """Stream function at the nodes: the flow rate that passes between two nodes is the difference of their values.

    ``psi(b) - psi(a)`` is the flux through the mesh edge from a to b towards its right, with the smoothing pressure
    correction, so ``u = (d psi/dy, -d psi/dx)``. It is constant on each wall at rest and each mirror line. Because the
    fluxes balance in every cell, the way on which they are added up changes round-off only.

    Parameters
    ----------
    flow : Flow

    Returns
    -------
    (n,) float64
        Area per time; zero at the first wall of the outer boundary (at its first edge if there is no wall), in each
        connected part of the fluid. Periodic sides are cuts: the two images of a node differ by the flow between them.

    Raises
    ------
    InputError
        A pillar that gives out or takes in fluid: then there is no single value around it.
    """
    # Strategy: nodes joined by boundary edges without flux get one number together; a search in breadth over the mesh
    # edges then gives each number its value once.
    mesh = flow.mesh
    ends, flux = edge_fluxes(flow)
    passing = _check_pillars(flow, flux)
    rim = len(ends) - len(mesh.boundary_edges)
    closed = rim + np.flatnonzero(flux[rim:] == 0.0)
    graph = sparse.coo_array((np.ones(len(closed)), ends[closed].T), shape=(len(mesh.points),) * 2)
    numbers, number = sparse.csgraph.connected_components(graph, directed=False)
    outer = mesh.boundary_tags < 0
    first = np.concatenate([np.flatnonzero(outer & flow.faces.is_wall), np.flatnonzero(outer)])
    roots = number[np.concatenate([ends[rim + first, 0], np.arange(len(mesh.points))])]
    psi = add_up(number[ends].astype(np.int32), flux, roots.astype(np.int64), int(numbers))[number]
    missed = float(np.abs(psi[ends[:, 1]] - psi[ends[:, 0]] - flux).max(initial=0.0))
    if missed > SINGLE * passing:
        raise InputError(f"the stream function has no single value: two ways differ by {missed:.3g} of {passing:.3g}")
    return np.asarray(psi)


def edge_fluxes(flow: Flow) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
    """Every mesh edge, inner ones first, then the boundary edges: its ends (f, 2) and the flux to its right (f,)."""
    mesh, faces = flow.mesh, flow.faces
    ends = mesh.faces.ends
    inner = flow.face_flux[: len(ends) - len(mesh.boundary_edges)]
    return ends, np.concatenate([inner, flow.face_flux[faces.edge_face] * faces.edge_sign])


def passing_flow(flux: NDArray[np.float64], rim: NDArray[np.float64]) -> float:
    """Flow that passes: half of what goes through the boundary, or the largest flux of an edge if that is greater."""
    return max(0.5 * float(np.abs(rim).sum()), float(np.abs(flux).max(initial=0.0)))


def _check_pillars(flow: Flow, flux: NDArray[np.float64]) -> float:
    """Refuse pillars with a net flux; return the flow that passes."""
    tags = flow.mesh.boundary_tags
    rim = flux[len(flux) - len(tags) :]
    passing = passing_flow(flux, rim)
    net = np.bincount(tags[tags >= 0], rim[tags >= 0])
    if len(net) and np.abs(net).max() > SINGLE * passing:
        worst = int(np.argmax(np.abs(net)))
        raise InputError(
            f"the stream function has no single value: pillar {worst} {'takes in' if net[worst] > 0 else 'gives out'} "
            f"{abs(net[worst]):.3g} of {passing:.3g} that passes"
        )
    return passing


@njit(cache=True, error_model="numpy")
def add_up(ends: Ints, flux: Floats, roots: Longs, nodes: int) -> Floats:
    """Values (nodes,) whose differences along the edges are `flux`; zero at the first root of each connected part."""
    start = np.zeros(nodes + 1, dtype=np.int64)
    for e in range(len(ends)):
        start[ends[e, 0] + 1] += 1
        start[ends[e, 1] + 1] += 1
    for i in range(nodes):
        start[i + 1] += start[i]
    edge = np.empty(start[nodes], dtype=np.int64)
    place = start[:-1].copy()
    for e in range(len(ends)):
        for k in range(2):
            edge[place[ends[e, k]]] = e
            place[ends[e, k]] += 1

    values = np.zeros(nodes)
    seen = np.zeros(nodes, dtype=np.bool_)
    queue = np.empty(nodes, dtype=np.int64)
    for root in roots:
        if seen[root]:
            continue
        seen[root] = True
        queue[0] = root
        done, count = 0, 1
        while done < count:
            i = queue[done]
            done += 1
            for p in range(start[i], start[i + 1]):
                e = edge[p]
                a, b = ends[e, 0], ends[e, 1]
                j = b if a == i else a
                if not seen[j]:
                    seen[j] = True
                    values[j] = values[i] + (flux[e] if a == i else -flux[e])
                    queue[count] = j
                    count += 1
    return values


def add_up_plain(ends: Ints, flux: Floats, roots: Longs, nodes: int) -> Floats:
    """Twin of `add_up`: all differences at once by least squares, then each part moved to zero at its first root."""
    rows = np.arange(len(ends))
    table = np.zeros((len(ends), nodes))
    np.add.at(table, (rows, ends[:, 1]), 1.0)
    np.add.at(table, (rows, ends[:, 0]), -1.0)
    values = np.linalg.lstsq(table, flux)[0]
    graph = sparse.coo_array((np.ones(len(ends)), ends.T), shape=(nodes, nodes))
    _, part = sparse.csgraph.connected_components(graph, directed=False)
    for p in np.unique(part):
        values[part == p] -= values[next(r for r in roots if part[r] == p)]
    return np.asarray(values)
