"""Areas and shape of triangles."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from vasculo.geometry.predicates import orient2d

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.geometry.arrays import Floats, Ints


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
    areas = np.empty(len(triangles))
    fill_areas(points, triangles, areas)
    return areas


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


def signed_areas_plain(points: NDArray[np.float64], triangles: NDArray[np.int32]) -> NDArray[np.float64]:
    """Plain twin of `signed_areas`."""
    a, b, c = (points[triangles[:, i]] for i in range(3))
    return np.asarray(0.5 * ((b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])))


@njit(cache=True, error_model="numpy")
def fill_areas(points: Floats, triangles: Ints, areas: Floats) -> None:
    """Areas of the triangles, into `areas`."""
    for t in range(len(triangles)):
        a = triangles[t, 0]
        b = triangles[t, 1]
        c = triangles[t, 2]
        areas[t] = 0.5 * (
            (points[b, 0] - points[a, 0]) * (points[c, 1] - points[a, 1])
            - (points[b, 1] - points[a, 1]) * (points[c, 0] - points[a, 0])
        )


@njit(cache=True, error_model="numpy")
def first_turned(points: Floats, triangles: Ints) -> int:
    """First triangle that is flat or clockwise by exact arithmetic, or -1."""
    for t in range(len(triangles)):
        a = triangles[t, 0]
        b = triangles[t, 1]
        c = triangles[t, 2]
        if orient2d(points[a, 0], points[a, 1], points[b, 0], points[b, 1], points[c, 0], points[c, 1]) <= 0.0:
            return t
    return -1
