"""The homogeneous mesh of the matrix: outline nodes exactly as they are, constrained Delaunay, springs."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from vasculo.errors import InputError
from vasculo.geometry.curve import curve_order
from vasculo.mesh.draft import Draft
from vasculo.mesh.generate import check_count, check_narrowest
from vasculo.mesh.improve import smooth_draft
from vasculo.mesh.passages import passages_of
from vasculo.mesh.placement import interior_nodes
from vasculo.mesh.size import level_field
from vasculo.mesh.subdivide import wall_nodes
from vasculo.mesh.triangulate.delaunay import fluid_triangles
from vasculo.mesh.triangulate.flips import retriangulate
from vasculo.mesh.truss import relax_truss, unique_edges
from vasculo.mesh.walls import walls_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.geometry.domain import Domain

LARGEST = 5_000_000
"""Most triangles."""


class MatrixMesh(NamedTuple):
    """Springs and triangles between the pillars.

    Parameters
    ----------
    points : (n, 2) float64, model length
        The nodes of the pillars first, in their order and unchanged; then those of the outer outline, then the others.
    springs : (m, 2) int32
        The edges of the triangles, each once, outline edges included; none runs through a pillar.
    triangles : (t, 3) int32
        Counter-clockwise; they cover the fluid.
    pinned : (n,) bool
        Nodes on the outer outline.
    """

    points: NDArray[np.float64]
    springs: NDArray[np.int32]
    triangles: NDArray[np.int32]
    pinned: NDArray[np.bool_]


def matrix_springs(domain: Domain, spacing: float) -> MatrixMesh:
    """Mesh the space between the pillars evenly, with exactly the outline nodes on the pillars.

    Parameters
    ----------
    domain : Domain
    spacing : float, model length
        Distance between nodes away from the pillars. Springs join membrane to membrane in narrower passages.

    Returns
    -------
    MatrixMesh

    Raises
    ------
    InputError
        The spacing is not positive, or asks for too many triangles; or a passage is too narrow to mesh.
    ComputationError
        The triangulation could not be made to follow the outlines.

    Notes
    -----
    The homogeneous mesh of the "dual mesh approach" (Szczerba & Szekely 2005, section 4). Outline edges that the
    Delaunay triangulation lacks, across narrow passages, are recovered by flips, so no pillar segment is ever cut.
    """
    if not (np.isfinite(spacing) and spacing > 0.0):
        raise InputError(f"the spacing of the matrix must be a positive length, not {spacing}")
    check_count(domain.area / spacing**2 / 0.433, LARGEST, f"spacing {spacing:g}")
    walls = walls_of(domain)
    # Strategy: a size field that is the spacing everywhere, so only the outer outline and the open space are divided.
    passages = passages_of(walls, 0.1 * spacing)
    check_narrowest(domain, passages)
    field = level_field(walls, float(spacing), passages)
    points, edges, segment = wall_nodes(walls, field, whole=walls.tags >= 0)
    expected = domain.area / spacing**2 / 0.866
    placed = interior_nodes(field, points, np.full(len(points), float(spacing)), edges, expected, LARGEST)
    if placed is None:
        raise InputError(f"the matrix would need more than {LARGEST} nodes: use a wider spacing")
    inner = placed[0][curve_order(placed[0])]
    fixed = np.arange(len(points) + len(inner)) < len(points)
    points = np.concatenate((points, inner))
    triangles, neighbours = fluid_triangles(points, edges)
    draft = Draft(points, np.full(len(points), float(spacing)), fixed, triangles, neighbours, edges, segment)
    relax_truss(draft)
    retriangulate(draft)
    smooth_draft(draft)
    retriangulate(draft)
    membrane = sum(len(pillar) for pillar in domain.pillars)
    pinned = fixed & (np.arange(len(points)) >= membrane)
    return MatrixMesh(points, unique_edges(triangles, neighbours), triangles, pinned)
