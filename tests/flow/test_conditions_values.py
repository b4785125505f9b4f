"""Values of the conditions: numbers and functions, parabolas on any side, body forces, and who has which condition."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from tests.flow.lattice_cell import lattice_cell
from tests.flow.meshes import annulus, rectangle

from vasculo.errors import InputError
from vasculo.flow.body_force import PIECE, cell_forces
from vasculo.flow.boundary import Periodic, Pressure, Slip, Velocity, Wall, edges_by_name
from vasculo.flow.faces import INNER, MIRROR, MOVING, OPEN, build_faces, measure_faces, measure_faces_plain
from vasculo.flow.parts import prescribed_flux
from vasculo.flow.values import scalar_at, vector_at
from vasculo.mesh.triangulation import Triangulation

MESH = rectangle(1.5, 1.0, across=5)
RING = annulus()
AT = np.array([[0.0, 1.0], [2.0, 3.0], [4.0, 5.0]])


def edges_along(nodes):
    """Start, middle and end of the segments of a line."""
    return np.stack([nodes[:-1], 0.5 * (nodes[:-1] + nodes[1:]), nodes[1:]], axis=1)


def flux_to_the_left(points, velocity):
    along = points[:, 2] - points[:, 0]
    mean = (velocity[:, 0] + 4.0 * velocity[:, 1] + velocity[:, 2]) / 6.0
    return float(np.sum(mean[:, 1] * along[:, 0] - mean[:, 0] * along[:, 1]))


@given(
    arrays(float, st.tuples(st.integers(0, 9), st.just(2)), elements=st.floats(0.05, 0.95)),
    st.floats(-np.pi, np.pi),
    st.floats(-5.0, 5.0),
    st.randoms(use_true_random=False),
)
@settings(max_examples=100, deadline=None)
def test_a_parabola_brings_the_same_through_any_side_between_two_ends(inner, turn, mean, shuffle):
    nodes = np.concatenate([[[0.0, 0.0]], inner, [[1.0, 0.0]]]) * 2.0
    c, s = np.cos(turn), np.sin(turn)
    points = edges_along(nodes @ np.array([[c, s], [-s, c]]) + (3.0, -7.0))
    order = list(range(len(points)))
    shuffle.shuffle(order)
    points = points[order]
    velocity = Velocity.parabolic(mean).at(points, "in")
    assert flux_to_the_left(points, velocity) == pytest.approx(2.0 * mean, rel=1e-12, abs=1e-12)
    # Straight across: no component along the chord, nothing at the two ends.
    np.testing.assert_allclose(velocity @ (c, s), 0.0, atol=1e-12)
    ends = np.isclose(points @ (c, s), (3.0, -7.0) @ np.array([c, s]), atol=1e-9)
    np.testing.assert_allclose(velocity[ends], 0.0, atol=1e-7)


def test_the_peak_of_a_parabola():
    points = edges_along(np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]))
    velocity = Velocity.parabolic(peak=3.0).at(points, "in")
    np.testing.assert_allclose(velocity[:, :, 1], [[0.0, 2.25, 3.0], [3.0, 2.25, 0.0]], atol=1e-15)
    np.testing.assert_array_equal(velocity, Velocity.parabolic(2.0).at(points, "in"))


def test_a_parabola_needs_two_ends_and_a_side_between_them():
    with pytest.raises(InputError, match="'rim': the side is closed or branches"):
        build_faces(RING, {"rim": Velocity.parabolic(1.0)})
    bulge = np.array([[0.0, 0.0], [-0.25, 1.0], [1.0, 0.0]])
    with pytest.raises(InputError, match=r"reaches 0\.25 of its width beyond"):
        Velocity.parabolic(1.0).at(edges_along(bulge), "in")


@pytest.mark.parametrize("sizes", [{}, {"mean": 1.0, "peak": 1.0}, {"mean": np.nan}, {"peak": "fast"}])
def test_what_a_parabola_is_given(sizes):
    with pytest.raises(InputError, match="parabolic velocity"):
        Velocity.parabolic(**sizes)


def test_walls_move_in_any_way():
    for wall in (
        Wall((1.0, 2.0)),
        Wall((lambda x, _y: 1.0 + 0 * x, 2.0)),
        Wall(lambda x, _y: (1.0 + 0 * x, 2.0)),
        Wall(lambda x, _y: np.stack([1.0 + 0 * x, 2.0 + 0 * x])),
    ):
        np.testing.assert_array_equal(wall.at(AT, "top"), [[1.0, 2.0]] * 3)
    np.testing.assert_array_equal(Wall().at(AT, "top"), 0.0)
    np.testing.assert_array_equal(Wall.turning(2.0).at(AT, "top"), AT[:, ::-1] * [-2.0, 2.0])
    np.testing.assert_array_equal(Wall.turning(1, [2.0, 3]).at(AT, "top")[1], 0.0)
    assert Wall.turning(1, np.array([2, 3])) == Wall.turning(1.0, (2.0, 3.0))


@pytest.mark.parametrize("given", [(np.nan, (0.0, 0.0)), (1.0, 0.0), (1.0, (0.0, np.inf)), (1.0, (0.0, 0.0, 0.0))])
def test_what_a_turning_wall_is_given(given):
    with pytest.raises(InputError, match="of a turning wall is"):
        Wall.turning(*given)


@pytest.mark.parametrize("value", [1.0, 3, np.float32(2.0), True, lambda x, _y: x, lambda _x, _y: 4])
def test_values_at_points(value):
    found = scalar_at(value, AT, "it")
    assert found.dtype == np.float64
    np.testing.assert_array_equal(found, value(*AT.T) + 0 * AT[:, 0] if callable(value) else [value] * 3)
    assert found.flags.writeable


@pytest.mark.parametrize(
    ("value", "words"),
    [
        ("1.0", "give numbers, or functions"),
        (None, "give numbers, or functions"),
        (1j, "give numbers, or functions"),
        (lambda *_: [1.0, [2.0]], "give numbers, or functions"),
        (lambda *_: np.zeros(2), r"has shape \(2,\), its coordinates have \(3,\)"),
        (lambda x, _y: np.where(x > 1.0, np.nan, x), r"2 of 3 values are not finite, the first one at \(2, 3\)"),
        (np.inf, r"3 of 3 values are not finite, the first one at \(0, 1\)"),
    ],
)
def test_values_that_are_none(value, words):
    with pytest.raises(InputError, match=f"^it: .*{words}"):
        scalar_at(value, AT, "it")


@pytest.mark.parametrize("value", [1.0, (1.0, 2.0, 3.0), lambda x, _y: x, lambda *_: (1.0,), np.float64(1.0), "ab"])
def test_vectors_that_are_none(value):
    with pytest.raises(InputError, match=r"^it: give two components"):
        vector_at(value, AT, "it")


@pytest.mark.parametrize(
    ("condition", "words"),
    [
        (
            Wall(lambda x, y: (np.where(x > 1.4, np.inf, x), y)),
            "velocity of the wall 'top': 2 of 24 values are not finite",
        ),
        (Velocity(lambda x, _y: np.log(x - 10.0)), "velocity on 'top': 24 of 24 values are not finite"),
        (Pressure(lambda x, _y: np.where(x > 1.0, np.nan, 1.0)), "pressure on 'top': 3 of 8 values are not finite"),
        (Pressure(np.nan), "pressure on 'top': 8 of 8"),
        (Wall(1.0), "velocity of the wall 'top': give two components"),
    ],
)
def test_conditions_that_are_not_finite(condition, words):
    with pytest.raises(InputError, match=words), np.errstate(all="ignore"):
        build_faces(MESH, {"top": condition})


def test_pressures_along_a_side():
    faces = build_faces(MESH, {"left": Pressure(lambda x, y: 2.0 * x + y), "right": Pressure(5.0)})
    chosen = MESH.edge_of("left")
    heights = MESH.points[MESH.boundary_edges[chosen]].mean(axis=1)[:, 1]
    np.testing.assert_allclose(faces.opening[faces.edge_face[chosen] - faces.inner] + faces.level, heights)
    assert faces.level == 0.5 * (5.0 + heights.min())


def test_who_has_which_condition():
    faces = build_faces(RING, {"rim": Pressure(0.0), "pillars": Slip(), "pillar 0": Velocity(0.0, 0.0)})
    is_pillar = RING.boundary_tags == 0
    np.testing.assert_array_equal(faces.kind[faces.edge_face], np.where(is_pillar, MOVING, OPEN))
    np.testing.assert_array_equal(faces.is_wall, is_pillar)
    faces = build_faces(RING, {"pillars": Slip(), "rim": Wall((1.0, 0.0))})
    np.testing.assert_array_equal(faces.kind[faces.edge_face], np.where(is_pillar, MIRROR, MOVING))
    np.testing.assert_array_equal(faces.is_wall, ~is_pillar)
    np.testing.assert_array_equal(prescribed_flux(faces)[is_pillar], 0.0)


def test_edges_of_single_pillars():
    tags = np.where(MESH.boundary_tags == -1, np.arange(len(MESH.boundary_tags)) % 3, MESH.boundary_tags)
    mesh = Triangulation(MESH.points, MESH.triangles, MESH.boundary_edges, tags, MESH.side_names)
    names = [*mesh.side_names, "pillars", "pillar 2", "pillar 0"]
    wanted = [np.flatnonzero(tags == tag) for tag in (-1, -2, -3, -4, 1, 2, 0)]
    for found, edges in zip(edges_by_name(mesh, names), wanted, strict=True):
        np.testing.assert_array_equal(found, edges)


@pytest.mark.parametrize("name", ["pillar 1", "pillar 00", "pillar", "pillar -1", 0])
def test_pillars_that_are_not_there(name):
    with pytest.raises(InputError, match=r"no 'pillar 1': the mesh has pillar 0 only|no side is named") as caught:
        build_faces(RING, {name: Wall()})
    assert "\n" not in str(caught.value)
    with pytest.raises(InputError, match="the mesh has no pillar"):
        build_faces(MESH, {"pillar 0": Wall()})


@pytest.mark.parametrize("conditions", [{}, {"left": Periodic("right", 1.0), "bottom": Periodic("top")}])
def test_measures_of_faces_agree_with_the_plain_twin(conditions):
    mesh = lattice_cell((1.0, 0.1), (0.4, 0.9), lambda angle: 0.2 + 0.05 * np.cos(3.0 * angle), 7, 5)
    faces = build_faces(mesh, conditions)
    wanted = measure_faces_plain(mesh.points, mesh.areas, faces.ends, faces.cells)
    for threads in (1, 3):
        found = [np.full_like(part, np.nan) for part in wanted]
        for rank in range(threads):
            measure_faces(rank, threads, mesh.points, mesh.areas, faces.ends, faces.cells, *found)
        for mine, kept, other in zip(
            found, (faces.tangent, faces.normal, faces.length, faces.distance), wanted, strict=True
        ):
            np.testing.assert_array_equal(mine, kept)
            np.testing.assert_allclose(mine, other, rtol=1e-15, atol=1e-16)
    seams = faces.kind == INNER
    away = mesh.centroids[faces.cells[seams, 1]] - mesh.centroids[faces.cells[seams, 0]]
    if not conditions:
        np.testing.assert_allclose(faces.distance[seams], np.einsum("fi,fi->f", away, faces.normal[seams]), rtol=1e-12)


def test_periodic_edges_face_each_other():
    mesh = lattice_cell((1.0, 0.1), (0.4, 0.9), lambda angle: 0.2 + 0 * angle, 7, 5)
    faces = build_faces(mesh, {"left": Periodic("right", 2.0), "top": Periodic("bottom", -1.0)})
    for side, other, shift in (("left", "right", (1.0, 0.1)), ("bottom", "top", (0.4, 0.9))):
        here, there = mesh.edge_of(side), mesh.edge_of(other)
        order = np.argsort(faces.edge_face[here]), np.argsort(faces.edge_face[there])
        np.testing.assert_array_equal(faces.edge_face[here][order[0]], faces.edge_face[there][order[1]])
        middles = [mesh.points[mesh.boundary_edges[e]].mean(axis=1) for e in (here[order[0]], there[order[1]])]
        np.testing.assert_allclose(middles[1] - middles[0], np.tile(shift, (7, 1)), atol=1e-12)
    np.testing.assert_allclose(faces.gradient @ (1.0, 0.1), 2.0)
    np.testing.assert_allclose(faces.gradient @ (0.4, 0.9), 1.0)
    # The four corners of the cell are one point of the flow.
    share = np.linalg.solve(np.array([(1.0, 0.1), (0.4, 0.9)]).T, mesh.points.T)
    corners = np.flatnonzero(np.abs(share).min(axis=0) > 0.5 - 1e-9)
    assert len(corners) == 4
    assert len(set(faces.same[corners].tolist())) == 1


def mean_by_gauss(mesh, force):
    """Mean over triangles by a 6 x 6 Gauss rule on the square, folded onto the triangle."""
    node, weight = np.polynomial.legendre.leggauss(6)
    s, t = (part.ravel() for part in np.meshgrid(0.5 * (node + 1.0), 0.5 * (node + 1.0)))
    w = np.outer(weight, weight).ravel() * s / (weight.sum() ** 2) * 2.0
    barycentric = np.column_stack([1.0 - s, s * (1.0 - t), s * t])
    places = np.einsum("qk,tki->tqi", barycentric, mesh.points[mesh.triangles])
    return np.stack([np.einsum("q,tq->t", w, part) for part in force(places[..., 0], places[..., 1])], axis=1)


def test_body_forces_of_degree_four_are_integrated_exactly():
    def force(x, y):
        return x**4 - 3.0 * x**3 * y + x * x * y * y, y**4 + 2.0 * x * y**3 - 7.0

    np.testing.assert_allclose(cell_forces(MESH, force), mean_by_gauss(MESH, force), rtol=1e-12, atol=1e-13)


def test_body_forces_as_they_are_given(monkeypatch):
    cells = len(MESH.triangles)
    np.testing.assert_array_equal(cell_forces(MESH, None), np.zeros((cells, 2)))
    np.testing.assert_array_equal(cell_forces(MESH, (1, -2)), np.tile([1.0, -2.0], (cells, 1)))
    rows = np.arange(2.0 * cells).reshape(cells, 2)
    np.testing.assert_array_equal(cell_forces(MESH, rows), rows)
    np.testing.assert_allclose(cell_forces(MESH, lambda _x, _y: (1, -2)), np.tile([1.0, -2.0], (cells, 1)), rtol=1e-14)
    whole = cell_forces(MESH, lambda x, y: (x * y, np.sin(x)))
    monkeypatch.setattr("vasculo.flow.body_force.PIECE", cells // 3)
    assert cells < PIECE
    np.testing.assert_array_equal(cell_forces(MESH, lambda x, y: (x * y, np.sin(x))), whole)


@pytest.mark.parametrize(
    ("force", "words"),
    [
        (1.0, r"force has shape \(\): give \(2,\), one row a triangle, \(80, 2\)"),
        ([[1.0, 2.0]] * 3, r"force has shape \(3, 2\)"),
        ((np.nan, 0.0), "1 components of the force are not finite"),
        (
            lambda x, y: (np.where(x > 1.4, np.inf, x), y),
            r"body force: \d+ of 480 values are not finite, the first one",
        ),
        (lambda x, _y: x, "body force: give two components"),
        ("down", "force is 'down'"),
    ],
)
def test_body_forces_that_are_none(force, words):
    with pytest.raises(InputError, match=words):
        cell_forces(MESH, force)
