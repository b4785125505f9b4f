"""The cell: a membrane ring and the filaments that join all its nodes.

Membranes lie behind one another in one array of points; pillar `k` owns the nodes ``starts[k]`` to ``starts[k + 1]``.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numba import njit

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

REFERENCE_SPACING = 2 * math.pi / 16  # membrane spacing, R0, at which a filament has exactly the ratio asked for


def stack(outlines: Sequence[NDArray[np.float64]]) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """Put outlines behind one another.

    Parameters
    ----------
    outlines : sequence of (k, 2) float64
        One a pillar.

    Returns
    -------
    points : (n, 2) float64
    starts : (p + 1,) int32
    """
    starts = np.zeros(len(outlines) + 1, dtype=np.int32)
    starts[1:] = np.cumsum([len(outline) for outline in outlines])
    return np.ascontiguousarray(np.concatenate(outlines), dtype=np.float64), starts


def ring(starts: NDArray[np.int32]) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Previous and next node of every membrane node.

    Parameters
    ----------
    starts : (p + 1,) int32

    Returns
    -------
    previous, following : (n,) int32
    """
    nodes = np.arange(starts[-1], dtype=np.int32)
    previous, following = nodes - 1, nodes + 1
    previous[starts[:-1]] = starts[1:] - 1
    following[starts[1:] - 1] = starts[:-1]
    return previous.astype(np.int32), following.astype(np.int32)


def side_lengths(points: NDArray[np.float64], starts: NDArray[np.int32]) -> NDArray[np.float64]:
    """Length of the side from each membrane node to the next; (n,) float64, model length."""
    side = points[ring(starts)[1]] - points
    return np.hypot(side[:, 0], side[:, 1])


def node_lengths(points: NDArray[np.float64], starts: NDArray[np.int32]) -> NDArray[np.float64]:
    """Membrane length that belongs to each node, half of its two sides; (n,) float64, model length."""
    lengths = side_lengths(points, starts)
    return 0.5 * (lengths + lengths[ring(starts)[0]])


@njit(cache=True, error_model="numpy")
def _filaments(points, starts, share, activation, strain, stiffness, reach):  # type: ignore[no-untyped-def]
    total = 0
    for k in range(starts.size - 1):
        n = starts[k + 1] - starts[k]
        total += n * (n - 1) // 2
    rest = np.empty(total)
    stiff = np.empty(total)
    sums = np.empty(starts[-1])
    for i in range(starts[-1]):
        sums[i] = 0.0
    q = 0
    for k in range(starts.size - 1):
        for i in range(starts[k], starts[k + 1]):
            for j in range(i + 1, starts[k + 1]):
                length = math.hypot(points[j, 0] - points[i, 0], points[j, 1] - points[i, 1])
                rest[q] = length * (1.0 - 0.5 * strain * (activation[i] + activation[j]))
                stiff[q] = stiffness * share[i] * share[j] if length < reach else 0.0
                sums[i] += stiff[q]
                sums[j] += stiff[q]
                q += 1
    return rest, stiff, sums


def filaments(
    points: NDArray[np.float64],
    starts: NDArray[np.int32],
    activation: NDArray[np.float64],
    strain: float,
    ratio: float,
    reach: float,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Join all membrane nodes of a pillar by filaments that are shorter or longer than now by the activation.

    The stiffness is ``ratio * s_i * s_j / s_ref**2`` (ours), so that the modulus of a cell does not depend on its
    number of nodes; with 16 nodes on a circle of radius R0 it is exactly `ratio`.

    Parameters
    ----------
    points : (n, 2) float64
        Membrane nodes, R0.
    starts : (p + 1,) int32
    activation : (n,) float64
        -1 to 1.
    strain : float
        Relative shortening at full activation of both ends.
    ratio : float
        Stiffness over that of a matrix spring.
    reach : float
        Longest filament, R0; longer ones get no stiffness.

    Returns
    -------
    rest, stiffness : (f,) float64
        Pairs (i, j > i) pillar after pillar, row after row; R0 and matrix spring stiffnesses.
    sums : (n,) float64
        Stiffness of all filaments at each node.
    """
    share = node_lengths(points, starts) / REFERENCE_SPACING
    return _filaments(points, starts, share, activation, float(strain), float(ratio), float(reach))


def filaments_plain(
    points: NDArray[np.float64],
    starts: NDArray[np.int32],
    activation: NDArray[np.float64],
    strain: float,
    ratio: float,
    reach: float,
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Give what `filaments` gives, in plain NumPy."""
    share = node_lengths(points, starts) / REFERENCE_SPACING
    first, second = pairs(starts)
    length = np.linalg.norm(points[second] - points[first], axis=1)
    rest = length * (1.0 - 0.5 * strain * (activation[first] + activation[second]))
    stiffness = np.where(length < reach, ratio * share[first] * share[second], 0.0)
    sums = np.zeros(len(points))
    np.add.at(sums, first, stiffness)
    np.add.at(sums, second, stiffness)
    return rest, stiffness, sums


def pairs(starts: NDArray[np.int32]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Both nodes of every filament in the order of `filaments`; two (f,) int64."""
    parts = [start + np.array(np.triu_indices(end - start, 1)) for start, end in pairwise(starts)]
    joined = np.concatenate(parts, axis=1) if parts else np.zeros((2, 0), dtype=np.int64)
    return joined[0], joined[1]
