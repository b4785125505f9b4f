"""A velocity that is linear in each triangle, free of divergence, and carries exactly the fluxes of the solution."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numba import njit

from vasculo.flow.faces import MIRROR, MOVING, OPEN
from vasculo.flow.read.stream import edge_fluxes, passing_flow

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.flow.solution import Flow
    from vasculo.geometry.arrays import Bytes, Flags, Floats, Ints

CLOSED = 1e-12  # of the passing flow: an edge with a prescribed velocity that lets through less is closed
WALL = -1  # beyond a closed edge


class Conservative(NamedTuple):
    """The field by its outflow through the edges of each triangle; edge k is opposite to corner k.

    Parameters
    ----------
    outflow : (t, 3, 2) float64
        Outward flux per edge parameter (area per time) at the two ends of each edge, corner k + 1 and k + 2. Linear in
        between; the mean of the two is the flux through the edge.
    beyond : (t, 3) int32
        What lies across each edge: 3 times the triangle there plus its edge, WALL, or -2 - e for the open boundary edge
        e. Periodic sides are joined.
    passing : float
        Flow that passes (area per time).
    """

    outflow: NDArray[np.float64]
    beyond: NDArray[np.int32]
    passing: float


def conservative_field(flow: Flow) -> Conservative:
    """Make the field: along an edge the normal velocity has the mean of the flux and the slope of the node velocities.

    At a node with a prescribed velocity, such as those of walls, it has that velocity, and the slope follows. The field
    is the curl of a stream function that is quadratic in each triangle and continuous, so streamlines do not end
    inside, do not cross walls, and the fluid sticks to these. Its error is of second order.

    Parameters
    ----------
    flow : Flow

    Returns
    -------
    Conservative
    """
    mesh, faces = flow.mesh, flow.faces
    _, flux = edge_fluxes(flow)
    passing = passing_flow(flux, flux[len(flux) - len(mesh.boundary_edges) :])
    inner = faces.inner
    closed = np.zeros(len(faces.ends), dtype=np.uint8)
    closed[inner:] = (faces.kind[inner:] != OPEN) & (
        (np.abs(flow.face_flux[inner:]) <= CLOSED * passing) | (faces.kind[inner:] == MIRROR)
    )
    given = np.zeros(len(mesh.points), dtype=np.bool_)
    given[faces.same[faces.ends[faces.kind == MOVING]]] = True
    edge = np.full(len(faces.ends), WALL, dtype=np.int32)
    edge[faces.edge_face] = np.arange(len(faces.edge_face))
    outflow = np.empty((len(mesh.triangles), 3, 2))
    beyond = np.empty((len(mesh.triangles), 3), dtype=np.int32)
    fill_field(
        mesh.points, mesh.triangles, faces.same, faces.ends, faces.cells, flow.face_flux, closed, edge,
        flow.node_velocity(), given[faces.same], outflow, beyond,
    )  # fmt: skip
    return Conservative(outflow, beyond, passing)


@njit(cache=True, error_model="numpy")
def fill_field(
    points: Floats,
    triangles: Ints,
    same: Ints,
    ends: Ints,
    cells: Ints,
    flux: Floats,
    closed: Bytes,
    edge: Ints,
    velocity: Floats,
    given: Flags,
    outflow: Floats,
    beyond: Ints,
) -> None:
    """Fill the tables of `Conservative` face by face; overwrites `outflow` and `beyond`."""
    for f in range(len(ends)):
        a, b = ends[f, 0], ends[f, 1]
        along_x, along_y = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]
        slope = 0.0
        if not closed[f]:
            first = velocity[a, 0] * along_y - velocity[a, 1] * along_x
            last = velocity[b, 0] * along_y - velocity[b, 1] * along_x
            slope = last - first
            if given[a] != given[b]:
                slope = 2.0 * (flux[f] - first if given[a] else last - flux[f])
        left, right = cells[f, 0], cells[f, 1]
        here = there = 0
        for k in range(3):
            if triangles[left, (k + 1) % 3] == a and triangles[left, (k + 2) % 3] == b:
                here = k
            meets = right >= 0 and same[triangles[right, (k + 2) % 3]] == same[a]
            if meets and same[triangles[right, (k + 1) % 3]] == same[b]:
                there = k
        outflow[left, here, 0], outflow[left, here, 1] = flux[f] - 0.5 * slope, flux[f] + 0.5 * slope
        if right >= 0:
            outflow[right, there, 0], outflow[right, there, 1] = -flux[f] - 0.5 * slope, -flux[f] + 0.5 * slope
            beyond[left, here] = 3 * right + there
            beyond[right, there] = 3 * left + here
        else:
            beyond[left, here] = WALL if closed[f] else -2 - edge[f]


def corner_velocities(points: Floats, triangles: Ints, outflow: Floats) -> Floats:
    """Velocity of the field at the three corners of each triangle; (t, 3, 2).

    At corner i it is the vector whose outflow through the two edges that meet there is the one in the table.
    """
    corner = points[triangles]
    velocity = np.empty((len(triangles), 3, 2))
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        # Edge k runs from i to j, edge j from k to i; v . (outward normal times length) = outflow.
        normals = np.empty((len(triangles), 2, 2))
        for row, (start, end) in enumerate(((i, j), (k, i))):
            along = corner[:, end] - corner[:, start]
            normals[:, row] = np.column_stack([along[:, 1], -along[:, 0]])
        wanted = np.column_stack([outflow[:, k, 0], outflow[:, j, 1]])
        velocity[:, i] = np.linalg.solve(normals, wanted[:, :, None])[:, :, 0]
    return velocity
