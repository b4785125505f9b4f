"""A mesh that follows its walls and keeps all of its triangles, so that what goes by them need not be made anew."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import InputError
from vasculo.mesh.generate import AREA_ROUNDING
from vasculo.mesh.improve import smooth
from vasculo.mesh.repair.carry import carry_along
from vasculo.mesh.repair.light import is_misfit
from vasculo.mesh.repair.match import match_outlines
from vasculo.mesh.repair.work import INNER, work_on
from vasculo.mesh.triangulation import Triangulation
from vasculo.mesh.walls import walls_of

if TYPE_CHECKING:
    from vasculo.geometry.domain import Domain

POOR = 0.5
"""Triangles may not have a smaller mean ratio 4 sqrt(3) area / (sum of squared edges), unless two edges are walls."""

SMOOTHING = 2
"""Sweeps of smoothing, as for a fresh mesh."""


def follow_mesh(mesh: Triangulation, before: Domain, after: Domain) -> Triangulation | None:
    """Move the nodes of a mesh with the outlines of its domain; triangles and walls stay the same.

    Parameters
    ----------
    mesh : Triangulation
        Of the domain before, from `generate_mesh`.
    before, after : Domain

    Returns
    -------
    Triangulation or None
        Of the domain after, with the triangles, boundary edges, tags and wanted sizes of `mesh`. None where an outline
        has other nodes, vanished or is new, or where the edges would no longer have the lengths that were wanted: the
        mesh is then to be made anew.

    Raises
    ------
    InputError
        The mesh is not one of the domain before.

    Notes
    -----
    Ours; see the page on mesh repair. The same input gives the same mesh.
    """
    old, new = walls_of(before), walls_of(after)
    if len(old.nodes) != len(new.nodes) or not np.array_equal(old.tags, new.tags) or mesh.sizes is None:
        return None
    match = match_outlines(old, new)
    if len(match.fresh) or not np.array_equal(match.nodes, np.arange(len(match.nodes))):
        return None
    work, places = work_on(mesh, old, new, match)
    if np.array_equal(old.nodes, new.nodes):
        return mesh
    on_wall = work.wall != INNER
    touched, first, star = carry_along(work.points, work.triangles, mesh.boundary_edges, on_wall, places)
    if is_misfit(work.points, mesh.points, work.triangles, work.neighbours, on_wall, touched, mesh.sizes, POOR):
        return None
    smooth(work.points, work.triangles, first, star, on_wall | ~touched, SMOOTHING)
    try:
        moved = Triangulation(
            work.points, mesh.triangles, mesh.boundary_edges, mesh.boundary_tags, mesh.side_names, mesh.neighbours,
            mesh.sizes,
        )  # fmt: skip
    except InputError:
        return None
    area = after.area
    return moved if abs(float(moved.areas.sum()) - area) <= AREA_ROUNDING * area else None
