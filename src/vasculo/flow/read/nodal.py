"""Node values from cell values: the paper's linear problem, here a consistent-mass projection."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from vasculo.flow.faces import MIRROR, MOVING, OPEN
from vasculo.flow.read.gradients import cell_gradients
from vasculo.springs.threads import run_team

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.flow.faces import Faces
    from vasculo.geometry.arrays import Flags, Floats, Ints, Longs
    from vasculo.mesh.triangulation import Triangulation

STEPS = 16  # the distance to the solution, of second order at the start, falls threefold a step
FEWEST = 16_384  # nodes that are worth a thread


def project_to_nodes(mesh: Triangulation, faces: Faces, velocity: NDArray[np.float64]) -> NDArray[np.float64]:
    """Velocity at the nodes, second order in the edge length and exact for linear fields.

    Continuous and linear in each triangle, with the prescribed values at walls and inlets and the least squared
    distance to the cells' linear fields elsewhere; on mirror lines the component across is removed.

    Parameters
    ----------
    mesh : Triangulation
    faces : Faces
    velocity : (t, 2) float64
        At the centroids.

    Returns
    -------
    (n, 2) float64
    """
    nodes = len(mesh.points)
    moving = faces.kind[faces.inner :] == MOVING
    fixed, given = np.zeros(nodes, dtype=np.bool_), np.zeros((nodes, 2))
    prescribe(faces.ends[faces.inner :], faces.same, moving, faces.profile, fixed, given)
    gradient = cell_gradients(mesh, faces, velocity, moving, faces.profile[:, 1])
    values = _project(mesh, faces, velocity, gradient, fixed, given)
    remove_across(np.flatnonzero(faces.kind == MIRROR), faces.ends, faces.normal, faces.same, fixed, values)
    return values[faces.same]


def project_pressure(mesh: Triangulation, faces: Faces, pressure: NDArray[np.float64]) -> NDArray[np.float64]:
    """Pressure at the nodes, second order in the edge length and exact for linear fields.

    Parameters
    ----------
    mesh : Triangulation
    faces : Faces
    pressure : (t,) float64
        At the centroids.

    Returns
    -------
    (n,) float64
        Continuous; across periodic sides it jumps by the pressure drop.
    """
    nodes, drop, level = len(mesh.points), faces.gradient, faces.level
    even = (pressure - level + mesh.centroids @ drop)[:, None]
    gradient = cell_gradients(mesh, faces, even, faces.kind[faces.inner :] == OPEN, faces.opening[:, None])
    values = _project(mesh, faces, even, gradient, np.zeros(nodes, dtype=np.bool_), np.zeros((nodes, 1)))
    return np.asarray(values[faces.same, 0] + level - mesh.points @ drop)


def _project(
    mesh: Triangulation,
    faces: Faces,
    values: NDArray[np.float64],
    gradient: NDArray[np.float64],
    fixed: NDArray[np.bool_],
    given: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Project cell values (t, k) with gradients (t, k, 2) to the nodes, (n, k); `fixed` ones keep what is `given`."""
    # Strategy: M x = r with the mass matrix M of linear elements, and r from the field that is linear in each triangle
    # (the cell values alone would lose an order where the triangles around a node are uneven). Scaled by its diagonal,
    # the eigenvalues of M lie in [1/2, 2] on every mesh of triangles (Wathen 1987), so a fixed number of Chebyshev
    # steps does: no factor, no inner products. The start is the mean of what the triangles around a node say, of second
    # order itself and exact for linear fields. An entry of M belongs to a face, a row to a node and a thread.
    nodes = len(mesh.points)
    right = np.zeros((nodes, values.shape[1]))
    x = np.zeros_like(right)
    diagonal = np.zeros(nodes)
    gather(
        mesh.points, mesh.triangles, mesh.centroids, mesh.areas, faces.same, np.ascontiguousarray(values), gradient,
        right, x, diagonal,
    )  # fmt: skip
    x[fixed] = given[fixed]
    start, column, share = mass_rows(faces.ends, faces.cells, faces.same, mesh.areas, nodes)

    still = fixed | (diagonal == 0.0)
    step, after = np.zeros_like(x), np.empty_like(x)
    centre, radius = 1.25, 0.75  # of the eigenvalues of M over its diagonal
    keep, take = 0.0, 1.0 / centre
    rho = radius / centre
    for _ in range(STEPS):
        run_team(
            iterate, nodes // FEWEST + 1, start, column, share, diagonal, right, still, keep, take, step, x, after
        )  # fmt: skip
        x, after = after, x
        new = 1.0 / (2.0 * centre / radius - rho)
        keep, take, rho = new * rho, 2.0 * new / radius, new
    return x


@njit(cache=True, error_model="numpy")
def gather(
    points: Floats,
    triangles: Ints,
    centroids: Floats,
    areas: Floats,
    same: Ints,
    values: Floats,
    gradient: Floats,
    right: Floats,
    mean: Floats,
    diagonal: Floats,
) -> None:
    """Add up, at each node, the cells' linear fields times its hat function and their mean, and the mass diagonal.

    Overwrites `right` and `mean` (n, k) and `diagonal` (n,), given as zeros.
    """
    count = values.shape[1]
    for t in range(len(triangles)):
        for c in range(3):
            i = triangles[t, c]
            x, y = points[i, 0] - centroids[t, 0], points[i, 1] - centroids[t, 1]
            i = same[i]
            diagonal[i] += areas[t] / 6.0
            for k in range(count):
                slope = gradient[t, k, 0] * x + gradient[t, k, 1] * y
                right[i, k] += areas[t] * (values[t, k] / 3.0 + slope / 12.0)
                mean[i, k] += areas[t] * (values[t, k] + slope)
    for i in range(len(diagonal)):
        if diagonal[i] > 0.0:
            for k in range(count):
                mean[i, k] /= 6.0 * diagonal[i]


@njit(cache=True, error_model="numpy")
def prescribe(ends: Ints, same: Ints, known: Flags, profile: Floats, fixed: Flags, values: Floats) -> None:
    """Give the ends of boundary faces that are `known` (b,) the mean of what these prescribe, `profile` (b, 3, k).

    Overwrites `values` (n, k) there, and sets `fixed` (n,), given as False.
    """
    number = np.zeros(len(fixed), dtype=np.int32)
    for f in np.flatnonzero(known):
        for end in range(2):
            i = same[ends[f, end]]
            number[i] += 1
            for k in range(values.shape[1]):
                values[i, k] = profile[f, 2 * end, k] + (values[i, k] if fixed[i] else 0.0)
            fixed[i] = True
    for i in np.flatnonzero(fixed):
        for k in range(values.shape[1]):
            values[i, k] /= number[i]


@njit(cache=True, error_model="numpy")
def mass_rows(ends: Ints, cells: Ints, same: Ints, areas: Floats, nodes: int) -> tuple[Longs, Ints, Floats]:
    """Rows of the mass matrix off its diagonal: start (n + 1,), column and entry of each; both directions of a face."""
    start = np.zeros(nodes + 1, dtype=np.int64)
    for f in range(len(ends)):
        start[same[ends[f, 0]] + 1] += 1
        start[same[ends[f, 1]] + 1] += 1
    for i in range(nodes):
        start[i + 1] += start[i]
    column = np.empty(start[nodes], dtype=np.int32)
    share = np.empty(start[nodes])
    place = start[:-1].copy()
    for f in range(len(ends)):
        area = areas[cells[f, 0]] + (areas[cells[f, 1]] if cells[f, 1] >= 0 else 0.0)
        for end in range(2):
            i = same[ends[f, end]]
            column[place[i]] = same[ends[f, 1 - end]]
            share[place[i]] = area / 12.0
            place[i] += 1
    return start, column, share


@njit(cache=True, error_model="numpy", nogil=True)
def iterate(
    rank: int,
    threads: int,
    start: Longs,
    column: Ints,
    share: Floats,
    diagonal: Floats,
    right: Floats,
    still: Flags,
    keep: float,
    take: float,
    step: Floats,
    x: Floats,
    after: Floats,
) -> int:
    """One Chebyshev step at the nodes of this thread; overwrites `step` and `after` (n, k).

    step = keep step + take (right - M x) / diagonal, after = x + step; `still` nodes keep their values.
    """
    nodes = len(x)
    for i in range(rank * nodes // threads, (rank + 1) * nodes // threads):
        for k in range(x.shape[1]):
            if still[i]:
                after[i, k] = x[i, k]
                continue
            rest = right[i, k]
            for place in range(start[i], start[i + 1]):
                rest -= share[place] * x[column[place], k]
            step[i, k] = keep * step[i, k] + take * (rest / diagonal[i] - x[i, k])
            after[i, k] = x[i, k] + step[i, k]
    return 0


@njit(cache=True, error_model="numpy")
def remove_across(mirror: Longs, ends: Ints, normal: Floats, same: Ints, fixed: Flags, values: Floats) -> None:
    """Remove the velocity across mirror lines at their nodes that are not `fixed`; overwrites `values` (n, 2)."""
    for f in mirror:
        for end in range(2):
            i = same[ends[f, end]]
            if not fixed[i]:
                across = values[i, 0] * normal[f, 0] + values[i, 1] * normal[f, 1]
                values[i, 0] -= across * normal[f, 0]
                values[i, 1] -= across * normal[f, 1]
