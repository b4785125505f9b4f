"""The walls of a domain as one list of directed segments."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.geometry.domain import Domain


@dataclass(frozen=True, eq=False)
class Walls:
    """Segments of all outlines, directed with the fluid on the left.

    Parameters
    ----------
    nodes : (n, 2) float64, model length
        Nodes of the outlines: the pillars in their order, then the outer outline, each as it stands in the domain.
    edges : (n, 2) int32
        Start and end node of each segment; a pillar's outline is walked backwards.
    body : (n,) int32
        Pillar index; the number of pillars for the outer outline.
    tags : (n,) int32
        Tag of each segment as in `Triangulation`.
    arc : (n,) float64, model length
        Place of the segment's start along its outline, in walking order.
    lengths : (n,) float64, model length
        Length of each segment.
    around : (n,) float64, model length
        Length of the whole outline that the segment belongs to.
    """

    nodes: NDArray[np.float64]
    edges: NDArray[np.int32]
    body: NDArray[np.int32]
    tags: NDArray[np.int32]
    arc: NDArray[np.float64]
    lengths: NDArray[np.float64]
    around: NDArray[np.float64]

    @cached_property
    def facts(self) -> NDArray[np.float64]:
        """Arc, length and length of the outline of each segment, side by side; (n, 3) float64, model length."""
        return np.column_stack((self.arc, self.lengths, self.around))

    @cached_property
    def segments(self) -> NDArray[np.float64]:
        """Start and end coordinates; (n, 4) float64, model length."""
        return np.column_stack((self.nodes[self.edges[:, 0]], self.nodes[self.edges[:, 1]]))


def walls_of(domain: Domain) -> Walls:
    """List the segments of a domain's outlines; the segments of one outline follow each other."""
    outlines = [*domain.pillars, domain.outer]
    counts = np.array([len(outline) for outline in outlines])
    first = np.concatenate(([0], np.cumsum(counts)))
    total = int(first[-1])
    nodes = np.concatenate(outlines)
    body = np.repeat(np.arange(len(outlines), dtype=np.int32), counts)
    # Strategy: outer segments run i -> i + 1; pillar segments run backwards, so walking order is last node first.
    place = np.arange(total) - first[body]
    outer = body == len(outlines) - 1
    start = np.where(outer, place, (counts[body] - place) % counts[body])
    end = np.where(outer, (place + 1) % counts[body], counts[body] - 1 - place)
    edges = np.column_stack((first[body] + start, first[body] + end)).astype(np.int32)
    step = nodes[edges[:, 1]] - nodes[edges[:, 0]]
    lengths = np.hypot(step[:, 0], step[:, 1])
    summed = np.concatenate(([0.0], np.cumsum(lengths)))
    around = summed[first[1:]] - summed[first[:-1]]
    names = {name: -1 - j for j, name in enumerate(domain.side_names)}
    tags = body.copy()
    tags[outer] = [names[name] for name in domain.sides]
    return Walls(nodes, edges, body, tags, summed[:-1] - summed[first[body]], lengths, around[body])
