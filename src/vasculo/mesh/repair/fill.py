"""Cavities: triangles taken out of a mesh, and the holes filled anew between what stays and the new walls."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import shapely
from scipy.spatial import cKDTree

from vasculo.errors import ComputationError
from vasculo.mesh.placement import interior_nodes
from vasculo.mesh.repair.edit import DEAD
from vasculo.mesh.repair.work import INNER, pack
from vasculo.mesh.size import with_wall_edges
from vasculo.mesh.subdivide import wall_nodes
from vasculo.mesh.triangulate.delaunay import fluid_triangles
from vasculo.mesh.walls import Walls

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.mesh.repair.sizes import Wanted
    from vasculo.mesh.repair.work import Work

MOST_FILL = 4
"""Most nodes in the holes for each triangle taken out and each edge around."""


def near_outlines(work: Work, walls: Walls, fresh: NDArray[np.int64], margin: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Triangles inside new outlines or nearer to them than a margin.

    Parameters
    ----------
    work : Work
    walls : Walls
        Of the domain after.
    fresh : (c,) int64
        Outlines that are new.
    margin : (c,) float64, model length

    Returns
    -------
    (t,) bool
    """
    near = np.zeros(len(work.triangles), dtype=np.bool_)
    tree = shapely.STRtree(shapely.polygons(work.points[work.triangles]))
    outer = walls.body[-1]
    for body, reach in zip(fresh.tolist(), margin.tolist(), strict=True):
        nodes = walls.nodes[walls.body == body]
        shape = shapely.Polygon(nodes) if body != outer else shapely.LinearRing(nodes)
        near[tree.query(shape.buffer(reach), predicate="intersects")] = True
    return near


def with_ring(triangles: NDArray[np.int32], marked: NDArray[np.bool_], nodes: int) -> NDArray[np.bool_]:
    """Mark also the triangles that share a node with marked ones; (t,) bool."""
    touched = np.zeros(nodes, dtype=np.bool_)
    touched[triangles[marked].ravel()] = True
    return np.asarray(touched[triangles].any(axis=1))


def refill(
    work: Work,
    gone: NDArray[np.bool_],
    walls: Walls,
    fresh: NDArray[np.int64],
    wanted: Wanted,
) -> int:
    """Take triangles out and fill the holes; overwrites the work.

    Parameters
    ----------
    work : Work
        With the outlines that go on where they belong.
    gone : (t,) bool
        Among them all triangles at outlines that do not go on, and all that a new outline meets.
    walls : Walls
        Of the domain after.
    fresh : (c,) int64
        Outlines that are new.
    wanted : Wanted

    Returns
    -------
    int
        Number of new triangles.

    Raises
    ------
    ComputationError
        The holes could not be filled.
    """
    # Strategy: the rim of the holes is made of edges of triangles that stay, backwards, and of walls that go on; with
    # the walls of the new outlines it bounds a fluid like any other, which the mesher's own steps fill.
    edges, segment, owner = _rim(work, gone, len(walls.edges))
    rim, local = np.unique(edges, return_inverse=True)
    edges = local.reshape(edges.shape).astype(np.int32)
    new, corner = _only(walls, fresh)
    places = np.concatenate((work.points[rim], new.nodes))
    field = wanted.field(_only(walls, _bodies_near(walls, places, wanted.edge_length / wanted.grading))[0])
    on_wall, new_edges, new_segment = wall_nodes(new, field)
    points = np.concatenate((work.points[rim], on_wall))
    edges = np.concatenate((edges, new_edges + np.int32(len(rim))))
    segment = np.concatenate((segment, corner[new_segment]))
    owner = np.concatenate((owner, np.full(len(new_edges), -1)))
    field = with_wall_edges(field, points, edges)
    taken = int(np.count_nonzero(gone))
    most = MOST_FILL * (taken + len(edges))
    placed = interior_nodes(field, points, field.at(points), edges, float(taken), most)
    if placed is None:
        raise ComputationError(f"the {len(edges)} edges around the holes ask for more than {most} nodes")
    points = np.concatenate((points, placed[0]))
    triangles, neighbours = fluid_triangles(points, edges)
    wall = np.full(len(points), INNER, dtype=np.int32)
    wall[: len(rim)] = work.wall[rim]
    wall[len(rim) : len(rim) + len(new.nodes)] = -2 - corner
    start = edges[segment >= 0, 0]
    cut = start >= len(rim) + len(new.nodes)
    wall[start[cut]] = segment[segment >= 0][cut]
    _join(work, gone, rim, points, wall, triangles, neighbours, edges, segment, owner)
    pack(work, len(walls.nodes))
    return len(triangles)


def _rim(
    work: Work, gone: NDArray[np.bool_], segments: int
) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.int64]]:
    """Edges around the holes, hole on the left; their outline segments and 3 t + corner of what stays; -1 for none."""
    triangles, neighbours = work.triangles, work.neighbours
    row, c = np.nonzero(~gone[:, None] & (neighbours >= 0) & gone[neighbours])
    inner = np.column_stack((triangles[row, (c + 2) % 3], triangles[row, (c + 1) % 3]))
    owner = 3 * row + c
    row, c = np.nonzero(gone[:, None] & (neighbours < 0) & (neighbours >= -segments))
    on_wall = np.column_stack((triangles[row, (c + 1) % 3], triangles[row, (c + 2) % 3]))
    segment = np.concatenate((np.full(len(inner), -1, dtype=np.int32), -1 - neighbours[row, c]))
    return np.concatenate((inner, on_wall)), segment, np.concatenate((owner, np.full(len(row), -1)))


def _only(walls: Walls, bodies: NDArray[np.int64]) -> tuple[Walls, NDArray[np.int32]]:
    """Walls of some outlines, and the numbers that their nodes (and segments) have among all."""
    chosen = np.zeros(int(walls.body[-1]) + 1, dtype=np.bool_)
    chosen[bodies] = True
    kept = chosen[walls.body]
    number = (np.cumsum(kept) - 1).astype(np.int32)
    return (
        Walls(
            walls.nodes[kept],
            number[walls.edges[kept]],
            walls.body[kept],
            walls.tags[kept],
            walls.arc[kept],
            walls.lengths[kept],
            walls.around[kept],
        ),
        np.flatnonzero(kept).astype(np.int32),
    )


def _bodies_near(walls: Walls, places: NDArray[np.float64], reach: float) -> NDArray[np.int64]:
    """Outlines with a node within reach of one of the places, and the outer one."""
    away = cKDTree(places).query(walls.nodes, distance_upper_bound=reach)[0]
    return np.unique(np.append(walls.body[np.isfinite(away)], walls.body[-1]))


def _join(
    work: Work,
    gone: NDArray[np.bool_],
    rim: NDArray[np.int32],
    points: NDArray[np.float64],
    wall: NDArray[np.int32],
    triangles: NDArray[np.int32],
    neighbours: NDArray[np.int32],
    edges: NDArray[np.int32],
    segment: NDArray[np.int32],
    owner: NDArray[np.int64],
) -> None:
    """Put the triangles of the holes behind those of the work and join them along the rim."""
    row, c = np.nonzero(neighbours < 0)
    size = len(points)
    key = triangles[row, (c + 1) % 3].astype(np.int64) * size + triangles[row, (c + 2) % 3]
    given = edges[:, 0].astype(np.int64) * size + edges[:, 1]
    order = np.argsort(given)
    edge = order[np.searchsorted(given[order], key)]
    first = len(work.triangles)
    neighbours = np.where(neighbours >= 0, neighbours + first, neighbours).astype(np.int32)
    kept = owner[edge] >= 0
    neighbours[row, c] = np.where(kept, owner[edge] // 3, -1 - segment[edge])
    work.neighbours[owner[edge[kept]] // 3, owner[edge[kept]] % 3] = first + row[kept]
    work.triangles[gone, 0] = DEAD
    number = np.concatenate((rim, len(work.points) + np.arange(size - len(rim)))).astype(np.int32)
    work.triangles = np.concatenate((work.triangles, number[triangles]))
    work.neighbours = np.concatenate((work.neighbours, neighbours))
    work.slot = np.concatenate((work.slot, np.full(len(triangles), -1, dtype=np.int32)))
    work.points = np.concatenate((work.points, points[len(rim) :]))
    work.wall = np.concatenate((work.wall, wall[len(rim) :]))
    work.origin = np.concatenate((work.origin, np.full(size - len(rim), -1, dtype=np.int32)))
