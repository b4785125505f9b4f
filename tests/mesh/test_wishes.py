"""Edge lengths by curvature and by a function of the user."""

import numpy as np
import pytest

from vasculo.errors import InputError
from vasculo.geometry.domain import Domain
from vasculo.mesh.generate import generate_mesh
from vasculo.mesh.predict import predicted_triangles
from vasculo.mesh.quality import edge_lengths
from vasculo.mesh.size import size_field
from vasculo.mesh.walls import walls_of
from vasculo.mesh.wishes import curvature_wishes


def wall_lengths(mesh, tag):
    ends = mesh.points[mesh.boundary_edges[mesh.boundary_tags == tag]]
    return np.hypot(*(ends[:, 1] - ends[:, 0]).T)


def test_curvature_of_circles_is_exact(make_disk):
    walls = walls_of(Domain.rectangle(9, 5, [make_disk(2, 2, 1.0, 40), make_disk(6, 2, 0.5, 90)]))
    lines, sizes, _ = curvature_wishes(walls, 30.0, 10.0, 0.25)
    points = lines[:, :2]
    for centre, radius, nodes in (((2, 2), 1.0, 40), ((6, 2), 0.5, 90)):
        own = np.hypot(*(points - centre).T) < 1.01 * radius
        chord = 2 * radius * np.sin(np.pi / nodes)
        assert own.sum() == 2 * nodes
        # half of two chords over the angle that the outline turns by
        assert sizes[own] == pytest.approx(nodes * chord / 30.0, rel=1e-9)


@pytest.mark.parametrize("per_turn", [20, 60])
def test_a_circle_gets_so_many_edges_whatever_its_radius(per_turn, make_disk, check_mesh):
    domain = Domain.rectangle(12, 8, [make_disk(3, 4, 2.0, 12), make_disk(8, 4, 0.3, 12)])
    mesh = generate_mesh(domain, 2.0, curvature=per_turn)
    check_mesh(mesh, domain)
    for tag in (0, 1):
        assert per_turn * 0.9 <= len(wall_lengths(mesh, tag)) <= per_turn * 1.5


def test_curvature_grades_into_sharp_corners(check_mesh):
    domain = Domain.rectangle(8, 8, [[(3, 3), (5, 3), (5, 5), (3, 5)]])
    mesh = generate_mesh(domain, 0.8, curvature=60)
    check_mesh(mesh, domain)
    ends = mesh.points[mesh.boundary_edges[mesh.boundary_tags == 0]]
    lengths = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
    middle = np.abs(ends.mean(axis=1) - 4)
    corner, centre = middle.min(axis=1) > 0.9, middle.min(axis=1) < 0.2
    assert lengths[corner].max() < 0.6 * lengths[centre].min()
    assert lengths.min() < 0.2
    assert mesh.quality().min() > 0.5


def test_a_size_function_is_followed_within_its_gradation(check_mesh):
    domain = Domain.rectangle(4, 4)

    def spot(points):
        return np.where(np.hypot(points[:, 0] - 1, points[:, 1] - 3) < 0.3, 0.02, 1.0)

    mesh = generate_mesh(domain, 0.4, size=spot, grading=0.2)
    check_mesh(mesh, domain)
    lengths = edge_lengths(mesh.points, mesh.triangles).mean(axis=1)
    away = np.hypot(*(mesh.centroids - (1, 3)).T)
    assert lengths[away < 0.25].mean() == pytest.approx(0.02, rel=0.15)
    assert lengths[away > 2.4].mean() == pytest.approx(0.4, rel=0.15)
    wanted = np.minimum(0.4, 0.02 + 0.2 * np.maximum(away - 0.3, 0.0))
    assert np.abs(np.log(lengths / wanted)).mean() < 0.15
    assert mesh.quality().mean() > 0.95
    assert mesh.quality().min() > 0.5


def test_a_smooth_function_gives_its_own_lengths(check_mesh):
    domain = Domain.rectangle(3, 1)
    mesh = generate_mesh(domain, 1.0, size=lambda p: 0.02 + 0.03 * p[:, 0])
    check_mesh(mesh, domain)
    lengths = edge_lengths(mesh.points, mesh.triangles).mean(axis=1)
    wanted = 0.02 + 0.03 * mesh.centroids[:, 0]
    assert np.log(lengths / wanted).mean() == pytest.approx(0.0, abs=0.08)
    assert np.abs(np.log(lengths / wanted)).max() < 0.6


def test_functions_never_lengthen_edges():
    domain = Domain.rectangle(3, 2)
    plain = generate_mesh(domain, 0.3)
    wide = generate_mesh(domain, 0.3, size=lambda p: np.full(len(p), 5.0))
    assert np.array_equal(plain.points, wide.points)
    assert np.array_equal(plain.triangles, wide.triangles)


@pytest.mark.parametrize(
    "wishes",
    [
        {"curvature": 40.0},
        {"curvature": 200.0},
        {"size": lambda p: 0.02 + 0.1 * np.abs(p[:, 0] - 4)},
        {"size": lambda p: np.full(len(p), 0.03)},
    ],
)
def test_prediction_holds_for_wishes(wishes, make_disk):
    domain = Domain.rectangle(8, 6, [make_disk(2, 3), make_disk(5.5, 3, 0.7), [(3.4, 1), (4, 1), (4, 1.6)]])
    walls = walls_of(domain)
    field = size_field(walls, 0.5, 0.5, 0.0, 0.25, **wishes)
    predicted, _, _ = predicted_triangles(walls, field, domain.area)
    mesh = generate_mesh(domain, 0.5, **wishes)
    assert 0.5 < len(mesh.triangles) / predicted < 2.0
    with pytest.raises(InputError, match="more than the limit of 300"):
        generate_mesh(domain, 0.5, max_triangles=300, **wishes)


@pytest.mark.parametrize(
    ("size", "words"),
    [
        (lambda p: p, r"size gave an array of shape \(\d+, 2\) for \d+ points, expected \(\d+,\)"),
        (lambda p: 0.0 * p[:, 0], r"size gave 0 at \(.*\), expected a positive length"),
        (lambda p: np.where(p[:, 0] > 1, np.nan, 1.0), r"size gave nan at \(.*\), expected a positive length"),
        (lambda p: np.full(len(p), 1e-9), "size asks for edges so short that it would have to be read at .* places"),
    ],
)
def test_bad_functions_are_refused_in_one_line(size, words):
    with pytest.raises(InputError, match=words) as caught:
        generate_mesh(Domain.rectangle(3, 2), 0.3, size=size)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("value", [-1.0, np.nan, 1e6])
def test_refused_curvature(value):
    with pytest.raises(InputError, match="curvature must lie between 0 and 10000 edges a turn"):
        generate_mesh(Domain.rectangle(3, 2), 0.3, curvature=value)
