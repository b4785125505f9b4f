"""Passages: the tubules between neighbouring pillars, how wide they are, and what they cost to mesh."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vasculo.geometry.outline import following
from vasculo.mesh.size import BASE_LAYERS, GRADING, LAYER
from vasculo.mesh.triangulate.delaunay import fluid_triangles
from vasculo.plexus.passage_kernels import expected_triangles, narrowest_ways, sort_triangles

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from vasculo.geometry.arrays import Flags, Floats, Ints


@dataclass(frozen=True, eq=False)
class Passages:
    """One row a passage: two neighbouring pillars, or a pillar and a side of the outer outline.

    Neighbours share a piece of the medial axis of the fluid: in the constrained Delaunay triangulation of the outlines
    some triangle has one edge on one of the two and its apex on the other. These triangles make up the passage.

    Attributes
    ----------
    bodies : ndarray of int32, shape (k, 2)
        Pillars i < j; or pillar i and -1 - s for side s of `sides`, as in the tags of a mesh. Sorted, sides after
        pillars.
    width : ndarray of float64, shape (k,)
        Narrowest width: the exact distance of the two outlines (model length).
    place : ndarray of float64, shape (k, 2)
        Middle of the narrowest place (model length).
    facing : ndarray of float64, shape (k, 2, 2)
        The two points that face each other there, on the first and on the second body (model length).
    length : ndarray of float64, shape (k,)
        Half of the walls that line the passage, both sides together (model length).
    mean_width : ndarray of float64, shape (k,)
        Area of the passage over its length (model length).
    triangles, refinement : ndarray of float64, shape (k,)
        Expected triangles of a flow mesh in the passage, and how many of them are there only because so many are wanted
        across it.
    total : float
        Expected triangles of the whole mesh: passages, junctions of three bodies, hollows and open fluid.
    edge_length, across : float
        Plain edge length (model length) and triangles across a passage of that mesh.
    sides : tuple of str
        Names of the sides, sorted.

    Examples
    --------
    >>> import vasculo as vc
    >>> from vasculo.plexus.voronoi import voronoi_plexus
    >>> domain = voronoi_plexus(4, seed=1)
    >>> vc.measure.passages(domain).bodies.shape[1]
    2
    """

    bodies: Ints
    width: Floats
    place: Floats
    facing: Floats
    length: Floats
    mean_width: Floats
    triangles: Floats
    refinement: Floats
    total: float
    edge_length: float
    across: float
    sides: tuple[str, ...]

    def __len__(self) -> int:
        """Return the number of passages."""
        return len(self.width)

    @property
    def between_pillars(self) -> Flags:
        """Passages (k,) with a pillar on both sides."""
        return np.asarray(self.bodies[:, 1] >= 0)

    @property
    def refined(self) -> Flags:
        """Passages (k,) too narrow for their triangles across at the plain edge length: the mesh is finer there."""
        return np.asarray(self.width < self.across * self.edge_length / LAYER)

    def columns(self) -> dict[str, NDArray[np.generic]]:
        """Return the table as named columns, each of shape (k,); a side stands by its name."""
        names = np.array([*map(str, range(int(self.bodies.max(initial=-1)) + 1)), *reversed(self.sides)])
        return {
            "pillar": self.bodies[:, 0],
            "other": names[self.bodies[:, 1]],
            "width": self.width,
            "x": self.place[:, 0],
            "y": self.place[:, 1],
            "x_on_pillar": self.facing[:, 0, 0],
            "y_on_pillar": self.facing[:, 0, 1],
            "x_on_other": self.facing[:, 1, 0],
            "y_on_other": self.facing[:, 1, 1],
            "length": self.length,
            "mean_width": self.mean_width,
            "triangles": self.triangles,
            "refinement": self.refinement,
        }


def find_passages(
    pillars: Sequence[Floats], outer: Floats, sides: Sequence[str], edge_length: float, across: float
) -> Passages:
    """Measure all passages between the outlines of a domain (which are not checked again).

    Strategy: outlines cut into pieces, their nodes triangulated without a node inside the fluid; each triangle then
    lies in a passage of two bodies, in a junction of three or in a hollow of one. Only neighbours are measured exactly.

    Parameters
    ----------
    pillars : sequence of ndarray of float64, shape (k_i, 2)
        Counter-clockwise, simple, disjoint, inside the outer outline (model length).
    outer : ndarray of float64, shape (k, 2)
        Outer outline, counter-clockwise (model length).
    sides : sequence of k str
        Name of each segment of the outer outline.
    edge_length : float
        Plain edge length of the mesh that is predicted (model length).
    across : float
        Triangles wanted across every passage of it.

    Returns
    -------
    Passages

    Raises
    ------
    ComputationError
        When outlines are so close that they cannot be triangulated.
    """
    names = tuple(sorted(set(sides)))
    rings = [pillar[::-1] for pillar in pillars] + [outer]
    counts = np.array([len(ring) for ring in rings])
    starts = np.concatenate(rings)
    ends = starts[following(counts)]
    label = np.repeat(np.arange(len(rings), dtype=np.int32), counts)
    label[label == len(pillars)] += np.array([names.index(side) for side in sides], dtype=np.int32)
    steps = ends - starts
    lengths = np.hypot(steps[:, 0], steps[:, 1])
    pieces = np.maximum(np.ceil(lengths / edge_length - 1e-9), 1.0).astype(np.int64)
    segment = np.repeat(np.arange(len(starts)), pieces)
    share = (np.arange(len(segment)) - np.repeat(np.cumsum(pieces) - pieces, pieces)) / pieces[segment]
    points = starts[segment] + share[:, None] * steps[segment]
    after = following(np.add.reduceat(pieces, np.cumsum(counts) - counts))
    edges = np.column_stack((np.arange(len(points)), after)).astype(np.int32)
    triangles, neighbours = fluid_triangles(points, edges)

    one, two, apex = sort_triangles(triangles, neighbours, label[segment])
    mesh = points, after, triangles, neighbours, apex, lengths[segment], pieces[segment] == 1, edge_length
    unrefined = expected_triangles(*mesh, BASE_LAYERS, GRADING)
    expected = expected_triangles(*mesh, float(across), GRADING) if across > BASE_LAYERS else unrefined

    bodies = len(pillars) + len(names)
    mine = np.flatnonzero((one >= 0) & (one < len(pillars)))
    numbers, row = np.unique(one[mine].astype(np.int64) * bodies + two[mine], return_inverse=True)
    pairs = np.column_stack(np.divmod(numbers, bodies)).astype(np.int32)
    order = np.argsort(label, kind="stable")
    first = np.searchsorted(label[order], np.arange(bodies + 1))
    facing = narrowest_ways(pairs, np.hstack((starts, ends))[order], first)
    width = np.hypot(*(facing[:, 1] - facing[:, 0]).T)
    corner = np.arange(len(mine))[:, None], (apex[mine, None] + np.arange(3)) % 3
    tip, left, right = np.moveaxis(points[triangles[mine][corner]], 1, 0)
    base, height = right - left, tip - left
    area = 0.5 * (base[:, 0] * height[:, 1] - base[:, 1] * height[:, 0])

    def summed(values: Floats) -> Floats:
        return np.bincount(row, weights=values, minlength=len(pairs)).astype(np.float64)

    length = summed(0.5 * np.hypot(base[:, 0], base[:, 1]))
    return Passages(
        bodies=np.where(pairs < len(pillars), pairs, np.int32(len(pillars) - 1) - pairs),
        width=width,
        place=facing.mean(axis=1),
        facing=facing,
        length=length,
        mean_width=summed(area) / length,
        triangles=summed(expected[mine]),
        refinement=summed((expected - unrefined)[mine]),
        total=float(expected.sum()),
        edge_length=float(edge_length),
        across=float(across),
        sides=names,
    )
