"""The faces of the triangles: the two cells of each, what holds there, and which cells meet at a vertex."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy import sparse

from vasculo.flow.boundary import (
    PILLARS,
    Condition,
    Periodic,
    Pressure,
    Slip,
    Velocity,
    Wall,
    conditions_by_name,
    periodic_pairs,
)
from vasculo.flow.periodic import gradient_of_drops, matched_edges

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from vasculo.mesh.triangulation import Triangulation

# Kinds of face, for the kernels. A periodic pair of edges is one inner face.
INNER, MOVING, MIRROR, OPEN = 0, 1, 2, 3
KIND_OF = {Wall: MOVING, Velocity: MOVING, Slip: MIRROR, Pressure: OPEN, Periodic: INNER}


@dataclass(frozen=True, eq=False)
class Faces:
    """Faces of a triangulation, inner ones first, then the `b` boundary faces.

    Parameters
    ----------
    ends : (m, 2) int32
        Vertices from and to, counter-clockwise in the first cell: its outward normal is on the right.
    cells : (m, 2) int32
        First and second cell; the second is -1 on the boundary.
    kind : (m,) int32
        INNER, MOVING (prescribed velocity, walls too), MIRROR (slip) or OPEN (prescribed pressure).
    tangent, normal : (m, 2) float64
        Unit vectors; the normal points out of the first cell.
    length : (m,) float64
    distance : (m,) float64
        Between the two centroids (centroid and face on the boundary), measured along the normal.
    profile : (b, 3, 2) float64
        Prescribed velocity at the start, the middle and the end of each boundary face; zero where it is not MOVING.
    opening : (b,) float64
        Prescribed pressure of each boundary face above `level`; zero where it is not OPEN.
    level : float
        Middle of the prescribed pressures; the unknowns are counted from it, so a common pressure costs no digits.
    edge_face : (e,) int32
        Face of each boundary edge of the mesh.
    edge_sign : (e,) float64
        +1 if the face's normal points out through that edge, -1 at the far side of a periodic pair.
    is_wall : (e,) bool
        Edges that are walls: sides with `Wall`, and pillars unless they are open or slip.
    same : (n,) int32
        Representative of each vertex: vertices glued by periodicity share it.
    corner_start, corners : (n + 1,), (3 t,) int32
        Cell corners (3 cell + corner) that meet at each representative.
    rim_start, rim : (n + 1,), (2 b,) int32
        Boundary faces (2 face + end, counted from the first boundary face) that meet at each representative.
    gradient : (2,) float64
        Mean pressure drop per length imposed by periodic pairs.
    """

    ends: NDArray[np.int32]
    cells: NDArray[np.int32]
    kind: NDArray[np.int32]
    tangent: NDArray[np.float64]
    normal: NDArray[np.float64]
    length: NDArray[np.float64]
    distance: NDArray[np.float64]
    profile: NDArray[np.float64]
    opening: NDArray[np.float64]
    level: float
    edge_face: NDArray[np.int32]
    edge_sign: NDArray[np.float64]
    is_wall: NDArray[np.bool_]
    same: NDArray[np.int32]
    corner_start: NDArray[np.int32]
    corners: NDArray[np.int32]
    rim_start: NDArray[np.int32]
    rim: NDArray[np.int32]
    gradient: NDArray[np.float64]

    @property
    def inner(self) -> int:
        """Number of inner faces; boundary faces are numbered from here."""
        return len(self.ends) - len(self.profile)


def build_faces(mesh: Triangulation, conditions: Mapping[str, Condition]) -> Faces:
    """Build the list of faces and evaluate the conditions on them.

    Raises
    ------
    InputError
        For conditions that do not fit the mesh.
    """
    named = conditions_by_name(mesh, conditions)
    pairs = periodic_pairs(conditions)
    edges, cell_of_edge = mesh.boundary_edges, mesh.boundary_triangles
    glued, glue, shifts = matched_edges(mesh, pairs)

    inner_ends, inner_cells = (part[: -len(edges)] for part in mesh.faces)
    seam_cells = np.column_stack([cell_of_edge[glued[:, 0]], cell_of_edge[glued[:, 1]]])
    free = np.setdiff1d(np.arange(len(edges)), glued.ravel())
    rim_cells = np.column_stack([cell_of_edge[free], np.full(len(free), -1)])

    ends = np.concatenate([inner_ends, edges[glued[:, 0]], edges[free]]).astype(np.int32)
    cells = np.concatenate([inner_cells, seam_cells, rim_cells]).astype(np.int32)
    inner = len(ends) - len(free)
    edge_face = np.empty(len(edges), dtype=np.int32)
    edge_sign = np.ones(len(edges))
    edge_face[glued[:, 0]] = edge_face[glued[:, 1]] = np.arange(len(inner_cells), inner)
    edge_sign[glued[:, 1]] = -1.0
    edge_face[free] = np.arange(inner, len(ends))

    along = mesh.points[ends[:, 1]] - mesh.points[ends[:, 0]]
    length = np.hypot(along[:, 0], along[:, 1])
    tangent = along / length[:, None]
    # The centroid of a triangle lies a third of its height, 2 area / length, from an edge.
    both = mesh.areas[cells[:, 0]] + np.where(cells[:, 1] >= 0, mesh.areas[cells[:, 1]], 0.0)

    kind, profile, opening, is_wall = _values(mesh, named, ends, inner, free)
    is_open = kind[inner:] == OPEN
    level = 0.5 * float(opening[is_open].min() + opening[is_open].max()) if is_open.any() else 0.0
    opening[is_open] -= level
    same = _representatives(len(mesh.points), glue)
    corner_start, corner_list = _by_vertex(same[mesh.triangles].ravel(), len(same))
    rim_start, rim_list = _by_vertex(same[ends[inner:]].ravel(), len(same))
    return Faces(
        ends=ends,
        cells=np.ascontiguousarray(cells),
        kind=kind,
        tangent=tangent,
        normal=np.column_stack([tangent[:, 1], -tangent[:, 0]]),
        length=length,
        distance=both * (2.0 / 3.0) / length,
        profile=profile,
        opening=opening,
        level=level,
        edge_face=edge_face,
        edge_sign=edge_sign,
        is_wall=is_wall,
        same=same,
        corner_start=corner_start,
        corners=corner_list,
        rim_start=rim_start,
        rim=rim_list,
        gradient=gradient_of_drops(pairs, shifts),
    )


def _values(
    mesh: Triangulation, named: Mapping[str, Condition], ends: NDArray[np.int32], inner: int, free: NDArray[np.int64]
) -> tuple[NDArray[np.int32], NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]:
    """Kind of every face, prescribed velocities and pressures of the boundary faces, and which edges are walls."""
    kind = np.full(len(ends), INNER, dtype=np.int32)
    profile = np.zeros((len(free), 3, 2))
    opening = np.zeros(len(free))
    is_wall = np.zeros(len(mesh.boundary_edges), dtype=bool)
    for name in [*mesh.side_names, PILLARS]:
        condition, chosen = named[name], mesh.edge_of(name)
        if isinstance(condition, Wall) or (name == PILLARS and isinstance(condition, Velocity)):
            is_wall[chosen] = True
        if isinstance(condition, Periodic):
            continue
        rim = np.searchsorted(free, chosen)
        kind[inner + rim] = KIND_OF[type(condition)]
        if isinstance(condition, Pressure):
            opening[rim] = float(condition.value)
        elif isinstance(condition, Velocity) and len(rim):
            first, last = mesh.points[ends[inner + rim, 0]], mesh.points[ends[inner + rim, 1]]
            profile[rim] = condition.at(np.stack([first, 0.5 * (first + last), last], axis=1), name)
    return kind, profile, opening, is_wall


def _representatives(nodes: int, glue: NDArray[np.int64]) -> NDArray[np.int32]:
    """Lowest vertex of each set of glued vertices."""
    if len(glue) == 0:
        return np.arange(nodes, dtype=np.int32)
    graph = sparse.coo_array((np.ones(len(glue)), (glue[:, 0], glue[:, 1])), shape=(nodes, nodes))
    _, label = sparse.csgraph.connected_components(graph, directed=False)
    _, first, which = np.unique(label, return_index=True, return_inverse=True)
    return first[which].astype(np.int32)


def _by_vertex(vertex: NDArray[np.int32], nodes: int) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Positions in `vertex` sorted by vertex, and where each vertex starts."""
    start = np.zeros(nodes + 1, dtype=np.int32)
    np.cumsum(np.bincount(vertex, minlength=nodes), out=start[1:])
    return start, np.argsort(vertex, kind="stable").astype(np.int32)
