"""Gradients of cell values, by least squares over the neighbours of each cell."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.flow.faces import Faces
    from vasculo.geometry.arrays import Flags, Floats, Ints
    from vasculo.mesh.triangulation import Triangulation

FLAT = 1e-10  # neighbours within this share of one line (squared) give a gradient along it only


def cell_gradients(
    mesh: Triangulation,
    faces: Faces,
    values: NDArray[np.float64],
    known: NDArray[np.bool_],
    given: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Gradient of each cell from its neighbours and the prescribed values beside it.

    Parameters
    ----------
    mesh : Triangulation
    faces : Faces
    values : (t, k) float64
        At the centroids.
    known : (b,) bool
        Boundary faces with prescribed values.
    given : (b, k) float64
        Their values at the middle.

    Returns
    -------
    (t, k, 2) float64
        Exact for linear fields. A cell that sees along one line only has a neighbour's gradient across it.
    """
    return fit_gradients(
        mesh.points, mesh.triangles, mesh.centroids, faces.same, faces.ends, faces.cells, faces.inner,
        np.ascontiguousarray(values, dtype=np.float64), known, np.ascontiguousarray(given),
    )  # fmt: skip


@njit(cache=True, error_model="numpy")
def fit_gradients(
    points: Floats,
    triangles: Ints,
    centroids: Floats,
    same: Ints,
    ends: Ints,
    cells: Ints,
    inner: int,
    values: Floats,
    known: Flags,
    given: Floats,
) -> Floats:
    """Least squares, each equation over its distance; see `cell_gradients`."""
    count = values.shape[1]
    table = np.zeros((len(values), 3))
    gradient = np.zeros((len(values), count, 2))
    for f in range(len(ends)):
        if f >= inner and not known[f - inner]:
            continue
        x, y = step_across(points, triangles, centroids, same, ends, cells, f)
        weight = 1.0 / (x * x + y * y)
        left, other = cells[f, 0], cells[f, 1]
        for side in range(2 if f < inner else 1):
            cell = cells[f, side]
            table[cell, 0] += weight * x * x
            table[cell, 1] += weight * x * y
            table[cell, 2] += weight * y * y
            for k in range(count):
                ahead = values[other, k] if f < inner else given[f - inner, k]
                change = weight * (ahead - values[left, k])
                gradient[cell, k, 0] += change * x
                gradient[cell, k, 1] += change * y
    flat = np.zeros(len(values), dtype=np.bool_)
    for cell in range(len(values)):
        xx, xy, yy = table[cell]
        trace, determinant = xx + yy, xx * yy - xy * xy
        flat[cell] = determinant <= FLAT * trace * trace
        if trace == 0.0:
            continue
        if flat[cell]:
            xx, yy, xy, determinant = yy, xx, -xy, trace * trace
        for k in range(count):
            one, two = gradient[cell, k]
            gradient[cell, k, 0] = (yy * one - xy * two) / determinant
            gradient[cell, k, 1] = (xx * two - xy * one) / determinant
    # A cell that sees along one line only takes what lies across it from a neighbour that sees more.
    for f in range(inner):
        left, right = cells[f]
        if flat[left] != flat[right]:
            cell, other = (left, right) if flat[left] else (right, left)
            x, y = step_across(points, triangles, centroids, same, ends, cells, f)
            for k in range(count):
                across = (gradient[other, k, 1] * x - gradient[other, k, 0] * y) / (x * x + y * y)
                gradient[cell, k, 0] -= across * y
                gradient[cell, k, 1] += across * x
    return gradient


@njit(cache=True, error_model="numpy")
def step_across(
    points: Floats, triangles: Ints, centroids: Floats, same: Ints, ends: Ints, cells: Ints, face: int
) -> tuple[float, float]:
    """Way from the centroid of a face's first cell to that of the second, also across a seam, or to a rim's middle."""
    a, b, left, right = ends[face, 0], ends[face, 1], cells[face, 0], cells[face, 1]
    if right < 0:
        x, y = 0.5 * (points[a, 0] + points[b, 0]), 0.5 * (points[a, 1] + points[b, 1])
        return x - centroids[left, 0], y - centroids[left, 1]
    seen = a
    for k in range(3):
        if same[triangles[right, k]] == same[a]:
            seen = triangles[right, k]
    x = (points[a, 0] - centroids[left, 0]) + (centroids[right, 0] - points[seen, 0])
    return x, (points[a, 1] - centroids[left, 1]) + (centroids[right, 1] - points[seen, 1])


def fit_gradients_plain(
    points: Floats,
    triangles: Ints,
    centroids: Floats,
    same: Ints,
    ends: Ints,
    cells: Ints,
    inner: int,
    values: Floats,
    known: Flags,
    given: Floats,
) -> Floats:
    """Twin of `fit_gradients`: the equations of each cell gathered and solved by their pseudo-inverse."""
    steps: list[list[NDArray[np.float64]]] = [[] for _ in values]
    changes: list[list[NDArray[np.float64]]] = [[] for _ in values]
    for f, (left, other) in enumerate(cells):
        start = points[ends[f, 0]]
        if f < inner:
            seen = points[triangles[other][same[triangles[other]] == same[ends[f, 0]]][0]]
            step, change = start - centroids[left] + centroids[other] - seen, values[other] - values[left]
            steps[other].append(-step)
            changes[other].append(-change)
        elif known[f - inner]:
            step = 0.5 * (start + points[ends[f, 1]]) - centroids[left]
            change = given[f - inner] - values[left]
        else:
            continue
        steps[left].append(step)
        changes[left].append(change)
    gradient = np.zeros((*values.shape, 2))
    flat = np.ones(len(values), dtype=bool)
    for cell, (step, change) in enumerate(zip(steps, changes, strict=True)):
        if step:
            unit = np.array(step) / np.linalg.norm(step, axis=1)[:, None]
            found = np.linalg.pinv(unit, rcond=np.sqrt(FLAT)) @ (
                np.array(change) / np.linalg.norm(step, axis=1)[:, None]
            )
            gradient[cell] = found.T
            flat[cell] = np.linalg.matrix_rank(unit, tol=np.sqrt(FLAT)) < 2
    for left, right in cells[:inner]:
        for cell, other in ((left, right), (right, left)):
            if flat[cell] and not flat[other]:
                along = steps[cell][0] / np.linalg.norm(steps[cell][0])
                gradient[cell] += gradient[other] - np.outer(gradient[other] @ along, along)
    return gradient
