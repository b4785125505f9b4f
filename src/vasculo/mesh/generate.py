"""From a domain to a triangulation of its fluid."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import ComputationError, InputError
from vasculo.geometry.outline import is_number
from vasculo.mesh.delaunay import fluid_triangles
from vasculo.mesh.draft import Draft
from vasculo.mesh.flips import retriangulate
from vasculo.mesh.improve import smooth_draft
from vasculo.mesh.placement import interior_nodes
from vasculo.mesh.predict import predicted_triangles
from vasculo.mesh.size import size_field, with_wall_edges
from vasculo.mesh.snap import snap_to_walls
from vasculo.mesh.subdivide import wall_nodes
from vasculo.mesh.triangulation import Triangulation
from vasculo.mesh.truss import relax_truss
from vasculo.mesh.walls import walls_of

if TYPE_CHECKING:
    from vasculo.geometry.domain import Domain
    from vasculo.mesh.passages import Passages
    from vasculo.mesh.size import SizeField
    from vasculo.mesh.walls import Walls

NARROWEST = 1e-6
"""Narrowest passage that is meshed, over the extent of the domain: Qhull tells its nodes apart."""

SMOOTHING = 3
"""Rounds of flips and smoothing after the truss."""

AREA_ROUNDING = 1e-12
"""The areas of the triangles add up to the fluid's within this share."""


def generate_mesh(
    domain: Domain,
    edge_length: float,
    wall_edge_length: float | None = None,
    *,
    across: float = 0.0,
    grading: float = 0.25,
    iterations: int = 10,
    max_triangles: int = 5_000_000,
) -> Triangulation:
    """Triangulate the fluid of a domain.

    Parameters
    ----------
    domain : Domain
        Every node of its outlines becomes a mesh node; their segments may be cut.
    edge_length : float, model length
        Wanted edge length far from walls and passages.
    wall_edge_length : float, model length, optional
        Wanted edge length at all walls; `edge_length` if left out. Shorter outline segments keep their length.
    across : float, default 0
        Layers of triangles wanted across each passage between two outlines. Even with 0, wall edges stay below the
        width of their passage.
    grading : float, dimensionless, default 0.25
        Largest change of the edge length per length.
    iterations : int, default 10
        Rounds of truss relaxation, snapping and flips.
    max_triangles : int, default 5 000 000
        A mesh predicted to be larger is refused.

    Returns
    -------
    Triangulation
        The first nodes are those of the outlines: pillars in their order, then the outer outline.

    Raises
    ------
    InputError
        Numbers out of range, a passage too narrow to mesh, or too many triangles (with their number).
    ComputationError
        The triangulation could not be made to follow the walls.

    Notes
    -----
    Szczerba & Szekely 2005, section 3, after Persson & Strang 2004: masses inside the domain and outside the pillars,
    Delaunay triangulation, springs slightly too long that push the masses apart with the motion of eqs. (2) and (3),
    re-triangulation, snapping to the walls. Placement in layers, the size field and the final smoothing are ours.
    The same input gives the same mesh.
    """
    wall = edge_length if wall_edge_length is None else wall_edge_length
    _check_numbers(edge_length, wall, across, grading, iterations, max_triangles)
    check_count(domain.area / edge_length**2 / 0.433, max_triangles, f"edge_length {edge_length:g}")
    walls = walls_of(domain)
    field = size_field(walls, edge_length, wall, across, grading)
    _check_field(domain, walls, field, max_triangles)
    draft = first_draft(walls, field, max_triangles)
    for _ in range(iterations):
        retriangulate(draft)
        relax_truss(draft)
        snap_to_walls(draft)
    for _ in range(SMOOTHING):
        retriangulate(draft)
        smooth_draft(draft)
    retriangulate(draft)
    tags = walls.tags[draft.segment]
    mesh = Triangulation(draft.points, draft.triangles, draft.edges, tags, domain.side_names)
    covered = float(mesh.areas.sum())
    if not abs(covered - domain.area) <= AREA_ROUNDING * domain.area:
        raise ComputationError(
            f"the {len(mesh.triangles)} triangles cover {covered:.15g} of the fluid's area {domain.area:.15g}: "
            "outlines are too close to each other"
        )
    return mesh


def _check_numbers(
    edge_length: float, wall: float, across: float, grading: float, iterations: int, max_triangles: int
) -> None:
    """Refuse numbers out of range."""
    for name, value in (("edge_length", edge_length), ("wall_edge_length", wall)):
        if not (is_number(value) and 0.0 < value < np.inf):
            raise InputError(f"{name} must be a positive length, not {value!r}")
    if not 0.0 <= across <= 100.0:
        raise InputError(f"across must lie between 0 and 100 triangles, not {across}")
    if not 0.01 <= grading <= 0.5:
        raise InputError(f"grading must lie between 0.01 and 0.5, not {grading}")
    if not 0 <= iterations <= 1000:
        raise InputError(f"iterations must lie between 0 and 1000, not {iterations}")
    if max_triangles < 1:
        raise InputError(f"max_triangles must be at least 1, not {max_triangles}")


def check_count(predicted: float, most: int, where: str) -> None:
    """Refuse a mesh that would be too large."""
    if predicted > most:
        raise InputError(
            f"the mesh would need about {predicted:.3g} triangles, more than the limit of {most}, with {where}: "
            "use longer edges, fewer across, or raise max_triangles"
        )


def check_narrowest(domain: Domain, passages: Passages) -> None:
    """Refuse a passage too narrow to mesh."""
    low_x, low_y, high_x, high_y = domain.bounds
    limit = NARROWEST * max(high_x - low_x, high_y - low_y)
    if len(passages.gap) and passages.gap.min() < limit:
        i = int(np.argmin(passages.gap))
        between = _between(domain, int(passages.body[i]), int(passages.other[i]))
        raise InputError(f"{between} are {passages.gap[i]:.3g} apart, less than {limit:.3g}: merge or part them")


def _check_field(domain: Domain, walls: Walls, field: SizeField, most: int) -> None:
    """Refuse passages too narrow to mesh, and too many triangles."""
    check_narrowest(domain, field.passages)
    total, dearest, (one, other, width) = predicted_triangles(walls, field, domain.area)
    where = f"edge_length {field.largest:g}"
    if one >= 0:
        where += f" ({dearest:.3g} of them where {_between(domain, one, other)} are {width:.3g} apart)"
    check_count(total, most, where)


def _between(domain: Domain, one: int, other: int) -> str:
    """Name two outlines."""
    names = [f"pillar {body}" if body < len(domain.pillars) else "the outer outline" for body in sorted((one, other))]
    return f"parts of {names[0]}" if one == other else f"{names[0]} and {names[1]}"


def first_draft(walls: Walls, field: SizeField, max_triangles: int) -> Draft:
    """Place all nodes and triangulate the fluid."""
    on_wall, edges, segment = wall_nodes(walls, field)
    field = with_wall_edges(field, on_wall, edges)
    inner = interior_nodes(walls, field, on_wall, edges, max_triangles)
    if inner is None:
        raise InputError(
            f"the mesh would need more than {max_triangles} nodes: use longer edges or raise max_triangles"
        )
    points = np.concatenate((on_wall, inner))
    triangles, neighbours = fluid_triangles(points, edges)
    fixed = np.arange(len(points)) < len(on_wall)
    return Draft(points, field.at(points), fixed, triangles, neighbours, edges, segment)
