"""Where three passages meet: how the flow splits and joins."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vasculo.measure.passage_legs import junction_middles

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.geometry.arrays import Flags, Floats, Ints, Longs
    from vasculo.measure.passage_graph import PassageGraph

DEAD = 1e-9
"""Junctions with less than this share of the largest flow through a junction are dead."""


@dataclass(frozen=True, eq=False)
class Junctions:
    """One row a junction: a triangle between three bodies, from which three arms lead away.

    Where four passages meet there are two junctions beside each other.

    Attributes
    ----------
    place : (j, 2) float64
        Circumcentre of the triangle, or the middle of its longest edge where that lies outside (model length).
    bodies : (j, 3) int32
        Pillars, or -1 - s for side s; counter-clockwise. Arm k runs between bodies k and k + 1.
    rows : (j, 3) int64
        Row of the passage of each arm, -1: a direct way to the next junction that no table lists.
    outflow : (j, 3) float64
        Flow out through each arm, negative: in (area per time). The three cancel but for round-off.

    Examples
    --------
    >>> import vasculo as vc
    >>> from vasculo.plexus.voronoi import voronoi_plexus
    >>> domain = voronoi_plexus(4, seed=1)
    >>> mesh = vc.generate_mesh(domain, edge_length=0.5)
    >>> flow = vc.solve_stokes(mesh, {"left": vc.Pressure(1.0), "right": vc.Pressure(0.0)})
    >>> junctions = vc.measure.tubule_flow(domain, flow).junctions
    >>> junctions.bodies.shape == (len(junctions), 3)
    True
    """

    place: Floats
    bodies: Ints
    rows: Longs
    outflow: Floats

    def __len__(self) -> int:
        """Return the number of junctions."""
        return len(self.place)

    @property
    def trunk(self) -> Longs:
        """Arm with the largest flow; (j,) int64."""
        return np.argmax(np.abs(self.outflow), axis=1)

    @property
    def flow(self) -> Floats:
        """Flow through the junction: that of the trunk; (j,) float64, area per time."""
        return np.abs(self.outflow).max(axis=1, initial=0.0)

    @property
    def dead(self) -> Flags:
        """Junctions where nothing flows; (j,) bool."""
        return np.asarray(self.flow <= DEAD * self.flow.max(initial=0.0))

    @property
    def diverging(self) -> Flags:
        """Junctions with one inflow and two outflows; (j,) bool."""
        return np.asarray((self._trunk_outflow < 0.0) & ~self.dead)

    @property
    def converging(self) -> Flags:
        """Junctions with two inflows and one outflow; (j,) bool."""
        return np.asarray((self._trunk_outflow > 0.0) & ~self.dead)

    @property
    def shares(self) -> Floats:
        """Shares of the two other arms, counter-clockwise after the trunk; (j, 2) float64, NaN in dead ones."""
        arms = (self.trunk[:, None] + np.array([1, 2])) % 3
        part = np.abs(np.take_along_axis(self.outflow, arms, axis=1))
        shares = np.full(part.shape, np.nan)
        np.divide(part, self.flow[:, None], out=shares, where=~self.dead[:, None])
        return shares

    @property
    def _trunk_outflow(self) -> Floats:
        return np.asarray(np.take_along_axis(self.outflow, self.trunk[:, None], axis=1)[:, 0])

    def columns(self) -> dict[str, NDArray[np.generic]]:
        """Return the table as named columns, each of shape (j,)."""
        kind = np.where(self.dead, "dead", np.where(self.diverging, "diverging", "converging"))
        columns: dict[str, NDArray[np.generic]] = {"x": self.place[:, 0], "y": self.place[:, 1]}
        columns |= {f"body_{k + 1}": self.bodies[:, k] for k in range(3)}
        columns |= {f"outflow_{k + 1}": self.outflow[:, k] for k in range(3)}
        shares = self.shares
        return columns | {"kind": kind, "flow": self.flow, "share_1": shares[:, 0], "share_2": shares[:, 1]}


def junction_table(graph: PassageGraph, psi: Floats) -> Junctions:
    """Read the junctions of a graph with the stream function on its bodies, (bodies,) float64."""
    nodes = graph.pieces.triangles[graph.junctions]
    corner = graph.corner_bodies[graph.junctions]
    after = np.roll(corner, -1, axis=1)
    own, first = np.unique(graph.number(graph.row_bodies), return_index=True)
    arms = graph.number(np.stack((corner, after), axis=2))
    at = np.minimum(np.searchsorted(own, arms), len(own) - 1)
    return Junctions(
        place=junction_middles(graph.pieces.points, nodes),
        bodies=np.where(corner < graph.pillars, corner, -1 - graph.side[nodes]).astype(np.int32),
        rows=np.where(own[at] == arms, first[at], -1),
        outflow=psi[after] - psi[corner],
    )
