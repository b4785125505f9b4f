"""Plain twin of the smoothing."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.mesh.improve import STILL

if TYPE_CHECKING:
    from numpy.typing import NDArray


def smooth_plain(points: NDArray[np.float64], triangles: NDArray[np.int32], fixed: NDArray[np.bool_]) -> None:
    """One sweep of `smooth`; overwrites the points.

    Parameters
    ----------
    points : (n, 2) float64, model length
    triangles : (t, 3) int32
    fixed : (n,) bool
    """
    turned = np.array([[0.0, -1.0], [1.0, 0.0]])
    for i in np.flatnonzero(~fixed):
        rows, corner = np.nonzero(triangles == i)
        a = points[triangles[rows, (corner + 1) % 3]]
        b = points[triangles[rows, (corner + 2) % 3]]
        # ratio f = n / d of each triangle, with gradients of n, d and f, and the Hessian of the sum of f^2
        f, d = _ratio(a, b, points[i])
        grad_n = 2.0 * points[i] - a - b
        grad_d = np.sqrt(3.0) * (b - a) @ turned.T
        grad_f = (grad_n - f[:, None] * grad_d) / d[:, None]
        mixed = grad_f[:, :, None] * grad_d[:, None, :]
        second = (2.0 * np.eye(2) - mixed - mixed.transpose(0, 2, 1)) / d[:, None, None]
        gradient = (2.0 * f[:, None] * grad_f).sum(axis=0)
        hessian = 2.0 * (grad_f[:, :, None] * grad_f[:, None, :] + f[:, None, None] * second).sum(axis=0)
        if np.linalg.det(hessian) > 0.0 and hessian[0, 0] > 0.0:
            step = -np.linalg.solve(hessian, gradient)
        else:
            step = -gradient / np.abs(hessian[np.triu_indices(2)]).sum()
        energy = (f**2).sum()
        if (step**2).sum() < STILL * (f * d).sum() / len(f):
            continue
        for _ in range(5):
            new, area = _ratio(a, b, points[i] + step)
            if area.min() > 0.0 and (new**2).sum() < energy:
                points[i] += step
                break
            step = 0.5 * step


def _ratio(
    a: NDArray[np.float64], b: NDArray[np.float64], node: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Inverse mean ratio of the triangles (node, a, b), and sqrt(12) times their areas."""
    u, v = a - node, b - node
    area = np.sqrt(3.0) * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    return ((u**2).sum(axis=1) + (v**2).sum(axis=1) - (u * v).sum(axis=1)) / area, area
