"""Delaunay triangulations: of points in the plane, and of the fluid between walls."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import ComputationError, InputError
from vasculo.geometry.curve import curve_order
from vasculo.geometry.predicates import LARGEST, SMALLEST, first_out_of_range
from vasculo.mesh.triangulate.flips import restore_delaunay
from vasculo.mesh.triangulate.fluid import BOTH, OPEN, OUTSIDE, TWICE, keep_left, pick
from vasculo.mesh.triangulate.insertion import MOST, ROW, first_corner, insert_nodes, write_triangles
from vasculo.mesh.triangulate.walls import any_triangle, recover_edges

if TYPE_CHECKING:
    from vasculo.geometry.arrays import Floats, Ints


def delaunay(points: Floats, *, presorted: bool = False) -> tuple[Ints, Ints]:
    """Triangulate points: no circumcircle of a triangle has a point inside of it, exactly.

    Parameters
    ----------
    points : (n, 2) float64, model length
        At least three, not all on a line, no two the same; coordinates that are zero or 1e-60 to 1e70 in size.
    presorted : bool
        Whether points that follow each other are near each other already, as along a space-filling curve; otherwise
        they are sorted so inside. A matter of speed, and of the choice among the triangulations of points on a circle.

    Returns
    -------
    triangles : (t, 3) int32
        Corners, counter-clockwise; all of the convex hull, points on its edges among its corners. Near triangles have
        near numbers.
    neighbours : (t, 3) int32
        Triangle across the edge opposite to each corner, -1 at the hull.

    Raises
    ------
    InputError
        Fewer than three points, coordinates out of range, two points that coincide, or all on a line.

    Notes
    -----
    Bowyer 1981, Watson 1981, with a far node for the hull, a visibility walk, and exact predicates (Shewchuk 1997).
    The same input gives the same triangles.
    """
    points = np.ascontiguousarray(points, dtype=np.float64)
    check_points(points)
    if presorted:
        return triangulate_sorted(points)
    order = curve_order(points)
    triangles, neighbours = triangulate_sorted(points.take(order, axis=0))
    return order.take(triangles), neighbours


def fluid_triangles(points: Floats, edges: Ints) -> tuple[Ints, Ints]:
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
        Counter-clockwise; every wall edge is an edge of exactly one of them. Constrained Delaunay: no node that can be
        seen from inside of a triangle lies inside of its circumcircle, exactly. Near triangles have near numbers.
    neighbours : (t, 3) int32
        Triangle across the edge opposite to each corner, -1 at the walls.

    Raises
    ------
    ComputationError
        Nodes that coincide or lie on a wall, walls that cross, or that do not part the fluid from the rest.
    InputError
        Fewer than three nodes, or coordinates out of range (see `delaunay`).
    """
    # Strategy: triangulate all nodes; flip away what crosses a wall; cut at the walls and keep what is to their left;
    # make the Delaunay property good where there were flips.
    points = np.ascontiguousarray(points, dtype=np.float64)
    check_points(points)
    loops = edges[edges[:, 0] == edges[:, 1], 0]
    if len(loops):
        raise ComputationError(f"{len(loops)} walls have no length, the first at {_text(points[loops[0]])}")
    order = curve_order(points)
    points = points.take(order, axis=0)
    place = np.empty(len(points), dtype=np.int32)
    place[order] = np.arange(len(points), dtype=np.int32)
    walls = place.take(edges)
    try:
        triangles, neighbours = triangulate_sorted(points)
    except InputError as error:
        raise ComputationError(str(error)) from None
    at = any_triangle(triangles, len(points))
    dirty, kept = np.zeros((2, len(triangles)), dtype=np.bool_)
    number, start, end = recover_edges(points, triangles, neighbours, walls, at, dirty)
    if number >= 0:
        way = f"the wall from {_text(points[walls[number, 0]])} to {_text(points[walls[number, 1]])}"
        if end < 0:
            raise ComputationError(f"the node at {_text(points[start])} lies on {way}: move it, or cut the wall there")
        raise ComputationError(
            f"{way} crosses the wall between {_text(points[start])} and {_text(points[end])}: part them"
        )
    wrong, start, end = keep_left(triangles, neighbours, walls, at, kept)
    if wrong:
        raise ComputationError(f"{WRONG[wrong]}, from {_text(points[start])} to {_text(points[end])}")
    triangles, neighbours, dirty = pick(triangles, neighbours, kept, dirty)
    restore_delaunay(points, triangles, neighbours, dirty)
    return order.take(triangles), neighbours


WRONG = {
    OPEN: "the outer outline does not close: the fluid reaches the edge of the convex hull",
    TWICE: "two walls join the same nodes",
    OUTSIDE: "there is nothing to the left of a wall at the convex hull",
    BOTH: "the walls do not part the fluid from the rest: it is on both sides of the wall",
}
"""What is said of walls that bound no fluid, before the edge where it was seen."""


def _text(point: Floats) -> str:
    """Coordinates in a message."""
    return f"({point[0]:.6g}, {point[1]:.6g})"


def check_points(points: Floats) -> None:
    """Refuse points that cannot be triangulated because of their number or their coordinates."""
    if points.ndim != 2 or points.shape[1] != 2:
        raise InputError(f"points must have the shape (n, 2), not {points.shape}")
    if not 3 <= len(points) <= MOST:
        raise InputError(f"{len(points)} points cannot be triangulated: 3 to {MOST} are possible")
    i = first_out_of_range(points)
    if i >= 0:
        raise InputError(
            f"point {i} is ({points[i, 0]:.6g}, {points[i, 1]:.6g}): coordinates must be zero or {SMALLEST:g} to "
            f"{LARGEST:g} in size"
        )


def triangulate_sorted(points: Floats) -> tuple[Ints, Ints]:
    """Triangulate checked points in the order in which they stand; see `delaunay`."""
    xy = points.ravel()
    same = 0 if (points[0] == points[1]).all() else -1
    if same < 0:
        third = first_corner(xy)
        if third < 0:
            raise InputError(
                f"all {len(points)} points lie on the line through {_text(points[0])} and {_text(points[1])}: "
                "there is no triangle"
            )
        rows = np.empty(2 * ROW * len(points), dtype=np.uint32)
        same = insert_nodes(xy, third, rows)
    if same >= 0:
        x, y = points[same]
        raise InputError(f"two points coincide at ({x:.17g}, {y:.17g}): leave one of them out")
    return write_triangles(rows)
