"""Which outlines of a domain go on in the next one, and where their nodes move."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numba import njit
from scipy.spatial import cKDTree

from vasculo.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.geometry.arrays import Ints
    from vasculo.mesh.triangulation import Triangulation
    from vasculo.mesh.walls import Walls

SAME = 0.5
"""An outline goes on when no node moves further than this share of the outline's mean radius."""


@dataclass(frozen=True, eq=False)
class Match:
    """Outlines of two domains, paired; those without a partner are missing from both lists.

    Parameters
    ----------
    before, after : (k,) int64
        Outlines that go on, numbered as in `Walls`.
    nodes : (n,) int32
        Outline node after for each outline node before, -1 where the outline does not go on. The same numbers hold for
        the segments: they stand in the places of the nodes, in an order that depends on their number only.
    fresh : (c,) int64
        Outlines after that did not exist before.
    """

    before: NDArray[np.int64]
    after: NDArray[np.int64]
    nodes: NDArray[np.int32]
    fresh: NDArray[np.int64]


def match_outlines(before: Walls, after: Walls) -> Match:
    """Pair the outlines of two domains that have as many nodes and lie in nearly the same place.

    Parameters
    ----------
    before, after : Walls

    Returns
    -------
    Match
        The outer outline is only paired with the outer outline.
    """
    counts, first, centres = _outlines(before)
    new_counts, new_first, new_centres = _outlines(after)
    partner = np.full(len(counts), -1, dtype=np.int64)
    partner[-1] = len(new_counts) - 1
    if len(counts) > 1 and len(new_counts) > 1:
        near = np.asarray(cKDTree(new_centres[:-1]).query(centres[:-1])[1])
        back = np.asarray(cKDTree(centres[:-1]).query(new_centres[:-1])[1])
        mutual = back[near] == np.arange(len(near))
        partner[:-1][mutual] = near[mutual]
    held = np.flatnonzero(partner >= 0)
    held = held[counts[held] == new_counts[partner[held]]]
    old_nodes = _ranges(first[held], counts[held])
    new_nodes = _ranges(new_first[partner[held]], counts[held])
    if len(held):
        away = after.nodes[new_nodes] - before.nodes[old_nodes]
        begin = np.cumsum(counts[held]) - counts[held]
        furthest = np.maximum.reduceat(np.hypot(away[:, 0], away[:, 1]), begin)
        spread = before.nodes[old_nodes] - np.repeat(centres[held], counts[held], axis=0)
        radius = np.add.reduceat(np.hypot(spread[:, 0], spread[:, 1]), begin) / counts[held]
        held = held[furthest <= SAME * radius]
        old_nodes = _ranges(first[held], counts[held])
        new_nodes = _ranges(new_first[partner[held]], counts[held])
    nodes = np.full(len(before.nodes), -1, dtype=np.int32)
    nodes[old_nodes] = new_nodes
    fresh = np.setdiff1d(np.arange(len(new_counts)), partner[held])
    return Match(held, partner[held], nodes, fresh)


def _outlines(walls: Walls) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]:
    """Count the nodes of each outline; its first node and its mean node."""
    counts = np.bincount(walls.body)
    first = np.cumsum(counts) - counts
    return counts, first, np.add.reduceat(walls.nodes, first) / counts[:, None]


def _ranges(first: NDArray[np.int64], counts: NDArray[np.int64]) -> NDArray[np.int64]:
    """Numbers first, first + 1, ... first + count - 1 for each pair, one after the other."""
    return np.arange(int(counts.sum())) + np.repeat(first - np.cumsum(counts) + counts, counts)


def wall_segments(mesh: Triangulation, walls: Walls) -> NDArray[np.int32]:
    """Outline segment that each boundary edge of a mesh is a piece of.

    Parameters
    ----------
    mesh : Triangulation
    walls : Walls
        Of the domain that the mesh was made for.

    Returns
    -------
    (b,) int32

    Raises
    ------
    InputError
        The mesh is not one of this domain.
    """
    corners = len(walls.nodes)
    if len(mesh.points) < corners or not np.array_equal(mesh.points[:corners], walls.nodes):
        raise InputError(f"the mesh does not begin with the {corners} outline nodes of the domain before")
    segment = np.full(len(mesh.boundary_edges), -1, dtype=np.int32)
    following = np.full(len(mesh.points), -1, dtype=np.int32)
    failed = follow_segments(mesh.boundary_edges, walls.edges, following, segment)
    if failed >= 0 or segment.min(initial=0) < 0:
        raise InputError("the boundary of the mesh does not follow the outlines of the domain before")
    return segment


@njit(cache=True, error_model="numpy")
def follow_segments(edges: Ints, walls: Ints, following: Ints, segment: Ints) -> int:
    """Walk along every outline segment over its wall edges and number them in `segment` (given: -1).

    `walls` (m, 2) holds the end nodes of the segments, the first nodes of the mesh; `following` (n,) is a buffer
    (given: -1), left with the wall edge that starts at each node. Returns the first segment without such a way, or -1.
    """
    for e in range(len(edges)):
        following[edges[e, 0]] = e
    for s in range(len(walls)):
        node = walls[s, 0]
        while True:
            e = following[node]
            if e < 0 or segment[e] >= 0:
                return s
            segment[e] = s
            node = edges[e, 1]
            if node == walls[s, 1]:
                break
            if node < len(walls):
                return s
    return -1


def follow_segments_plain(edges: NDArray[np.int32], walls: NDArray[np.int32]) -> NDArray[np.int32]:
    """Plain twin of `follow_segments`, for outlines that fit."""
    number = {(int(a), int(b)): e for e, (a, b) in enumerate(edges)}
    onward = {int(a): int(b) for a, b in edges}
    segment = np.full(len(edges), -1, dtype=np.int32)
    for s, (start, end) in enumerate(walls.tolist()):
        node = start
        while node != end:
            segment[number[node, onward[node]]] = s
            node = onward[node]
    return segment
