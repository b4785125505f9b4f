"""From a domain to a triangulation of its fluid."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import ComputationError, InputError
from vasculo.mesh.delaunay import fluid_triangles
from vasculo.mesh.flips import restore_delaunay
from vasculo.mesh.improve import smooth, stars
from vasculo.mesh.placement import interior_nodes
from vasculo.mesh.size import size_field
from vasculo.mesh.subdivide import wall_nodes
from vasculo.mesh.triangulation import Triangulation
from vasculo.mesh.truss import DAMPING, FOLD, PRESSURE, TIME_STEP, relax, unique_edges
from vasculo.mesh.walls import walls_of

if TYPE_CHECKING:
    from vasculo.geometry.domain import Domain


def generate_mesh(
    domain: Domain,
    edge_length: float,
    wall_edge_length: float | None = None,
    *,
    across: float = 0.0,
    grading: float = 0.25,
    iterations: int = 3,
    max_triangles: int = 5_000_000,
) -> Triangulation:
    """Triangulate the fluid of a domain."""
    walls = walls_of(domain)
    wall = edge_length if wall_edge_length is None else wall_edge_length
    field, _passages = size_field(walls, edge_length, wall, across, grading)
    on_wall, edges, segment = wall_nodes(walls, field)
    inner = interior_nodes(walls, field, on_wall, edges, max_triangles // 2)
    if inner is None:
        raise InputError(f"more than {max_triangles} triangles")
    points = np.concatenate((on_wall, inner))
    triangles, neighbours = fluid_triangles(points, edges)
    fixed = len(on_wall)
    sizes = field.at(points)
    for _ in range(iterations):
        restore_delaunay(points, triangles, neighbours, 50)
        velocities = np.zeros_like(points)
        springs = unique_edges(triangles, neighbours)
        relax(points, velocities, springs, triangles, sizes, fixed, 8, PRESSURE, TIME_STEP, DAMPING, FOLD)
    for _ in range(3):
        restore_delaunay(points, triangles, neighbours, 50)
        first, star = stars(triangles, len(points))
        smooth(points, triangles, first, star, fixed, 1)
    restore_delaunay(points, triangles, neighbours, 50)
    mesh = Triangulation(points, triangles, edges, walls.tags[segment], domain.side_names)
    if not abs(mesh.areas.sum() - domain.area) <= 1e-12 * domain.area:
        raise ComputationError(f"the mesh covers {mesh.areas.sum():.15g} of the fluid's {domain.area:.15g}")
    return mesh
