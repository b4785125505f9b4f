"""The cell: a membrane ring and the filaments that join all its nodes.

Membranes lie behind one another in one array of points; pillar `k` owns the nodes ``starts[k]`` to ``starts[k + 1]``.
"""

from __future__ import annotations

import math
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numba import njit

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

REFERENCE_SPACING = 2 * math.pi / 16  # membrane spacing, R0, at which a filament has exactly the ratio asked for
LANES = 8  # filaments that are kept or left out together


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


class Filaments(NamedTuple):
    """Filaments of all cells, in runs.

    Filament t of a run joins the nodes ``first + t`` and ``second + t`` of its pillar, both counted on round the
    membrane, so that a run reads and writes stretches of memory.

    Attributes
    ----------
    run_starts : (p + 1,) int32
        Runs of each pillar.
    runs : (r, 3) int32
        First node, second node (greater) and number of filaments, a multiple of `LANES`.
    rest_starts : (p + 1,) int64
        Filaments of each pillar.
    rest : (f,) float64
        Rest lengths, R0; -1 where there is no filament: beyond reach, or past the end of a run.
    share : (n,) float64
        The stiffness of a filament is the product of the shares of its ends; square roots of a matrix spring stiffness.
    sums : (n,) float64
        Stiffness of all filaments at each node, matrix spring stiffnesses.
    """

    run_starts: NDArray[np.int32]
    runs: NDArray[np.int32]
    rest_starts: NDArray[np.int64]
    rest: NDArray[np.float64]
    share: NDArray[np.float64]
    sums: NDArray[np.float64]


@njit(cache=True, error_model="numpy")
def _near(points, start, n, i, d, count, square):  # type: ignore[no-untyped-def]
    """Whether one of the filaments from nodes i, i + 1, ... to those d further on is within reach."""
    for t in range(i, min(i + LANES, count)):
        a, b = start + t, start + (t + d) % n
        if (points[b, 0] - points[a, 0]) ** 2 + (points[b, 1] - points[a, 1]) ** 2 < square:
            return True
    return False


@njit(cache=True, error_model="numpy")
def _count_runs(points, starts, reach, run_starts, rest_starts, runs):  # type: ignore[no-untyped-def]
    """Find the runs of all pillars; fills `runs` when it is large enough, and returns how many there are."""
    r = 0
    for k in range(starts.size - 1):
        run_starts[k] = r
        start, n = starts[k], starts[k + 1] - starts[k]
        total = 0
        for d in range(1, n // 2 + 1):
            count = n if 2 * d < n else d
            open_run = False
            for i in range(0, count, LANES):
                if not _near(points, start, n, i, d, count, reach * reach):
                    open_run = False
                    continue
                if not open_run:
                    r += 1
                    if r <= len(runs):
                        runs[r - 1, 0], runs[r - 1, 1], runs[r - 1, 2] = i, i + d, 0
                    open_run = True
                if r <= len(runs):
                    runs[r - 1, 2] += LANES
                total += LANES
        rest_starts[k + 1] = rest_starts[k] + total
    run_starts[-1] = r
    return r


@njit(cache=True, error_model="numpy")
def _fill_runs(points, reference, starts, activation, strain, reach, run_starts, runs, share, rest, sums):  # type: ignore[no-untyped-def]
    q = 0
    for k in range(starts.size - 1):
        start, n = starts[k], starts[k + 1] - starts[k]
        for r in range(run_starts[k], run_starts[k + 1]):
            d = runs[r, 1] - runs[r, 0]
            count = n if 2 * d < n else d
            for i in range(runs[r, 0], runs[r, 0] + runs[r, 2]):
                rest[q] = -1.0
                if i < count:
                    a, b = start + i, start + (i + d) % n
                    dx, dy = points[b, 0] - points[a, 0], points[b, 1] - points[a, 1]
                    if dx * dx + dy * dy < reach * reach:
                        dx, dy = reference[b, 0] - reference[a, 0], reference[b, 1] - reference[a, 1]
                        part = 1.0 - 0.5 * strain * (activation[a] + activation[b])
                        rest[q] = max(0.0, math.sqrt(dx * dx + dy * dy) * part)
                        sums[a] += share[a] * share[b]
                        sums[b] += share[a] * share[b]
                q += 1


def filaments(
    points: NDArray[np.float64],
    reference: NDArray[np.float64],
    starts: NDArray[np.int32],
    activation: NDArray[np.float64],
    strain: float,
    ratio: float,
    reach: float,
) -> Filaments:
    """Join all membrane nodes of a pillar by filaments that are shorter or longer by the activation of their ends.

    The stiffness is ``ratio * s_i * s_j / s_ref**2`` (ours), so that the modulus of a cell does not depend on its
    number of nodes; with 16 nodes on a circle of radius R0 it is exactly `ratio`. The rest length is the distance of
    the reference points times ``1 - strain * (a_i + a_j) / 2``, and not less than zero.

    Parameters
    ----------
    points : (n, 2) float64
        Membrane nodes, R0.
    reference : (n, 2) float64
        Where filaments without activation are free of stress, R0; `points` for cells without memory.
    starts : (p + 1,) int32
    activation : (n,) float64
    strain : float
        Relative shortening at an activation of 1 at both ends.
    ratio : float
        Stiffness over that of a matrix spring.
    reach : float
        Nodes farther apart than this, R0, are not joined; infinite: all to all.

    Returns
    -------
    Filaments
    """
    share = math.sqrt(ratio) / REFERENCE_SPACING * node_lengths(points, starts)
    # Strategy: node i with node i + d, for d = 1, 2, ... half way round; of each d only the stretches within reach.
    run_starts, rest_starts = np.zeros(len(starts), dtype=np.int32), np.zeros(len(starts), dtype=np.int64)
    runs = np.zeros((len(points) + int((np.diff(starts) // 2).sum()), 3), dtype=np.int32)
    needed = _count_runs(points, starts, float(reach), run_starts, rest_starts, runs)
    if needed > len(runs):
        runs = np.zeros((needed, 3), dtype=np.int32)
        _count_runs(points, starts, float(reach), run_starts, rest_starts, runs)
    rest, sums = np.empty(rest_starts[-1]), np.zeros(len(points))
    _fill_runs(points, reference, starts, activation, float(strain), float(reach), run_starts, runs, share, rest, sums)
    return Filaments(run_starts, runs[:needed], rest_starts, rest, share, sums)


def filaments_plain(
    points: NDArray[np.float64],
    reference: NDArray[np.float64],
    starts: NDArray[np.int32],
    activation: NDArray[np.float64],
    strain: float,
    ratio: float,
    reach: float,
) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]]:
    """Give the filaments of `filaments` one by one.

    Returns
    -------
    pairs : (f, 2) int64
        Nodes, the smaller first, in order.
    rest, stiffness : (f,) float64
    """
    share = node_lengths(points, starts) / REFERENCE_SPACING
    pairs = np.concatenate([start + np.argwhere(np.tri(end - start, k=-1).T) for start, end in pairwise(starts)])
    first, second = pairs[np.linalg.norm(points[pairs[:, 1]] - points[pairs[:, 0]], axis=1) < reach].T
    length = np.linalg.norm(reference[second] - reference[first], axis=1)
    rest = length * (1.0 - 0.5 * strain * (activation[first] + activation[second]))
    return np.column_stack((first, second)), np.maximum(rest, 0.0), ratio * share[first] * share[second]


def filament_pairs(
    starts: NDArray[np.int32], filaments: Filaments
) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.float64]]:
    """Read the runs as single filaments, in the form and order of `filaments_plain`."""
    pairs = [np.zeros((0, 2), dtype=np.int64)]
    for k, (start, end) in enumerate(pairwise(starts)):
        for first, second, count in filaments.runs[filaments.run_starts[k] : filaments.run_starts[k + 1]]:
            pairs.append(start + (np.array([[first, second]]) + np.arange(count)[:, None]) % (end - start))
    nodes = np.sort(np.concatenate(pairs), axis=1)
    there = filaments.rest >= 0.0
    nodes, rest = nodes[there], filaments.rest[there]
    order = np.lexsort(nodes.T[::-1])
    nodes, rest = nodes[order], rest[order]
    return nodes, rest, filaments.share[nodes[:, 0]] * filaments.share[nodes[:, 1]]
