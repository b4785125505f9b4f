"""The extracellular matrix: springs between the membranes and the outer boundary."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial import cKDTree

from vasculo.flow.read.locate import Locator
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


def no_matrix(points: NDArray[np.float64]) -> Matrix:
    """Leave the matrix out: membrane nodes (n, 2) only, which no spring holds."""
    return Matrix(
        points,
        points,
        np.zeros((0, 2), dtype=np.int32),
        np.zeros((0, 3), dtype=np.int32),
        np.zeros(len(points), dtype=np.bool_),
    )


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
    upright = _areas(old.points, old.triangles) > 1e-3 * _areas(old.reference, old.triangles)
    old = replace(old, triangles=old.triangles[upright])
    triangle, shares = Locator(old).find(new.points)
    lost = np.flatnonzero(triangle < 0)  # new membrane nodes just off the old sides
    if lost.size:
        triangle[lost] = cKDTree(old.points[old.triangles].mean(axis=1)).query(new.points[lost])[1]
        shares[lost] = _nearest_shares(old.points[old.triangles[triangle[lost]]], new.points[lost])
    displacement = (moved[old.triangles[triangle]] * shares[:, :, None]).sum(axis=1)
    return Matrix(new.points, new.points - displacement, new.springs, new.triangles, new.pinned)


def _nearest_shares(corners: NDArray[np.float64], points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Barycentric coordinates (k, 3) of points beside triangles (k, 3, 2), brought back to the triangle."""
    parts = np.stack(
        [
            _cross(corners[:, (i + 1) % 3] - points, corners[:, (i + 2) % 3] - points)
            for i in range(3)
        ],
        axis=1,
    )  # fmt: skip
    inside = np.maximum(parts, 0.0)
    return inside / inside.sum(axis=1, keepdims=True)


def _cross(u: NDArray[np.float64], v: NDArray[np.float64]) -> NDArray[np.float64]:
    return u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]


def _areas(points: NDArray[np.float64], triangles: NDArray[np.int32]) -> NDArray[np.float64]:
    """Signed areas; (t,) float64."""
    a, b, c = points[triangles[:, 0]], points[triangles[:, 1]], points[triangles[:, 2]]
    return 0.5 * _cross(b - a, c - a)
