"""The long waves of a relaxation: moves of whole neighbourhoods, on a coarse grid, solved for in every sweep."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numba import njit
from scipy.linalg import cholesky_banded
from scipy.sparse import coo_array, diags_array, hstack

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.sparse import csc_array, csr_array

    Floats = NDArray[np.float64]
    Flags = NDArray[np.bool_]

PILLARS_ACROSS = 3.0  # width of a cell of the grid, in the distance of pillars
SMALL = 1e-9  # stiffness of a grid node that no spring moves, over the largest


class Coarse(NamedTuple):
    """A grid of bilinear hats over the bodies, which are the pillars and then the matrix nodes.

    A hat moves a body as a whole by its value at the body's centre. It is zero on the rim of the grid, which is where
    the outer nodes are pinned.

    Attributes
    ----------
    body_starts : (g + 1,) int32
        Entries of each hat.
    bodies : (q,) int32
        Bodies under it.
    values : (q,) float64
        Its values there.
    hats : (b, 4) int32
        Hats over each body, -1 where there are less than four.
    weights : (b, 4) float64
        Their values.
    factor : (2 g, k + 1) float64
        Rows of the banded Cholesky factor of the stiffness of the hats: the diagonal, and then to the left of it.
        Unknowns are x and y of hat 0, x and y of hat 1, and so on.
    """

    body_starts: NDArray[np.int32]
    bodies: NDArray[np.int32]
    values: Floats
    hats: NDArray[np.int32]
    weights: Floats
    factor: Floats


def coarse_grid(
    points: Floats, centres: Floats, starts: NDArray[np.int32], springs: NDArray[np.int32], rest: Floats, pinned: Flags
) -> Coarse:
    """Lay a grid over the bodies and factorise its stiffness.

    Parameters
    ----------
    points : (m, 2) float64
        Nodes, membrane nodes first, R0.
    centres : (p, 2) float64
        Of the pillars, R0.
    starts : (p + 1,) int32
        Their membrane nodes.
    springs, rest : (s, 2) int32, (s,) float64
        Matrix springs and their rest lengths, R0.
    pinned : (m,) bool

    Returns
    -------
    Coarse
        Without hats when the pillars are too few for it.
    """
    n, p = int(starts[-1]), len(centres)
    places = np.concatenate((centres, points[n:]))
    low, size = points.min(axis=0), np.ptp(points, axis=0)
    cells = np.maximum(1, np.round(size / (PILLARS_ACROSS * math.sqrt(size[0] * size[1] / p))).astype(np.int64))
    # Strategy: hats are counted along the shorter direction first, so that the band is narrow.
    slow, fast = (0, 1) if cells[0] >= cells[1] else (1, 0)
    inner = cells - 1
    count = int(inner.prod())
    if count == 0:
        none = np.zeros(0, dtype=np.int32)
        return Coarse(
            np.zeros(1, dtype=np.int32),
            none,
            np.zeros(0),
            np.full((len(places), 4), -1, dtype=np.int32),
            np.zeros((len(places), 4)),
            np.zeros((0, 1)),
        )
    at = (places - low) / size * cells
    cell = np.clip(np.floor(at).astype(np.int64), 0, cells - 1)
    part = at - cell
    hats, weights = np.empty((len(places), 4), dtype=np.int32), np.empty((len(places), 4))
    free = np.concatenate((np.ones(p, dtype=np.bool_), ~pinned[n:]))
    for k, (dx, dy) in enumerate(((0, 0), (0, 1), (1, 0), (1, 1))):
        node = cell + np.array([dx - 1, dy - 1])
        inside = ((node >= 0) & (node < inner)).all(axis=1) & free
        value = (part[:, 0] if dx else 1.0 - part[:, 0]) * (part[:, 1] if dy else 1.0 - part[:, 1])
        hats[:, k] = np.where(inside, node[:, slow] * inner[fast] + node[:, fast], -1)
        weights[:, k] = np.where(inside, value, 0.0)
    body, column = np.nonzero(hats >= 0)
    shape = coo_array((weights[body, column], (hats[body, column], body)), shape=(count, len(places))).tocsr()
    shape.sort_indices()
    owner = np.concatenate((np.repeat(np.arange(p), np.diff(starts)), np.arange(p, len(places))))
    factor = _factor(points, owner, springs, rest, shape, int(inner[fast]))
    return Coarse(shape.indptr.astype(np.int32), shape.indices.astype(np.int32), shape.data, hats, weights, factor)


def _factor(
    points: Floats, owner: NDArray[np.int64], springs: NDArray[np.int32], rest: Floats, shape: csr_array, inner: int
) -> Floats:
    """Factorise the stiffness that springs give hats, `inner` of them in a row; (2 g, band + 1), see `Coarse`."""
    # Strategy: a spring from a long chain may join hats far apart. It then counts twice at either end, which is more
    # than its energy can be, so that the band stays narrow and the sweeps stable.
    first, second = owner[springs[:, 0]], owner[springs[:, 1]]
    between = first != second
    vector = (points[springs[:, 1]] - points[springs[:, 0]])[between]
    length = np.hypot(vector[:, 0], vector[:, 1])
    along = vector / length[:, None]
    across = np.maximum(0.0, 1.0 - rest[between] / length)  # a spring under tension holds against turning
    one, two = shape[:, first[between]], shape[:, second[between]]
    strain = (one - two).tocsc()
    lowest, highest = _span(strain)
    far = highest - lowest > 2 * inner + 2
    if far.any():
        apart = math.sqrt(2.0) * hstack([one[:, far], two[:, far]])
        strain = hstack([strain[:, ~far], apart]).tocsc()
        along = np.concatenate((along[~far], along[far], along[far]))
        across = np.concatenate((across[~far], across[far], across[far]))
    count = shape.shape[0]
    band = min(4 * inner + 5, 2 * count - 1)
    rows = np.zeros((2 * count, band + 1))
    for i in range(2):
        for j in range(2):
            stiffness = along[:, i] * along[:, j] * (1.0 - across) + (across if i == j else 0.0)
            block = (strain @ diags_array(stiffness) @ strain.T).tocoo()
            row, column = 2 * block.row + i, 2 * block.col + j
            lower = column <= row
            rows[row[lower], (row - column)[lower]] = block.data[lower]
    rows[:, 0] += SMALL * rows[:, 0].max() if rows[:, 0].max() > 0.0 else 1.0
    upside = np.zeros((band + 1, 2 * count))
    for d in range(band + 1):
        upside[d, : 2 * count - d] = rows[d:, d]
    lower_factor = cholesky_banded(upside, lower=True)
    for d in range(band + 1):
        rows[d:, d] = lower_factor[d, : 2 * count - d]
        rows[:d, d] = 0.0
    return rows


def _span(columns: csc_array) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Lowest and highest row of the entries of each column; 0 in empty ones."""
    ends = columns.indptr
    filled = np.flatnonzero(np.diff(ends))
    lowest, highest = np.zeros((2, columns.shape[1]), dtype=np.int64)
    if filled.size:
        lowest[filled] = np.minimum.reduceat(columns.indices, ends[filled])
        highest[filled] = np.maximum.reduceat(columns.indices, ends[filled])
    return lowest, highest


@njit(cache=True, error_model="numpy", nogil=True)
def coarse_speeds(momentum, whole, n, body_starts, bodies, values, factor, speeds):  # type: ignore[no-untyped-def]
    """Speed of each hat from the momenta under it, written to `speeds` (2 g,); twin: `coarse_speeds_plain`.

    Parameters
    ----------
    momentum : (2, m) float64
        Of the nodes; those of the matrix, from node `n` on, are read.
    whole : (2, p) float64
        Of the pillars.
    n : int
    body_starts, bodies, values, factor
        See `Coarse`.
    speeds : (2 g,) float64
        Overwritten.
    """
    pillars = whole.shape[1]
    shift = n - pillars
    for g in range(body_starts.size - 1):
        sx, sy = 0.0, 0.0
        for q in range(body_starts[g], body_starts[g + 1]):
            b = bodies[q]
            if b < pillars:
                sx += values[q] * whole[0, b]
                sy += values[q] * whole[1, b]
            else:
                sx += values[q] * momentum[0, b + shift]
                sy += values[q] * momentum[1, b + shift]
        speeds[2 * g], speeds[2 * g + 1] = sx, sy
    band = factor.shape[1] - 1
    for i in range(speeds.size):
        total = speeds[i]
        for d in range(1, min(band, i) + 1):
            total -= factor[i, d] * speeds[i - d]
        speeds[i] = total / factor[i, 0]
    for i in range(speeds.size - 1, -1, -1):
        value = speeds[i] / factor[i, 0]
        speeds[i] = value
        for d in range(1, min(band, i) + 1):
            speeds[i - d] -= factor[i, d] * value


def coarse_speeds_plain(momentum: Floats, whole: Floats, n: int, coarse: Coarse) -> Floats:
    """Give what `coarse_speeds` gives, as (g, 2) float64."""
    count = len(coarse.body_starts) - 1
    body = np.concatenate((whole, momentum[:, n:]), axis=1)
    hat = np.repeat(np.arange(count), np.diff(coarse.body_starts))
    load = np.zeros((count, 2))
    np.add.at(load, hat, coarse.values[:, None] * body[:, coarse.bodies].T)
    lower = np.zeros((2 * count, 2 * count))
    for d in range(coarse.factor.shape[1]):
        i = np.arange(d, 2 * count)
        lower[i, i - d] = coarse.factor[i, d]
    return np.asarray(np.linalg.solve(lower @ lower.T, load.ravel()).reshape(count, 2), dtype=np.float64)
