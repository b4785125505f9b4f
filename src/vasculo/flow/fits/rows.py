"""The rows of the tables: for one face after another its neighbourhood, its three fits, and their weights."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from vasculo.flow.faces import INNER, MOVING, OPEN
from vasculo.flow.fits.data import collect
from vasculo.flow.fits.fit import AT_REST, LINEAR, OUTFLOW, QUADRATIC, SHEAR, fit_weights
from vasculo.flow.fits.functionals import (
    CLASSICAL_ALPHA,
    MOST_ALPHA,
    OUTFLOW_FIT,
    PRESSURE_FIT,
    VELOCITY_FIT,
    add_direct_part,
    damping,
    lacks_share,
    set_goals,
)
from vasculo.flow.fits.stencil import MAX_CELLS, MAX_RIM, TOP_LEVEL, grow

if TYPE_CHECKING:
    from numpy.typing import NDArray

WORST = 1e3  # condition above which the neighbourhood grows, and then the polynomial shrinks
MAX_ROWS = MAX_CELLS + 3 * MAX_RIM + 2  # two for the functionals
BLOCK = 256  # faces that a thread takes at a time

# Counted faces: by neighbourhood level of a full velocity fit, then by fallback.
COUNTS = (
    "level_0",
    "level_1",
    "level_2",
    "level_3",
    "linear_fits",
    "two_point_fits",
    "two_point_outflows",
    "two_point_pressures",
    "damped_fits",
)
DAMPED = len(COUNTS) - 1


@njit(cache=True, error_model="numpy", nogil=True)
def fill_rows(
    rank: int,
    threads: int,
    chosen: NDArray[np.int64],
    order: int,
    points: NDArray[np.float64],
    triangles: NDArray[np.int32],
    centroids: NDArray[np.float64],
    ends: NDArray[np.int32],
    own_cells: NDArray[np.int32],
    rim_ends: NDArray[np.int32],
    kinds: NDArray[np.int32],
    rim_kind: NDArray[np.int32],
    profile: NDArray[np.float64],
    opening: NDArray[np.float64],
    same: NDArray[np.int32],
    corner_start: NDArray[np.int32],
    corners: NDArray[np.int32],
    rim_start: NDArray[np.int32],
    rim: NDArray[np.int32],
    start: NDArray[np.int64],
    stop: NDArray[np.int64],
    out_cell: NDArray[np.int32],
    out_weight: NDArray[np.float64],
    constant: NDArray[np.float64],
    needed: NDArray[np.int32],
    counts: NDArray[np.int64],
) -> int:
    """Fill the rows of the chosen faces from `start` on, as far as `stop` lets them.

    Names as in `Faces`, `Tables`, `grow` and `collect`. A face that needs more room says how many cells it found in
    `needed`, and is left; otherwise `stop` becomes the end of its row. `counts` has a row a thread.
    """
    # Strategy: three fits a face: the velocity, on openings also the velocity through them, the pressure. For the first
    # the neighbourhood grows until there are data enough and the fit is sound; if it never is, the polynomial shrinks.
    inner = len(ends) - len(rim_ends)
    cell_stamp, rim_stamp = np.full(len(triangles), -1, np.int32), np.full(len(rim_ends), -1, np.int32)
    cells, cell_at = np.empty(MAX_CELLS, np.int32), np.empty((MAX_CELLS, 2))
    near, near_at = np.empty(MAX_RIM, np.int32), np.empty((MAX_RIM, 4))
    source, at, weight = np.empty(MAX_ROWS, np.int32), np.empty((MAX_ROWS, 2)), np.empty(MAX_ROWS)
    value, work, goals = np.empty((MAX_ROWS, 2)), np.empty((8, MAX_ROWS)), np.empty((2, 6))
    count = np.zeros(2, np.int64)
    inside, beside = (QUADRATIC, AT_REST) if order == 2 else (LINEAR, SHEAR)
    for block in range(rank * BLOCK, len(chosen), threads * BLOCK):
        for number in range(block, min(block + BLOCK, len(chosen))):
            f = chosen[number]
            place = start[f]
            kind, edge = kinds[f], f - inner
            ex = points[ends[f, 1], 0] - points[ends[f, 0], 0]
            ey = points[ends[f, 1], 1] - points[ends[f, 0], 1]
            length = np.sqrt(ex * ex + ey * ey)
            ex, ey = ex / length**2, ey / length**2
            own = 2 if kind == INNER else 1
            count[0] = count[1] = 0
            for fit in range(3):
                if fit == OUTFLOW_FIT and kind != OPEN:
                    continue
                family = LINEAR
                if fit == VELOCITY_FIT:
                    family = inside if kind == INNER else beside
                elif fit == OUTFLOW_FIT:
                    family = OUTFLOW
                enough = 4
                if fit == OUTFLOW_FIT:
                    enough = 5
                elif fit == VELOCITY_FIT and kind == INNER and order == 2:
                    enough = 8
                fitted = False
                rows, attempt = 0, 0
                alpha = CLASSICAL_ALPHA if kind == INNER else 0.0
                while attempt < (TOP_LEVEL + 2 if fit == VELOCITY_FIT else 1):
                    if fit == VELOCITY_FIT and attempt <= TOP_LEVEL:
                        grow(
                            attempt, f, ex, ey, points, triangles, centroids, ends, own_cells, rim_ends, same,
                            corner_start, corners, rim_start, rim, cell_stamp, rim_stamp, cells, cell_at, near,
                            near_at, count,
                        )  # fmt: skip
                    if attempt > TOP_LEVEL:
                        family = LINEAR if kind == INNER else SHEAR
                    rows = collect(
                        fit == PRESSURE_FIT, fit == VELOCITY_FIT and kind != INNER, own, edge, count[0], cell_at,
                        count[1], near, near_at, rim_kind, profile, opening, source, at, weight, value,
                    )  # fmt: skip
                    few = rows < enough or (fit == VELOCITY_FIT and count[0] < 5)
                    if not few or (fit == VELOCITY_FIT and attempt >= TOP_LEVEL):
                        if order == 2 and kind == INNER:
                            alpha = damping(near, count[1], rim_kind)
                        set_goals(fit, family, kind, alpha, length, cell_at, goals)
                        fitted = fit_weights(family, rows, at, weight, goals, work) < WORST
                        if fitted:
                            break
                    attempt += 1
                if fitted and fit == VELOCITY_FIT and order == 2 and attempt <= TOP_LEVEL:
                    plain = alpha
                    while alpha < MOST_ALPHA and lacks_share(kind, alpha, length, cell_at, work):
                        alpha = 1.5 * alpha + 0.5
                        set_goals(fit, family, kind, alpha, length, cell_at, goals)
                        fit_weights(family, rows, at, weight, goals, work)
                    counts[rank, DAMPED] += alpha > plain and count[0] <= stop[f] - place
                if fit == VELOCITY_FIT:
                    # Only now the number of cells is known.
                    if count[0] > stop[f] - place:
                        needed[f] = count[0]
                        break
                    stop[f] = place + count[0]
                    for k in range(count[0]):
                        out_cell[place + k] = cells[k]
                        for column in range(4):
                            out_weight[place + k, column] = 0.0
                    if fitted:
                        counts[rank, attempt] += 1
                if not fitted:
                    counts[rank, TOP_LEVEL + 2 + fit] += 1
                    rows = 0
                column = 2 if fit == PRESSURE_FIT else 0
                for r in range(rows):
                    for goal in range(2):
                        part = work[6 + goal, r]
                        if source[r] >= 0:
                            out_weight[place + source[r], column + goal] += part
                        elif fit == PRESSURE_FIT:
                            constant[f, 4 + goal] += part * value[r, 0]
                        else:
                            constant[f, 2 * goal] += part * value[r, 0]
                            constant[f, 2 * goal + 1] += part * value[r, 1]
                    if kind == MOVING and fit == VELOCITY_FIT:
                        # The fit is for what is left beside the given parabola through the values on the face.
                        part = work[6, r] + (alpha / (cell_at[0, 1] * length) if r == 0 else 0.0)
                        for axis in range(2):
                            a, b, c = profile[edge, 0, axis], profile[edge, 1, axis], profile[edge, 2, axis]
                            given = b + (c - a) * at[r, 0] + 2.0 * (a + c - 2.0 * b) * at[r, 0] ** 2
                            constant[f, axis] -= part * given
                here = max(edge, 0)
                add_direct_part(
                    fit, kind, alpha, fitted, length, cell_at, out_weight[place:], constant[f], profile[here],
                    opening[here],
                )  # fmt: skip
    return 0
