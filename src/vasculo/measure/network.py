"""The Poiseuille network of a domain: lubrication theory in every passage, solved without a mesh."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING

import numpy as np
from scipy import sparse
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import splu

from vasculo.errors import ComputationError, InputError
from vasculo.geometry.outline import is_number
from vasculo.measure.junctions import junction_table
from vasculo.measure.passage_graph import PassageGraph, passage_graph
from vasculo.measure.passage_legs import link_legs, walk_pressures
from vasculo.measure.tubules import TubuleFlow

if TYPE_CHECKING:
    from collections.abc import Collection, Mapping

    from numpy.typing import NDArray

    from vasculo.geometry.arrays import Floats
    from vasculo.geometry.domain import Domain

BALANCED = 1e-9
"""Sum of the pressure drops around a part of the network, over the largest one, that is round-off."""


@dataclass(frozen=True, eq=False)
class NetworkFlow(TubuleFlow):
    """Flow through the passages as lubrication theory has it; the rows are those of `tubule_flow`.

    Attributes
    ----------
    resistance : (k,) float64
        Pressure lost in the passage over its flow, up to the middles of the junctions at its ends (pressure times time
        over area); NaN beside an opening.
    pressure : (j,) float64
        At the junctions.
    outflow : dict of str to float
        Flow rate out through each opening (area per time); sides that meet are one opening and stand as "left+top".
    pressures : dict of str to float
        As given.
    viscosity : float
        As given.

    Examples
    --------
    >>> import vasculo as vc
    >>> from vasculo.plexus.voronoi import voronoi_plexus
    >>> domain = voronoi_plexus(4, seed=1)
    >>> estimate = vc.measure.poiseuille_network(domain, {"left": 1.0, "right": 0.0})
    >>> sorted(estimate.outflow)
    ['left', 'right']
    """

    resistance: Floats
    pressure: Floats
    outflow: dict[str, float]
    pressures: dict[str, float]
    viscosity: float

    def permeability(self, domain: Domain, inlet: str = "left", outlet: str = "right") -> float:
        """Darcy permeability of the domain from inlet to outlet, as `vasculo.measure.permeability` has it.

        Parameters
        ----------
        domain : Domain
            The domain of the network.
        inlet, outlet : str
            Names of two openings opposite each other.

        Returns
        -------
        float
            Model length squared.

        Raises
        ------
        InputError
            When one of them is no opening of its own, or there is no pressure drop between them.
        """
        for name in (inlet, outlet):
            if name not in self.outflow:
                raise InputError(f"{name!r} is no opening of its own; these are {', '.join(self.outflow)}")
        drop = self.pressures[inlet] - self.pressures[outlet]
        if drop == 0.0:
            raise InputError(f"no pressure drop from {inlet} to {outlet}: both {self.pressures[inlet]:.3g}")
        length = float(np.hypot(*(_middle(domain, outlet) - _middle(domain, inlet))))
        x0, y0, x1, y1 = domain.bounds
        height = (x1 - x0) * (y1 - y0) / length
        return self.outflow[outlet] * self.viscosity * length / (height * drop)

    def columns(self) -> dict[str, NDArray[np.generic]]:
        """Return the table as named columns, each of shape (k,); a side stands by its name."""
        return super().columns() | {"resistance": self.resistance}


def poiseuille_network(
    domain: Domain,
    pressures: Mapping[str, float] | None = None,
    viscosity: float = 1.0,
    *,
    mirrors: Collection[str] = (),
    junction_resistance: bool = True,
) -> NetworkFlow:
    """Estimate the flow through every passage from the outlines alone, each passage a slit of changing width.

    A passage loses ``12 viscosity q ds / w^3`` on a piece ds of its middle line (plane Poiseuille flow; Reynolds 1886),
    from the middle of one junction to that of the next; openings are reservoirs.

    Parameters
    ----------
    domain : Domain
        At least one pillar.
    pressures : mapping of str to float, optional
        Pressure at each open side (force per length); left 1 and right 0 if not given. All other sides are walls.
    viscosity : float
        Dynamic viscosity (force times time per area of model length), positive.
    mirrors : collection of str
        Sides that are mirror lines: a passage beside one is half of a passage.
    junction_resistance : bool
        Whether passages go on to the middles of the junctions, or end where a junction begins. In a plexus the first
        gives too little flow, the second too much.

    Returns
    -------
    NetworkFlow

    Raises
    ------
    InputError
        Unknown names, values that are not finite, or openings of different pressure with nothing between them.
    ComputationError
        When nothing holds back the flow: mirror lines only.

    Notes
    -----
    The flow rate of a plexus comes out 1 to 6 % too low, its split among the passages within about 1 %; the page on the
    network says where it is wrong. Cost grows linearly with the nodes of the outlines.

    Examples
    --------
    >>> import vasculo as vc
    >>> from vasculo.plexus.voronoi import voronoi_plexus
    >>> domain = voronoi_plexus(4, seed=1)
    >>> mesh = vc.generate_mesh(domain, edge_length=0.5)
    >>> flow = vc.solve_stokes(mesh, {"left": vc.Pressure(1.0), "right": vc.Pressure(0.0)})
    >>> estimate = vc.measure.poiseuille_network(domain, {"left": 1.0, "right": 0.0})
    >>> round(estimate.outflow["right"] / flow.flow_rate("right"), 1)
    1.0
    """
    # Strategy: the unknowns are the stream function on the pillars and on the walls between openings, so the flow
    # balances everywhere from the start. The pressures lost around a pillar sum to zero, those along a wall to the
    # difference between the openings at its ends: a sparse, symmetric, positive system with one row a body.
    given = {"left": 1.0, "right": 0.0} if pressures is None else dict(pressures)
    _check(domain, given, viscosity, mirrors)
    graph = passage_graph(domain, given)
    openings = _openings(graph, given)
    slip = np.isin(graph.segment_side, [graph.sides.index(name) for name in mirrors])
    pieces, links = graph.pieces, graph.links
    resistance, shear, length = link_legs(
        pieces.points, pieces.before, pieces.after, pieces.triangles, pieces.body, graph.segment_body, slip, links
    )
    resistance *= viscosity
    if not junction_resistance:
        resistance[graph.junctions] = 0.0
    psi = _solve(graph, resistance, openings)
    flux = psi[graph.row_bodies[:, 1]] - psi[graph.row_bodies[:, 0]]
    known = np.where(links.sum(axis=1) == 1, np.fmax.reduce(openings[graph.corner_bodies], axis=1), np.nan)
    pressure = walk_pressures(pieces.triangles, pieces.neighbours, pieces.body, links, resistance, psi, known)
    mine = graph.row >= 0
    along, sheared = (
        np.bincount(graph.row[mine], weights=values[mine].sum(axis=1), minlength=len(flux))
        for values in (length, shear)
    )
    mean = np.full(len(flux), np.nan)
    np.divide(sheared, along, out=mean, where=along > 0.0)
    return NetworkFlow(
        bodies=graph.bodies,
        width=np.hypot(*(graph.facing[:, 1] - graph.facing[:, 0]).T),
        place=graph.facing.mean(axis=1),
        facing=graph.facing,
        flux=flux,
        wall_shear=viscosity * np.abs(flux) * mean,
        junctions=junction_table(graph, psi),
        sides=graph.sides,
        graph=graph,
        resistance=_row_resistance(graph, resistance),
        pressure=pressure[graph.junctions],
        outflow=_outflow(graph, psi),
        pressures=given,
        viscosity=float(viscosity),
    )


def _check(domain: Domain, pressures: Mapping[str, float], viscosity: float, mirrors: Collection[str]) -> None:
    """Refuse what is no network."""
    if not (is_number(viscosity) and 0.0 < viscosity < np.inf):
        raise InputError(f"viscosity is {viscosity!r}: give a positive number")
    if not pressures:
        raise InputError("a network needs at least one side with a given pressure")
    for name, value in pressures.items():
        if not (is_number(value) and isfinite(value)):
            raise InputError(f"pressure on {name!r} is {value!r}: give a finite number")
    for name in mirrors:
        if name not in domain.sides:
            raise InputError(f"no side is called {name!r}; the sides are {', '.join(domain.side_names)}")
        if name in pressures:
            raise InputError(f"side {name!r} has a pressure: it cannot be a mirror line too")


def _openings(graph: PassageGraph, pressures: Mapping[str, float]) -> Floats:
    """Pressure of each open body, NaN on closed ones; (bodies,) float64."""
    found = np.full(len(graph.closed), np.nan)
    value = np.array([pressures.get(name, np.nan) for name in graph.sides])
    for start in np.flatnonzero(~graph.closed[graph.segment_body]):
        body, here = graph.segment_body[start], value[graph.segment_side[start]]
        if np.isnan(found[body]):
            found[body] = here
        elif found[body] != here:
            raise InputError(f"openings of pressure {found[body]:.3g} and {here:.3g} meet: put a wall between them")
    corner = found[graph.corner_bodies]
    low, high = np.fmin.reduce(corner, axis=1), np.fmax.reduce(corner, axis=1)
    for t in np.flatnonzero(low < high):
        x, y = graph.pieces.points[graph.pieces.triangles[t]].mean(axis=0)
        raise InputError(
            f"nothing parts the openings of pressure {low[t]:.3g} and {high[t]:.3g} near ({x:.3g}, {y:.3g})"
        )
    return found


def _solve(graph: PassageGraph, resistance: Floats, openings: Floats) -> Floats:
    """Stream function on the closed bodies, NaN on openings; (bodies,) float64."""
    bodies, runs = len(graph.closed), len(graph.closed) - graph.pillars
    drop = np.zeros(bodies)
    wall = graph.pillars + np.flatnonzero(graph.closed[graph.pillars :])
    if runs > 1:
        before, after = (graph.pillars + (wall - graph.pillars + step) % runs for step in (-1, 1))
        drop[wall] = openings[after] - openings[before]
    legs = resistance[graph.links]
    one, two = graph.link_bodies[legs > 0.0].T
    weights = sparse.coo_array((legs[legs > 0.0], (one, two)), shape=(bodies, bodies)).tocsr()
    weights = weights + weights.T
    parts, part = connected_components(weights, directed=False)
    excess = np.bincount(part, weights=drop, minlength=parts)
    if np.abs(excess).max() > BALANCED * np.abs(drop).max(initial=0.0):
        raise ComputationError(
            f"nothing holds back the flow between the openings: a pressure drop of {np.abs(excess).max():.3g} meets "
            "no resistance"
        )
    _, first = np.unique(part, return_index=True)
    free = np.ones(bodies, dtype=np.bool_)
    free[first] = False
    psi = np.zeros(bodies)
    if free.any():
        laplacian = sparse.diags_array(weights.sum(axis=1)) - weights
        inner = laplacian.tocsr()[free][:, free].tocsc()
        factor = splu(inner, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
        psi[free] = factor.solve(drop[free])
    psi[~graph.closed] = np.nan
    return psi


def _row_resistance(graph: PassageGraph, resistance: Floats) -> Floats:
    """Resistance of the links between the two bodies of each row; (k,) float64, NaN beside an opening."""
    keys, number = np.unique(graph.number(graph.link_bodies), return_inverse=True)
    total = np.bincount(number, weights=resistance[graph.links], minlength=len(keys))
    own = graph.number(graph.row_bodies)
    linked = np.isin(own, keys)
    found = np.full(len(own), np.nan)
    found[linked] = total[np.searchsorted(keys, own[linked])]
    return found


def _outflow(graph: PassageGraph, psi: Floats) -> dict[str, float]:
    """Flow rate out through each opening, by the names of its sides."""
    runs = len(graph.closed) - graph.pillars
    found: dict[str, float] = {}
    for run in np.flatnonzero(~graph.closed[graph.pillars :]):
        sides = np.unique(graph.segment_side[graph.segment_body == graph.pillars + run])
        before, after = (graph.pillars + (run + step) % runs for step in (-1, 1))
        out = float(psi[after] - psi[before]) if runs > 1 else 0.0
        name = "+".join(graph.sides[side] for side in sides)
        found[name] = found.get(name, 0.0) + out
    return found


def _middle(domain: Domain, name: str) -> Floats:
    """Middle of a side, by length; (2,) float64."""
    mine = np.flatnonzero([side == name for side in domain.sides])
    start, end = domain.outer[mine], np.roll(domain.outer, -1, axis=0)[mine]
    return np.asarray(np.average(0.5 * (start + end), axis=0, weights=np.hypot(*(end - start).T)))
