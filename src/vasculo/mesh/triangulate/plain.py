"""Plain twins of the triangulations: from edge to edge, each triangle by its definition, in fractions."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vasculo.geometry.predicates import incircle_plain, orient2d_plain

if TYPE_CHECKING:
    from vasculo.geometry.arrays import Floats, Ints

Node = tuple[float, float]
Edge = tuple[int, int]


def fluid_triangles_plain(points: Floats, edges: Ints) -> set[tuple[int, int, int]]:
    """Twin of `fluid_triangles`: triangles, each with its lowest node first. No four nodes may lie on a circle.

    Start from the walls. The triangle to the left of an edge goes to the node that both its ends can see, whose circle
    holds no other such node; its two other edges are the next.
    """
    nodes: list[Node] = [(float(x), float(y)) for x, y in points]
    walls: list[Edge] = [(int(a), int(b)) for a, b in edges]
    todo, seen, found = list(walls), set(walls), set()
    while todo:
        a, b = todo.pop()
        apex = -1
        for c in range(len(nodes)):
            if c in (a, b) or orient2d_plain(*nodes[a], *nodes[b], *nodes[c]) <= 0:
                continue
            if apex >= 0 and incircle_plain(*nodes[a], *nodes[b], *nodes[apex], *nodes[c]) <= 0:
                continue
            if _is_free(nodes, walls, a, c) and _is_free(nodes, walls, b, c):
                apex = c
        corners = (a, b, apex)
        first = corners.index(min(corners))
        found.add((corners[first], corners[first - 2], corners[first - 1]))
        for u, v in ((b, apex), (apex, a)):
            if (u, v) not in seen and (v, u) not in seen:
                todo.append((v, u))
            seen.add((u, v))
    return found


def delaunay_plain(points: Floats) -> set[tuple[int, int, int]]:
    """Twin of `delaunay`: the fluid between the edges of the convex hull."""
    nodes: list[Node] = [(float(x), float(y)) for x, y in points]
    hull = [
        (a, b)
        for a in range(len(nodes))
        for b in range(len(nodes))
        if a != b
        and all(
            orient2d_plain(*nodes[a], *nodes[b], *c) > 0
            or (_on_line(nodes[a], nodes[b], c) and not _between(nodes, a, b, c))
            for c in nodes
        )
    ]
    return fluid_triangles_plain(points, hull)  # type: ignore[arg-type]


def _on_line(a: Node, b: Node, c: Node) -> bool:
    """Whether three nodes are collinear."""
    return orient2d_plain(*a, *b, *c) == 0


def _between(nodes: list[Node], a: int, b: int, c: Node) -> bool:
    """Whether c, on the line through nodes a and b, lies strictly between them."""
    low, high = sorted((nodes[a], nodes[b]))
    return low < c < high


def _is_free(nodes: list[Node], walls: list[Edge], a: int, c: int) -> bool:
    """Whether nodes a and c can see each other: no wall across, no node on the way."""
    start, end = nodes[a], nodes[c]
    if any(_on_line(start, end, node) and _between(nodes, a, c, node) for node in nodes):
        return False
    for u, v in walls:
        sides = orient2d_plain(*start, *end, *nodes[u]) * orient2d_plain(*start, *end, *nodes[v])
        others = orient2d_plain(*nodes[u], *nodes[v], *start) * orient2d_plain(*nodes[u], *nodes[v], *end)
        if sides < 0 and others < 0:
            return False
    return True
