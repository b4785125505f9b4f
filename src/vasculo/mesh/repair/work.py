"""A mesh under repair: its arrays, with room for more, and how they become a triangulation again."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numba import njit

from vasculo.mesh.repair.edit import DEAD
from vasculo.mesh.repair.match import wall_segments

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.geometry.arrays import Ints
    from vasculo.mesh.repair.match import Match
    from vasculo.mesh.triangulation import Triangulation
    from vasculo.mesh.walls import Walls

INNER = -1
"""`Work.wall` of a node that is on no wall."""


@dataclass(slots=True, eq=False)
class Work:
    """Arrays that the steps of a repair overwrite or replace.

    Parameters
    ----------
    points : (n, 2) float64, model length
    wall : (n,) int32
        `INNER`; s >= 0: a cut on outline segment s; -2 - c: outline node c.
    origin : (n,) int32
        Node of the old mesh, -1 for a new one.
    triangles : (t, 3) int32
        Counter-clockwise; the first corner of one that is gone is `DEAD`.
    neighbours : (t, 3) int32
        Triangle across the edge opposite to each corner; -1 - s on outline segment s.
    slot : (t,) int32
        Triangle of the old mesh in whose place this one stands, -1 for a new one.
    """

    points: NDArray[np.float64]
    wall: NDArray[np.int32]
    origin: NDArray[np.int32]
    triangles: NDArray[np.int32]
    neighbours: NDArray[np.int32]
    slot: NDArray[np.int32]


def work_on(mesh: Triangulation, before: Walls, after: Walls, match: Match) -> tuple[Work, NDArray[np.float64]]:
    """Take up a mesh of the domain before, with the walls of the domain after as far as they go on.

    Parameters
    ----------
    mesh : Triangulation
    before, after : Walls
    match : Match

    Returns
    -------
    work : Work
        At the places before. Outlines that do not go on have inner nodes and edges on a segment that does not exist.
    places : (n, 2) float64, model length
        Where the nodes belong: wall nodes on the outlines after, all others as they are.
    """
    edges = mesh.boundary_edges
    old = wall_segments(mesh, before)
    new = match.nodes[old]
    goes_on = new >= 0
    places = mesh.points.copy()
    wall = np.full(len(places), INNER, dtype=np.int32)
    # Strategy: a cut keeps its share of the way along its segment.
    start, cut = edges[:, 0], goes_on & (edges[:, 0] >= len(before.nodes))
    node, segment, target = start[cut], before.segments[old[cut]], after.segments[new[cut]]
    way = segment[:, 2:] - segment[:, :2]
    share = ((mesh.points[node] - segment[:, :2]) * way).sum(axis=1) / (way**2).sum(axis=1)
    places[node] = target[:, :2] + share[:, None] * (target[:, 2:] - target[:, :2])
    wall[node] = new[cut]
    kept = np.flatnonzero(match.nodes >= 0)
    places[kept] = after.nodes[match.nodes[kept]]
    wall[kept] = -2 - match.nodes[kept]
    code = np.where(goes_on, new, len(after.edges)).astype(np.int32)
    neighbours = mesh.neighbours.copy()
    following = np.full(len(places), -1, dtype=np.int32)
    following[start] = np.arange(len(start), dtype=np.int32)
    number_walls(mesh.triangles, neighbours, following, code)
    count = len(mesh.triangles)
    origin, slot = np.arange(len(places), dtype=np.int32), np.arange(count, dtype=np.int32)
    return Work(mesh.points.copy(), wall, origin, mesh.triangles.copy(), neighbours, slot), places


@njit(cache=True, error_model="numpy")
def number_walls(triangles: Ints, neighbours: Ints, following: Ints, segment: Ints) -> None:
    """Put -1 - segment into `neighbours` at the walls; `following` gives the wall edge that starts at each node."""
    for t in range(len(triangles)):
        for c in range(3):
            if neighbours[t, c] < 0:
                neighbours[t, c] = -1 - segment[following[triangles[t, (c + 1) % 3]]]


def pack(work: Work, corners: int) -> NDArray[np.int32]:
    """Drop triangles that are gone and nodes without triangles, outline nodes first; overwrites the work.

    Parameters
    ----------
    work : Work
    corners : int
        Number of outline nodes, all of them in the work; they get their own numbers.

    Returns
    -------
    (n,) int32
        Old number of each node that is left.
    """
    number = np.full(len(work.points), -1, dtype=np.int32)
    place = np.full(len(work.triangles), -1, dtype=np.int32)
    nodes, count = number_anew(work.triangles, work.wall, corners, number, place)
    used = np.flatnonzero(number >= 0)
    source = np.empty(nodes, dtype=np.int32)
    source[number[used]] = used
    work.points, work.wall, work.origin = work.points[source], work.wall[source], work.origin[source]
    triangles, neighbours = np.empty((count, 3), dtype=np.int32), np.empty((count, 3), dtype=np.int32)
    bring_together(work.triangles, work.neighbours, number, place, triangles, neighbours)
    work.triangles, work.neighbours, work.slot = triangles, neighbours, work.slot[place >= 0]
    return source


@njit(cache=True, error_model="numpy")
def number_anew(triangles: Ints, wall: Ints, corners: int, number: Ints, place: Ints) -> tuple[int, int]:
    """Give nodes and triangles new numbers (given: -1); how many there are."""
    for t in range(len(triangles)):
        if triangles[t, 0] != DEAD:
            for c in range(3):
                number[triangles[t, c]] = 0
    nodes = corners
    for i in range(len(number)):
        if number[i] == 0:
            if wall[i] <= -2:
                number[i] = -2 - wall[i]
            else:
                number[i] = nodes
                nodes += 1
    count = 0
    for t in range(len(triangles)):
        if triangles[t, 0] != DEAD:
            place[t] = count
            count += 1
    return nodes, count


@njit(cache=True, error_model="numpy")
def bring_together(
    triangles: Ints, neighbours: Ints, number: Ints, place: Ints, packed: Ints, packed_neighbours: Ints
) -> None:
    """Copy the triangles that have a place, with new numbers, into the last two arrays."""
    for t in range(len(triangles)):
        p = place[t]
        if p < 0:
            continue
        for c in range(3):
            packed[p, c] = number[triangles[t, c]]
            u = neighbours[t, c]
            packed_neighbours[p, c] = place[u] if u >= 0 else u


def wall_edges(work: Work) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Wall edges (b, 2), fluid on the left, and the outline segment of each (b,)."""
    edges = np.empty((len(work.points), 2), dtype=np.int32)
    segment = np.empty(len(work.points), dtype=np.int32)
    count = list_walls(work.triangles, work.neighbours, edges, segment)
    return edges[:count], segment[:count]


@njit(cache=True, error_model="numpy")
def list_walls(triangles: Ints, neighbours: Ints, edges: Ints, segment: Ints) -> int:
    """Wall edges and their outline segments into `edges` and `segment`, as far as there is room; how many there are."""
    count = 0
    for t in range(len(triangles)):
        for c in range(3):
            if neighbours[t, c] < 0:
                if count < len(edges):
                    edges[count, 0] = triangles[t, (c + 1) % 3]
                    edges[count, 1] = triangles[t, (c + 2) % 3]
                    segment[count] = -1 - neighbours[t, c]
                count += 1
    return count


@njit(cache=True, error_model="numpy")
def find_same(triangles: Ints, origin: Ints, slot: Ints, old: Ints, same: Ints) -> None:
    """Old triangle with the same three nodes, where a triangle stands in its place, into `same` (t,), given: -1."""
    for t in range(len(triangles)):
        if slot[t] < 0:
            continue
        for k in range(3):
            if (
                origin[triangles[t, 0]] == old[slot[t], k]
                and origin[triangles[t, 1]] == old[slot[t], (k + 1) % 3]
                and origin[triangles[t, 2]] == old[slot[t], (k + 2) % 3]
            ):
                same[t] = slot[t]
