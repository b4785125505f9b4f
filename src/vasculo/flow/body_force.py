"""The body force of each cell: its mean over the triangle."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import InputError
from vasculo.flow.values import vector_at

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from vasculo.flow.values import Field
    from vasculo.mesh.triangulation import Triangulation

# Six points of a triangle, exact for polynomials of degree 4 (Dunavant 1985): the barycentric coordinate a of (1 - 2 a,
# a, a) and its turns, and the weight of each.
ORBITS = ((0.445948490915965, 0.223381589678011), (0.091576213509771, 0.109951743655322))
PIECE = 100_000  # triangles at a time


def cell_forces(mesh: Triangulation, force: ArrayLike | Field | None) -> NDArray[np.float64]:
    """Mean body force in each cell.

    Parameters
    ----------
    mesh : Triangulation
    force : (2,) or (t, 2) array_like, or callable, or None
        Force per area: one for all, one a cell, or a function of the coordinates (two float64 arrays) that returns both
        components; it is integrated over each triangle by a formula of degree 4.

    Returns
    -------
    (t, 2) float64

    Raises
    ------
    InputError
        Another shape, or values that are not finite.
    """
    cells = len(mesh.triangles)
    if force is None:
        return np.zeros((cells, 2))
    if callable(force):
        pieces = [_mean(mesh.points[mesh.triangles[k : k + PIECE]], force) for k in range(0, cells, PIECE)]
        return np.concatenate(pieces)
    try:
        given = np.asarray(force, dtype=np.float64)
    except (TypeError, ValueError):
        raise InputError(f"force is {force!r}: give two numbers, or a row of them a triangle") from None
    if given.shape not in {(2,), (cells, 2)}:
        raise InputError(
            f"force has shape {given.shape}: give (2,), one row a triangle, ({cells}, 2), or a function of (x, y)"
        )
    bad = int(np.count_nonzero(~np.isfinite(given)))
    if bad:
        raise InputError(f"{bad} components of the force are not finite")
    return np.ascontiguousarray(np.broadcast_to(given, (cells, 2)))


def _mean(corners: NDArray[np.float64], force: Field) -> NDArray[np.float64]:
    """Mean of a function over triangles with these corners, (k, 3, 2)."""
    places, weights = [], []
    for near, weight in ORBITS:
        for k in range(3):
            places.append(near * corners.sum(axis=1) + (1.0 - 3.0 * near) * corners[:, k])
            weights.append(weight)
    return np.asarray(np.einsum("q,qki->ki", weights, vector_at(force, np.stack(places), "body force")))
