"""What flows through each passage of a domain, from a solved flow."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import shapely
from scipy.spatial import cKDTree

from vasculo.errors import InputError
from vasculo.flow.read.stream import edge_fluxes, stream_function
from vasculo.measure.junctions import Junctions, junction_table
from vasculo.measure.passage_graph import PassageGraph, passage_graph

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.flow.solution import Flow
    from vasculo.geometry.arrays import Flags, Floats, Ints, Longs
    from vasculo.geometry.domain import Domain

ON_THE_WALL = 1e-6
"""How far a corner of the outer outline may lie from a node of the mesh, over the extent of the domain."""


@dataclass(frozen=True, eq=False)
class TubuleFlow:
    """Flow through the passages: one row a passage, in the order of `vasculo.measure.passages`.

    Attributes
    ----------
    bodies : (k, 2) int32
        Pillars i < j; or pillar i and -1 - s for side s of `sides`.
    width : (k,) float64
        Narrowest width (model length).
    place : (k, 2) float64
        Middle of the narrowest place (model length).
    facing : (k, 2, 2) float64
        The two points that face each other there, on the first and on the second body (model length).
    flux : (k,) float64
        Flow across the line from the first to the second point of `facing` towards its right: the stream function on
        the second body less that on the first (area per time). The same on every line between the two bodies. NaN
        beside an opening: there is no second wall.
    wall_shear : (k,) float64
        Mean of the absolute wall shear over the walls that line the passage (force per length).
    junctions : Junctions
        Where three passages meet.
    sides : tuple of str
        Names of the sides, sorted.
    graph : PassageGraph
        The triangles between the outlines from which the rows were made.

    Examples
    --------
    >>> import vasculo as vc
    >>> from vasculo.plexus.voronoi import voronoi_plexus
    >>> domain = voronoi_plexus(4, seed=1)
    >>> mesh = vc.generate_mesh(domain, edge_length=0.5)
    >>> flow = vc.solve_stokes(mesh, {"left": vc.Pressure(1.0), "right": vc.Pressure(0.0)})
    >>> tubules = vc.measure.tubule_flow(domain, flow)
    >>> tubules.sides
    ('bottom', 'left', 'right', 'top')
    """

    bodies: Ints
    width: Floats
    place: Floats
    facing: Floats
    flux: Floats
    wall_shear: Floats
    junctions: Junctions
    sides: tuple[str, ...]
    graph: PassageGraph

    def __len__(self) -> int:
        """Return the number of passages."""
        return len(self.flux)

    @property
    def between_walls(self) -> Flags:
        """Passages (k,) with a wall or mirror line on both sides: the tubules."""
        return np.isfinite(self.flux)

    @property
    def mean_speed(self) -> Floats:
        """Mean speed at the narrowest place: flow over width; (k,) float64, model length per time."""
        return np.abs(self.flux) / self.width

    @property
    def gini(self) -> float:
        """Gini coefficient of the flow of the tubules, 0: all alike, towards 1: one carries all.

        Raises
        ------
        InputError
            When nothing flows through any tubule.
        """
        flow = self._sorted_flow()
        rank = np.arange(1, len(flow) + 1)
        return float(np.sum((2 * rank - len(flow) - 1) * flow) / (len(flow) * flow.sum()))

    def top_share(self, part: float = 0.1) -> float:
        """Share of the summed flow of all tubules that the strongest of them carry.

        Parameters
        ----------
        part : float
            Part of the tubules that is counted, above 0 and at most 1; at least one tubule.

        Raises
        ------
        InputError
            When the part is out of range, or nothing flows through any tubule.
        """
        if not 0.0 < part <= 1.0:
            raise InputError(f"the part of the tubules must be above 0 and at most 1, not {part!r}")
        flow = self._sorted_flow()
        return float(flow[-max(1, round(part * len(flow))) :].sum() / flow.sum())

    def columns(self) -> dict[str, NDArray[np.generic]]:
        """Return the table as named columns, each of shape (k,); a side stands by its name."""
        names = np.array([*map(str, range(int(self.bodies.max(initial=-1)) + 1)), *reversed(self.sides)])
        return {
            "pillar": self.bodies[:, 0],
            "other": names[self.bodies[:, 1]],
            "width": self.width,
            "x": self.place[:, 0],
            "y": self.place[:, 1],
            "flux": self.flux,
            "mean_speed": self.mean_speed,
            "wall_shear": self.wall_shear,
        }

    def _sorted_flow(self) -> Floats:
        flow = np.sort(np.abs(self.flux[self.between_walls]))
        if not flow.sum() > 0.0:
            raise InputError(f"nothing flows through any of the {len(flow)} tubules")
        return flow


def tubule_flow(domain: Domain, flow: Flow) -> TubuleFlow:
    """Read from a solved flow what passes through each passage, and how it splits at the junctions.

    The stream function is constant on every wall, so one number a pillar gives the flow through every passage without
    any integration, and flows balance at the junctions to round-off.

    Parameters
    ----------
    domain : Domain
        The domain of the flow.
    flow : Flow
        Its solution; the pillars are walls or mirror lines.

    Returns
    -------
    TubuleFlow

    Raises
    ------
    InputError
        When the domain has no pillar, the flow is that of another domain, or fluid passes through a pillar.

    Notes
    -----
    A side is open when fluid passes through any of its edges, closed when it is a wall, a mirror line, or its velocity
    runs along it.
    A passage between a pillar and an open side is a row without flux (NaN).

    Examples
    --------
    >>> import vasculo as vc
    >>> from vasculo.plexus.voronoi import voronoi_plexus
    >>> domain = voronoi_plexus(4, seed=1)
    >>> mesh = vc.generate_mesh(domain, edge_length=0.5)
    >>> flow = vc.solve_stokes(mesh, {"left": vc.Pressure(1.0), "right": vc.Pressure(0.0)})
    >>> tubules = vc.measure.tubule_flow(domain, flow)
    >>> len(tubules.flux) == len(tubules.width)
    True
    >>> bool(abs(tubules.junctions.outflow.sum(axis=1)).max() < 1e-9)  # what flows in flows out
    True
    """
    mesh = flow.mesh
    if mesh.side_names != domain.side_names or int(mesh.boundary_tags.max(initial=-1)) + 1 != len(domain.pillars):
        raise InputError(
            f"the flow was solved around {int(mesh.boundary_tags.max(initial=-1)) + 1} pillars between the sides "
            f"{', '.join(mesh.side_names)}; this domain has {len(domain.pillars)} and {', '.join(domain.side_names)}"
        )
    _, flux = edge_fluxes(flow)
    tight = flux[len(flux) - len(mesh.boundary_tags) :] == 0.0
    leaking = mesh.boundary_tags[(mesh.boundary_tags >= 0) & ~tight]
    if len(leaking):
        raise InputError(f"pillar {leaking[0]} is open: the flow along its passages is not constant")
    openings = {mesh.side_names[-1 - tag] for tag in np.unique(mesh.boundary_tags[~tight])}
    graph = passage_graph(domain, openings)
    psi = _stream_of_bodies(domain, flow, graph)
    return TubuleFlow(
        bodies=graph.bodies,
        width=np.hypot(*(graph.facing[:, 1] - graph.facing[:, 0]).T),
        place=graph.facing.mean(axis=1),
        facing=graph.facing,
        flux=psi[graph.row_bodies[:, 1]] - psi[graph.row_bodies[:, 0]],
        wall_shear=_lining_shear(flow, graph),
        junctions=junction_table(graph, psi),
        sides=graph.sides,
        graph=graph,
    )


def _stream_of_bodies(domain: Domain, flow: Flow, graph: PassageGraph) -> Floats:
    """Stream function on every closed body of the graph, NaN on openings; (bodies,) float64."""
    mesh = flow.mesh
    nodal = stream_function(flow)
    psi = np.full(len(graph.closed), np.nan)
    on_pillar = mesh.boundary_tags >= 0
    psi[mesh.boundary_tags[on_pillar]] = nodal[mesh.boundary_edges[on_pillar, 0]]
    rim = mesh.boundary_edges[~on_pillar, 0]
    corners = np.flatnonzero(graph.pieces.body >= graph.pillars)
    away, nearest = np.empty(len(corners)), np.empty(len(corners), dtype=np.int64)
    away[:], nearest[:] = cKDTree(mesh.points[rim]).query(graph.pieces.points[corners])
    extent = float(np.ptp(domain.outer, axis=0).max())
    runs = graph.pieces.body[corners]
    for run in np.unique(runs[graph.closed[runs]]):
        mine = np.flatnonzero(runs == run)
        best = mine[np.argmin(away[mine])]
        if away[best] > ON_THE_WALL * extent:
            raise InputError(
                f"the flow is not that of this domain: no mesh node within {away[best]:.3g} of the outer outline"
            )
        psi[run] = nodal[rim[nearest[best]]]
    return psi


def _lining_shear(flow: Flow, graph: PassageGraph) -> Floats:
    """Mean absolute wall shear over the walls that line each passage; (k,) float64, NaN where there are none."""
    ends = flow.mesh.points[flow.wall_edges]
    length = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
    pieces = shapely.linestrings(
        graph.pieces.points[np.column_stack((np.arange(len(graph.pieces.after)), graph.pieces.after))]
    )
    piece = shapely.STRtree(pieces).nearest(shapely.points(ends.mean(axis=1)))
    row = _row_of_pieces(graph)[piece]
    lined = row >= 0
    total = np.bincount(row[lined], weights=length[lined], minlength=len(graph.bodies))
    shear = np.bincount(row[lined], weights=(length * np.abs(flow.wall_shear))[lined], minlength=len(graph.bodies))
    mean = np.full(len(total), np.nan)
    np.divide(shear, total, out=mean, where=total > 0.0)
    return mean


def _row_of_pieces(graph: PassageGraph) -> Longs:
    """Row of the passage that the outline piece from each node on lines, -1: none; (n,) int64."""
    triangle, corner = np.nonzero(graph.pieces.neighbours < 0)
    row = np.full(len(graph.pieces.points), -1, dtype=np.int64)
    row[graph.pieces.triangles[triangle, (corner + 1) % 3]] = graph.row[triangle]
    return row
