"""The steps of a repair, in order: carry, take out and fill, fit lengths, smooth, mend."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from vasculo.errors import ComputationError, InputError
from vasculo.mesh.adjacency import stars
from vasculo.mesh.generate import AREA_ROUNDING
from vasculo.mesh.improve import smooth
from vasculo.mesh.repair.carry import carry_along, mark_around, mark_broken
from vasculo.mesh.repair.edit import cut_long_edges, draw_short_edges
from vasculo.mesh.repair.fill import near_outlines, refill, with_ring
from vasculo.mesh.repair.light import is_misfit
from vasculo.mesh.repair.sizes import mesh_sizes
from vasculo.mesh.repair.work import INNER, find_same, pack, wall_edges, work_on
from vasculo.mesh.triangulate.flips import restore_delaunay
from vasculo.mesh.triangulation import Triangulation

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.geometry.domain import Domain
    from vasculo.mesh.repair.match import Match
    from vasculo.mesh.repair.sizes import Wanted
    from vasculo.mesh.walls import Walls

BROKEN = 0.15
"""A carried triangle with a mean ratio below this is taken out and its surroundings filled anew."""

MARGIN = 1.0
"""Triangles nearer to a new outline than this many of its edges make room for it."""

ATTEMPTS = 3
"""Tries to fill the holes, each with one more ring of triangles taken out."""

MOST_NEW = 0.6
"""Share of the triangles from which on taking them out is no repair."""

FITS, SETTLED = 10, 0.02
"""Most rounds of cutting and contracting; they end when fewer than this share of the nodes comes or goes."""

ROUNDS = 1
"""Rounds of smoothing and flips at the end."""

POOR, MENDS = 0.5, 2
"""Triangles with a smaller mean ratio at the end are taken out and their surroundings filled anew, so many times."""

WORST = 0.25
"""With a triangle below this mean ratio the repair has failed."""


class Repair:
    """A repair under way.

    Parameters
    ----------
    mesh : Triangulation
    old, new : Walls
        Of the domains before and after.
    match : Match
    wanted : Wanted
    most : int
        Largest number of triangles.
    """

    def __init__(self, mesh: Triangulation, old: Walls, new: Walls, match: Match, wanted: Wanted, most: int) -> None:
        self.mesh, self.walls, self.wanted, self.most = mesh, new, wanted, most
        self.sizes, self.carried = mesh.sizes, 0
        self.match = match
        self.work, self.places = work_on(mesh, old, new, match)
        self.refilled = self.flipped = 0

    def run(self) -> None:
        """Take all steps.

        Raises
        ------
        ComputationError
            The mesh is no good, or would be too large.
        """
        touched = self._carry()
        if self._let_be(touched):
            return
        self._refill()
        if not self.refilled and not np.array_equal(self.match.nodes, np.arange(len(self.match.nodes))):
            pack(self.work, len(self.walls.nodes))
        touched = self._touched()
        for _ in range(FITS):
            touched, changed = self._fit_lengths(touched)
            if changed <= SETTLED * len(touched):
                break
        self._improve(touched)
        self._mend()

    def _carry(self) -> NDArray[np.bool_]:
        """Move the walls and, over some layers, the nodes behind them; which nodes have moved, (n,) bool."""
        work = self.work
        touched, self.first, self.star = carry_along(
            work.points, work.triangles, self.mesh.boundary_edges, work.wall != INNER, self.places
        )
        return touched

    def _let_be(self, touched: NDArray[np.bool_]) -> bool:
        """Smooth and flip a mesh that was only carried along; False if it needs more than that."""
        work, match = self.work, self.match
        if len(match.fresh) or not touched.any() or not np.array_equal(match.nodes, np.arange(len(match.nodes))):
            return False
        on_wall = work.wall != INNER
        if self.sizes is None or is_misfit(
            work.points, self.mesh.points, work.triangles, work.neighbours, on_wall, touched, self.sizes, POOR
        ):
            return False
        smooth(work.points, work.triangles, self.first, self.star, on_wall | ~touched, 1)
        self._flip(touched)
        self.carried = int(np.count_nonzero(touched))
        return True

    def _refill(self) -> None:
        """Mesh anew around outlines that are not the same, and where triangles are turned over."""
        work, walls, match = self.work, self.walls, self.match
        gone = np.empty(len(work.triangles), dtype=np.bool_)
        broken = mark_broken(work.points, work.triangles, BROKEN, gone)
        if broken:
            gone = with_ring(work.triangles, gone, len(work.points))
        lost = work.neighbours < -len(walls.edges)
        if lost.any():
            at_lost = np.zeros(len(work.points), dtype=np.bool_)
            row, c = np.nonzero(lost)
            at_lost[work.triangles[row, (c + 1) % 3]] = True
            gone |= at_lost[work.triangles].any(axis=1)
        if len(match.fresh):
            edge = np.minimum(walls.lengths, self.wanted.wall_edge_length)
            mean = np.bincount(walls.body, edge) / np.bincount(walls.body)
            gone |= near_outlines(work, walls, match.fresh, MARGIN * mean[match.fresh])
        if not gone.any():
            return
        for attempt in range(ATTEMPTS):
            share = np.count_nonzero(gone) / len(gone)
            if share > MOST_NEW:
                raise ComputationError(f"{share:.0%} of the triangles would have to go")
            try:
                self.refilled = refill(work, gone, walls, match.fresh, self.wanted)
            except ComputationError:
                if attempt == ATTEMPTS - 1:
                    raise
                gone = with_ring(work.triangles, gone, len(work.points))
            else:
                return

    def _touched(self) -> NDArray[np.bool_]:
        """Nodes that are new or have moved; (n,) bool."""
        work = self.work
        known = work.origin >= 0
        touched = ~known
        touched[known] = (work.points[known] != self.mesh.points[work.origin[known]]).any(axis=1)
        return touched

    def _flip(self, touched: NDArray[np.bool_]) -> None:
        """Make the triangles with touched nodes Delaunay."""
        work = self.work
        dirty = np.empty(len(work.triangles), dtype=np.bool_)
        mark_around(work.triangles, touched, dirty)
        self.flipped += restore_delaunay(work.points, work.triangles, work.neighbours, dirty)

    def _fit_lengths(self, touched: NDArray[np.bool_]) -> tuple[NDArray[np.bool_], int]:
        """Cut and contract edges by length; returns the nodes touched so far, and how many came or went."""
        work, corners = self.work, len(self.walls.nodes)
        wished, sizes = mesh_sizes(work, self.walls, self.wanted)
        nodes, count = len(work.points), len(work.triangles)
        room, space = nodes + nodes // 8 + 256, count + count // 4 + 1024
        while True:
            points, wall, demand = _longer(work.points, room), _longer(work.wall, room), _longer(wished, room)
            size = _longer(sizes, room)
            triangles, neighbours = _longer(work.triangles, space), _longer(work.neighbours, space)
            dirty = np.zeros(space, dtype=np.bool_)
            n, t = cut_long_edges(points, demand, wall, triangles, neighbours, dirty, nodes, count, walls=True)
            size[nodes:n] = demand[nodes:n]
            gone = draw_short_edges(points, demand, wall, triangles, neighbours, dirty, t, walls=True)
            self.flipped += restore_delaunay(points[:n], triangles[:t], neighbours[:t], dirty[:t].copy())
            gone += draw_short_edges(points, size, wall, triangles, neighbours, dirty, t, walls=False)
            n, t = cut_long_edges(points, size, wall, triangles, neighbours, dirty, n, t, walls=False)
            if n < room and t + 2 <= space:
                break
            room, space = 2 * room, 2 * space
            if space > 4 * self.most:
                raise ComputationError(f"more than {self.most} triangles would be needed")
        origin, slot = _longer(work.origin, n), _longer(work.slot, t)
        origin[nodes:], slot[count:] = -1, -1
        work.points, work.wall, work.origin = points[:n], wall[:n], origin
        work.triangles, work.neighbours, work.slot = triangles[:t], neighbours[:t], slot
        touched = np.concatenate((touched, np.ones(n - nodes, dtype=np.bool_)))
        touched[work.triangles[dirty[:t]].ravel()] = True
        self.sizes = size[:n]
        if gone:
            source = pack(work, corners)
            touched, self.sizes = touched[source], self.sizes[source]
        self._flip(touched)
        return touched, n - nodes + gone

    def _improve(self, touched: NDArray[np.bool_]) -> None:
        """Smooth the touched inner nodes and flip edges, in turn."""
        work = self.work
        fixed = (work.wall != INNER) | ~touched
        for _ in range(ROUNDS):
            smooth(work.points, work.triangles, *stars(work.triangles, len(work.points)), fixed, 1)
            self._flip(touched)

    def _mend(self) -> None:
        """Fill the surroundings of triangles that are still poor anew; give up where that does not help."""
        work, none = self.work, np.empty(0, dtype=np.int64)
        for attempt in range(MENDS + 1):
            poor = np.empty(len(work.triangles), dtype=np.bool_)
            least = POOR if attempt < MENDS else WORST
            mark_broken(work.points, work.triangles, least, poor)
            poor &= (work.neighbours < 0).sum(axis=1) < 2  # between two walls the outline sets the angle
            number = np.count_nonzero(poor)
            if not number:
                return
            if attempt == MENDS:
                raise ComputationError(f"{number} of {len(poor)} triangles stay flatter than a mean ratio of {least:g}")
            for _ in range(2 + attempt):
                poor = with_ring(work.triangles, poor, len(work.points))
            try:
                self.refilled += refill(work, poor, self.walls, none, self.wanted)
            except ComputationError:
                continue
            self.sizes = None
            touched = np.zeros(len(work.points), dtype=np.bool_)
            touched[work.triangles[work.slot < 0].ravel()] = True
            self._flip(touched)
            self._improve(touched)

    def mesh_of(self, after: Domain) -> Triangulation:
        """Check the mesh and return it.

        Raises
        ------
        ComputationError
            It does not cover the fluid of the domain after.
        """
        work = self.work
        edges, segment = wall_edges(work)
        tags, neighbours = self.walls.tags[segment], np.maximum(work.neighbours, -1)
        try:
            mesh = Triangulation(work.points, work.triangles, edges, tags, after.side_names, neighbours, self.sizes)
        except InputError as error:
            raise ComputationError(str(error)) from None
        covered, area = float(mesh.areas.sum()), after.area
        if not abs(covered - area) <= AREA_ROUNDING * area:
            raise ComputationError(f"the triangles cover {covered:.15g} of the fluid's area {area:.15g}")
        return mesh

    def counts(self) -> tuple[int, int, int, int, int]:
        """Nodes moved, inserted and deleted, edges flipped, triangles filled in."""
        if self.carried:
            return self.carried, 0, 0, self.flipped, 0
        inserted = int(np.count_nonzero(self.work.origin < 0))
        deleted = len(self.mesh.points) - len(self.work.points) + inserted
        return int(np.count_nonzero(self._touched())) - inserted, inserted, deleted, self.flipped, self.refilled

    def same_triangles(self) -> NDArray[np.int32]:
        """Triangle of the old mesh with the same three nodes, else -1; (t,) int32."""
        work = self.work
        if self.carried and not self.flipped:
            return work.slot
        same = np.full(len(work.triangles), -1, dtype=np.int32)
        find_same(work.triangles, work.origin, work.slot, self.mesh.triangles, same)
        return same


def _longer(array: NDArray[Any], room: int) -> NDArray[Any]:
    """Copy of an array with room for more rows."""
    longer = np.empty((room, *array.shape[1:]), dtype=array.dtype)
    longer[: len(array)] = array
    return longer
