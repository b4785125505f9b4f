"""Hand-made networks with every degenerate case, the rule for each, and the voids that the rule leaves.

Each is a unit lattice of 10 by 8 squares with a diagonal each, from which springs are torn and whose nodes are moved.
The void outlines are written down by hand, so that nothing of the extraction enters what is expected of it.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
import shapely

from vasculo.springs.network import SpringNetwork

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Node = tuple[int, int]
    Place = tuple[float, float]

COLUMNS, ROWS = 10, 8


@dataclass(frozen=True)
class Case:
    """One degenerate case.

    Parameters
    ----------
    name, rule : str
        What it is, and what is done about it.
    holes : tuple of shapely.Polygon
        All springs whose middles lie inside one are torn.
    voids : tuple of shapely.Polygon
        Outlines of which pillars are made, as the rule says; the larger first where two overlap.
    kept : tuple of paths
        Springs along these paths of lattice nodes stay.
    moved : dict
        Where lattice nodes are moved after tearing.
    counts : dict
        What the report counts.
    refused : str
        Words of the refusal, if that is the rule.
    """

    name: str
    rule: str
    holes: tuple[shapely.Polygon, ...]
    voids: tuple[shapely.Polygon, ...] = ()
    kept: tuple[tuple[Node, ...], ...] = ()
    moved: dict[Node, Place] = field(default_factory=dict)
    counts: dict[str, int] = field(default_factory=dict)
    refused: str = ""

    def network(self, triangles: bool = True) -> SpringNetwork:
        """Make the network, with its initial triangulation or without."""
        points, corners, edges = lattice_of_squares()
        middle = shapely.points(points[edges].mean(axis=1))
        torn = np.zeros(len(edges), dtype=bool)
        for hole in self.holes:
            torn |= shapely.contains_properly(hole, middle)
        kept = {tuple(sorted((number(p), number(q)))) for path in self.kept for p, q in pairwise(path)}
        torn &= np.array([tuple(edge) not in kept for edge in edges.tolist()])
        network = SpringNetwork(points, edges[~torn], triangles=corners if triangles else None)
        for node, place in self.moved.items():
            network.points[number(node)] = place
        return network


def number(node: Node) -> int:
    """Index of a lattice node."""
    return node[0] + (COLUMNS + 1) * node[1]


def lattice_of_squares() -> tuple[NDArray[np.float64], NDArray[np.int32], NDArray[np.int32]]:
    """Points, triangles and edges of the lattice."""
    x, y = np.meshgrid(np.arange(COLUMNS + 1.0), np.arange(ROWS + 1.0))
    a = np.array([number((x, y)) for y in range(ROWS) for x in range(COLUMNS)])
    b, c, d = a + 1, a + COLUMNS + 2, a + COLUMNS + 1
    triangles = np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)]).astype(np.int32)
    pairs = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    return np.stack([x.ravel(), y.ravel()], axis=1), triangles, np.unique(pairs, axis=0).astype(np.int32)


def _ring(x0: int, y0: int, x1: int, y1: int) -> tuple[Node, ...]:
    """Lattice nodes around a rectangle, closed."""
    way = [(x, y0) for x in range(x0, x1)] + [(x1, y) for y in range(y0, y1)]
    way += [(x, y1) for x in range(x1, x0, -1)] + [(x0, y) for y in range(y1, y0 - 1, -1)]
    return tuple(way)


def _row(x0: int, x1: int, y: int) -> tuple[Node, ...]:
    """Lattice nodes along a row."""
    return tuple((x, y) for x in range(x0, x1 + 1))


BOX, WIDE, LARGE = shapely.box(2, 2, 8, 6), shapely.box(1, 2, 9, 6), shapely.box(1, 1, 9, 7)
LEFT_LOBE = shapely.Polygon([(1, 2), (5, 2), (6, 4), (5, 6), (1, 6)])
CROSSED_LOBE = shapely.Polygon([(1, 2), (5, 2), (5 + 5 / 6, 4), (5, 6), (1, 6)])
SPIKED = shapely.Polygon([(2, 2), (8, 2), (8, 6), (2, 6), (2, 5), (0.4, 4), (2, 3)])
OVERLAPPING = (
    shapely.Polygon([(1, 2), (5, 2), (6.3, 3), (6.3, 5), (5, 6), (1, 6)]),
    shapely.Polygon([(9, 2), (9, 6), (6, 6), (4.9, 5), (4.9, 3), (6, 2)]),
)
ALL = shapely.box(-1, -1, COLUMNS + 1, ROWS + 1)

SPRINGS = (
    Case(
        "Springs of no length",
        "Read from the initial triangles, not from positions: nothing changes.",
        (BOX,),
        (BOX,),
        moved={(2, 4): (2, 5), (8, 4): (8, 3), (5, 2): (6, 2)},
        counts={"short_springs": 3, "coincident_nodes": 6},
    ),
    Case(
        "Nodes in one place",
        "Nodes that no spring joins stay two nodes, wherever they lie.",
        (BOX,),
        (BOX,),
        moved={(1, 5): (2, 4), (9, 3): (8, 4)},
        counts={"short_springs": 0, "coincident_nodes": 4},
    ),
    Case(
        "A node pushed through its cord",
        "Springs cross, triangles fold; the outline follows, its thin spike is rounded off.",
        (BOX,),
        (SPIKED,),
        moved={(2, 4): (0.4, 4)},
        counts={"invalid_outlines": 0},
    ),
    Case(
        "A loose node thrown out",
        "Folded triangles in the void count negative: its area stays.",
        (BOX,),
        (BOX,),
        moved={(5, 4): (9.4, 4.4)},
        counts={"folded_voids": 1},
    ),
    Case(
        "Uneven nodes",
        "The pillar gets new nodes at even distances.",
        (BOX,),
        (BOX,),
        moved={(3, 2): (2.1, 2), (4, 2): (2.2, 2), (5, 2): (2.3, 2), (6, 6): (7.8, 6), (5, 6): (7.6, 6)},
    ),
    Case(
        "A dangling cord",
        "The same void lies on both sides: no part of the outline.",
        (BOX,),
        (BOX,),
        kept=((*_row(2, 5, 4), (6, 5)),),
        counts={"dangling_springs": 4, "second_loops": 0},
    ),
    Case(
        "An outline that crosses itself",
        "The largest lobe stays.",
        (WIDE,),
        (CROSSED_LOBE,),
        moved={(6, 2): (6, 4.4), (6, 6): (6, 3.6)},
        counts={"invalid_outlines": 1},
    ),
    Case(
        "Touching itself at a node",
        "A figure eight: the largest lobe stays.",
        (WIDE,),
        (LEFT_LOBE,),
        moved={(6, 2): (6, 4), (6, 6): (6, 4)},
        counts={"invalid_outlines": 1, "coincident_nodes": 2},
    ),
    Case(
        "Touching itself along a spring",
        "The largest lobe stays.",
        (WIDE,),
        (LEFT_LOBE,),
        moved={(6, 2): (6, 4), (7, 2): (7, 4), (6, 6): (6, 4), (7, 6): (7, 4)},
        counts={"invalid_outlines": 1, "coincident_nodes": 4},
    ),
    Case(
        "A flap on one node",
        "The outline visits the node twice; the flap is filled up.",
        (BOX,),
        (BOX,),
        kept=(((2, 4), (3, 4), (3, 5), (2, 4)),),
        counts={"touching_outlines": 1, "invalid_outlines": 1},
    ),
    Case(
        "Two voids, one node between",
        "Two pillars, a tubule apart.",
        (shapely.box(1, 1, 5, 4), shapely.box(5, 4, 9, 7)),
        (shapely.box(1, 1, 5, 4), shapely.box(5, 4, 9, 7)),
        counts={"one_spring_cords": 0, "touching_outlines": 0},
    ),
    Case(
        "Two voids, one spring between",
        "Two pillars, a tubule apart; thin cords never merge them.",
        (WIDE,),
        (shapely.box(1, 2, 5, 6), shapely.box(5, 2, 9, 6)),
        kept=(tuple((5, y) for y in range(2, 7)),),
        counts={"one_spring_cords": 1},
    ),
)
"""Springs, nodes and outlines."""

VOIDS = (
    Case(
        "Voids that overlap",
        "Their cord has folded over: the smaller pillar is cut back to a tubule's width.",
        (shapely.box(1, 2, 5, 6), shapely.box(6, 2, 9, 6)),
        OVERLAPPING,
        moved={(5, y): (6.3, y) for y in (3, 4, 5)} | {(6, y): (4.9, y) for y in (3, 4, 5)},
        counts={"cut_pairs": 1},
    ),
    Case(
        "A void at the frame",
        "Its pillar keeps half a tubule from the frame.",
        (shapely.box(2, 0, 8, 4),),
        (shapely.box(2, 0, 8, 4),),
        counts={"frame_voids": 1},
    ),
    Case(
        "A void with a broken frame",
        "The edge of the tissue closes its outline.",
        (shapely.box(2, -1, 8, 4),),
        (shapely.box(2, 0, 8, 4),),
        counts={"frame_voids": 1},
    ),
    Case(
        "A ring broken to the outside",
        "The gap is part of the void as far as the edge; a narrow neck is then cut off.",
        (shapely.union_all([BOX, shapely.box(4, -1, 5, 3)]),),
        (shapely.union_all([BOX, shapely.box(4, 0, 5, 3)]),),
        counts={"frame_voids": 1},
    ),
    Case(
        "An island joined to nothing",
        "A fragment: dropped before voids are looked for.",
        (BOX,),
        (BOX,),
        kept=(_ring(4, 3, 6, 5),),
        counts={"fragments": 1, "fragment_springs": 8, "second_loops": 0},
    ),
    Case(
        "An island on one spring",
        "The outer loop alone is the outline: filled up.",
        (BOX,),
        (BOX,),
        kept=(_ring(5, 4, 6, 5), _row(2, 5, 4)),
        counts={"second_loops": 1, "dangling_springs": 3, "dropped_nested": 0},
    ),
    Case(
        "An island with a void of its own",
        "The inner void lies inside another one and is dropped.",
        (LARGE,),
        (LARGE,),
        kept=(_ring(4, 3, 7, 5), _row(1, 4, 4)),
        counts={"voids": 2, "dropped_nested": 1, "second_loops": 1},
    ),
    Case(
        "Fragments",
        "All but the largest connected part are dropped.",
        (LARGE,),
        (LARGE,),
        kept=(_ring(2, 2, 4, 4), _ring(5, 5, 8, 6), _row(5, 8, 3)),
        counts={"fragments": 3, "fragment_springs": 19, "voids": 1},
    ),
    Case(
        "Nothing broken",
        "Refused: no void.",
        (),
        refused="no void: the largest face covers 1 mean initial triangles",
    ),
    Case(
        "Everything broken",
        "Refused: one void above 90 % of the tissue.",
        (shapely.box(0, 0, COLUMNS, ROWS),),
        refused="everything is broken: one void covers 100 %",
    ),
    Case(
        "One spring left",
        "Refused: one void above 90 % of the tissue.",
        (ALL,),
        kept=(((4, 4), (5, 4)),),
        refused="everything is broken: one void covers 100 % of the network, 1 springs are left",
    ),
    Case(
        "A void as narrow as a tubule",
        "Nothing is left of it; refused where it is the only one.",
        (shapely.box(2, 3, 8, 4),),
        refused="no pillar: all 1 voids vanish or fall below 0.6 L0",
    ),
)
"""Voids, islands and pieces, and what is refused."""

CASES = SPRINGS + VOIDS
