"""Corridors: the lanes of fluid between pillars that carry the flow from the inlet to the outlet."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numba import njit
from scipy import sparse

from vasculo.errors import InputError
from vasculo.flow.read.stream import edge_fluxes, stream_function
from vasculo.geometry.boxtree import STACK, box_tree, least
from vasculo.geometry.outline import is_number
from vasculo.measure.hydraulics import flow_direction, passing_flow

if TYPE_CHECKING:
    from vasculo.flow.solution import Flow
    from vasculo.geometry.arrays import Flags, Floats, Longs
    from vasculo.geometry.domain import Domain

SPACING = 0.5
"""Distance of the stations over the radius of the mean pillar."""
FEWEST = 100
"""Fewest stations."""


@dataclass(frozen=True, eq=False)
class Corridors:
    """Lanes of fluid where straight lines across the mean flow, the stations, cut the domain; one row a lane.

    A lane is a piece of a station from one wall, its left or right bank, to the next. The flow through it is the
    difference of the stream function between its ends, exactly the same wherever a line crosses between the same banks.

    Attributes
    ----------
    direction : float
        Of the mean flow against x, degrees.
    stations : ndarray of float64, shape (s,)
        Places of the stations along it (model length).
    station : ndarray of int64, shape (k,)
        Station of each lane.
    ends : ndarray of float64, shape (k, 2, 2)
        Its right end and its left end, seen along the mean flow (model length).
    banks : ndarray of int64, shape (k, 2)
        Walls there: the same number at every station along one and the same wall; -1 at an opening.
    flux : ndarray of float64, shape (k,)
        Flow through it along the mean flow (area per time); below zero where the fluid flows back.
    width : ndarray of float64, shape (k,)
        Twice the distance from its middle to the nearest wall: the width of the passage there, whichever way it runs
        (model length). At a mirror line it is that of the half which is in the domain.
    run : ndarray of float64, shape (k,)
        Length of the stretch of stations along which a lane runs between the same two banks: no branch leaves or joins
        it there (model length). 0 for a lane with one wall on both sides, a bay.

    Examples
    --------
    >>> import vasculo as vc
    >>> from vasculo.plexus.voronoi import voronoi_plexus
    >>> domain = voronoi_plexus(4, seed=1)
    >>> mesh = vc.generate_mesh(domain, edge_length=0.5)
    >>> flow = vc.solve_stokes(mesh, {"left": vc.Pressure(1.0), "right": vc.Pressure(0.0)})
    >>> lanes = vc.measure.corridors(domain, flow)
    >>> round(lanes.direction, 6), len(lanes.flux) == len(lanes.width)
    (0.0, True)
    """

    direction: float
    stations: Floats
    station: Longs
    ends: Floats
    banks: Longs
    flux: Floats
    width: Floats
    run: Floats

    def __len__(self) -> int:
        """Return the number of lanes."""
        return len(self.flux)

    @property
    def is_through(self) -> Flags:
        """Lanes (k,) between two different walls; the others are bays of one wall, with no net flow."""
        return np.asarray((self.banks[:, 0] != self.banks[:, 1]) | (self.banks[:, 0] < 0))

    @property
    def counts(self) -> Longs:
        """Lanes between two different walls at each station; (s,) int64."""
        return np.bincount(self.station[self.is_through], minlength=len(self.stations))

    @property
    def effective_counts(self) -> Floats:
        """Lanes that carry the flow at each station, (sum of abs q)^2 / sum q^2; (s,) float64.

        n where n lanes carry the same; 1 where one carries all; 0 where nothing flows.
        """
        size = np.abs(self.flux)
        total = np.bincount(self.station, size, len(self.stations))
        squares = np.bincount(self.station, size**2, len(self.stations))
        return np.divide(total**2, squares, out=np.zeros(len(total)), where=squares > 0.0)

    @property
    def count(self) -> float:
        """Mean over the stations of the lanes between two different walls."""
        return float(self.counts.mean())

    @property
    def effective_count(self) -> float:
        """Mean over the stations of the lanes that carry the flow."""
        return float(self.effective_counts.mean())

    @property
    def mean_width(self) -> float:
        """Width that the flow passes on average, each lane weighted by its flux (model length)."""
        return self._by_flux(self.width)

    @property
    def mean_run(self) -> float:
        """How far the flow runs between the same two banks on average, weighted by flux (model length)."""
        return self._by_flux(self.run)

    def _by_flux(self, values: Floats) -> float:
        size = np.abs(self.flux)
        return float(np.average(values, weights=size)) if size.any() else float("nan")


def corridors(
    domain: Domain, flow: Flow, inlet: str = "left", outlet: str = "right", *, spacing: float | None = None
) -> Corridors:
    """Find the lanes that carry the flow.

    Parameters
    ----------
    domain : Domain
        The domain of the flow.
    flow : Flow
        Its solution; the pillars are walls or mirror lines.
    inlet, outlet : str
        Names of two sides; the mean flow goes from the middle of one to the middle of the other.
    spacing : float, optional
        Distance of the stations (model length), rounded so that a whole number fits. Half the radius of the mean
        pillar if left out, and at least 100 stations. They lie where there are pillars, from the first to the last
        along the mean flow; without pillars all over the domain.

    Returns
    -------
    Corridors

    Raises
    ------
    InputError
        When the spacing is no positive number, there is no such side, a pillar takes in or gives out fluid, or nothing
        flows.

    Examples
    --------
    >>> import vasculo as vc
    >>> from vasculo.plexus.voronoi import voronoi_plexus
    >>> domain = voronoi_plexus(4, seed=1)
    >>> mesh = vc.generate_mesh(domain, edge_length=0.5)
    >>> flow = vc.solve_stokes(mesh, {"left": vc.Pressure(1.0), "right": vc.Pressure(0.0)})
    >>> lanes = vc.measure.corridors(domain, flow)
    >>> through = lanes.flux[lanes.station == 10].sum()
    >>> round(float(through / flow.flow_rate("right")), 3)
    1.0
    """
    if spacing is not None and not (is_number(spacing) and 0.0 < spacing < np.inf):
        raise InputError(f"the spacing of stations is {spacing!r}, expected a number above 0")
    direction = flow_direction(domain, inlet, outlet)
    if passing_flow(flow, outlet) == 0.0:
        raise InputError(f"nothing flows from {inlet} to {outlet}: there are no corridors")
    psi = stream_function(flow)
    along = np.array([np.cos(np.radians(direction)), np.sin(np.radians(direction))])
    stations, gap = _stations(domain, along, spacing)
    mesh = flow.mesh
    bank = _banks(flow)
    start, end = mesh.boundary_edges.T
    # Strategy: boundary edges have the fluid on their left, so one that runs along the mean flow is the right end of a
    # lane, one that runs against it a left end. The lanes of a station are its right ends and its left ends in order.
    across = np.array([-along[1], along[0]])
    place, side = mesh.points @ along, mesh.points @ across
    cuts = []
    for first, second in ((start, end), (end, start)):
        low = np.searchsorted(stations, place[first], side="left")
        many = np.maximum(np.searchsorted(stations, place[second], side="left") - low, 0)
        edge = np.repeat(np.arange(len(start)), many)
        station = np.arange(len(edge)) - np.repeat(np.cumsum(many) - many, many) + np.repeat(low, many)
        a, b = first[edge], second[edge]
        share = (stations[station] - place[a]) / (place[b] - place[a])
        height = side[a] + share * (side[b] - side[a])
        order = np.lexsort((height, station))
        value = psi[a] + share * (psi[b] - psi[a])
        cuts.append((station[order], height[order], value[order], bank[edge][order]))
    (station, low_end, low_psi, low_bank), (_, high_end, high_psi, high_bank) = cuts
    banks = np.column_stack((low_bank, high_bank))
    heights = np.column_stack((low_end, np.maximum(high_end, low_end)))
    ends = stations[station][:, None, None] * along + heights[:, :, None] * across
    closed = np.flatnonzero(bank >= 0)
    tree = box_tree(mesh.points[mesh.boundary_edges[closed]].reshape(-1, 4))
    middles = ends.mean(axis=1)
    away = nearest_distances(middles, tree.segments, tree.weights, tree.boxes, tree.lowest)
    return Corridors(
        direction=direction,
        stations=stations,
        station=station,
        ends=ends,
        banks=banks,
        flux=high_psi - low_psi,
        width=np.minimum(2.0 * away, heights[:, 1] - heights[:, 0]),
        run=np.asarray(_runs(station, banks) * gap),
    )


def _stations(domain: Domain, along: Floats, spacing: float | None) -> tuple[Floats, float]:
    """Places of the stations along the mean flow, and their distance."""
    reach = np.concatenate(domain.pillars) if domain.pillars else domain.outer
    low, high = float((reach @ along).min()), float((reach @ along).max())
    if spacing is not None:
        count = max(1, round((high - low) / spacing))
    else:
        wanted = SPACING * domain.mean_radius if domain.pillars else high - low
        count = max(FEWEST, int(np.ceil((high - low) / wanted)))
    gap = (high - low) / count
    return np.asarray(low + gap * (np.arange(count) + 0.5)), gap


def _banks(flow: Flow) -> Longs:
    """Give the number of the wall that each boundary edge belongs to, -1 where fluid passes; (b,) int64."""
    mesh = flow.mesh
    _, flux = edge_fluxes(flow)
    closed = flux[len(flux) - len(mesh.boundary_edges) :] == 0.0
    walls = mesh.boundary_edges[closed]
    graph = sparse.coo_array((np.ones(len(walls)), walls.T), shape=(len(mesh.points),) * 2)
    number = sparse.csgraph.connected_components(graph, directed=False)[1]
    return np.where(closed, number[mesh.boundary_edges[:, 0]], -1).astype(np.int64)


def _runs(station: Longs, banks: Longs) -> Longs:
    """Stations in the unbroken stretch between the same two banks that each lane belongs to, 0 for bays; (k,) int64."""
    if not len(station):
        return np.zeros(0, dtype=np.int64)
    pair = np.unique(banks, axis=0, return_inverse=True)[1].ravel()
    order = np.lexsort((station, pair))
    fresh = np.ones(len(order), dtype=np.bool_)
    fresh[1:] = (np.diff(pair[order]) != 0) | (np.diff(station[order]) > 1)
    number = np.cumsum(fresh) - 1
    first = np.flatnonzero(fresh)
    last = np.append(first[1:], len(order)) - 1
    length = station[order[last]] - station[order[first]] + 1
    run = np.empty(len(order), dtype=np.int64)
    run[order] = length[number]
    run[(banks[:, 0] == banks[:, 1]) & (banks[:, 0] >= 0)] = 0
    return run


@njit(cache=True, error_model="numpy")
def nearest_distances(points: Floats, segments: Floats, weights: Floats, boxes: Floats, lowest: Floats) -> Floats:
    """Distance of points (k, 2) to the nearest segment of a `BoxTree`; (k,) float64."""
    stack = np.empty(STACK, dtype=np.int64)
    away = np.empty(len(points))
    for i in range(len(points)):
        away[i] = least(segments, weights, boxes, lowest, stack, 1.0, points[i, 0], points[i, 1], np.inf, np.int64(-1))[
            0
        ]
    return away


def nearest_distances_plain(points: Floats, segments: Floats) -> Floats:
    """Twin of `nearest_distances`: every point against every segment."""
    start, step = segments[:, :2], segments[:, 2:] - segments[:, :2]
    away = points[:, None] - start
    square = np.maximum(np.sum(step**2, axis=1), 1e-300)
    along = np.clip(np.sum(away * step, axis=2) / square, 0.0, 1.0)
    return np.asarray(np.linalg.norm(away - along[:, :, None] * step, axis=2).min(axis=1))
