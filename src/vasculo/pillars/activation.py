"""What a membrane senses: wall shear at its nodes, its mean, and the activation that follows."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import ComputationError
from vasculo.flow.read.forces import pillar_walls, wall_force
from vasculo.pillars.cell import node_lengths, ring, side_lengths
from vasculo.pillars.responses import respond

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.flow.read.forces import Part
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
    on_pillar, length = pillar_walls(flow)
    middles = flow.mesh.points[flow.wall_edges[on_pillar]].mean(axis=1)
    side, fraction = wall_sides(middles, flow.wall_pillar[on_pillar], points, starts)
    return side, fraction, length, on_pillar


def node_shear(
    flow: Flow,
    points: NDArray[np.float64],
    starts: NDArray[np.int32],
    smoothing: int = 1,
    sealed: NDArray[np.bool_] | None = None,
) -> NDArray[np.float64]:
    """Magnitude of the wall shear that each membrane node senses.

    A node takes the length-weighted mean of its two sides, then all are smoothed along the membrane by 1/4, 1/2, 1/4
    (ours).

    Parameters
    ----------
    flow : Flow
    points, starts : (n, 2) float64, (p + 1,) int32
        Membranes, the pillars of the flow in order.
    smoothing : int
        Passes of the smoothing.
    sealed : (n,) bool, optional
        Membrane sides, by their first node, that no fluid reaches: they feel nothing.

    Returns
    -------
    (n,) float64
        Model pressure.

    Raises
    ------
    ComputationError
        If a membrane side that faces the fluid has no edge of the flow mesh.
    """
    side, _, length, on_pillar = flow_wall(flow, points, starts)
    shear = np.abs(flow.wall_shear[on_pillar])
    covered = np.bincount(side, length, minlength=len(points))
    missing = covered == 0.0
    if sealed is not None:
        missing &= ~sealed
    if missing.any():
        node = int(np.argmax(missing))
        pillar = int(np.searchsorted(starts, node, side="right")) - 1
        raise ComputationError(
            f"the flow mesh has no edge on side {node - starts[pillar]} of pillar {pillar}, "
            f"{side_lengths(points, starts)[node]:.3g} long: refine the flow mesh (flow_across)"
        )
    on_side = np.bincount(side, shear * length, minlength=len(points)) / np.where(covered > 0.0, covered, 1.0)
    return smooth_to_nodes(on_side, side_lengths(points, starts), starts, smoothing)


def smooth_to_nodes(
    on_side: NDArray[np.float64], lengths: NDArray[np.float64], starts: NDArray[np.int32], passes: int
) -> NDArray[np.float64]:
    """Carry side values (n,) to nodes (n,): length-weighted mean of the two sides, then passes of 1/4, 1/2, 1/4."""
    previous, following = ring(starts)
    weighted = on_side * lengths
    node = (weighted + weighted[previous]) / (lengths + lengths[previous])
    for _ in range(passes):
        node = 0.25 * node[previous] + 0.5 * node + 0.25 * node[following]
    return node


def pillar_means(
    values: NDArray[np.float64], points: NDArray[np.float64], starts: NDArray[np.int32]
) -> NDArray[np.float64]:
    """Mean of node values over each membrane, weighted by membrane length; (p,) float64."""
    weights = node_lengths(points, starts)
    return np.add.reduceat(values * weights, starts[:-1]) / np.add.reduceat(weights, starts[:-1])


def activation(
    shear: NDArray[np.float64],
    points: NDArray[np.float64],
    starts: NDArray[np.int32],
    response: str = "linear",
    limit: float = 1.0,
) -> NDArray[np.float64]:
    """Compare the shear at each node with the mean of its pillar, by a law of `vasculo.pillars.responses`.

    Positive means contraction, negative stretching (Szczerba & Szekely 2005, section 4). By default it is
    ``clip(shear / mean - 1, -1, 1)``; the formula is ours.

    Parameters
    ----------
    shear : (n,) float64
        As given by `node_shear`.
    points, starts : (n, 2) float64, (p + 1,) int32
        Membranes.
    response : str
        Name of the law.
    limit : float
        Largest activation either way, dimensionless.

    Returns
    -------
    (n,) float64
        Within +- `limit`; 0 on a pillar without shear.

    Raises
    ------
    ComputationError
        If the law fails, or does not give one finite number a node; names the pillar.
    """
    active = np.zeros(len(shear))
    sides = side_lengths(points, starts)
    means = pillar_means(shear, points, starts)
    for pillar, (first, last) in enumerate(pairwise(starts)):
        if means[pillar] > 0.0:
            way = np.cumsum(sides[first:last])
            position = np.concatenate(([0.0], way[:-1])) / way[-1]
            try:
                active[first:last] = respond(response, shear[first:last], float(means[pillar]), position, limit)
            except ComputationError as error:
                raise ComputationError(f"pillar {pillar}: {error}") from error
    return active


def rolled(values: NDArray[np.float64], starts: NDArray[np.int32], seed: int, step: int) -> NDArray[np.float64]:
    """Move the values of every membrane along it by a random number of nodes.

    A control: the same values on every membrane, without information about the flow.

    Parameters
    ----------
    values, starts : (n,) float64, (p + 1,) int32
    seed, step : int
        Together they fix the numbers, so that a run that was interrupted draws the same.

    Returns
    -------
    (n,) float64
    """
    draws = np.random.default_rng((seed, step))
    parts = np.split(values, starts[1:-1])
    return np.concatenate([np.roll(part, draws.integers(len(part))) for part in parts])


def node_traction(
    flow: Flow, points: NDArray[np.float64], starts: NDArray[np.int32], part: Part = "viscous"
) -> NDArray[np.float64]:
    """Spread the force of the fluid on the wall edges over the membrane nodes by the lever rule.

    The force of an edge goes to the ends of its membrane side so that total force and moment are kept.

    Parameters
    ----------
    flow : Flow
    points, starts : (n, 2) float64, (p + 1,) int32
        Membranes.
    part : {"viscous", "full"}
        The friction alone, as in the paper, or the pressure as well.

    Returns
    -------
    (n, 2) float64
        Force on each node, model pressure times model length.
    """
    side, fraction, _, on_pillar = flow_wall(flow, points, starts)
    force = wall_force(flow, part)[on_pillar]
    following = ring(starts)[1]
    loads = np.zeros_like(points)
    np.add.at(loads, side, force * (1.0 - fraction)[:, None])
    np.add.at(loads, following[side], force * fraction[:, None])
    return loads
