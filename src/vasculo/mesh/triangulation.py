"""Triangulation: points, triangles, neighbours, faces, boundary edges with tags."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from vasculo.errors import InputError
from vasculo.mesh.adjacency import adjacency, first_fault, list_faces, match_rim
from vasculo.mesh.quality import first_turned, signed_areas, triangle_quality
from vasculo.shown import Shown

if TYPE_CHECKING:
    from numpy.typing import NDArray


class MeshFaces(NamedTuple):
    """Every edge of a triangulation once: the inner ones, then the boundary edges in their order.

    Parameters
    ----------
    ends : (f, 2) int32
        Nodes of each edge.
    triangles : (f, 2) int32
        Triangle on the left of it, triangle on the right; -1 at the boundary.
    """

    ends: NDArray[np.int32]
    triangles: NDArray[np.int32]


class MeshCheck(NamedTuple):
    """What `Triangulation.check` found.

    Parameters
    ----------
    nodes, triangles, edges, loops : int
        Counts; `loops` are the closed boundaries.
    area : float, model length squared
        Area of the triangles.
    least_area : float, model length squared
    least_quality, mean_quality : float, dimensionless
        2 r_in / r_circ.
    """

    nodes: int
    triangles: int
    edges: int
    loops: int
    area: float
    least_area: float
    least_quality: float
    mean_quality: float


@dataclass(frozen=True, eq=False)
class Triangulation(Shown):
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
    neighbours : (t, 3) int32, optional
        Triangle across the edge opposite to each corner, -1 at the boundary; found if left out.
    sizes : (n,) float64, optional, model length
        Edge length that was wanted at each node; the mesher and the repair say it, None: not known.

    Attributes
    ----------
    boundary_triangles : (b,) int32
        Triangle of each boundary edge.

    Raises
    ------
    InputError
        A triangle that is not counter-clockwise, an edge used twice in one direction, neighbours that are none,
        boundary edges that are not exactly the edges with one triangle, or tags out of range.

    Notes
    -----
    The arrays belong to the triangulation and are not to be changed: what is computed from them is kept.

    Examples
    --------
    >>> import vasculo as vc
    >>> corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
    >>> border = [(0, 1), (1, 2), (2, 3), (3, 0)]
    >>> mesh = vc.Triangulation(corners, [(0, 1, 2), (0, 2, 3)], border, [-1, -1, -1, -1], ("wall",))
    >>> mesh.areas.tolist(), mesh.quality().round(3).tolist()
    ([0.5, 0.5], [0.828, 0.828])
    >>> mesh.check().triangles
    2
    """

    points: NDArray[np.float64]
    triangles: NDArray[np.int32]
    boundary_edges: NDArray[np.int32]
    boundary_tags: NDArray[np.int32]
    side_names: tuple[str, ...]
    neighbours: NDArray[np.int32] = None  # type: ignore[assignment]
    sizes: NDArray[np.float64] | None = None
    boundary_triangles: NDArray[np.int32] = field(init=False)

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
        if self.sizes is not None and np.shape(self.sizes) != (len(self.points),):
            raise InputError(f"sizes have shape {np.shape(self.sizes)}, but there are {len(self.points)} nodes")
        worst = int(np.argmin(self.areas))
        if not self.areas[worst] > 0.0:
            raise InputError(f"triangle {worst} is not counter-clockwise: its area is {self.areas[worst]:.3g}")
        given: NDArray[np.int32] | None = self.neighbours
        if given is None:
            object.__setattr__(self, "neighbours", adjacency(self.triangles, len(self.points)))
        else:
            object.__setattr__(self, "neighbours", np.ascontiguousarray(given, dtype=np.int32))
            self._check_neighbours()
        self._check_boundary()

    def _check_neighbours(self) -> None:
        """Given neighbours must share the edge, and know each other."""
        if self.neighbours.shape != self.triangles.shape:
            raise InputError(
                f"neighbours have shape {self.neighbours.shape}, but the triangles have {self.triangles.shape}"
            )
        fault = first_fault(self.triangles, self.neighbours)
        if fault >= 0:
            t, k = divmod(fault, 3)
            raise InputError(f"triangles {t} and {self.neighbours[t, k]} are given as neighbours, but share no edge")

    def _check_boundary(self) -> None:
        """Every edge without a neighbour must be a boundary edge, in its direction, with a tag."""
        edges, tags = self.boundary_edges, self.boundary_tags
        alone = int(np.count_nonzero(self.neighbours < 0))
        owner, after = np.empty(len(edges), dtype=np.int32), np.empty(len(edges), dtype=np.int32)
        if len(edges) and (edges.min() < 0 or edges.max() >= len(self.points)):
            raise InputError(f"boundary edges must name nodes 0 to {len(self.points) - 1}")
        first = np.full(len(self.points), -1, dtype=np.int32)
        if match_rim(self.triangles, self.neighbours, edges, first, after, owner):
            raise InputError(f"{alone} edges have one triangle, but other {len(edges)} edges are given as boundary")
        object.__setattr__(self, "boundary_triangles", owner)
        if len(tags) != len(edges) or (len(tags) and tags.min() < -len(self.side_names)):
            raise InputError(f"{len(edges)} boundary edges need as many tags, none below {-len(self.side_names)}")

    @cached_property
    def faces(self) -> MeshFaces:
        """Every edge once, with the triangles on both sides."""
        inner = (self.triangles.size - len(self.boundary_edges)) // 2
        ends, beside = np.empty((inner, 2), dtype=np.int32), np.empty((inner, 2), dtype=np.int32)
        list_faces(self.triangles, self.neighbours, ends, beside)
        rim = np.column_stack((self.boundary_triangles, np.full(len(self.boundary_triangles), -1, dtype=np.int32)))
        return MeshFaces(np.concatenate((ends, self.boundary_edges)), np.concatenate((beside, rim)))

    def check(self) -> MeshCheck:
        """Check the whole mesh: orientation by exact arithmetic, conformity, closed boundaries, no node left over.

        Raises
        ------
        InputError
            The first fault found, with its numbers.
        """
        turned = first_turned(self.points, self.triangles)
        if turned >= 0:
            raise InputError(f"triangle {turned} is not counter-clockwise: its area is {self.areas[turned]:.3g}")
        used = np.bincount(self.triangles.ravel(), minlength=len(self.points))
        if not used.all():
            raise InputError(f"{np.count_nonzero(used == 0)} of {len(used)} nodes belong to no triangle")
        self._check_neighbours()
        self._check_boundary()
        starts, ends = (np.bincount(side, minlength=len(used)) for side in self.boundary_edges.T)
        if (starts != ends).any() or starts.max() > 1:
            node = int(np.flatnonzero((starts != ends) | (starts > 1))[0])
            raise InputError(
                f"{starts[node]} boundary edges leave node {node} and {ends[node]} reach it, expected 1 each"
            )
        following = np.arange(len(used))
        following[self.boundary_edges[:, 0]] = self.boundary_edges[:, 1]
        graph = coo_array((np.ones(len(starts)), (np.arange(len(starts)), following)), shape=(len(starts), len(starts)))
        loops = connected_components(graph, directed=False)[0] - int(np.count_nonzero(starts == 0))
        quality = self.quality()
        return MeshCheck(
            len(self.points), len(self.triangles), len(self.faces.ends), int(loops), float(self.areas.sum()),
            float(self.areas.min()), float(quality.min()), float(quality.mean()),
        )  # fmt: skip

    def __repr__(self) -> str:
        sides = ", ".join(self.side_names)
        return f"Triangulation({len(self.points)} nodes, {len(self.triangles)} triangles, sides: {sides})"

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
        """Give the indices of the boundary edges of a side; of all pillars for "pillars", of one for "pillar 3".

        Raises
        ------
        InputError
            No side has this name.
        """
        if name == "pillars":
            return np.flatnonzero(self.boundary_tags >= 0)
        one = re.fullmatch(r"pillar (0|[1-9][0-9]*)", name)
        if one and name not in self.side_names and (self.boundary_tags == int(one[1])).any():
            return np.flatnonzero(self.boundary_tags == int(one[1]))
        if name not in self.side_names:
            raise InputError(f"no side is called {name!r}; the sides are {', '.join(self.side_names)}")
        return np.flatnonzero(self.boundary_tags == -1 - self.side_names.index(name))
