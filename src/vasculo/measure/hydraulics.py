"""What the flow does to the plexus: permeability, wall shear, drag."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import InputError
from vasculo.flow.boundary import Periodic
from vasculo.flow.read.forces import drag
from vasculo.flow.stokes import solve_stokes
from vasculo.measure.shape import axis_cosines, pillars

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.flow.solution import Flow
    from vasculo.geometry.domain import Domain
    from vasculo.mesh.triangulation import Triangulation

    Floats = NDArray[np.float64]

BAND = 2.5
"""Cells within this many edge lengths of a side give its pressure."""


def permeability(domain: Domain, flow: Flow, inlet: str = "left", outlet: str = "right") -> float:
    """Darcy permeability of the domain from inlet to outlet: Q eta L / (H dp).

    Q is the flow rate out of `outlet`, eta the viscosity, L the length between the two sides, H the area of the
    bounding box over L, and dp the mean pressure at `inlet` over that at `outlet`. Independent of viscosity and
    pressure; H^2/12 for an empty channel with no-slip walls.

    Parameters
    ----------
    domain : Domain
        The domain of the flow.
    flow : Flow
        Its solution.
    inlet, outlet : str
        Names of two sides opposite each other.

    Returns
    -------
    float
        Model length squared.

    Raises
    ------
    InputError
        When there is no pressure drop between the two sides.
    """
    first, upstream = _side(flow, inlet)
    last, downstream = _side(flow, outlet)
    drop = upstream - downstream
    scale = float(np.ptp(flow.pressure))
    if not abs(drop) > 1e-9 * scale:
        raise InputError(f"no pressure drop from {inlet} to {outlet}: {upstream:.3g} and {downstream:.3g}")
    x0, y0, x1, y1 = domain.bounds
    length = float(np.hypot(*(last - first)))
    height = (x1 - x0) * (y1 - y0) / length
    return flow.flow_rate(outlet) * flow.viscosity * length / (height * drop)


def permeability_tensor(
    mesh: Triangulation, first: tuple[str, str] = ("left", "right"), second: tuple[str, str] = ("bottom", "top")
) -> Floats:
    """Darcy permeability K of a periodic cell: mean velocity over the whole cell = K (pressure drop per length) / eta.

    Two flows, driven by a pressure drop from one pair of sides to the other, once for each pair; the pillars are walls.
    Symmetric and positive definite but for the error of the flows, which is of second order in the edge length.

    Parameters
    ----------
    mesh : Triangulation
        Of the fluid of one cell, a parallelogram.
    first, second : tuple of two str
        Names of opposite sides, which must be translated copies of each other, vertex by vertex.

    Returns
    -------
    ndarray of float64, shape (2, 2)
        Model length squared.

    Raises
    ------
    InputError
        When the sides do not match, or are four in name only.
    ComputationError
        When a flow could not be solved, as in a cell without pillars, which holds nothing back.
    """
    pairs = (first, second)
    if len({*first, *second}) < 4:
        raise InputError(f"the sides {first} and {second} are not four different ones")
    middles = {}
    for name in (*first, *second):
        ends = mesh.points[mesh.boundary_edges[mesh.edge_of(name)]]
        lengths = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
        middles[name] = np.average(ends.mean(axis=1), axis=0, weights=lengths)
    shifts = np.array([middles[other] - middles[side] for side, other in pairs])
    velocity = np.empty((2, 2))
    for k in range(2):
        drops = {side: Periodic(other, float(k == j)) for j, (side, other) in enumerate(pairs)}
        flow = solve_stokes(mesh, drops)
        # What leaves through a side has come from its partner: div u = 0 turns the area's mean into these fluxes.
        velocity[:, k] = np.array([flow.flow_rate(other) for _, other in pairs]) @ shifts
    # Unit drops, one a column, are the gradients shifts^-1.
    return np.asarray(velocity / abs(np.linalg.det(shifts)) @ shifts)


def mean_wall_shear(flow: Flow) -> float:
    """Mean of the absolute wall shear over the length of all pillar walls (force per length).

    Raises
    ------
    InputError
        When no pillar has a wall.
    """
    mine, lengths = _pillar_walls(flow)
    return float(np.average(np.abs(flow.wall_shear[mine]), weights=lengths))


def shear_ratio(flow: Flow) -> float:
    """Unevenness of the shear between pillars: 95th over 5th percentile of their mean absolute wall shear.

    Dimensionless, at least 1. Above about 20 the flow has left a part of the plexus.

    Raises
    ------
    InputError
        When no pillar has a wall, or the 5th percentile is zero.
    """
    mine, lengths = _pillar_walls(flow)
    owner = flow.wall_pillar[mine]
    total = np.bincount(owner, weights=lengths)
    shear = np.bincount(owner, weights=lengths * np.abs(flow.wall_shear[mine]))
    low, high = np.percentile(shear[total > 0.0] / total[total > 0.0], [5.0, 95.0])
    if not low > 0.0:
        raise InputError(f"the shear ratio needs flow past the pillars: 5th percentile {low:.3g}, 95th {high:.3g}")
    return float(high / low)


def pillar_drag(domain: Domain, flow: Flow, *, pressure: bool = True) -> Floats:
    """Force of the fluid on each pillar.

    Parameters
    ----------
    domain : Domain
        The domain of the flow.
    flow : Flow
        Its solution, with no-slip pillars.
    pressure : bool
        Whether the pressure part is added to the friction.

    Returns
    -------
    ndarray of float64, shape (p, 2)
        Force (per unit depth, model units); zero for a pillar that has no wall.
    """
    force = np.zeros((len(domain.pillars), 2))
    found = drag(flow, "full" if pressure else "viscous")
    force[: len(found)] = found
    return force


def alignment(domain: Domain, flow: Flow) -> float:
    """Order of the long axes against the local flow: the mean of cos 2 (orientation - direction of the friction drag).

    The fairer measure where paths of flow are oblique. The friction on a pillar points where the fluid slides past it;
    the pressure part is left out, because it points down the pressure gradient, which in a network of tubules need not
    be the way that the fluid goes. Every pillar counts once; pillars without friction are left out.

    Parameters
    ----------
    domain : Domain
        The domain of the flow.
    flow : Flow
        Its solution, with no-slip pillars.

    Returns
    -------
    float
        Dimensionless, -1 to 1.

    Raises
    ------
    InputError
        When no pillar is dragged.
    """
    drag = pillar_drag(domain, flow, pressure=False)
    size = np.hypot(drag[:, 0], drag[:, 1])
    dragged = size > 1e-12 * size.max(initial=0.0)
    if not dragged.any():
        raise InputError(f"alignment needs a pillar with drag, none of {len(domain.pillars)} has any")
    along = axis_cosines(pillars(domain), np.degrees(np.arctan2(drag[:, 1], drag[:, 0])))
    return float(np.mean(along[dragged]))


def _side(flow: Flow, name: str) -> tuple[Floats, float]:
    """Middle of a side and the mean pressure on it.

    Strategy: a straight line through the pressures of the cells near the side, over their distance from it.
    """
    mesh = flow.mesh
    edges = mesh.boundary_edges[mesh.edge_of(name)]
    ends = mesh.points[edges]
    step = ends[:, 1] - ends[:, 0]
    lengths = np.hypot(step[:, 0], step[:, 1])
    middle = np.average(ends.mean(axis=1), axis=0, weights=lengths)
    normal = np.array([-step[:, 1].sum(), step[:, 0].sum()])
    distance = (mesh.centroids - middle) @ (normal / np.hypot(*normal))
    near = distance < BAND * float(lengths.mean())
    weights = np.sqrt(mesh.areas[near])
    table = np.stack([np.ones(int(near.sum())), distance[near]], axis=1)
    fit, *_ = np.linalg.lstsq(table * weights[:, None], flow.pressure[near] * weights, rcond=None)
    return middle, float(fit[0])


def _pillar_walls(flow: Flow) -> tuple[NDArray[np.bool_], Floats]:
    """Which wall edges belong to pillars, and their lengths."""
    mine = flow.wall_pillar >= 0
    if not mine.any():
        raise InputError(f"no pillar has a wall: {len(flow.wall_edges)} wall edges, all on the outer boundary")
    ends = flow.mesh.points[flow.wall_edges[mine]]
    return mine, np.hypot(*(ends[:, 1] - ends[:, 0]).T)
