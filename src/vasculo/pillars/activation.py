"""What a membrane senses: wall shear at its nodes, its mean, and the activation that follows."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import ComputationError
from vasculo.pillars.cell import node_lengths, ring, side_lengths

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.flow.solution import Flow


def wall_sides(
    middles: NDArray[np.float64],
    owners: NDArray[np.int32],
    points: NDArray[np.float64],
    starts: NDArray[np.int32],
) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
    """Find the membrane side on which each wall edge of the flow mesh lies: the nearest one of its pillar.

    Parameters
    ----------
    middles : (w, 2) float64
        Middles of the wall edges, model length.
    owners : (w,) int32
        Pillar of each edge, -1 for an outer wall.
    points, starts : (n, 2) float64, (p + 1,) int32
        Membranes.

    Returns
    -------
    side : (w,) int32
        Node at which the side starts; -1 for an outer wall.
    fraction : (w,) float64
        Where the middle lies on it, 0 at its first node to 1 at its second.
    """
    side = np.full(len(owners), -1, dtype=np.int32)
    fraction = np.zeros(len(owners))
    order = np.argsort(owners, kind="stable")
    ends = np.searchsorted(owners[order], np.arange(len(starts)))
    for pillar, (first, last) in enumerate(pairwise(starts)):
        edges = order[ends[pillar] : ends[pillar + 1]]
        corner = points[first:last]
        along = np.roll(corner, -1, axis=0) - corner
        offset = middles[edges][:, None, :] - corner
        t = np.clip((offset * along).sum(axis=2) / (along**2).sum(axis=1), 0.0, 1.0)
        distance = ((offset - t[:, :, None] * along) ** 2).sum(axis=2)
        nearest = np.argmin(distance, axis=1)
        side[edges] = first + nearest
        fraction[edges] = t[np.arange(len(edges)), nearest]
    return side, fraction


def flow_wall(
    flow: Flow, points: NDArray[np.float64], starts: NDArray[np.int32]
) -> tuple[NDArray[np.int32], NDArray[np.float64], NDArray[np.float64], NDArray[np.bool_]]:
    """Place the pillar walls of a flow on the membranes.

    Returns
    -------
    side, fraction : (w,) int32, (w,) float64
        Of the edges on pillars, as in `wall_sides`.
    length : (w,) float64
        Of these edges, model length.
    on_pillar : bool array
        Which edges of ``flow.wall_edges`` they are.
    """
    on_pillar = flow.wall_pillar >= 0
    ends = flow.mesh.points[flow.wall_edges[on_pillar]]
    vector = ends[:, 1] - ends[:, 0]
    side, fraction = wall_sides(ends.mean(axis=1), flow.wall_pillar[on_pillar], points, starts)
    return side, fraction, np.hypot(vector[:, 0], vector[:, 1]), on_pillar


def node_shear(flow: Flow, points: NDArray[np.float64], starts: NDArray[np.int32]) -> NDArray[np.float64]:
    """Magnitude of the wall shear that each membrane node senses.

    A node takes the length-weighted mean of its two sides, then all are smoothed once by 1/4, 1/2, 1/4 (ours).

    Parameters
    ----------
    flow : Flow
    points, starts : (n, 2) float64, (p + 1,) int32
        Membranes, the pillars of the flow in order.

    Returns
    -------
    (n,) float64
        Model pressure.

    Raises
    ------
    ComputationError
        If a membrane side has no edge of the flow mesh.
    """
    side, _, length, on_pillar = flow_wall(flow, points, starts)
    shear = np.abs(flow.wall_shear[on_pillar])
    covered = np.bincount(side, length, minlength=len(points))
    if not covered.all():
        node = int(np.argmin(covered))
        pillar = int(np.searchsorted(starts, node, side="right")) - 1
        raise ComputationError(
            f"the flow mesh has no edge on side {node - starts[pillar]} of pillar {pillar}, "
            f"{side_lengths(points, starts)[node]:.3g} long: refine the flow mesh (flow_across)"
        )
    on_side = np.bincount(side, shear * length, minlength=len(points)) / covered
    return smooth_to_nodes(on_side, side_lengths(points, starts), starts)


def smooth_to_nodes(
    on_side: NDArray[np.float64], lengths: NDArray[np.float64], starts: NDArray[np.int32]
) -> NDArray[np.float64]:
    """Carry side values (n,) to nodes (n,): length-weighted mean of the two sides, then 1/4, 1/2, 1/4 once."""
    previous, following = ring(starts)
    weighted = on_side * lengths
    node = (weighted + weighted[previous]) / (lengths + lengths[previous])
    return 0.25 * node[previous] + 0.5 * node + 0.25 * node[following]


def pillar_means(
    values: NDArray[np.float64], points: NDArray[np.float64], starts: NDArray[np.int32]
) -> NDArray[np.float64]:
    """Mean of node values over each membrane, weighted by membrane length; (p,) float64."""
    weights = node_lengths(points, starts)
    return np.add.reduceat(values * weights, starts[:-1]) / np.add.reduceat(weights, starts[:-1])


def activation(
    shear: NDArray[np.float64], points: NDArray[np.float64], starts: NDArray[np.int32]
) -> NDArray[np.float64]:
    """Compare the shear at each node with the mean of its pillar: ``clip(shear / mean - 1, -1, 1)``.

    Positive means contraction, negative stretching (Szczerba & Szekely 2005, section 4; the formula is ours).

    Parameters
    ----------
    shear : (n,) float64
        As given by `node_shear`.
    points, starts : (n, 2) float64, (p + 1,) int32
        Membranes.

    Returns
    -------
    (n,) float64
        -1 to 1; 0 on a pillar without shear.
    """
    mean = np.repeat(pillar_means(shear, points, starts), np.diff(starts))
    felt = mean > 0.0
    return np.where(felt, np.clip(shear / np.where(felt, mean, 1.0) - 1.0, -1.0, 1.0), 0.0)


def node_traction(flow: Flow, points: NDArray[np.float64], starts: NDArray[np.int32]) -> NDArray[np.float64]:
    """Spread the viscous traction of the wall edges over the membrane nodes by the lever rule.

    The force of an edge goes to the ends of its membrane side so that total force and moment are kept; pressure is left
    out, as in the paper.

    Parameters
    ----------
    flow : Flow
    points, starts : (n, 2) float64, (p + 1,) int32
        Membranes.

    Returns
    -------
    (n, 2) float64
        Force on each node, model pressure times model length.
    """
    side, fraction, length, on_pillar = flow_wall(flow, points, starts)
    force = flow.wall_traction[on_pillar] * length[:, None]
    following = ring(starts)[1]
    loads = np.zeros_like(points)
    np.add.at(loads, side, force * (1.0 - fraction)[:, None])
    np.add.at(loads, following[side], force * fraction[:, None])
    return loads
