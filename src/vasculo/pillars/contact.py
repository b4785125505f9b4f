"""Contacts: the stretches of membrane that lie against a closed side, and the walls that end them."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import shapely

from vasculo.geometry.neighbours import as_polygons

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from numpy.typing import NDArray

    from vasculo.geometry.domain import Domain

SLACK = 1.1  # of the contact distance: membranes are held that far off the border, give or take rounding and resampling
ROUNDING = 1e-9  # of the length of the border: places nearer than this are one
AWAY = 1e-6  # of a wall: its end on the membrane does not count as a crossing


class Seal(NamedTuple):
    """A stretch of membrane with no fluid between it and a closed side.

    Parameters
    ----------
    pillar : int
    first, nodes : int
        First of its nodes, counter-clockwise, and their number; at least two.
    begin, end : float, model length
        Places on the border, along it from its node 0, to which the walls from the first and from the last node run.
    """

    pillar: int
    first: int
    nodes: int
    begin: float
    end: float


def rolled_outer(domain: Domain, openings: Collection[str]) -> tuple[NDArray[np.float64], tuple[str, ...]]:
    """Outer outline and its sides from the start of an opening on, so that no closed stretch runs over its end."""
    first = next(i for i, name in enumerate(domain.sides) if name in openings)
    return np.roll(domain.outer, -first, axis=0), (*domain.sides[first:], *domain.sides[:first])


def arc_lengths(outer: NDArray[np.float64]) -> NDArray[np.float64]:
    """Way along an outline to each node, and round to the first one again; (k + 1,) float64, model length."""
    step = np.roll(outer, -1, axis=0) - outer
    return np.concatenate(([0.0], np.cumsum(np.hypot(step[:, 0], step[:, 1]))))


def closed_stretches(sides: Sequence[str], openings: Collection[str]) -> list[tuple[int, int]]:
    """First segment of each closed stretch of the border and the one after its last."""
    closed = np.array([False, *(name not in openings for name in sides), False])
    change = np.flatnonzero(closed[1:] != closed[:-1])
    return [(int(first), int(last)) for first, last in change.reshape(-1, 2)]


def find_seals(
    pillars: Sequence[NDArray[np.float64]],
    outer: NDArray[np.float64],
    sides: Sequence[str],
    openings: Collection[str],
    contact: float,
    reach: float,
) -> list[Seal]:
    """Find where membranes touch the closed stretches of the border.

    Parameters
    ----------
    pillars : sequence of (k, 2) float64, model length
        Disjoint outlines, counter-clockwise.
    outer, sides
        Of the border, from the start of an opening on (`rolled_outer`).
    openings : collection of str
        Sides that are not closed.
    contact, reach : float, model length
        Distance at which a membrane touches; distance up to which the nodes beside the contact belong to it.

    Returns
    -------
    list of Seal
        In the order of their places on the border; no two share a side of a membrane or a piece of the border, and no
        wall of theirs crosses a pillar.
    """
    tree = shapely.STRtree(as_polygons(pillars))
    arc = arc_lengths(outer)
    found: list[tuple[float, Seal]] = []
    for first, last in closed_stretches(sides, openings):
        line = shapely.LineString(outer[np.arange(first, last + 1) % len(outer)])
        near = np.sort(tree.query(line, predicate="dwithin", distance=SLACK * contact))
        for pillar in near.tolist():
            for seal, distance in _contacts(pillar, pillars[pillar], line, contact, reach, tree):
                begin, end = seal.begin + arc[first], seal.end + arc[first]
                found.append((distance, seal._replace(begin=begin, end=end)))
    return _apart([seal for _, seal in sorted(found, key=lambda one: one[0])], pillars)


def _contacts(
    pillar: int,
    outline: NDArray[np.float64],
    line: shapely.LineString,
    contact: float,
    reach: float,
    tree: shapely.STRtree,
) -> list[tuple[Seal, float]]:
    """Seals between one membrane and one closed stretch, with the distance of each."""
    n = len(outline)
    nodes = shapely.points(outline)
    place = shapely.line_locate_point(line, nodes)
    away = shapely.distance(nodes, line)
    membrane = shapely.linestrings(np.stack((outline, np.roll(outline, -1, axis=0)), axis=1))
    across = shapely.distance(membrane, line)
    touches = away <= SLACK * contact
    # Where a corner of the border touches a side between its nodes, both of them count.
    between = (across <= SLACK * contact) & ~touches & ~np.roll(touches, -1)
    touches |= between | np.roll(between, 1)
    under = (away <= reach) | touches | np.roll(touches, 1) | np.roll(touches, -1)
    result = []
    for first, count in _runs(under, place):
        run = (first + np.arange(count)) % n
        core = np.flatnonzero(touches[run])
        if not len(core):
            continue
        # Strategy: from both ends of the run inwards to the first node whose way to the border is free.
        free = [not _is_crossed(outline[k], place[k], line, tree) for k in run]
        low = next((k for k in range(core[-1] + 1) if free[k]), count)
        high = next((k for k in range(count - 1, core[0] - 1, -1) if free[k]), -1)
        if low >= high:
            continue
        middle, half = 0.5 * (place[run[low]] + place[run[high]]), 0.5 * contact
        half = max(0.5 * float(place[run[high]] - place[run[low]]), half)
        begin, end = max(float(middle) - half, 0.0), min(float(middle) + half, line.length)
        nearest = float(across[run[low:high]].min())
        result.append((Seal(pillar, int(run[low]), high - low + 1, begin, end), nearest))
    return result


def _runs(under: NDArray[np.bool_], place: NDArray[np.float64]) -> list[tuple[int, int]]:
    """First node and number of nodes of each unbroken run of a closed ring, of two nodes at least."""
    n = len(under)
    if under.all():
        first, last = int(np.argmin(place)), int(np.argmax(place))
        return [(first, (last - first) % n + 1)] if first != last else []
    starts = np.flatnonzero(under & ~np.roll(under, 1))
    ends = np.flatnonzero(under & ~np.roll(under, -1))
    counts = [(int(ends[np.searchsorted(ends, start) % len(ends)]) - int(start)) % n + 1 for start in starts]
    return [(int(start), count) for start, count in zip(starts, counts, strict=True) if count > 1]


def _is_crossed(
    node: NDArray[np.float64],
    place: float,
    line: shapely.LineString,
    tree: shapely.STRtree,
) -> bool:
    """Whether a pillar lies on the straight way from a node of a membrane to its nearest place on the border."""
    foot = np.array(shapely.line_interpolate_point(line, place).coords[0])
    way = shapely.LineString([node + AWAY * (foot - node), foot])
    return bool(tree.query(way, predicate="intersects").size)


def _apart(seals: Sequence[Seal], pillars: Sequence[NDArray[np.float64]]) -> list[Seal]:
    """Leave out seals, given nearest first, whose piece of the border is taken; a side of a membrane goes to one."""
    kept: list[Seal] = []
    taken: dict[int, NDArray[np.bool_]] = {}
    for seal in seals:
        if any(seal.begin < other.end and other.begin < seal.end for other in kept):
            continue
        n = len(pillars[seal.pillar])
        used = taken.setdefault(seal.pillar, np.zeros(n, dtype=np.bool_))
        nodes = [k % n for k in range(seal.first, seal.first + seal.nodes - 1)]
        while nodes and used[nodes[0]]:
            del nodes[0]
        while nodes and used[nodes[-1]]:
            del nodes[-1]
        if nodes and not used[nodes].any():
            used[nodes] = True
            kept.append(seal._replace(first=nodes[0], nodes=len(nodes) + 1))
    return sorted(kept, key=lambda seal: seal.begin)
