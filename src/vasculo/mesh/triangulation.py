"""Triangulation: points, triangles, neighbours, boundary edges with tags."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import InputError
from vasculo.mesh.quality import signed_areas, triangle_quality

if TYPE_CHECKING:
    from numpy.typing import NDArray


@dataclass(frozen=True, eq=False)
class Triangulation:
    """A conforming triangulation of the fluid.

    Parameters
    ----------
    points : (n, 2) float64, model length
        Nodes.
    triangles : (t, 3) int32
        Corners, counter-clockwise.
    boundary_edges : (b, 2) int32
        Edges of one triangle only, directed with the fluid on the left.
    boundary_tags : (b,) int32
        k >= 0: pillar k; -1 - j: side `side_names[j]` of the outer boundary.
    side_names : tuple of str
        Names of the outer sides.

    Raises
    ------
    InputError
        A triangle that is not counter-clockwise, an edge used twice in one direction, boundary edges that are not
        exactly the edges with one triangle, or tags out of range.

    Notes
    -----
    The arrays belong to the triangulation and are not to be changed: neighbours and areas are kept once computed.
    """

    points: NDArray[np.float64]
    triangles: NDArray[np.int32]
    boundary_edges: NDArray[np.int32]
    boundary_tags: NDArray[np.int32]
    side_names: tuple[str, ...]

    def __post_init__(self) -> None:
        """Bring the arrays to their types and check the topology."""
        for name, kind in (
            ("points", np.float64),
            ("triangles", np.int32),
            ("boundary_edges", np.int32),
            ("boundary_tags", np.int32),
        ):
            object.__setattr__(self, name, np.ascontiguousarray(getattr(self, name), dtype=kind))
        object.__setattr__(self, "side_names", tuple(self.side_names))
        if not np.isfinite(self.points).all():
            raise InputError(f"{np.count_nonzero(~np.isfinite(self.points).all(axis=1))} mesh nodes are not finite")
        if len(self.triangles) == 0 or self.triangles.min() < 0 or self.triangles.max() >= len(self.points):
            raise InputError(f"triangles must name nodes 0 to {len(self.points) - 1}, and there must be one")
        worst = int(np.argmin(self.areas))
        if not self.areas[worst] > 0.0:
            raise InputError(f"triangle {worst} is not counter-clockwise: its area is {self.areas[worst]:.3g}")
        self._check_boundary()

    def _check_boundary(self) -> None:
        """Every edge without a neighbour must be a boundary edge, in its direction, with a tag."""
        rows, corners = np.nonzero(self.neighbours < 0)
        start = self.triangles[rows, (corners + 1) % 3].astype(np.int64)
        end = self.triangles[rows, (corners + 2) % 3]
        size = len(self.points)
        given = self.boundary_edges.astype(np.int64)
        if not np.array_equal(np.sort(start * size + end), np.sort(given[:, 0] * size + given[:, 1])):
            raise InputError(
                f"{len(start)} edges have one triangle, but other {len(given)} edges are given as boundary"
            )
        tags = self.boundary_tags
        if len(tags) != len(given) or (len(tags) and tags.min() < -len(self.side_names)):
            raise InputError(f"{len(given)} boundary edges need as many tags, none below {-len(self.side_names)}")

    @cached_property
    def neighbours(self) -> NDArray[np.int32]:
        """Triangle across the edge opposite to each corner, -1 at the boundary; (t, 3) int32."""
        return adjacency(self.triangles, len(self.points))

    @cached_property
    def areas(self) -> NDArray[np.float64]:
        """Areas of the triangles; (t,) float64, model length squared."""
        return signed_areas(self.points, self.triangles)

    @cached_property
    def centroids(self) -> NDArray[np.float64]:
        """Centroids of the triangles; (t, 2) float64, model length."""
        return np.asarray(self.points[self.triangles].mean(axis=1))

    def quality(self) -> NDArray[np.float64]:
        """2 r_in / r_circ of each triangle, 1 for equilateral; (t,) float64, dimensionless."""
        return triangle_quality(self.points, self.triangles)

    def edge_of(self, name: str) -> NDArray[np.int64]:
        """Give the indices of the boundary edges of a side; of all pillars for "pillars".

        Raises
        ------
        InputError
            No side has this name.
        """
        if name == "pillars":
            return np.flatnonzero(self.boundary_tags >= 0)
        if name not in self.side_names:
            raise InputError(f"no side is called {name!r}; the sides are {', '.join(self.side_names)}")
        return np.flatnonzero(self.boundary_tags == -1 - self.side_names.index(name))


def adjacency(triangles: NDArray[np.int32], nodes: int) -> NDArray[np.int32]:
    """Triangle across the edge opposite to each corner.

    Parameters
    ----------
    triangles : (t, 3) int32
        Corners, consistently oriented.
    nodes : int
        Number of nodes.

    Returns
    -------
    (t, 3) int32
        -1 where an edge has one triangle only.

    Raises
    ------
    InputError
        An edge is used twice in the same direction: triangles overlap or are oriented differently.
    """
    # Strategy: number each directed edge; its partner is the same edge backwards, found by one sort and one search.
    start = triangles[:, (1, 2, 0)].astype(np.int64).ravel()
    end = triangles[:, (2, 0, 1)].astype(np.int64).ravel()
    key = start * nodes + end
    order = np.argsort(key, kind="stable")
    ordered = key[order]
    twice = np.flatnonzero(ordered[1:] == ordered[:-1])
    if twice.size:
        edge = int(order[twice[0]])
        raise InputError(f"edge {start[edge]}-{end[edge]} is used twice in the same direction: triangles overlap there")
    back = end * nodes + start
    place = np.minimum(np.searchsorted(ordered, back), len(ordered) - 1)
    found = ordered[place] == back
    return np.where(found, order[place] // 3, -1).astype(np.int32).reshape(-1, 3)
