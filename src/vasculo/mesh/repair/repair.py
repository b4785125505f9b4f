"""Local repair: a mesh follows outlines that have moved, and is made anew only where it must be."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import ComputationError
from vasculo.mesh.generate import check_numbers, generate_mesh
from vasculo.mesh.repair.match import match_outlines, wall_segments
from vasculo.mesh.repair.sizes import Wanted
from vasculo.mesh.repair.steps import Repair
from vasculo.mesh.size import GRADING
from vasculo.mesh.walls import walls_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from vasculo.geometry.domain import Domain
    from vasculo.mesh.triangulation import Triangulation


@dataclass(frozen=True, eq=False)
class Repaired:
    """A repaired mesh, and what was done.

    Parameters
    ----------
    mesh : Triangulation
        Of the domain after, in the order that `generate_mesh` gives: outline nodes first.
    moved, inserted, deleted : int
        Nodes that changed their place, were added, were taken out.
    flipped : int
        Edge flips.
    refilled : int
        Triangles that fill holes around new outlines or where a move left nothing useful.
    reason : str
        Why the mesh was made anew as a whole; empty if it was not.
    node_origin : (n,) int32
        Node of the old mesh, -1 for a new one.
    triangle_origin : (t,) int32
        Triangle of the old mesh with the same three nodes (which may have moved), -1 if there is none.
    """

    mesh: Triangulation
    moved: int
    inserted: int
    deleted: int
    flipped: int
    refilled: int
    reason: str
    node_origin: NDArray[np.int32]
    triangle_origin: NDArray[np.int32]

    @property
    def remeshed(self) -> bool:
        """Whether repair failed and the mesh was made anew as a whole."""
        return bool(self.reason)


def repair_mesh(
    mesh: Triangulation,
    before: Domain,
    after: Domain,
    edge_length: float,
    wall_edge_length: float | None = None,
    *,
    across: float = 0.0,
    curvature: float = 0.0,
    size: Callable[[NDArray[np.float64]], NDArray[np.float64]] | None = None,
    grading: float = GRADING,
    max_triangles: int = 5_000_000,
) -> Repaired:
    """Turn the mesh of one domain into a mesh of another that differs a little.

    Parameters
    ----------
    mesh : Triangulation
        Of the domain before, from `generate_mesh` or from here.
    before, after : Domain
        Outlines may move, get other nodes, vanish, appear and merge.
    edge_length, wall_edge_length, across, curvature, size, grading, max_triangles
        As in `generate_mesh`.

    Returns
    -------
    Repaired
        With the guarantees of `generate_mesh`. The same input gives the same mesh; outlines that have not changed, the
        mesh itself.

    Raises
    ------
    InputError
        The mesh is not one of the domain before; or as in `generate_mesh`, where the mesh is made anew.
    ComputationError
        As in `generate_mesh`, where the mesh is made anew.

    Notes
    -----
    Ours; Szczerba & Szekely 2005 mesh anew in every step. Wall nodes move with their outlines, and inner nodes follow
    over a few layers by Laplace's equation; if all edges then still have their lengths, only smoothing
    is left. Where that turns a
    triangle over, and around outlines that are new, holes are cut and meshed. Then edges are flipped, cut or contracted
    by length, and nodes smoothed.

    Examples
    --------
    >>> import vasculo as vc
    >>> square = [(0.4, 0.4), (0.6, 0.4), (0.6, 0.6), (0.4, 0.6)]
    >>> before = vc.Domain.rectangle(1.0, 1.0, [square])
    >>> after = vc.Domain.rectangle(1.0, 1.0, [[(x + 0.01, y) for x, y in square]])
    >>> mesh = vc.generate_mesh(before, edge_length=0.1)
    >>> repaired = vc.repair_mesh(mesh, before, after, edge_length=0.1)
    >>> round(float(repaired.mesh.areas.sum()), 9)
    0.96
    """
    wall = edge_length if wall_edge_length is None else wall_edge_length
    check_numbers(edge_length, wall, across, curvature, grading, max_triangles)
    old, new = walls_of(before), walls_of(after)
    if len(old.nodes) == len(new.nodes) and (old.nodes == new.nodes).all() and (old.tags == new.tags).all():
        wall_segments(mesh, old)
        nodes, triangles = (np.arange(len(array), dtype=np.int32) for array in (mesh.points, mesh.triangles))
        return Repaired(mesh, 0, 0, 0, 0, 0, "", nodes, triangles)
    wanted = Wanted(edge_length, min(wall, edge_length), across, grading, curvature, size)
    try:
        steps = Repair(mesh, old, new, match_outlines(old, new), wanted, max_triangles)
        steps.run()
        repaired = steps.mesh_of(after)
    except ComputationError as error:
        reason = str(error)
    else:
        return Repaired(repaired, *steps.counts(), "", steps.work.origin, steps.same_triangles())
    made = generate_mesh(
        after,
        edge_length,
        wall_edge_length,
        across=across,
        curvature=curvature,
        size=size,
        grading=grading,
        max_triangles=max_triangles,
    )
    none, nothing = np.full(len(made.points), -1, dtype=np.int32), np.full(len(made.triangles), -1, dtype=np.int32)
    return Repaired(made, 0, len(none), len(mesh.points), 0, len(nothing), reason, none, nothing)
