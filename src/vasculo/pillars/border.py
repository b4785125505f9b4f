"""Pillars at the closed sides: where a membrane touches a side, no fluid passes between them.

A mirror wall is the middle between a pillar and its image, so a pillar that is half a merge gap away from it has merged
with its image. The cell stays a closed membrane, and only the fluid between it and the side goes.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from vasculo.geometry.domain import Domain
from vasculo.mesh.generate import generate_mesh
from vasculo.mesh.triangulation import Triangulation
from vasculo.pillars.contact import find_seals, rolled_outer
from vasculo.pillars.fluid import fluid_parts

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

    from vasculo.pillars.fluid import FluidPart


class FlowMesh(NamedTuple):
    """The mesh of the fluid, and which pillars have joined a closed side.

    Parameters
    ----------
    mesh : Triangulation
        Edges on membranes carry the number of their pillar in the domain, and so do the short walls from the end of a
        contact to the side.
    touching : (p,) bool
        Pillars that have joined a closed side.
    sealed : (n,) bool
        Membrane sides, each named by its first node, that no fluid touches: they have no wall edge and feel no shear.
    blocked : bool
        The fluid has no way from one opening to the other.
    """

    mesh: Triangulation
    touching: NDArray[np.bool_]
    sealed: NDArray[np.bool_]
    blocked: bool


def flow_mesh(
    domain: Domain,
    openings: Sequence[str],
    contact: float,
    reach: float,
    edge_length: float,
    wall_edge_length: float,
    *,
    across: float = 0.0,
    make: Callable[..., Triangulation] = generate_mesh,
) -> FlowMesh:
    """Mesh the fluid of a domain without the slivers between pillars and the closed sides that they touch.

    A pillar touches where a side of its membrane is within `contact` of a closed side. From there on all nodes of the
    membrane within `reach` lie under the seal, as far as nothing is in between; at both ends of it a straight wall runs
    to the nearest point of the side. Fluid that the seals enclose goes too, unless pillars swim in it.

    Parameters
    ----------
    domain : Domain
        Its pillars have evenly spaced nodes.
    openings : sequence of str
        The inlet and the outlet; all other sides are closed.
    contact, reach : float, model length
        Largest distance at which a pillar touches; largest length of the walls at the ends of a contact, about
        one membrane spacing.
    edge_length, wall_edge_length, across
        As in `generate_mesh`.
    make : callable
        Meshes the domain where no pillar touches; called like `generate_mesh`.

    Returns
    -------
    FlowMesh
        Without a touching pillar the mesh is that of `generate_mesh`, bit for bit.

    Raises
    ------
    InputError
        As `generate_mesh`.
    ComputationError
        As `generate_mesh`.
    """
    outer, sides = rolled_outer(domain, openings)
    seals = find_seals(domain.pillars, outer, sides, openings, contact, reach)
    starts = np.cumsum([0, *(len(outline) for outline in domain.pillars)])
    touching = np.zeros(len(domain.pillars), dtype=np.bool_)
    if not seals:
        mesh = make(domain, edge_length, wall_edge_length, across=across)
        return FlowMesh(mesh, touching, np.zeros(starts[-1], dtype=np.bool_), blocked=False)
    touching[[seal.pillar for seal in seals]] = True
    parts = fluid_parts(domain, outer, sides, openings, seals)
    sealed = np.repeat(touching, np.diff(starts))
    for part in parts:
        sealed[part.open_sides] = False
    # A pillar in fluid that a seal has taken away is part of the wall as a whole.
    lost = np.setdiff1d(np.flatnonzero(~touching), np.concatenate([part.pillars for part in parts]))
    touching[lost] = True
    for pillar in lost:
        sealed[starts[pillar] : starts[pillar + 1]] = True
    mesh = _join([_mesh_part(part, domain, edge_length, wall_edge_length, across) for part in parts], domain.side_names)
    return FlowMesh(mesh, touching, sealed, not any(part.is_through for part in parts))


def _mesh_part(
    part: FluidPart, domain: Domain, edge_length: float, wall_edge_length: float, across: float
) -> tuple[Triangulation, NDArray[np.int32]]:
    """Mesh one part of the fluid; with the tags that its boundary edges have in the whole."""
    alone = Domain(part.outline, [domain.pillars[k] for k in part.pillars], [str(tag) for tag in part.tags])
    low_x, low_y, high_x, high_y = alone.bounds
    longest = float(np.hypot(high_x - low_x, high_y - low_y))
    mesh = generate_mesh(alone, min(edge_length, longest), min(wall_edge_length, longest), across=across)
    own = np.concatenate((part.pillars, [int(name) for name in mesh.side_names[::-1]])).astype(np.int32)
    return mesh, own[mesh.boundary_tags]


def _join(parts: Sequence[tuple[Triangulation, NDArray[np.int32]]], side_names: tuple[str, ...]) -> Triangulation:
    """Put meshes that share no node into one."""
    meshes = [mesh for mesh, _ in parts]
    node = np.cumsum([0, *(len(mesh.points) for mesh in meshes[:-1])])
    cell = np.cumsum([0, *(len(mesh.triangles) for mesh in meshes[:-1])])
    return Triangulation(
        np.concatenate([mesh.points for mesh in meshes]),
        np.concatenate([mesh.triangles + first for mesh, first in zip(meshes, node, strict=True)]),
        np.concatenate([mesh.boundary_edges + first for mesh, first in zip(meshes, node, strict=True)]),
        np.concatenate([tags for _, tags in parts]),
        side_names,
        np.concatenate([_shifted(mesh.neighbours, first) for mesh, first in zip(meshes, cell, strict=True)]),
        np.concatenate([mesh.sizes for mesh in meshes]),
    )


def _shifted(neighbours: NDArray[np.int32], first: int) -> NDArray[np.int32]:
    """Neighbours of triangles that now count from `first`; -1 stays."""
    return np.where(neighbours < 0, -1, neighbours + first).astype(np.int32)
