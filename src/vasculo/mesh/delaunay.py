"""Constrained Delaunay triangulation of the fluid: Qhull, then walls recovered by flips, then the solid taken away."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import Delaunay, QhullError

from vasculo.errors import ComputationError
from vasculo.mesh.flips import recover_edges

if TYPE_CHECKING:
    from numpy.typing import NDArray

FRAME = 12
"""Far nodes on a circle around the domain, so that no wall lies on the hull."""


def fluid_triangles(
    points: NDArray[np.float64], edges: NDArray[np.int32]
) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Triangulate the fluid between directed wall edges.

    Parameters
    ----------
    points : (n, 2) float64, model length
        Wall nodes and interior nodes.
    edges : (e, 2) int32
        Wall edges, fluid on the left: closed outlines that do not cross.

    Returns
    -------
    triangles : (t, 3) int32
        Counter-clockwise; every wall edge is an edge of exactly one of them. Delaunay but for the recovered walls.
    neighbours : (t, 3) int32
        Triangle across the edge opposite to each corner, -1 at the walls.

    Raises
    ------
    ComputationError
        Nodes that the triangulation could not tell apart, or a wall that could not be made an edge.
    """
    triangles, neighbours = _triangulate(points)
    missing = edges[~_present(triangles, edges)]
    if len(missing):
        framed = _framed(points - points.mean(axis=0))
        at = np.empty(len(framed), dtype=np.int32)
        failed = recover_edges(framed, triangles, neighbours, np.ascontiguousarray(missing), at)
        if failed >= 0:
            (ax, ay), (bx, by) = points[missing[failed]]
            raise ComputationError(
                f"the wall from ({ax:.6g}, {ay:.6g}) to ({bx:.6g}, {by:.6g}) could not be made an edge of the mesh "
                f"({len(missing)} walls were missing): widen the passage beside it"
            )
    return _inside(triangles, neighbours, edges, len(points))


def _framed(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Add the far nodes."""
    low, high = points.min(axis=0), points.max(axis=0)
    angle = 2.0 * np.pi * (np.arange(FRAME) + 0.25) / FRAME
    circle = np.column_stack((np.cos(angle), np.sin(angle)))
    return np.concatenate((points, 0.5 * (low + high) + 1.5 * float(np.hypot(*(high - low))) * circle))


def _triangulate(points: NDArray[np.float64]) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Delaunay triangulation of the nodes and the far nodes around them."""
    try:
        found = Delaunay(_framed(points - points.mean(axis=0)))
    except QhullError as error:
        raise ComputationError(f"triangulating {len(points)} nodes failed: {str(error).split(chr(10))[0]}") from None
    if len(found.coplanar):
        lost, near = int(found.coplanar[0, 0]), int(found.coplanar[0, 2])
        raise ComputationError(
            f"{len(found.coplanar)} nodes coincide within rounding, the first at ({points[lost][0]:.6g}, "
            f"{points[lost][1]:.6g}), {np.hypot(*(points[lost] - points[near])):.3g} from the next: widen that passage"
        )
    return found.simplices.astype(np.int32), found.neighbors.astype(np.int32)


def _present(triangles: NDArray[np.int32], edges: NDArray[np.int32]) -> NDArray[np.bool_]:
    """Whether each wall is the edge of a triangle."""
    size = int(triangles.max()) + 1
    start = triangles.astype(np.int64).ravel()
    keys = np.sort(start * size + triangles[:, (1, 2, 0)].ravel())
    wanted = edges[:, 0].astype(np.int64) * size + edges[:, 1]
    return np.asarray(keys[np.minimum(np.searchsorted(keys, wanted), len(keys) - 1)] == wanted)


def _inside(
    triangles: NDArray[np.int32], neighbours: NDArray[np.int32], edges: NDArray[np.int32], nodes: int
) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Keep what lies to the left of the walls, by topology alone: the pieces after cutting at the walls."""
    size = int(triangles.max()) + 1
    start = triangles[:, (1, 2, 0)].astype(np.int64)
    end = triangles[:, (2, 0, 1)].astype(np.int64)
    wall = edges[:, 0].astype(np.int64) * size + edges[:, 1]
    back = edges[:, 1].astype(np.int64) * size + edges[:, 0]
    left = np.isin(start * size + end, wall)
    right = np.isin(start * size + end, back)
    cut = left | right
    joined = (neighbours >= 0) & ~cut
    rows = np.nonzero(joined)[0]
    count = len(triangles)
    graph = coo_array((np.ones(len(rows), dtype=np.int8), (rows, neighbours[joined])), shape=(count, count))
    pieces, label = connected_components(graph.tocsr(), directed=False)
    fluid = np.zeros(pieces, dtype=bool)
    fluid[label[left.any(axis=1)]] = True
    if fluid[label[right.any(axis=1)]].any() or np.count_nonzero(left) != len(edges):
        raise ComputationError(f"the {len(edges)} walls do not part the fluid from the solid: outlines touch or cross")
    kept = fluid[label]
    number = np.cumsum(kept) - 1
    inner = neighbours[kept]
    inner = np.where(cut[kept] | (inner < 0), -1, number[inner]).astype(np.int32)
    corners = triangles[kept]
    if corners.max() >= nodes:
        raise ComputationError("the outer outline does not close: a far node was reached from the fluid")
    return np.ascontiguousarray(corners), np.ascontiguousarray(inner)
