"""The faces of the triangles: the two cells of each, what holds there, and which cells meet at a vertex."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numba import njit
from scipy import sparse

from vasculo.flow.boundary import (
    Condition,
    Periodic,
    Pressure,
    Slip,
    Velocity,
    Wall,
    conditions_by_name,
    edges_by_name,
    periodic_pairs,
)
from vasculo.flow.periodic import gradient_of_drops, matched_edges
from vasculo.mesh.adjacency import stars
from vasculo.springs.threads import run_team

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    from vasculo.mesh.triangulation import Triangulation

# Kinds of face, for the kernels. A periodic pair of edges is one inner face.
INNER, MOVING, MIRROR, OPEN = 0, 1, 2, 3
KIND_OF = {Wall: MOVING, Velocity: MOVING, Slip: MIRROR, Pressure: OPEN, Periodic: INNER}
FEW = 50_000  # faces a thread; fewer are not worth another one


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
        Edges that are walls: what has `Wall`, and pillars unless they are open or slip.
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

    Parameters
    ----------
    mesh : Triangulation
    conditions : mapping of str to condition
        See `conditions_by_name`.

    Raises
    ------
    InputError
        For conditions that do not fit the mesh, and values that are not finite.
    """
    named = conditions_by_name(mesh, conditions)
    pairs = periodic_pairs(conditions)
    glued, glue, shifts = matched_edges(mesh, pairs)
    free = np.ones(len(mesh.boundary_edges), dtype=bool)
    free[glued] = False
    ends, cells, edge_face, edge_sign = _numbered(mesh, glued, free)
    inner = len(ends) - int(np.count_nonzero(free))

    tangent, normal = np.empty((len(ends), 2)), np.empty((len(ends), 2))
    length, distance = np.empty(len(ends)), np.empty(len(ends))
    run_team(
        measure_faces, len(ends) // FEW, mesh.points, mesh.areas, ends, cells, tangent, normal, length, distance
    )  # fmt: skip
    kind, profile, opening, is_wall = _values(mesh, named, ends, inner, edge_face)
    is_open = kind[inner:] == OPEN
    level = 0.5 * float(opening[is_open].min() + opening[is_open].max()) if is_open.any() else 0.0
    opening[is_open] -= level
    same = _representatives(len(mesh.points), glue)
    corner_start, corners = stars(same[mesh.triangles] if len(glue) else mesh.triangles, len(same))
    rim_start, rim = _by_vertex(same[ends[inner:]].ravel(), len(same))
    return Faces(
        ends=ends,
        cells=cells,
        kind=kind,
        tangent=tangent,
        normal=normal,
        length=length,
        distance=distance,
        profile=profile,
        opening=opening,
        level=level,
        edge_face=edge_face,
        edge_sign=edge_sign,
        is_wall=is_wall,
        same=same,
        corner_start=corner_start,
        corners=corners,
        rim_start=rim_start,
        rim=rim,
        gradient=gradient_of_drops(pairs, shifts),
    )


def _numbered(
    mesh: Triangulation, glued: NDArray[np.int64], free: NDArray[np.bool_]
) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.int32], NDArray[np.float64]]:
    """Give ends and cells of every face, and the face and sign of every boundary edge."""
    edges, beside = mesh.boundary_edges, mesh.boundary_triangles
    ends, cells = mesh.faces
    inner = len(ends) - len(edges)
    edge_face = np.empty(len(edges), dtype=np.int32)
    edge_face[free] = np.arange(inner + len(glued), len(ends) - len(glued))
    edge_face[glued] = np.arange(inner, inner + len(glued))[:, None]
    edge_sign = np.ones(len(edges))
    edge_sign[glued[:, 1]] = -1.0
    if len(glued):
        ends = np.concatenate([ends[:inner], edges[glued[:, 0]], edges[free]])
        cells = np.concatenate([cells[:inner], beside[glued], cells[inner:][free]])
    return ends, cells, edge_face, edge_sign


@njit(cache=True, error_model="numpy", nogil=True)
def measure_faces(
    rank: int,
    threads: int,
    points: NDArray[np.float64],
    areas: NDArray[np.float64],
    ends: NDArray[np.int32],
    cells: NDArray[np.int32],
    tangent: NDArray[np.float64],
    normal: NDArray[np.float64],
    length: NDArray[np.float64],
    distance: NDArray[np.float64],
) -> int:
    """Fill the last four: unit vectors, lengths, and the distances of centroids along the normal.

    The centroid of a triangle lies a third of its height, 2 area / length, from an edge.
    """
    for f in range(rank * len(ends) // threads, (rank + 1) * len(ends) // threads):
        x = points[ends[f, 1], 0] - points[ends[f, 0], 0]
        y = points[ends[f, 1], 1] - points[ends[f, 0], 1]
        size = np.hypot(x, y)
        both = areas[cells[f, 0]] + (areas[cells[f, 1]] if cells[f, 1] >= 0 else 0.0)
        tangent[f, 0], tangent[f, 1] = x / size, y / size
        normal[f, 0], normal[f, 1] = y / size, -(x / size)
        length[f], distance[f] = size, both * (2.0 / 3.0) / size
    return 0


def measure_faces_plain(
    points: NDArray[np.float64], areas: NDArray[np.float64], ends: NDArray[np.int32], cells: NDArray[np.int32]
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Tangent, normal, length and distance of each face; the reference of `measure_faces`."""
    along = points[ends[:, 1]] - points[ends[:, 0]]
    length = np.hypot(along[:, 0], along[:, 1])
    tangent = along / length[:, None]
    both = areas[cells[:, 0]] + np.where(cells[:, 1] >= 0, areas[cells[:, 1]], 0.0)
    return tangent, np.column_stack([tangent[:, 1], -tangent[:, 0]]), length, both * (2.0 / 3.0) / length


def _values(
    mesh: Triangulation,
    named: Mapping[str, Condition],
    ends: NDArray[np.int32],
    inner: int,
    edge_face: NDArray[np.int32],
) -> tuple[NDArray[np.int32], NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]:
    """Kind of every face, prescribed velocities and pressures of the boundary faces, and which edges are walls."""
    kind = np.full(len(ends), INNER, dtype=np.int32)
    profile = np.zeros((len(ends) - inner, 3, 2))
    opening = np.zeros(len(ends) - inner)
    is_wall = np.zeros(len(edge_face), dtype=bool)
    for (name, condition), chosen in zip(named.items(), edges_by_name(mesh, list(named)), strict=True):
        if isinstance(condition, Periodic) or len(chosen) == 0:
            continue
        faces = edge_face[chosen]
        kind[faces] = KIND_OF[type(condition)]
        first, last = mesh.points[ends[faces, 0]], mesh.points[ends[faces, 1]]
        middle = 0.5 * (first + last)
        if isinstance(condition, Pressure):
            opening[faces - inner] = condition.at(middle, name)
        elif isinstance(condition, (Wall, Velocity)):
            profile[faces - inner] = condition.at(np.stack([first, middle, last], axis=1), name)
            is_wall[chosen] = isinstance(condition, Wall) or mesh.boundary_tags[chosen[0]] >= 0
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
