"""Areas and shape of triangles."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray


def signed_areas(points: NDArray[np.float64], triangles: NDArray[np.int32]) -> NDArray[np.float64]:
    """Area of each triangle, positive when counter-clockwise.

    Parameters
    ----------
    points : (n, 2) float64, model length
    triangles : (t, 3) int32

    Returns
    -------
    (t,) float64, model length squared
    """
    a, b, c = (points[triangles[:, i]] for i in range(3))
    return np.asarray(0.5 * ((b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])))


def edge_lengths(points: NDArray[np.float64], triangles: NDArray[np.int32]) -> NDArray[np.float64]:
    """Lengths of the edges opposite to the corners; (t, 3) float64, model length."""
    step = points[triangles[:, (2, 0, 1)]] - points[triangles[:, (1, 2, 0)]]
    return np.asarray(np.hypot(step[:, :, 0], step[:, :, 1]))


def triangle_quality(points: NDArray[np.float64], triangles: NDArray[np.int32]) -> NDArray[np.float64]:
    """Shape 2 r_in / r_circ: 1 for an equilateral triangle, 0 for a flat one.

    Parameters
    ----------
    points : (n, 2) float64, model length
    triangles : (t, 3) int32

    Returns
    -------
    (t,) float64, dimensionless
        With sides a, b, c: (b + c - a)(c + a - b)(a + b - c) / (a b c); as 8 A^2 / (s a b c) it keeps its digits.
    """
    length = edge_lengths(points, triangles)
    area = signed_areas(points, triangles)
    return np.asarray(16.0 * area**2 / (length.sum(axis=1) * length.prod(axis=1)))


def smallest_angles(points: NDArray[np.float64], triangles: NDArray[np.int32]) -> NDArray[np.float64]:
    """Smallest angle of each triangle; (t,) float64, degrees."""
    a, b, c = np.sort(edge_lengths(points, triangles), axis=1).T
    return np.degrees(np.arccos(np.clip((b * b + c * c - a * a) / (2.0 * b * c), -1.0, 1.0)))
