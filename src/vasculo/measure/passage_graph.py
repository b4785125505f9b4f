"""The graph of the passages: triangles between the outlines as nodes, the edges that join two bodies as its links."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import InputError
from vasculo.measure.outline_pieces import cut_outlines, outlines_of
from vasculo.measure.passages import PLAIN_EDGE
from vasculo.plexus.passage_kernels import narrowest_ways, sort_triangles

if TYPE_CHECKING:
    from collections.abc import Collection

    from vasculo.geometry.arrays import Flags, Floats, Ints, Longs
    from vasculo.geometry.domain import Domain
    from vasculo.measure.outline_pieces import Outlines, Pieces


@dataclass(frozen=True, eq=False)
class PassageGraph:
    """Constrained Delaunay triangles between the outlines, and what they say about who faces whom.

    Bodies are the pillars and the runs: pieces of the outer outline that are all open or all closed, counter-clockwise
    one after the other. A triangle edge that joins two closed bodies is a link: the flow through it passes between
    these two. A triangle with two links lies in a passage, one with three is a junction, one with a single link is a
    mouth, where a passage comes out at an opening.

    Attributes
    ----------
    pieces : Pieces
        Nodes of the outlines, and the triangles.
    segment_body, segment_side : (n,) int32
        Body and side (-1: a pillar) of the outline piece that starts at each node.
    sides : tuple of str
        Names of the sides, sorted.
    pillars : int
        Number of pillars, bodies 0 to pillars - 1.
    closed : (bodies,) bool
        False for openings.
    row : (t,) int64
        Row of the tables to which each triangle belongs, -1: a junction, a hollow or fluid between sides only.
    bodies : (k, 2) int32
        Rows of the tables, as in `Passages`: pillars i < j, or pillar i and -1 - s for side s.
    row_bodies : (k, 2) int64
        The same as bodies of this graph.
    facing : (k, 2, 2) float64, model length
        The two points that face each other at the narrowest place, on the first and on the second body.
    """

    pieces: Pieces
    segment_body: Ints
    segment_side: Ints
    sides: tuple[str, ...]
    pillars: int
    closed: Flags
    row: Longs
    bodies: Ints
    row_bodies: Longs
    facing: Floats

    @property
    def side(self) -> Ints:
        """Side on which each node lies, -1: on a pillar; where an opening meets a wall, the wall; (n,) int32."""
        own = self.segment_body == self.pieces.body
        return np.asarray(np.where(own, self.segment_side, self.segment_side[self.pieces.before]))

    @cached_property
    def corner_bodies(self) -> Ints:
        """Bodies of the corners of the triangles; (t, 3) int32."""
        return self.pieces.body[self.pieces.triangles]

    @cached_property
    def links(self) -> Flags:
        """Edges opposite to the corners that join two closed bodies; (t, 3) bool."""
        one, two = np.roll(self.corner_bodies, -1, axis=1), np.roll(self.corner_bodies, -2, axis=1)
        return np.asarray((one != two) & self.closed[one] & self.closed[two])

    @property
    def junctions(self) -> Longs:
        """Triangles with three links; (j,) int64."""
        return np.flatnonzero(self.links.all(axis=1))

    @cached_property
    def link_bodies(self) -> Ints:
        """Bodies that each link joins, counter-clockwise, in the order of the true values of `links`; (l, 2) int32."""
        one, two = np.roll(self.corner_bodies, -1, axis=1), np.roll(self.corner_bodies, -2, axis=1)
        return np.column_stack((one[self.links], two[self.links]))

    def number(self, pairs: Ints | Longs) -> Longs:
        """One number for each pair of bodies, (..., 2), whichever of the two comes first."""
        return np.asarray(pairs.min(axis=-1).astype(np.int64) * len(self.closed) + pairs.max(axis=-1))


def passage_graph(domain: Domain, openings: Collection[str]) -> PassageGraph:
    """Triangulate the fluid between the outlines of a domain, and find rows, links and junctions.

    Parameters
    ----------
    domain : Domain
        At least one pillar.
    openings : collection of str
        Names of the sides through which fluid passes.

    Returns
    -------
    PassageGraph

    Raises
    ------
    InputError
        When the domain has no pillar, or an opening is no side.
    ComputationError
        When outlines are so close that they cannot be triangulated.

    Notes
    -----
    The rows are those of `passages`, but outlines are cut finer here: a passage shorter than the distance of outline
    nodes may be found here and not there. A name that stands for several stretches of the outer outline has a row for
    each of them.
    """
    if not domain.pillars:
        raise InputError("passages need at least one pillar, the domain has none")
    for name in openings:
        if name not in domain.sides:
            raise InputError(f"no side is called {name!r}; the sides are {', '.join(domain.side_names)}")
    outlines = outlines_of(domain, np.isin(domain.sides, list(openings)))
    pieces = cut_outlines(outlines, PLAIN_EDGE * domain.mean_radius)
    row, pairs = _rows(outlines, pieces, len(domain.pillars))
    order = np.argsort(outlines.stretch, kind="stable")
    first = np.searchsorted(outlines.stretch[order], np.arange(int(outlines.stretch.max()) + 2))
    run_of = np.empty(len(first) - 1, dtype=np.int64)
    side_of = np.empty(len(first) - 1, dtype=np.int32)
    run_of[outlines.stretch], side_of[outlines.stretch] = outlines.run, outlines.side
    segments = np.hstack((outlines.starts, outlines.ends))[order]
    return PassageGraph(
        pieces=pieces,
        segment_body=outlines.run[pieces.segment],
        segment_side=outlines.side[pieces.segment],
        sides=domain.side_names,
        pillars=len(domain.pillars),
        closed=outlines.closed,
        row=row,
        bodies=np.where(pairs < len(domain.pillars), pairs, -1 - side_of[pairs]).astype(np.int32),
        row_bodies=run_of[pairs],
        facing=narrowest_ways(pairs, segments, first),
    )


def _rows(outlines: Outlines, pieces: Pieces, pillars: int) -> tuple[Longs, Ints]:
    """Row of each triangle, (t,), and the pillar and the stretch of each row, (k, 2): pillars first, sides by name."""
    one, two, _ = sort_triangles(pieces.triangles, pieces.neighbours, outlines.stretch[pieces.segment])
    mine = np.flatnonzero((one >= 0) & (one < pillars))
    stretches = int(outlines.stretch.max()) + 1
    rank = np.empty(stretches, dtype=np.int64)
    side = np.full(stretches, -1)
    side[outlines.stretch] = outlines.side
    by_name = np.lexsort((np.arange(stretches), side, np.arange(stretches) >= pillars))
    rank[by_name] = np.arange(stretches)
    numbers, found = np.unique(one[mine].astype(np.int64) * stretches + rank[two[mine]], return_inverse=True)
    row = np.full(len(one), -1, dtype=np.int64)
    row[mine] = found
    first, second = np.divmod(numbers, stretches)
    return row, np.column_stack((first, by_name[second])).astype(np.int32)
