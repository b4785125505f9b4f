"""What a face may see: the cell values and prescribed values that enter its fits, with their weights."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from vasculo.flow.faces import MOVING, OPEN

if TYPE_CHECKING:
    from numpy.typing import NDArray

WALL_WEIGHT = 2.0  # of a prescribed value at a boundary face's middle; its two ends share as much
NEAREST = 0.2  # in face lengths: an opening nearer than this counts as if it were this far
FRONT = 0.3  # a boundary fit takes cells at least this part of its own cell's distance in front of the wall line
SLACK = 1e-9  # in face lengths: how far behind a line is behind


@njit(cache=True, error_model="numpy", nogil=True)
def fading(away: float) -> float:
    """Weight of an equation by its distance from the face in face lengths: to the power -1.25."""
    return 1.0 / (away * np.sqrt(np.sqrt(away)))


@njit(cache=True, error_model="numpy", nogil=True)
def collect(
    pressure: bool,
    bounded: bool,
    own: int,
    face: int,
    n_cells: int,
    cell_at: NDArray[np.float64],
    n_near: int,
    near: NDArray[np.int32],
    near_at: NDArray[np.float64],
    rim_kind: NDArray[np.int32],
    profile: NDArray[np.float64],
    opening: NDArray[np.float64],
    source: NDArray[np.int32],
    at: NDArray[np.float64],
    weight: NDArray[np.float64],
    value: NDArray[np.float64],
) -> int:
    """List the data of a fit; returns their number.

    Parameters
    ----------
    pressure : bool
        Pressure data: all cells, and openings. Otherwise velocity data: the cells in sight, and prescribed velocities.
    bounded : bool
        The velocity on the face itself is given, so only data in front of its line count.
    own : int
        Number of the face's own cells, which come first and are always seen.
    face : int
        Number from the first boundary face, negative for an inner face.
    n_cells, cell_at, n_near, near, near_at
        The neighbourhood, see `grow`.
    rim_kind, profile, opening
        What holds on the boundary faces, see `Faces`.
    source, at, weight, value
        Overwritten: place in the neighbourhood or -1, position, weight, prescribed value (two components).
    """
    # Strategy: a boundary face whose line has this face in front hides the cells behind that line, so nothing is seen
    # through a thin pillar or around a corner; with this face behind its line it is not seen itself. In face axes the
    # outward normal of a boundary face with direction (dx, dz) is (-dz, dx).
    rows = 0
    for k in range(n_cells):
        seen = not bounded or cell_at[k, 1] <= FRONT * cell_at[0, 1]
        if not pressure and k >= own:
            for g in range(n_near):
                if rim_kind[near[g]] == MOVING and near[g] != face:
                    dx, dz = near_at[g, 2] - near_at[g, 0], near_at[g, 3] - near_at[g, 1]
                    slack = SLACK * np.sqrt(dx * dx + dz * dz)
                    here = near_at[g, 0] * dz - near_at[g, 1] * dx
                    there = here + cell_at[k, 1] * dx - cell_at[k, 0] * dz
                    seen = seen and (here > slack or there <= slack)
        if seen:
            source[rows] = k
            at[rows, 0], at[rows, 1] = cell_at[k, 0], cell_at[k, 1]
            weight[rows] = fading(np.sqrt(cell_at[k, 0] ** 2 + cell_at[k, 1] ** 2))
            rows += 1
    for g in range(n_near):
        dx, dz = near_at[g, 2] - near_at[g, 0], near_at[g, 3] - near_at[g, 1]
        behind = near_at[g, 0] * dz - near_at[g, 1] * dx > SLACK * np.sqrt(dx * dx + dz * dz)
        for p in range(3):
            xi, zeta = near_at[g, 0] + 0.5 * p * dx, near_at[g, 1] + 0.5 * p * dz
            away = np.sqrt(xi * xi + zeta * zeta)
            if pressure:
                if rim_kind[near[g]] != OPEN or p != 1:
                    continue
                share, away = WALL_WEIGHT, max(away, NEAREST)
                value[rows, 0], value[rows, 1] = opening[near[g]], 0.0
            else:
                if rim_kind[near[g]] != MOVING or near[g] == face or behind or (bounded and zeta > -SLACK):
                    continue
                share = WALL_WEIGHT if p == 1 else WALL_WEIGHT * np.sqrt(0.5)
                value[rows, 0], value[rows, 1] = profile[near[g], p, 0], profile[near[g], p, 1]
            source[rows] = -1
            at[rows, 0], at[rows, 1] = xi, zeta
            weight[rows] = share * fading(away)
            rows += 1
    return rows
