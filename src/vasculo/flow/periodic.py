"""Periodic sides: which edge faces which, and the mean pressure gradient that a pressure drop imposes."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import cKDTree

from vasculo.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from vasculo.mesh.triangulation import Triangulation

MATCH = 1e-6  # vertices match within this fraction of the shortest edge of the side
CELLS_ACROSS = 3.0  # the fewest edge lengths between two paired sides: stencils must not meet their own images


def matched_edges(
    mesh: Triangulation, pairs: Sequence[tuple[str, str, float]]
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]:
    """Edges and vertices of paired sides.

    Returns
    -------
    edges : (k, 2) int64
        Boundary edges that face each other.
    vertices : (l, 2) int64
        Vertices that are the same point of the flow.
    shifts : (pairs, 2) float64
        From each side to its partner.

    Raises
    ------
    InputError
        The sides are no translated copies of each other, vertex by vertex, or too close together.
    """
    edges, vertices = [np.empty((0, 2), dtype=np.int64)], [np.empty((0, 2), dtype=np.int64)]
    shifts = np.empty((len(pairs), 2))
    for k, (side, other, _) in enumerate(pairs):
        here, there = mesh.edge_of(side), mesh.edge_of(other)
        nodes, partners, shifts[k] = _matched_vertices(mesh, side, other, here, there)
        vertices.append(np.column_stack([nodes, partners]))
        # The partner of the edge a -> b runs from b's partner to a's: both have the fluid on their left.
        wanted = partners[np.searchsorted(nodes, mesh.boundary_edges[here][:, ::-1])] @ (len(mesh.points), 1)
        given = mesh.boundary_edges[there].astype(np.int64) @ (len(mesh.points), 1)
        order = np.argsort(given)
        place = np.minimum(np.searchsorted(given[order], wanted), len(given) - 1)
        differ = int(np.count_nonzero(given[order][place] != wanted))
        if differ:
            raise InputError(
                f"sides {side!r} and {other!r} have the same vertices but {differ} edges differ: "
                "make one a translated copy of the other"
            )
        edges.append(np.column_stack([here, there[order][place]]))
    return np.concatenate(edges), np.concatenate(vertices), shifts


def gradient_of_drops(pairs: Sequence[tuple[str, str, float]], shifts: NDArray[np.float64]) -> NDArray[np.float64]:
    """Mean pressure drop per length, float64 (2,): the smallest G with G . shift = pressure drop for every pair."""
    if not pairs:
        return np.zeros(2)
    drops = np.array([drop for _, _, drop in pairs])
    gradient, _, _, _ = np.linalg.lstsq(shifts, drops)
    missed = float(np.abs(shifts @ gradient - drops).max())
    if missed > 1e-9 * max(float(np.abs(drops).max()), 1e-300):
        raise InputError(f"the pressure drops of the periodic pairs contradict each other by {missed:.3g}")
    return np.asarray(gradient)


def _matched_vertices(
    mesh: Triangulation, side: str, other: str, here: NDArray[np.int64], there: NDArray[np.int64]
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]:
    """Vertices of one side, their partners on the other, and the translation between them."""
    nodes = np.unique(mesh.boundary_edges[here]).astype(np.int64)
    others = np.unique(mesh.boundary_edges[there]).astype(np.int64)
    if len(nodes) != len(others) or len(nodes) == 0:
        raise InputError(f"sides {side!r} and {other!r} have {len(nodes)} and {len(others)} vertices: they must match")
    a, b = mesh.points[nodes], mesh.points[others]
    shift = b.mean(axis=0) - a.mean(axis=0)
    lengths = np.linalg.norm(np.diff(mesh.points[mesh.boundary_edges[here]], axis=1)[:, 0], axis=1)
    away, place = (np.asarray(found) for found in cKDTree(b).query(a + shift))
    wrong = int(np.count_nonzero(away > MATCH * lengths.min())) + len(nodes) - len(np.unique(place))
    if wrong:
        raise InputError(
            f"{wrong} of {len(nodes)} vertices of {side!r} have no partner on {other!r} (farthest {away.max():.3g}, "
            f"edges {lengths.min():.3g}): make one side a translated copy of the other"
        )
    across = float(np.hypot(*shift)) / float(lengths.max())
    if across < CELLS_ACROSS:
        raise InputError(
            f"periodic sides {side!r} and {other!r} are {across:.2g} edge lengths apart: refine to {CELLS_ACROSS:.0f}"
        )
    return nodes, others[place], shift
