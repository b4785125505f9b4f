"""What the plexus does to the flow, and the flow to its pillars: permeability, resistance, drag."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import InputError
from vasculo.flow.boundary import Periodic
from vasculo.flow.faces import OPEN
from vasculo.flow.read.forces import drag
from vasculo.flow.stokes import solve_stokes

if TYPE_CHECKING:
    from vasculo.flow.solution import Flow
    from vasculo.geometry.arrays import Floats
    from vasculo.geometry.domain import Domain
    from vasculo.mesh.triangulation import Triangulation

ROUND_OFF = 1e-13
"""Flow rates below this part of pressure range times area over viscosity are none."""

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

    Examples
    --------
    >>> import vasculo as vc
    >>> mesh = vc.generate_mesh(vc.Domain.rectangle(2.0, 1.0), edge_length=0.25)
    >>> flow = vc.solve_stokes(mesh, {"left": vc.Pressure(1.0), "right": vc.Pressure(0.0)})
    >>> round(vc.measure.permeability(vc.Domain.rectangle(2.0, 1.0), flow), 6), round(1 / 12, 6)
    (0.083333, 0.083333)
    """
    drop = pressure_drop(flow, inlet, outlet)
    x0, y0, x1, y1 = domain.bounds
    length = float(np.hypot(*(middle_of(domain, outlet) - middle_of(domain, inlet))))
    height = (x1 - x0) * (y1 - y0) / length
    return passing_flow(flow, outlet) * flow.viscosity * length / (height * drop)


def resistance(flow: Flow, inlet: str = "left", outlet: str = "right") -> float:
    """Hydraulic resistance from inlet to outlet: the pressure drop over the flow rate out of `outlet`.

    In proportion to the viscosity; eta L / (H K) with the permeability K.

    Parameters
    ----------
    flow : Flow
        A solved flow.
    inlet, outlet : str
        Names of two sides.

    Returns
    -------
    float
        Pressure times time per length squared (per unit depth); infinite when nothing flows out.

    Raises
    ------
    InputError
        When there is no pressure drop between the two sides.

    Examples
    --------
    >>> import vasculo as vc
    >>> mesh = vc.generate_mesh(vc.Domain.rectangle(2.0, 1.0), edge_length=0.25)
    >>> flow = vc.solve_stokes(mesh, {"left": vc.Pressure(1.0), "right": vc.Pressure(0.0)})
    >>> round(vc.measure.resistance(flow), 6)
    24.0
    """
    drop, rate = pressure_drop(flow, inlet, outlet), passing_flow(flow, outlet)
    return drop / rate if rate else float("inf")


def passing_flow(flow: Flow, outlet: str = "right") -> float:
    """Flow rate out of a side (area per time), exactly zero where it is no more than the round-off of the pressures."""
    rate = flow.flow_rate(outlet)
    scale = float(np.ptp(flow.pressure) * flow.mesh.areas.sum()) / flow.viscosity
    return rate if abs(rate) > ROUND_OFF * scale else 0.0


def pressure_drop(flow: Flow, inlet: str = "left", outlet: str = "right") -> float:
    """Mean pressure at `inlet` over that at `outlet`: the prescribed one where there is one, else read from the cells.

    Raises
    ------
    InputError
        When there is none, or no such side.
    """
    upstream, downstream = _pressure_at(flow, inlet), _pressure_at(flow, outlet)
    if not abs(upstream - downstream) > 1e-9 * float(np.ptp(flow.pressure)):
        raise InputError(f"no pressure drop from {inlet} to {outlet}: {upstream:.3g} and {downstream:.3g}")
    return upstream - downstream


def flow_direction(domain: Domain, inlet: str = "left", outlet: str = "right") -> float:
    """Direction of the mean flow: from the middle of the inlet to the middle of the outlet, degrees against x.

    The mean velocity over the fluid points from where the flow enters on average to where it leaves on average; this is
    the same for inlets and outlets that are used evenly, and it does not change while pillars move.

    Parameters
    ----------
    domain : Domain
        Any domain with two such sides.
    inlet, outlet : str
        Names of two sides.

    Returns
    -------
    float
        Above -180 and up to 180.

    Raises
    ------
    InputError
        When there is no such side, or both have the same middle.

    Examples
    --------
    >>> import vasculo as vc
    >>> box = vc.Domain.rectangle(2.0, 1.0)
    >>> vc.measure.flow_direction(box), vc.measure.flow_direction(box, "bottom", "top")
    (0.0, 90.0)
    """
    way = middle_of(domain, outlet) - middle_of(domain, inlet)
    if not np.hypot(*way) > 0.0:
        raise InputError(f"the sides {inlet} and {outlet} have the same middle: there is no direction between them")
    return float(np.degrees(np.arctan2(way[1], way[0])))


def middle_of(domain: Domain, side: str) -> Floats:
    """Middle of a side, mean over its length; (2,) float64, model length.

    Raises
    ------
    InputError
        When the domain has no such side.
    """
    mine = np.array([name == side for name in domain.sides])
    if not mine.any():
        raise InputError(f"no side is called {side!r}; the sides are {', '.join(domain.side_names)}")
    starts, ends = domain.outer[mine], np.roll(domain.outer, -1, axis=0)[mine]
    lengths = np.hypot(*(ends - starts).T)
    return np.asarray(lengths @ (0.5 * (starts + ends)) / lengths.sum())


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

    Examples
    --------
    >>> import vasculo as vc
    >>> square = [(0.4, 0.4), (0.6, 0.4), (0.6, 0.6), (0.4, 0.6)]
    >>> mesh = vc.generate_mesh(vc.Domain.rectangle(1.0, 1.0, [square]), edge_length=0.1)
    >>> tensor = vc.measure.permeability_tensor(mesh)
    >>> tensor.shape, bool(abs(tensor[0, 0] / tensor[1, 1] - 1.0) < 0.02)
    ((2, 2), True)
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

    Examples
    --------
    >>> import vasculo as vc
    >>> from vasculo.plexus.voronoi import voronoi_plexus
    >>> domain = voronoi_plexus(4, seed=1)
    >>> mesh = vc.generate_mesh(domain, edge_length=0.5)
    >>> flow = vc.solve_stokes(mesh, {"left": vc.Pressure(1.0), "right": vc.Pressure(0.0)})
    >>> drag = vc.measure.pillar_drag(domain, flow)
    >>> drag.shape, bool((drag[:, 0] > 0.0).all())
    ((4, 2), True)
    """
    force = np.zeros((len(domain.pillars), 2))
    found = drag(flow, "full" if pressure else "viscous")
    force[: len(found)] = found
    return force


def _pressure_at(flow: Flow, name: str) -> float:
    """Mean pressure on a side.

    Strategy: the prescribed one; without it a straight line through the pressures of the cells near the side, over
    their distance from it.
    """
    mesh, faces = flow.mesh, flow.faces
    edges = mesh.edge_of(name)
    ends = mesh.points[mesh.boundary_edges[edges]]
    step = ends[:, 1] - ends[:, 0]
    lengths = np.hypot(step[:, 0], step[:, 1])
    face = faces.edge_face[edges]
    if (faces.kind[face] == OPEN).all():
        return faces.level + float(np.average(faces.opening[face - faces.inner], weights=lengths))
    middle = np.average(ends.mean(axis=1), axis=0, weights=lengths)
    normal = np.array([-step[:, 1].sum(), step[:, 0].sum()])
    distance = (mesh.centroids - middle) @ (normal / np.hypot(*normal))
    near = distance < BAND * float(lengths.mean())
    weights = np.sqrt(mesh.areas[near])
    table = np.stack([np.ones(int(near.sum())), distance[near]], axis=1)
    fit, *_ = np.linalg.lstsq(table * weights[:, None], flow.pressure[near] * weights, rcond=None)
    return float(fit[0])
