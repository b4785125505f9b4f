"""Test rays from the centres of the voids to the nearest springs (Szczerba & Szekely 2005, section 3).

The paper's way to the polygons, whole: rays from the centre of a cluster, a search for the nearest spring on each, and
an inspection of the connections between the springs that were met. It uses deformed positions and living springs only,
so it checks the outlines that come from the topology of the initial triangulation.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import shapely
from numba import njit

from vasculo.geometry.neighbours import as_polygons
from vasculo.plexus.outlines import repaired
from vasculo.plexus.raycast import ray_directions, ray_distances
from vasculo.plexus.voids import join

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from vasculo.geometry.arrays import Flags, Floats, Ints, Longs

SHORT_PATH = 3
"""A path of at most this many springs between two springs that were met is short."""
LONGEST_PATH = 64
"""Longer paths than this are not walked: the void counts as open."""


@dataclass(frozen=True)
class RayOutlines:
    """Node loops that the rays found, end to end.

    Attributes
    ----------
    nodes : ndarray of int32, shape (k,)
        Nodes of the loop around each centre, counter-clockwise; of an open one the nodes of the springs that were met.
        Nodes joined by a spring of no length are one, the lowest.
    start : ndarray of int64, shape (c + 1,)
        Loop i is the rows start[i] to start[i + 1].
    closed : ndarray of bool, shape (c,)
        Whether the loop closes.
    links : ndarray of int32, shape (c, 3)
        Connections of a closed loop: from a spring that was met straight to the next one around the void; by a short
        path; by a longer path.
    distances, hits : ndarray of float64 and int32, shape (c, rays)
        See `vasculo.plexus.raycast.ray_distances`.
    same_as : ndarray of int32, shape (n,)
        The node that stands for each node.
    """

    nodes: Ints
    start: Longs
    closed: Flags
    links: Ints
    distances: Floats
    hits: Ints
    same_as: Ints

    def same_nodes(self, loops: Sequence[Ints]) -> Flags:
        """Whether each loop (c,) is closed and has exactly the nodes of the given one."""
        mine = np.split(self.nodes, self.start[1:-1])
        pairs = zip(self.closed.tolist(), mine, loops, strict=True)
        return np.array([ok and set(one.tolist()) == set(self.same_as[two].tolist()) for ok, one, two in pairs])


def ray_outlines(
    points: Floats, springs: Ints, centres: Floats, rays: int = 64, longest: int = LONGEST_PATH
) -> RayOutlines:
    """Find the loop of springs around each centre by rays, as the paper does.

    Each ray finds the nearest spring. From a spring that was met the walk goes on around the void, at each node to the
    next spring clockwise, so that the void stays on the left, until it comes to another spring that was met. A spring
    seen twice in turn, once from each side, dangles and is left out. A loop around an island in the void is dropped.

    Parameters
    ----------
    points : ndarray of float64, shape (n, 2)
        Node positions (model length).
    springs : ndarray of int32, shape (m, 2)
        Living springs.
    centres : ndarray of float64, shape (c, 2)
        Where the rays start (model length).
    rays : int
        Rays a centre.
    longest : int
        Most springs on the way from one spring that was met to the next; a longer gap is left open.

    Returns
    -------
    RayOutlines

    Raises
    ------
    InputError
        When there are fewer than 3 rays.
    """
    distances, hits = ray_distances(points, springs, centres, rays)
    arms = points[springs[:, 1]] - points[springs[:, 0]]
    same_as = np.empty(len(points), dtype=np.int32)
    join(springs[:, 0], springs[:, 1], arms.any(axis=1), same_as)
    same_as = np.unique(same_as, return_index=True)[1].astype(np.int32)[same_as]
    merged = same_as[springs]
    row, half = _half_edges(merged, len(points))
    nodes, start, closed, links = _inspect(points, merged, row, half, centres, hits, longest)
    return RayOutlines(nodes, start, closed, links, distances, hits, same_as)


def ray_agreement(points: Floats, springs: Ints, outlines: Sequence[Floats], rays: int = 64) -> Floats:
    """Overlap of each outline with the polygon that the rays find from its centre.

    The centre is the centroid, or a point well inside where the centroid lies outside. The polygon is the loop of
    `ray_outlines`; of a loop that stays open, the points where the rays met springs.

    Parameters
    ----------
    points : ndarray of float64, shape (n, 2)
        Node positions (model length).
    springs : ndarray of int32, shape (m, 2)
        Living springs.
    outlines : sequence of ndarray of float64, shape (k_i, 2)
        Outlines from the topology (model length).
    rays : int
        Rays an outline.

    Returns
    -------
    agreement : ndarray of float64, shape (v,)
        Area of the intersection over area of the union, dimensionless; 1 where both agree.
    """
    polygons = mended(outlines)
    centres = void_centres(polygons)
    found = ray_outlines(points, springs, centres, rays)
    met = np.where(np.isfinite(found.distances), found.distances, 0.0)
    stars = centres[:, None] + met[..., None] * ray_directions(rays)
    loops = np.split(points[found.nodes], found.start[1:-1])
    seen = mended([loop if ok else star for loop, star, ok in zip(loops, stars, found.closed, strict=True)])
    shared = shapely.area(shapely.intersection(seen, polygons))
    union = shapely.area(seen) + shapely.area(polygons) - shared
    return np.divide(shared, union, out=np.zeros(len(polygons)), where=union > 0.0)


def void_centres(polygons: NDArray[np.object_]) -> Floats:
    """Centroid (v, 2) of each polygon, or a point well inside where the centroid is not; the origin if it is empty."""
    centres = np.asarray(shapely.centroid(polygons), dtype=object)
    outside = ~shapely.is_empty(polygons) & ~shapely.contains(polygons, centres)
    centres[outside] = shapely.point_on_surface(polygons[outside])
    return np.nan_to_num(np.stack([shapely.get_x(centres), shapely.get_y(centres)], axis=1))


def mended(outlines: Sequence[Floats]) -> NDArray[np.object_]:
    """Make valid polygons (v,) of outlines that may touch or cross themselves, as `repaired` does."""
    result = np.empty(len(outlines), dtype=object)
    long = np.array([len(outline) >= 3 for outline in outlines], dtype=np.bool_)
    result[long] = as_polygons([outlines[index] for index in np.flatnonzero(long).tolist()])
    result[~long] = shapely.Polygon()
    for index in np.flatnonzero(~shapely.is_valid(result)).tolist():
        result[index] = repaired(outlines[index])[0]
    return result


@njit(cache=True, error_model="numpy")
def _half_edges(springs, nodes):  # type: ignore[no-untyped-def]
    """Half-edges that leave each node: node i has the rows row[i] to row[i + 1] of half; merged springs have none.

    Half-edge 2 s + k of spring s runs from its end k to its other end.
    """
    row = np.zeros(nodes + 1, dtype=np.int32)
    for s in range(springs.shape[0]):
        if springs[s, 0] != springs[s, 1]:
            row[springs[s, 0] + 1] += 1
            row[springs[s, 1] + 1] += 1
    for node in range(nodes):
        row[node + 1] += row[node]
    place, half = row[:-1].copy(), np.empty(row[-1], dtype=np.int32)
    for s in range(springs.shape[0]):
        if springs[s, 0] != springs[s, 1]:
            for k in range(2):
                half[place[springs[s, k]]] = 2 * s + k
                place[springs[s, k]] += 1
    return row, half


@njit(cache=True, error_model="numpy")
def _turn_on(points, springs, row, half, edge):  # type: ignore[no-untyped-def]
    """Next half-edge around the face on the left of a half-edge: the first one clockwise from the way back."""
    tail, node = springs[edge // 2, edge % 2], springs[edge // 2, 1 - edge % 2]
    x, y = points[tail, 0] - points[node, 0], points[tail, 1] - points[node, 1]
    best, least = edge ^ 1, np.inf
    for entry in range(row[node], row[node + 1]):
        other = half[entry]
        if other == edge ^ 1:
            continue
        head = springs[other // 2, 1 - other % 2]
        ax, ay = points[head, 0] - points[node, 0], points[head, 1] - points[node, 1]
        along, across = x * ax + y * ay, y * ax - x * ay
        share = along / (abs(along) + abs(across))
        # Grows from 0 to 4 with the clockwise angle; an arm that lies on the way back is reached last.
        turn = 1.0 - share if across > 0.0 else 3.0 + share
        if turn < least:
            best, least = other, turn
    return best


@njit(cache=True, error_model="numpy")
def _without_spikes(loop, count):  # type: ignore[no-untyped-def]
    """Take out of a closed loop what goes to and fro, in place; returns first and last row of what is left."""
    kept = 0
    for entry in range(count):
        if kept and loop[kept - 1] == loop[entry] ^ 1:
            kept -= 1
        else:
            loop[kept] = loop[entry]
            kept += 1
    first = 0
    while kept - first > 1 and loop[first] == loop[kept - 1] ^ 1:
        first, kept = first + 1, kept - 1
    return first, kept


@njit(cache=True, error_model="numpy")
def _inspect(points, springs, row, half, centres, hits, longest):  # type: ignore[no-untyped-def]
    """Loops around the centres: nodes, start, closed and links of `RayOutlines`.

    Strategy: mark the springs that the rays of one centre met, on the side that faces it; walk from one to the next. A
    loop that closes and is counter-clockwise is the void's; one that is clockwise goes around an island, so that the
    walk starts again at the next spring that no walk has passed.
    """
    count, rays = hits.shape
    seen_by = np.full(2 * springs.shape[0], -1, dtype=np.int32)
    passed_by = np.full(2 * springs.shape[0], -1, dtype=np.int32)
    loop = np.empty(2 * springs.shape[0] + 1, dtype=np.int32)
    met = np.empty(rays, dtype=np.int32)
    nodes, rows = np.empty(64 * count + 64, dtype=np.int32), 0
    start = np.zeros(count + 1, dtype=np.int64)
    closed, links = np.zeros(count, dtype=np.bool_), np.zeros((count, 3), dtype=np.int32)
    for c in range(count):
        many = 0
        for k in range(rays):
            s = hits[c, k]
            if s < 0 or springs[s, 0] == springs[s, 1]:
                continue
            p, q = springs[s, 0], springs[s, 1]
            left = (points[q, 0] - points[p, 0]) * (centres[c, 1] - points[p, 1]) - (points[q, 1] - points[p, 1]) * (
                centres[c, 0] - points[p, 0]
            )
            edge = 2 * s if left > 0.0 else 2 * s + 1
            if left != 0.0 and seen_by[edge] != c:
                seen_by[edge] = c
                met[many] = edge
                many += 1
        first, last = 0, 0
        for attempt in range(many):
            if passed_by[met[attempt]] == c:
                continue
            size, gap, edge = 0, 0, met[attempt]
            kinds = np.zeros(3, dtype=np.int32)
            while True:
                loop[size] = edge
                size += 1
                edge = _turn_on(points, springs, row, half, edge)
                if seen_by[edge] == c:
                    passed_by[edge] = c
                    kinds[0 if gap == 0 else 1 if gap <= SHORT_PATH else 2] += 1
                    gap = 0
                    if edge == met[attempt]:
                        break
                else:
                    gap += 1
                    if gap > longest or size == loop.size:
                        break
            if edge != met[attempt]:
                continue
            first, last = _without_spikes(loop, size)
            area = 0.0
            for entry in range(first, last):
                p, q = springs[loop[entry] // 2, loop[entry] % 2], springs[loop[entry] // 2, 1 - loop[entry] % 2]
                px, py = points[p, 0] - centres[c, 0], points[p, 1] - centres[c, 1]
                area += px * (points[q, 1] - centres[c, 1]) - py * (points[q, 0] - centres[c, 0])
            if area > 0.0 and last - first > 2:
                closed[c] = True
                links[c] = kinds
                break
        if not closed[c]:
            first, last = 0, many
            loop[:many] = met[:many]
        while rows + last - first > nodes.size:
            nodes = np.concatenate((nodes, np.empty_like(nodes)))
        for entry in range(first, last):
            nodes[rows] = springs[loop[entry] // 2, loop[entry] % 2]
            rows += 1
        start[c + 1] = rows
    return nodes[:rows], start, closed, links
