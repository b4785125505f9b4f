"""Triangulations by their definition, in exact arithmetic, and against their twins and Qhull."""

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import Delaunay

from vasculo.errors import ComputationError, InputError
from vasculo.geometry.predicates import incircle, incircle_plain, orient2d
from vasculo.mesh.triangulate.delaunay import delaunay, fluid_triangles
from vasculo.mesh.triangulate.plain import delaunay_plain, fluid_triangles_plain
from vasculo.mesh.triangulation import adjacency

KINDS = ["random", "clustered", "line and one", "grid", "circle", "two lines", "spiral", "turned grid"]


def scattered(kind, count, seed):
    """Different points of one kind."""
    rng = np.random.default_rng(seed)
    if kind == "random":
        points = rng.random((count, 2))
    elif kind == "clustered":
        points = rng.integers(0, 3, (count, 2)) + 10.0 ** rng.uniform(-9, -1, (count, 1)) * rng.normal(size=(count, 2))
    elif kind == "line and one":
        points = np.concatenate((np.outer(rng.integers(0, 10 * count, count - 1), (0.25, 1.0)), [(40.0, 1.5)]))
    elif kind == "grid":
        side = int(np.ceil(np.sqrt(count)))
        points = 0.1 * np.stack(np.divmod(rng.permutation(side * side)[:count], side), axis=1)
    elif kind == "circle":
        angle = 2 * np.pi * rng.integers(0, 64, count) / 64
        points = np.concatenate(([(0.0, 0.0)], np.column_stack((np.cos(angle), np.sin(angle)))))
    elif kind == "two lines":
        points = np.column_stack((rng.integers(0, 2, count), rng.integers(0, count, count)))
        points = np.concatenate((points, [(0, -1), (1, -1)])).astype(np.float64)
    elif kind == "spiral":
        angle = np.linspace(0.0, 12.0, count)
        points = np.column_stack((angle * np.cos(angle), angle * np.sin(angle)))
    else:
        side = int(np.ceil(np.sqrt(count)))
        grid = np.stack(np.divmod(np.arange(side * side), side), axis=1).astype(np.float64)
        points = grid @ np.array([(np.cos(0.3), np.sin(0.3)), (-np.sin(0.3), np.cos(0.3))])
    return np.unique(points, axis=0)[rng.permutation(len(np.unique(points, axis=0)))]


def turn(points, corners):
    a, b, c = corners
    return orient2d(*points[a], *points[b], *points[c])


def canonical(triangles):
    """The triangles as a set, each with its lowest node first."""
    return {tuple(np.roll(row, -int(np.argmin(row))).tolist()) for row in triangles}


def check_locally_delaunay(points, triangles, neighbours):
    """No node opposite to an edge within the circle beyond it: with that, all circles are empty (Delaunay 1934)."""
    for t, i in zip(*np.nonzero(neighbours >= 0), strict=True):
        u = neighbours[t, i]
        q = int(triangles[u, np.flatnonzero(neighbours[u] == t)[0]])
        assert incircle(*points[triangles[t, 0]], *points[triangles[t, 1]], *points[triangles[t, 2]], *points[q]) <= 0.0


def check_triangulation(points, triangles, neighbours):
    """All that makes a Delaunay triangulation of points one, in exact arithmetic."""
    assert triangles.dtype == neighbours.dtype == np.int32
    assert np.array_equal(np.unique(triangles), np.arange(len(points)))
    assert np.array_equal(adjacency(triangles, len(points)), neighbours)
    assert all(turn(points, row) > 0.0 for row in triangles)
    # Euler: a disk; its boundary is one ring that never turns right
    rim = np.count_nonzero(neighbours < 0)
    assert len(triangles) == 2 * len(points) - 2 - rim
    t, i = np.nonzero(neighbours < 0)
    following = dict(zip(triangles[t, (i + 1) % 3].tolist(), triangles[t, (i + 2) % 3].tolist(), strict=True))
    assert len(following) == rim
    node = first = next(iter(following))
    for step in range(1, rim + 1):
        onward = following[node]
        assert turn(points, (node, onward, following[onward])) >= 0.0
        node = onward
        assert (node == first) == (step == rim)
    check_locally_delaunay(points, triangles, neighbours)


@settings(deadline=None, max_examples=120)
@given(kind=st.sampled_from(KINDS), count=st.integers(4, 150), seed=st.integers(0, 10**6), presorted=st.booleans())
def test_every_kind_of_points(kind, count, seed, presorted):
    points = scattered(kind, count, seed)
    if all(turn(points, (0, 1, i)) == 0.0 for i in range(2, len(points))):
        return
    triangles, neighbours = delaunay(points, presorted=presorted)
    check_triangulation(points, triangles, neighbours)
    again = delaunay(points, presorted=presorted)
    assert np.array_equal(triangles, again[0])
    assert np.array_equal(neighbours, again[1])


@pytest.mark.parametrize("kind", KINDS)
def test_many_points(kind):
    points = scattered(kind, 900, 1)
    check_triangulation(points, *delaunay(points))


@settings(deadline=None, max_examples=25)
@given(count=st.integers(3, 11), seed=st.integers(0, 10**6), flat=st.booleans())
def test_twin(count, seed, flat):
    points = np.random.default_rng(seed).random((count, 2))
    if flat:
        points[: count // 2, 1] = 0.25 * points[: count // 2, 0]  # on a line but for rounding, or exactly
    triangles, _ = delaunay(points)
    assert canonical(triangles) == delaunay_plain(points)


def test_twin_of_all_circles():
    """The twin itself against the definition: the triples whose circle holds no point."""
    points = np.random.default_rng(3).random((9, 2))
    empty = set()
    for a, b, c in np.ndindex(9, 9, 9):
        if a < b and a < c and b != c and turn(points, (a, b, c)) > 0.0:
            others = [d for d in range(9) if d not in (a, b, c)]
            if all(incircle_plain(*points[a], *points[b], *points[c], *points[d]) < 0 for d in others):
                empty.add((a, b, c))
    assert delaunay_plain(points) == empty


@pytest.mark.parametrize("seed", range(3))
def test_qhull(seed):
    points = np.random.default_rng(seed).random((5_000, 2))
    triangles, neighbours = delaunay(points)
    found = Delaunay(points).simplices
    assert {tuple(sorted(row)) for row in triangles.tolist()} == {tuple(sorted(row)) for row in found.tolist()}
    assert np.array_equal(adjacency(triangles, len(points)), neighbours)


def test_near_triangles_have_near_numbers():
    points = np.random.default_rng(0).random((20_000, 2))
    _, neighbours = delaunay(points)
    apart = np.abs(neighbours - np.arange(len(neighbours))[:, None])[neighbours >= 0]
    assert np.median(apart) < 20
    assert np.mean(apart > 500) < 0.2


@pytest.mark.parametrize("scale", [1e-58, 1e-20, 1e20, 1e69])
def test_any_size(scale):
    points = np.random.default_rng(0).random((200, 2)) + 0.5
    powers = 2.0 ** np.round(np.log2(scale))  # exact
    assert np.array_equal(delaunay(points * powers)[0], delaunay(points)[0])


@pytest.mark.parametrize(
    ("points", "words"),
    [
        ([(0, 0), (1, 0)], "2 points cannot be triangulated: 3 to "),
        ([(0, 0, 1)] * 4, r"points must have the shape \(n, 2\), not \(4, 3\)"),
        ([(0, 0), (1, 0), (0, 1), (np.nan, 2)], r"point 3 is \(nan, 2\): coordinates must be zero or 1e-60 to 1e\+70"),
        ([(0, 0), (1e-70, 0), (0, 1)], r"point 1 is \(1e-70, 0\)"),
        ([(0, 0), (1, 1e71), (0, 1)], r"point 1 is \(1, 1e\+71\)"),
        ([(0, 0), (1, 0), (0.5, 0.25), (0, 1), (0.5, 0.25)], r"two points coincide at \(0.5, 0.25\)"),
        ([(2, 2), (2, 2), (2, 2)], r"two points coincide at \(2, 2\)"),
        ([(i, 3 * i) for i in range(50)], r"all 50 points lie on the line through \(0, 0\) and \(1, 3\)"),
        ([(0.5, 0.1), (0.5, 0.7), (0.5, -3.0)], "all 3 points lie on the line"),
    ],
)
@pytest.mark.parametrize("presorted", [False, True])
def test_refused_points(points, words, presorted):
    with pytest.raises(InputError, match=words):
        delaunay(np.array(points, dtype=np.float64), presorted=presorted)


# Walls


def star(rng, corners, low=0.1):
    """A star-shaped polygon around the origin, counter-clockwise."""
    angle = 2.0 * np.pi * (np.arange(corners) + rng.uniform(0.0, 0.9, corners)) / corners
    radius = rng.uniform(low, 1.0, corners)
    corners = np.column_stack((radius * np.cos(angle), radius * np.sin(angle)))
    return corners if shapely.LinearRing(corners).is_ccw else corners[::-1]


def as_walls(outlines):
    """Nodes and edges of outlines, each with the fluid on its left."""
    counts = [len(outline) for outline in outlines]
    first = np.cumsum([0, *counts])
    ring = [np.column_stack((np.arange(n), (np.arange(n) + 1) % n)) + k for n, k in zip(counts, first, strict=False)]
    return np.concatenate(outlines), np.concatenate(ring).astype(np.int32)


def fluid(seed, most=7, nodes=12):
    """A polygon with holes and nodes between them: points, edges and the shape; walls may be close together."""
    rng = np.random.default_rng(seed)
    outlines = [star(rng, int(rng.integers(5, 14)), 0.5)]
    shape = shapely.Polygon(outlines[0])
    for _ in range(int(rng.integers(0, most))):
        hole = star(rng, int(rng.integers(3, 12))) * 10.0 ** rng.uniform(-2, -0.3) + rng.uniform(-0.7, 0.7, 2)
        cut = shapely.Polygon(hole)
        if cut.is_valid and shape.contains_properly(cut):
            outlines.append(hole[::-1])
            shape = shape.difference(cut)
    inner = rng.uniform(-1, 1, (int(rng.integers(0, nodes)), 2))
    inner = inner[shapely.contains_xy(shape, inner)]
    points, edges = as_walls(outlines)
    return np.concatenate((points, inner)), edges, shape


def check_fluid(points, edges, area):
    triangles, neighbours = fluid_triangles(points, edges)
    assert triangles.dtype == neighbours.dtype == np.int32
    assert all(turn(points, row) > 0.0 for row in triangles)
    assert np.array_equal(adjacency(triangles, len(points)), neighbours)
    t, i = np.nonzero(neighbours < 0)
    rim = np.column_stack((triangles[t, (i + 1) % 3], triangles[t, (i + 2) % 3]))
    assert np.array_equal(np.unique(rim, axis=0), np.unique(edges, axis=0))
    assert len(rim) == len(edges)
    a, b, c = (points[triangles[:, k]] for k in range(3))
    twice = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    assert 0.5 * twice.sum() == pytest.approx(area, rel=1e-6)
    check_locally_delaunay(points, triangles, neighbours)
    return triangles


@settings(deadline=None, max_examples=50)
@given(seed=st.integers(0, 10**6))
def test_walls_are_edges_and_the_rest_is_delaunay(seed):
    points, edges, shape = fluid(seed)
    if shape.geom_type == "Polygon":
        check_fluid(points, edges, shape.area)


@settings(deadline=None, max_examples=8)
@given(seed=st.integers(0, 10**6))
def test_twin_of_the_fluid(seed):
    points, edges, shape = fluid(seed, 2, 5)
    if shape.geom_type == "Polygon":
        triangles, _ = fluid_triangles(points, edges)
        assert canonical(triangles) == fluid_triangles_plain(points, edges)


@pytest.mark.parametrize("teeth", [1, 2, 5, 40])
@pytest.mark.parametrize("height", [1e-9, 1e-3, 1.0])
def test_a_thin_comb(teeth, height):
    """Two zigzag walls, one right above the other: each is crossed by many Delaunay edges."""
    x = np.arange(2.0 * teeth + 1.0)
    upper = np.column_stack((x, 100.0 * (x % 2)))
    ring = np.concatenate((upper - (0.0, height), upper[::-1]))
    points, edges = as_walls([ring])
    check_fluid(points, edges, 2 * teeth * height)


def test_needles():
    rng = np.random.default_rng(5)
    x = np.sort(rng.random(200)) * 100.0
    ring = np.concatenate((np.column_stack((x, rng.random(200) * 1e-4)), [(101.0, 1.0)], [(-1.0, 1.0)]))
    points, edges = as_walls([ring])
    check_fluid(points, edges, shapely.Polygon(ring).area)


RING = np.array([(0, 1), (1, 2), (2, 3), (3, 0)], dtype=np.int32)
SQUARE = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]


@pytest.mark.parametrize(
    ("points", "edges", "words"),
    [
        (
            [(0, 0), (1, 1), (1, 0), (0, 1)],
            RING,
            r"the wall from \(\d, 0\) to \(\d, 1\) crosses the wall between \(\d, \d\) and \(\d, \d\): part them",
        ),
        ([*SQUARE, (0.5, 0.5), (0.5, 0.5)], RING, r"two points coincide at \(0.5, 0.5\)"),
        ([*SQUARE, (0.25, 0)], RING, r"the node at \(0.25, 0\) lies on the wall from \(0, 0\) to \(1, 0\)"),
        (SQUARE, RING[:, ::-1], r"there is nothing to the left of a wall at the convex hull"),
        (SQUARE, RING[:3], r"the outer outline does not close.*from \(0, 1\) to \(0, 0\)"),
        ([*SQUARE, (2, 0.5)], RING[:3], "the outer outline does not close"),
        (SQUARE, np.concatenate((RING, RING[:1])), r"two walls join the same nodes, from \(0, 0\) to \(1, 0\)"),
        (
            SQUARE,
            np.concatenate((RING, [(0, 2)])).astype(np.int32),
            r"on both sides of the wall, from \(0, 0\) to \(1, 1\)",
        ),
        (SQUARE, np.concatenate((RING, [(2, 2)])), r"1 walls have no length, the first at \(1, 1\)"),
        ([(0, 0), (1, 0), (2, 0), (3, 0)], RING, "all 4 points lie on the line"),
    ],
)
def test_walls_that_bound_no_fluid(points, edges, words):
    with pytest.raises(ComputationError, match=words):
        fluid_triangles(np.array(points, dtype=np.float64), edges)


def test_nodes_outside_of_the_fluid_are_left_out():
    points = np.array([*SQUARE, (0.4, 0.6), (3.0, 3.0), (-1.0, 0.5), (0.5, -2.0)])
    triangles = check_fluid(points, RING, 1.0)
    assert set(triangles.ravel().tolist()) == {0, 1, 2, 3, 4}
