"""The fluid that is left when some pillars have joined the border: its parts, each inside one outline."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import shapely

from vasculo.pillars.cell import stack
from vasculo.pillars.contact import ROUNDING, arc_lengths

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from numpy.typing import NDArray

    from vasculo.geometry.domain import Domain
    from vasculo.pillars.contact import Seal

_END, _NODE, _BEGIN = 0, 1, 2  # of a seal, of the border, of a seal: the order of those at one place


class FluidPart(NamedTuple):
    """One connected part of the fluid.

    Parameters
    ----------
    outline : (k, 2) float64, model length
        Its outer outline: pieces of the border, of membranes, and the walls between them; counter-clockwise.
    tags : (k,) int32
        Of the segment after each node: the pillar, or -1 - j for side j of the domain.
    pillars : (q,) int64
        Pillars inside it.
    open_sides : (m,) int64
        Membrane sides on its outline, by their first nodes.
    is_through : bool
        It touches all openings.
    """

    outline: NDArray[np.float64]
    tags: NDArray[np.int32]
    pillars: NDArray[np.int64]
    open_sides: NDArray[np.int64]
    is_through: bool


def fluid_parts(
    domain: Domain,
    outer: NDArray[np.float64],
    sides: Sequence[str],
    openings: Collection[str],
    seals: Sequence[Seal],
) -> list[FluidPart]:
    """Trace the outlines of the fluid between sealed membranes.

    Parameters
    ----------
    domain : Domain
    outer, sides, openings, seals
        As in `find_seals` and from it; at least one seal.

    Returns
    -------
    list of FluidPart
        Those that touch an opening or have pillars inside.
    """
    points, starts = stack(domain.pillars)
    after, tag, place, corner = _successors(points, starts, outer, sides, seals, domain.side_names)
    joined = {seal.pillar for seal in seals}
    free = np.array([k for k in range(len(domain.pillars)) if k not in joined], dtype=np.int64)
    probes = shapely.points(np.array([domain.pillars[k][0] for k in free]).reshape(-1, 2))
    doors = {-1 - domain.side_names.index(name) for name in openings}
    parts = []
    seen = np.zeros(len(after), dtype=np.bool_)
    for start in place:
        loop = []
        while not seen[start]:
            seen[start] = True
            loop.append(start)
            start = after[start]  # noqa: PLW2901
        if not loop:
            continue
        nodes = np.array(loop)
        outline, tags = corner[nodes], tag[nodes]
        step = np.abs(np.roll(outline, -1, axis=0) - outline).max(axis=1)
        real = step > ROUNDING * np.ptp(outer, axis=0).max()
        outline, tags, nodes = outline[real], tags[real], nodes[real]
        found = doors & set(tags.tolist())
        if len(outline) < 3:
            continue
        inside = free[shapely.contains(shapely.Polygon(outline), probes)] if len(free) else free
        if found or len(inside):
            on_membrane = (nodes < len(points)) & (after[nodes] < len(points))
            parts.append(FluidPart(outline, tags, inside, after[nodes[on_membrane]], found == doors))
    return parts


def _successors(
    points: NDArray[np.float64],
    starts: NDArray[np.int32],
    outer: NDArray[np.float64],
    sides: Sequence[str],
    seals: Sequence[Seal],
    names: tuple[str, ...],
) -> tuple[NDArray[np.int64], NDArray[np.int32], NDArray[np.int64], NDArray[np.float64]]:
    """Next node after each one on the outlines of the fluid, and the tag of the segment to it.

    The nodes are those of the membranes, then the nodes and the ends of seals on the border. Also returns those on the
    border that belong to the fluid, and the coordinates of all.
    """
    # Strategy: with the fluid on the left the border is walked forwards and a membrane backwards. A seal leads from the
    # border to the first node of its stretch, and from the last node back.
    n = len(points)
    owner = np.repeat(np.arange(len(starts) - 1, dtype=np.int32), np.diff(starts))
    arc = arc_lengths(outer)
    stops = [(float(s), _NODE, k) for k, s in enumerate(arc[:-1])]
    for k, seal in enumerate(seals):
        stops += [(_settled(seal.begin, arc), _BEGIN, k), (_settled(seal.end, arc), _END, k)]
    stops.sort()
    total = n + len(stops)
    after = np.empty(total, dtype=np.int64)
    after[:n] = np.arange(n) - 1
    after[starts[:-1]] = starts[1:] - 1
    tag = np.empty(total, dtype=np.int32)
    tag[:n] = owner
    corner = np.concatenate((points, _at([s for s, *_ in stops], outer, arc)))
    side = np.array([-1 - names.index(name) for name in sides], dtype=np.int32)
    fluid, open_stretch, last = [], True, -1
    for k, (s, kind, which) in enumerate(stops):
        here = n + k
        if kind == _END:
            seal = seals[which]
            node = starts[seal.pillar] + (seal.first + seal.nodes - 1) % (starts[seal.pillar + 1] - starts[seal.pillar])
            after[node] = here
            open_stretch, last = True, -1
        if not open_stretch:
            continue
        if last >= 0:
            after[last] = here
        fluid.append(here)
        last = here
        tag[here] = side[min(int(np.searchsorted(arc, s, side="right")) - 1, len(side) - 1)]
        if kind == _BEGIN:
            seal = seals[which]
            after[here] = starts[seal.pillar] + seal.first
            tag[here] = seal.pillar
            open_stretch = False
    after[last] = n
    return after, tag, np.array(fluid), corner


def _settled(place: float, arc: NDArray[np.float64]) -> float:
    """Move a place on the border onto a node where it is one but for rounding."""
    nearest = float(arc[np.argmin(np.abs(arc - place))])
    return nearest if abs(nearest - place) <= ROUNDING * arc[-1] else place


def _at(places: Sequence[float], outer: NDArray[np.float64], arc: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points at places along the border; (m, 2) float64, model length."""
    closed = np.concatenate((outer, outer[:1]))
    return np.column_stack((np.interp(places, arc, closed[:, 0]), np.interp(places, arc, closed[:, 1])))
