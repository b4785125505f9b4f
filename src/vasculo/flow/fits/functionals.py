"""What is wanted from the fits of a face: derivative, means and difference, as factors of the coefficients."""

from __future__ import annotations

from typing import TYPE_CHECKING

from numba import njit

from vasculo.flow.faces import INNER, MIRROR, OPEN
from vasculo.flow.fits.fit import QUADRATIC, SIZES, term

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

# Of the difference between the two cells that the quadratic fit cannot see. 1: on equilateral triangles the normal
# derivative becomes the plain difference, whose errors cancel around a triangle to third order. Beside a boundary more,
# for safety where small triangles stand at a wall.
ALPHA = 1.0
RIM_ALPHA = 1.3
MIRROR_ALPHA = (
    4.0  # beside a mirror line, where nothing tells the fits what is beyond: less lets local modes nearly free
)
# Least share of the plain difference over the distance that a cell's own value must keep in the derivative at a face,
# inside and at the boundary. Where coarse triangles stand on fine wall edges the fit alone may leave it none, or less:
# then alpha (at the boundary from 0) grows until it has.
INNER_SHARE, RIM_SHARE = 0.5, 0.7
MOST_ALPHA = 10.0
CLASSICAL_ALPHA = 1.0  # with a linear fit: the plain difference of the two cells, corrected for their skewness only

# Columns of `Tables.weight`.
GRADIENT, MEAN, JUMP, PRESSURE = range(4)
# The fits of a face, in turn.
VELOCITY_FIT, OUTFLOW_FIT, PRESSURE_FIT = range(3)


@njit(cache=True, error_model="numpy", nogil=True)
def damping(near: NDArray[np.int32], count: int, rim_kind: NDArray[np.int32]) -> float:
    """Alpha of a quadratic fit, from the kinds of the `count` boundary faces that it sees."""
    alpha = RIM_ALPHA if count > 0 else ALPHA
    for k in range(count):
        if rim_kind[near[k]] == MIRROR:
            alpha = MIRROR_ALPHA
    return alpha


@njit(cache=True, error_model="numpy", nogil=True)
def lacks_share(
    kind: int, alpha: float, length: float, cell_at: NDArray[np.float64], work: NDArray[np.float64]
) -> bool:
    """Whether a cell's own value counts too little in the derivative that `work` holds (own cells come first there)."""
    if kind == INNER:
        between = (cell_at[1, 1] - cell_at[0, 1]) * length
        return alpha + between * min(-work[6, 0], work[6, 1]) < INNER_SHARE
    return alpha + cell_at[0, 1] * length * work[6, 0] < RIM_SHARE


@njit(cache=True, error_model="numpy", nogil=True)
def set_goals(
    fit: int,
    family: int,
    kind: int,
    alpha: float,
    length: float,
    cell_at: NDArray[np.float64],
    goals: NDArray[np.float64],
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
                factor = (1 - 2 * side) * alpha / between
                goals[0, k] += factor * term(family, k, cell_at[side, 0], cell_at[side, 1])
        goals[0, 2] += 1.0 / length
        goals[1, 0] = 1.0
        if family == QUADRATIC:
            goals[1, 3] = 1.0 / 12.0
    else:
        goals[0, 0] = 1.0 / length
        for k in range(SIZES[family]):
            goals[0, k] -= alpha / (cell_at[0, 1] * length) * term(family, k, cell_at[0, 0], cell_at[0, 1])


@njit(cache=True, error_model="numpy", nogil=True)
def add_direct_part(
    fit: int,
    kind: int,
    alpha: float,
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
        part = (alpha if fitted else 1.0) / (left + right)
        weight[0, GRADIENT] -= part
        weight[1, GRADIENT] += part
        if not fitted:
            weight[0, MEAN] = right / (left + right)
            weight[1, MEAN] = left / (left + right)
    elif fit == VELOCITY_FIT:
        if not fitted:
            weight[0, GRADIENT] = -1.0 / left
            constant[0], constant[1] = profile[1, 0] / left, profile[1, 1] / left
        else:
            weight[0, GRADIENT] -= alpha / left
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
