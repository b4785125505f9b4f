"""Triangulation: topology, geometry, refusals."""

import numpy as np
import pytest

from vasculo.errors import InputError
from vasculo.mesh.adjacency import adjacency, adjacency_plain
from vasculo.mesh.quality import edge_lengths, smallest_angles, triangle_quality
from vasculo.mesh.triangulation import Triangulation

POINTS = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
TRIANGLES = [(0, 1, 2), (0, 2, 3)]
EDGES = [(0, 1), (1, 2), (2, 3), (3, 0)]
TAGS = [-1, -2, -1, 0]


def square(**change):
    parts = {"points": POINTS, "triangles": TRIANGLES, "boundary_edges": EDGES, "boundary_tags": TAGS}
    return Triangulation(**{**parts, "side_names": ("a", "b"), **change})


def test_square_of_two():
    mesh = square()
    assert np.array_equal(mesh.neighbours, [(-1, 1, -1), (-1, -1, 0)])
    assert mesh.areas == pytest.approx([0.5, 0.5])
    assert mesh.centroids == pytest.approx(np.array([(2 / 3, 1 / 3), (1 / 3, 2 / 3)]))
    assert mesh.quality() == pytest.approx([2 * (np.sqrt(2) - 1)] * 2)
    assert mesh.edge_of("a").tolist() == [0, 2]
    assert mesh.edge_of("b").tolist() == [1]
    assert mesh.edge_of("pillars").tolist() == [3]
    assert mesh.neighbours is mesh.neighbours
    assert mesh.triangles.dtype == mesh.boundary_tags.dtype == np.int32


def test_quality_of_known_triangles():
    points = np.array([(0, 0), (1, 0), (0.5, np.sqrt(3) / 2), (1, 1e-5), (4, 0), (0, 3)], dtype=float)
    triangles = np.array([(0, 1, 2), (0, 1, 3), (0, 4, 5)], dtype=np.int32)
    quality = triangle_quality(points, triangles)
    assert quality[0] == pytest.approx(1.0)
    assert quality[1] == pytest.approx(2e-5, rel=1e-3)
    assert quality[2] == pytest.approx(2 * 1.0 / 2.5)
    assert smallest_angles(points, triangles) == pytest.approx(
        [60, np.degrees(1e-5), np.degrees(np.arctan(0.75))], rel=1e-3
    )
    assert edge_lengths(points, triangles)[2] == pytest.approx([5, 3, 4])


def test_quality_is_twice_the_ratio_of_radii():
    rng = np.random.default_rng(0)
    points = rng.random((300, 2))
    triangles = np.arange(300, dtype=np.int32).reshape(-1, 3)
    sides = edge_lengths(points, triangles)
    s = sides.sum(axis=1) / 2
    area = np.sqrt(s * (s - sides[:, 0]) * (s - sides[:, 1]) * (s - sides[:, 2]))
    inner, outer = area / s, sides.prod(axis=1) / (4 * area)
    assert triangle_quality(points, triangles) == pytest.approx(2 * inner / outer, rel=1e-6)


def test_neighbours_are_mutual(make_plexus):
    from vasculo.mesh.generate import generate_mesh

    mesh = generate_mesh(make_plexus(8, 6, 6, 0, 0.5), 0.6)
    for t, row in enumerate(mesh.neighbours[:500]):
        for corner, other in enumerate(row):
            shared = {mesh.triangles[t, (corner + 1) % 3], mesh.triangles[t, (corner + 2) % 3]}
            if other >= 0:
                assert t in mesh.neighbours[other]
                assert shared < set(mesh.triangles[other])


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"triangles": [(0, 2, 1), (0, 2, 3)]}, "triangle 0 is not counter-clockwise"),
        ({"points": POINTS * (1, 0)}, "is not counter-clockwise: its area is 0"),
        (
            {"triangles": [(0, 1, 2), (0, 2, 3), (0, 1, 2)]},
            "edge 1-2 is used twice|edge 0-1 is used twice|edge 2-0 is used",
        ),
        ({"boundary_edges": EDGES[:3], "boundary_tags": TAGS[:3]}, "4 edges have one triangle, but other 3"),
        ({"boundary_edges": [(1, 0), (1, 2), (2, 3), (3, 0)]}, "4 edges have one triangle"),
        ({"boundary_tags": TAGS[:3]}, "need as many tags"),
        ({"boundary_tags": [-1, -3, 0, 0]}, "none below -2"),
        ({"triangles": [(0, 1, 9), (0, 2, 3)]}, "nodes 0 to 3"),
        ({"triangles": np.empty((0, 3), dtype=int)}, "there must be one"),
        ({"points": POINTS * (1, np.nan)}, "4 mesh nodes are not finite"),
    ],
)
def test_refusals(change, words):
    with pytest.raises(InputError, match=words):
        square(**change)


def test_unknown_side():
    with pytest.raises(InputError, match="no side is called 'c'; the sides are a, b"):
        square().edge_of("c")


def test_adjacency_of_three_on_an_edge_refused():
    with pytest.raises(InputError, match="is used twice"):
        adjacency(np.array([(0, 1, 2), (1, 0, 3), (0, 1, 4)], dtype=np.int32), 5)


def test_adjacency_and_twin_agree(make_stars):
    from vasculo.mesh.generate import generate_mesh

    mesh = generate_mesh(make_stars(3, 8), 0.8)
    assert np.array_equal(adjacency(mesh.triangles, len(mesh.points)), adjacency_plain(mesh.triangles))
    assert np.array_equal(mesh.neighbours, adjacency_plain(mesh.triangles))


def test_faces_are_every_edge_once():
    from vasculo.geometry.domain import Domain
    from vasculo.mesh.generate import generate_mesh

    mesh = generate_mesh(Domain.rectangle(3, 2, [[(1, 1), (2, 1), (1.5, 1.5)]]), 0.4)
    ends, triangles = mesh.faces
    edges = np.unique(np.sort(mesh.triangles[:, [(0, 1), (1, 2), (2, 0)]].reshape(-1, 2), axis=1), axis=0)
    assert np.array_equal(np.unique(np.sort(ends, axis=1), axis=0), edges)
    assert len(ends) == len(edges)
    rim = len(mesh.boundary_edges)
    assert np.array_equal(ends[-rim:], mesh.boundary_edges)
    assert np.array_equal(triangles[-rim:, 0], mesh.boundary_triangles)
    assert (triangles[-rim:, 1] == -1).all()
    way = mesh.points[ends[:, 1]] - mesh.points[ends[:, 0]]
    for side, sign in ((0, 1.0), (1, -1.0)):
        inner = slice(None) if side == 0 else slice(0, -rim)
        away = mesh.centroids[triangles[inner, side]] - mesh.points[ends[inner, 0]]
        assert (sign * (way[inner, 0] * away[:, 1] - way[inner, 1] * away[:, 0]) > 0).all()
        assert (np.isin(ends[inner], mesh.triangles[triangles[inner, side]])).all()
    assert mesh.faces is mesh.faces


def test_check_counts():
    found = square().check()
    assert found[:4] == (4, 2, 5, 1)
    assert found.area == pytest.approx(1.0)
    assert found.least_area == pytest.approx(0.5)
    ring = [(1, 0), (0, 1), (-1, 0), (0, -1)]
    points = np.array([*(np.array(ring) * 2), *ring], dtype=float)
    triangles = [t for i in range(4) for t in ((i, (i + 1) % 4, 4 + i), (4 + i, (i + 1) % 4, 4 + (i + 1) % 4))]
    edges = [(i, (i + 1) % 4) for i in range(4)] + [(4 + (i + 1) % 4, 4 + i) for i in range(4)]
    annulus = Triangulation(points, triangles, edges, [-1] * 4 + [0] * 4, ("rim",))
    assert annulus.check()[:4] == (8, 8, 16, 2)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"neighbours": [(-1, 1, -1), (-1, -1, -1)]}, "triangles 0 and 1 are given as neighbours, but share no edge"),
        ({"neighbours": [(-1, 1, -1), (-1, 0, -1)]}, "triangles 0 and 1 are given as neighbours"),
        ({"neighbours": [(-1, 5, -1), (-1, -1, 0)]}, "triangles 0 and 5 are given as neighbours"),
        ({"neighbours": [(-1, 1), (-1, 0)]}, r"neighbours have shape \(2, 2\)"),
        ({"boundary_edges": [(0, 1), (1, 2), (2, 3), (3, 9)]}, "boundary edges must name nodes 0 to 3"),
    ],
)
def test_given_neighbours_and_edges_are_checked(change, words):
    assert np.array_equal(square(neighbours=[(-1, 1, -1), (-1, -1, 0)]).neighbours, square().neighbours)
    with pytest.raises(InputError, match=words):
        square(**change)


def test_check_finds_what_the_arrays_became():
    mesh = square(points=POINTS.copy())
    mesh.points[2] = (0.3, -0.1)
    with pytest.raises(InputError, match="triangle 0 is not counter-clockwise"):
        mesh.check()
    lost = Triangulation(np.concatenate((POINTS, [(9.0, 9.0)])), TRIANGLES, EDGES, TAGS, ("a", "b"))
    with pytest.raises(InputError, match="1 of 5 nodes belong to no triangle"):
        lost.check()
    # two triangles that meet in one node only: the boundary passes through it twice
    points = np.array([(0.0, 0.0), (1, 0), (0, 1), (-1, 0), (0, -1)])
    edges = [(0, 1), (1, 2), (2, 0), (0, 3), (3, 4), (4, 0)]
    with pytest.raises(InputError, match="2 boundary edges leave node 0 and 2 reach it"):
        Triangulation(points, [(0, 1, 2), (0, 3, 4)], edges, [-1] * 6, ("a",)).check()
