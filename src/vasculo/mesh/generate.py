"""From a domain to a triangulation of its fluid."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import ComputationError, InputError
from vasculo.geometry.curve import curve_order
from vasculo.geometry.outline import is_number
from vasculo.mesh.charges import MOST_CHARGES, relax_charges
from vasculo.mesh.draft import Draft
from vasculo.mesh.improve import smooth_draft
from vasculo.mesh.placement import interior_nodes
from vasculo.mesh.predict import predicted_triangles
from vasculo.mesh.size import GRADING, size_field, with_wall_edges
from vasculo.mesh.snap import snap_to_walls
from vasculo.mesh.subdivide import wall_nodes
from vasculo.mesh.triangulate.delaunay import fluid_triangles
from vasculo.mesh.triangulate.flips import retriangulate
from vasculo.mesh.triangulation import Triangulation
from vasculo.mesh.truss import relax_truss
from vasculo.mesh.walls import walls_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from vasculo.geometry.domain import Domain
    from vasculo.mesh.passages import WallSamples
    from vasculo.mesh.size import SizeField
    from vasculo.mesh.walls import Walls

ROUNDS = {"advancing": 0, "truss": 10, "charges": 10}
"""The methods, and how many rounds of motion each has by itself."""

NARROWEST = 1e-9
"""Narrowest passage that is meshed, over the extent of the domain: a million roundings of the coordinates."""

SMOOTHING = 2
"""Rounds of smoothing and flips at the end of every method."""

AREA_ROUNDING = 1e-12
"""The areas of the triangles add up to the fluid's within this share."""


def generate_mesh(
    domain: Domain,
    edge_length: float,
    wall_edge_length: float | None = None,
    *,
    across: float = 0.0,
    curvature: float = 0.0,
    size: Callable[[NDArray[np.float64]], NDArray[np.float64]] | None = None,
    grading: float = GRADING,
    method: str = "advancing",
    iterations: int | None = None,
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
    curvature : float, default 0
        Edges wanted in a full turn of a wall, whatever its radius; also grades the mesh into sharp corners. 0: none.
    size : callable, optional
        Wanted edge length at any place: (n, 2) points to (n,) lengths, both in model length. It can only make edges
        shorter than the other wishes, and `grading` holds for it too.
    grading : float, dimensionless, default 0.25
        Largest change of the edge length per length.
    method : {"advancing", "truss", "charges"}
        "advancing": nodes where the advancing placement puts them, then smoothing. The other two let them move before:
        "truss" as springs that are a little too long (the paper's internal pressure), "charges" as springs between
        masses that all repel each other (the paper's first way; its cost grows with the square of the nodes).
    iterations : int, optional
        Rounds of motion, snapping and re-triangulation of "truss" and "charges"; 10 if left out.
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
    Szczerba & Szekely 2005, section 3: masses inside the domain and outside the pillars, Delaunay triangulation,
    springs with the wanted lengths, motion by eqs. (2) and (3), re-triangulation, snapping to the walls; "truss" after
    Persson & Strang 2004. The size field, the placement in layers and the smoothing are ours. The same input gives the
    same mesh, bit for bit, on any number of threads.

    Examples
    --------
    >>> import vasculo as vc
    >>> square = [(0.4, 0.4), (0.6, 0.4), (0.6, 0.6), (0.4, 0.6)]
    >>> mesh = vc.generate_mesh(vc.Domain.rectangle(1.0, 1.0, [square]), edge_length=0.1, wall_edge_length=0.05)
    >>> round(float(mesh.areas.sum()), 9), bool(mesh.quality().min() > 0.5)
    (0.96, True)
    """
    wall = edge_length if wall_edge_length is None else wall_edge_length
    rounds = _rounds(method, iterations)
    check_numbers(edge_length, wall, across, curvature, grading, max_triangles)
    low_x, low_y, high_x, high_y = domain.bounds
    if edge_length > (longest := float(np.hypot(high_x - low_x, high_y - low_y))):
        raise InputError(
            f"edge_length {edge_length:g} is longer than the whole domain ({longest:.6g} corner to corner)"
        )
    check_count(domain.area / edge_length**2 / 0.433, max_triangles, f"edge_length {edge_length:g}")
    walls = walls_of(domain)
    field = size_field(
        walls, edge_length, wall, across, grading, curvature=curvature, size=size, most=4 * max_triangles
    )
    expected = _check_field(domain, walls, field, max_triangles)
    draft = first_draft(walls, field, expected, max_triangles)
    if method == "charges":
        check_charges(len(draft.points))
    for _ in range(rounds):
        if method == "truss":
            relax_truss(draft)
        else:
            relax_charges(draft)
        retriangulate(draft)
        snap_to_walls(draft)
        retriangulate(draft)
    for _ in range(SMOOTHING):
        smooth_draft(draft)
        retriangulate(draft)
    tags = walls.tags[draft.segment]
    mesh = Triangulation(
        draft.points, draft.triangles, draft.edges, tags, domain.side_names, draft.neighbours, draft.sizes
    )
    covered = float(mesh.areas.sum())
    if not abs(covered - domain.area) <= AREA_ROUNDING * domain.area:
        raise ComputationError(
            f"the {len(mesh.triangles)} triangles cover {covered:.15g} of the fluid's area {domain.area:.15g}: "
            "outlines are too close to each other"
        )
    return mesh


def _rounds(method: str, iterations: int | None) -> int:
    """Check the method and return its rounds of motion."""
    if method not in ROUNDS:
        raise InputError(f"method must be one of {', '.join(ROUNDS)}, not {method!r}")
    if iterations is None:
        return ROUNDS[method]
    if isinstance(iterations, bool) or not isinstance(iterations, (int, np.integer)) or not 0 <= iterations <= 1000:
        raise InputError(f"iterations must be a whole number from 0 to 1000, not {iterations!r}")
    return int(iterations) if method != "advancing" else 0


def check_numbers(
    edge_length: float, wall: float, across: float, curvature: float, grading: float, max_triangles: int
) -> None:
    """Refuse numbers out of range."""
    for name, value in (("edge_length", edge_length), ("wall_edge_length", wall)):
        if not (is_number(value) and 0.0 < value < np.inf):
            raise InputError(f"{name} must be a positive length, not {value!r}")
    if not 0.0 <= across <= 100.0:
        raise InputError(f"across must lie between 0 and 100 triangles, not {across}")
    if not 0.0 <= curvature <= 10_000.0:
        raise InputError(f"curvature must lie between 0 and 10000 edges a turn, not {curvature}")
    if not 0.01 <= grading <= 0.5:
        raise InputError(f"grading must lie between 0.01 and 0.5, not {grading}")
    if max_triangles < 1:
        raise InputError(f"max_triangles must be at least 1, not {max_triangles}")


def check_count(predicted: float, most: int, where: str) -> None:
    """Refuse a mesh that would be too large."""
    if predicted > most:
        raise InputError(
            f"the mesh would need about {predicted:.3g} triangles, more than the limit of {most}, with {where}: "
            "use longer edges, fewer across, or raise max_triangles"
        )


def check_narrowest(domain: Domain, passages: WallSamples) -> None:
    """Refuse a passage too narrow to mesh."""
    low_x, low_y, high_x, high_y = domain.bounds
    limit = NARROWEST * max(high_x - low_x, high_y - low_y)
    if len(passages.gap) and passages.gap.min() < limit:
        i = int(np.argmin(passages.gap))
        between = _between(domain, int(passages.body[i]), int(passages.other[i]))
        raise InputError(f"{between} are {passages.gap[i]:.3g} apart, less than {limit:.3g}: merge or part them")


def _check_field(domain: Domain, walls: Walls, field: SizeField, most: int) -> float:
    """Refuse passages too narrow to mesh, and too many triangles; returns the number expected."""
    check_narrowest(domain, field.passages)
    total, dearest, (one, other, width) = predicted_triangles(walls, field, domain.area)
    where = f"edge_length {field.largest:g}"
    if one >= 0:
        where += f" ({dearest:.3g} of them where {_between(domain, one, other)} are {width:.3g} apart)"
    check_count(total, most, where)
    return total


def check_charges(nodes: int) -> None:
    """Refuse to let too many masses repel each other."""
    if nodes > MOST_CHARGES:
        raise InputError(
            f"{nodes} charges repel each other in {0.5 * nodes**2:.3g} pairs a step, more than {MOST_CHARGES} charges "
            f"({0.5 * MOST_CHARGES**2:.3g} pairs) allow: use method='truss' or 'advancing', or longer edges"
        )


def _between(domain: Domain, one: int, other: int) -> str:
    """Name two outlines."""
    names = [f"pillar {body}" if body < len(domain.pillars) else "the outer outline" for body in sorted((one, other))]
    return f"parts of {names[0]}" if one == other else f"{names[0]} and {names[1]}"


def first_draft(walls: Walls, field: SizeField, expected: float, max_triangles: int) -> Draft:
    """Place all nodes and triangulate the fluid; about `expected` triangles."""
    on_wall, edges, segment = wall_nodes(walls, field)
    field = with_wall_edges(field, on_wall, edges)
    sizes = field.at(on_wall)
    placed = interior_nodes(field, on_wall, sizes, edges, 0.5 * expected, max_triangles)
    if placed is None:
        raise InputError(
            f"the mesh would need more than {max_triangles} nodes: use longer edges or raise max_triangles"
        )
    order = curve_order(placed[0])
    points, wanted = np.concatenate((on_wall, placed[0][order])), np.concatenate((sizes, placed[1][order]))
    triangles, neighbours = fluid_triangles(points, edges)
    fixed = np.arange(len(points)) < len(on_wall)
    return Draft(points, wanted, fixed, triangles, neighbours, edges, segment)
