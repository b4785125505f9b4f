"""For every face: how its gradient, velocity, pressure and pressure difference follow from the cells around it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from vasculo.flow.faces import INNER, MOVING, OPEN, Faces
from vasculo.flow.fits.data import collect
from vasculo.flow.fits.fit import AT_REST, LINEAR, OUTFLOW, QUADRATIC, SHEAR, SIZES, fit_weights, term
from vasculo.flow.fits.stencil import MAX_CELLS, MAX_RIM, TOP_LEVEL, grow

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.mesh.triangulation import Triangulation

ALPHA = 1.5  # of the difference between the two cells that the fit cannot see
WORST = 1e3  # condition above which the neighbourhood grows, and then the polynomial shrinks
ROOM = 12  # cells a face that room is made for at first
MAX_ROWS = MAX_CELLS + 3 * MAX_RIM + 2  # two for the functionals

# Columns of `Tables.weight`.
GRADIENT, MEAN, JUMP, PRESSURE = range(4)
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
)
VELOCITY_FIT, OUTFLOW_FIT, PRESSURE_FIT = range(3)


@dataclass(frozen=True, eq=False)
class Tables:
    """Weights of the cells in the four functionals of each face, and what prescribed values add.

    Parameters
    ----------
    start : (m + 1,) int64
        Where each face begins in `cell` and `weight`.
    cell : (k,) int32
        Cells of the faces' neighbourhoods, their own cells first.
    weight : (k, 4) float64
        Weight of each cell in: the normal derivative of the velocity (per length); its mean over the face; the pressure
        difference across the face that a linear pressure does not explain; the pressure on the face.
    constant : (m, 6) float64
        Prescribed values' part: derivative x, y, mean x, y, difference, pressure.
    counts : dict of str to int
        See `COUNTS`.
    """

    start: NDArray[np.int64]
    cell: NDArray[np.int32]
    weight: NDArray[np.float64]
    constant: NDArray[np.float64]
    counts: dict[str, int]


@njit(cache=True, error_model="numpy")
def set_goals(
    fit: int, family: int, kind: int, length: float, cell_at: NDArray[np.float64], goals: NDArray[np.float64]
) -> None:
    """Set what is wanted from a fit, as factors of the polynomial's coefficients; overwrites `goals`.

    Row 0: normal derivative, or (pressure) minus the difference between the face's two cells, of a boundary face
    between its cell and its middle. Row 1: mean over the face.
    """
    for k in range(6):
        goals[0, k] = goals[1, k] = 0.0
    if fit == PRESSURE_FIT:
        goals[1, 0] = 0.0 if kind == OPEN else 1.0
        for axis in range(2):
            goals[0, axis + 1] = cell_at[0, axis] - (cell_at[1, axis] if kind == INNER else 0.0)
    elif fit == OUTFLOW_FIT:
        goals[1, 0], goals[1, 2] = 1.0, 1.0 / 12.0
    elif kind == INNER:
        between = (cell_at[1, 1] - cell_at[0, 1]) * length
        for k in range(SIZES[family]):
            for side in range(2):
                factor = (1 - 2 * side) * ALPHA / between
                goals[0, k] += factor * term(family, k, cell_at[side, 0], cell_at[side, 1])
        goals[0, 2] += 1.0 / length
        goals[1, 0] = 1.0
        if family == QUADRATIC:
            goals[1, 3] = 1.0 / 12.0
    else:
        goals[0, 0] = 1.0 / length


@njit(cache=True, error_model="numpy")
def direct_part(
    fit: int,
    kind: int,
    fitted: bool,
    length: float,
    cell_at: NDArray[np.float64],
    weight: NDArray[np.float64],
    constant: NDArray[np.float64],
    profile: NDArray[np.float64],
    opening: float,
) -> None:
    """Add what does not come from a fit: the differences between a face's own cells, and the last fallbacks.

    `weight`, `constant`, `profile` and `opening` are the rows of this face; adds to the first two.
    """
    left = -cell_at[0, 1] * length
    if fit == VELOCITY_FIT and kind == INNER:
        right = cell_at[1, 1] * length
        weight[0, GRADIENT] -= ALPHA / (left + right)
        weight[1, GRADIENT] += ALPHA / (left + right)
        if not fitted:
            weight[0, MEAN] = right / (left + right)
            weight[1, MEAN] = left / (left + right)
    elif fit == VELOCITY_FIT:
        if not fitted:
            weight[0, GRADIENT] = -1.0 / left
            constant[0], constant[1] = profile[1, 0] / left, profile[1, 1] / left
    elif fit == OUTFLOW_FIT:
        if not fitted:
            weight[0, MEAN] = 1.0
    else:
        weight[0, JUMP] -= 1.0
        if kind == INNER:
            weight[1, JUMP] += 1.0
        if kind == OPEN:
            constant[4] += opening
            constant[5] = opening
        elif not fitted:
            weight[0, PRESSURE] = 0.5 if kind == INNER else 1.0
            if kind == INNER:
                weight[1, PRESSURE] = 0.5


@njit(cache=True, error_model="numpy")
def fill_tables(
    first: int,
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
    cell_stamp: NDArray[np.int32],
    rim_stamp: NDArray[np.int32],
    cells: NDArray[np.int32],
    cell_at: NDArray[np.float64],
    near: NDArray[np.int32],
    near_at: NDArray[np.float64],
    count: NDArray[np.int64],
    source: NDArray[np.int32],
    at: NDArray[np.float64],
    weight: NDArray[np.float64],
    value: NDArray[np.float64],
    work: NDArray[np.float64],
    goals: NDArray[np.float64],
    start: NDArray[np.int64],
    out_cell: NDArray[np.int32],
    out_weight: NDArray[np.float64],
    constant: NDArray[np.float64],
    counts: NDArray[np.int64],
) -> int:
    """Fill the tables from face `first` on; returns the face before which the room ran out, or the number of faces.

    Names as in `Faces`, `Tables`, `grow` and `collect`; everything from `cell_stamp` on is overwritten. `out_weight`
    and `constant` come in as zeros, `cell_stamp` and `rim_stamp` as -1.
    """
    # Strategy: three fits a face: the velocity, on openings also the velocity through them, the pressure. For the first
    # the neighbourhood grows until there are data enough and the fit is sound; if it never is, the polynomial shrinks.
    inner = len(ends) - len(rim_ends)
    for f in range(first, len(ends)):
        place = start[f]
        if place + MAX_CELLS > len(out_cell):
            return f
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
                family = QUADRATIC if kind == INNER else AT_REST
            elif fit == OUTFLOW_FIT:
                family = OUTFLOW
            fitted = False
            rows = 0
            for attempt in range(TOP_LEVEL + 2):
                if fit != VELOCITY_FIT and attempt > 0:
                    break
                if fit == VELOCITY_FIT and attempt <= TOP_LEVEL:
                    grow(
                        attempt, f, ex, ey, points, triangles, centroids, ends, own_cells, rim_ends, same, corner_start,
                        corners, rim_start, rim, cell_stamp, rim_stamp, cells, cell_at, near, near_at, count,
                    )  # fmt: skip
                if attempt > TOP_LEVEL:
                    family = LINEAR if kind == INNER else SHEAR
                rows = collect(
                    fit == PRESSURE_FIT, fit == VELOCITY_FIT and kind != INNER, own, edge, count[0], cell_at, count[1],
                    near, near_at, rim_kind, profile, opening, source, at, weight, value,
                )  # fmt: skip
                enough = 8 if kind == INNER and fit == VELOCITY_FIT else 5 if fit == OUTFLOW_FIT else 4
                few = rows < enough or (fit == VELOCITY_FIT and count[0] < 5)
                if few and (fit != VELOCITY_FIT or attempt < TOP_LEVEL):
                    continue
                set_goals(fit, family, kind, length, cell_at, goals)
                fitted = fit_weights(family, rows, at, weight, goals, work) < WORST
                if fitted:
                    if fit == VELOCITY_FIT:
                        counts[attempt] += 1
                    break
            if not fitted:
                counts[TOP_LEVEL + 2 + fit] += 1
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
                    for axis in range(2):
                        a, b, c = profile[edge, 0, axis], profile[edge, 1, axis], profile[edge, 2, axis]
                        given = b + (c - a) * at[r, 0] + 2.0 * (a + c - 2.0 * b) * at[r, 0] ** 2
                        constant[f, axis] -= work[6, r] * given
            here = max(edge, 0)
            direct_part(
                fit, kind, fitted, length, cell_at, out_weight[place:], constant[f], profile[here], opening[here]
            )
        for k in range(count[0]):
            out_cell[place + k] = cells[k]
        start[f + 1] = place + count[0]
    return len(ends)


def face_tables(mesh: Triangulation, faces: Faces, opening: NDArray[np.float64]) -> Tables:
    """Tables of all faces.

    Parameters
    ----------
    mesh : Triangulation
    faces : Faces
    opening : (b,) float64
        Prescribed pressures in the unit of the unknowns.
    """
    total, inner = len(faces.ends), faces.inner
    room = ROOM * total + 2 * MAX_CELLS
    start = np.zeros(total + 1, dtype=np.int64)
    cell, weight = np.empty(room, dtype=np.int32), np.zeros((room, 4))
    constant, counts = np.zeros((total, 6)), np.zeros(len(COUNTS), dtype=np.int64)
    given = (
        mesh.points, mesh.triangles, mesh.centroids, faces.ends, faces.cells, faces.ends[inner:], faces.kind,
        faces.kind[inner:], faces.profile, opening, faces.same, faces.corner_start, faces.corners, faces.rim_start,
        faces.rim, np.full(len(mesh.triangles), -1, dtype=np.int32), np.full(total - inner, -1, dtype=np.int32),
        np.empty(MAX_CELLS, dtype=np.int32), np.empty((MAX_CELLS, 2)), np.empty(MAX_RIM, dtype=np.int32),
        np.empty((MAX_RIM, 4)), np.zeros(2, dtype=np.int64), np.empty(MAX_ROWS, dtype=np.int32),
        np.empty((MAX_ROWS, 2)), np.empty(MAX_ROWS), np.empty((MAX_ROWS, 2)), np.empty((8, MAX_ROWS)), np.empty((2, 6)),
        start,
    )  # fmt: skip
    done = 0
    while True:
        done = fill_tables(done, *given, cell, weight, constant, counts)
        if done == total:
            break
        more = len(cell) // 2 + MAX_CELLS
        cell = np.concatenate([cell, np.empty(more, dtype=np.int32)])
        weight = np.concatenate([weight, np.zeros((more, 4))])
    used = int(start[-1])
    named = {name: int(number) for name, number in zip(COUNTS, counts, strict=True)}
    return Tables(start=start, cell=cell[:used], weight=weight[:used], constant=constant, counts=named)
