"""The extracellular matrix: springs between the membranes and the outer boundary."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.interpolate import LinearNDInterpolator, NearestNDInterpolator

from vasculo.mesh.matrix import matrix_springs

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.geometry.domain import Domain

FLAT = 0.1  # area of a triangle over that free of stress below which an elastic matrix is meshed anew


@dataclass(frozen=True, slots=True)
class Matrix:
    """Springs of the matrix.

    Attributes
    ----------
    points : (m, 2) float64
        Nodes, the membrane nodes of all pillars first, model length.
    reference : (m, 2) float64
        Where they are free of stress, model length.
    springs : (s, 2) int32
    triangles : (t, 3) int32
    pinned : (m,) bool
        Nodes on the outer boundary.
    """

    points: NDArray[np.float64]
    reference: NDArray[np.float64]
    springs: NDArray[np.int32]
    triangles: NDArray[np.int32]
    pinned: NDArray[np.bool_]

    @property
    def rest_lengths(self) -> NDArray[np.float64]:
        """Length of each spring free of stress; (s,) float64, model length."""
        vector = self.reference[self.springs[:, 1]] - self.reference[self.springs[:, 0]]
        return np.hypot(vector[:, 0], vector[:, 1])


def lay_matrix(domain: Domain, spacing: float) -> Matrix:
    """Mesh the space between the pillars anew, free of stress.

    Parameters
    ----------
    domain : Domain
    spacing : float
        Distance of its nodes away from the membranes, model length.

    Returns
    -------
    Matrix
        The nodes of the pillars, in order, come first.
    """
    points, springs, triangles, pinned = matrix_springs(domain, spacing)
    return Matrix(points, points, springs, triangles, pinned)


def is_flat(matrix: Matrix) -> bool:
    """Whether a triangle has lost nine tenths of its area, or has turned over."""
    return bool((_areas(matrix.points, matrix.triangles) < FLAT * _areas(matrix.reference, matrix.triangles)).any())


def carry_over(old: Matrix, new: Matrix) -> Matrix:
    """Give a new mesh the stress of an old one: the displacement from the state free of stress is interpolated.

    Parameters
    ----------
    old : Matrix
        Deformed.
    new : Matrix
        Of the same space, free of stress.

    Returns
    -------
    Matrix
        The new mesh with a reference that its points are displaced from as the old one's were.
    """
    moved = old.points - old.reference
    displacement = LinearNDInterpolator(old.points, moved)(new.points)
    lost = np.isnan(displacement).any(axis=1)
    if lost.any():
        displacement[lost] = NearestNDInterpolator(old.points, moved)(new.points[lost])
    return Matrix(new.points, new.points - displacement, new.springs, new.triangles, new.pinned)


def _areas(points: NDArray[np.float64], triangles: NDArray[np.int32]) -> NDArray[np.float64]:
    """Signed areas; (t,) float64."""
    a, b, c = points[triangles[:, 0]], points[triangles[:, 1]], points[triangles[:, 2]]
    u, v = b - a, c - a
    return 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
