"""The size field: bounds, gradient, passages, prediction."""

import numpy as np
import pytest

from vasculo.geometry.domain import Domain
from vasculo.mesh.generate import generate_mesh
from vasculo.mesh.passages import nearest_facing, passages_of
from vasculo.mesh.passages_plain import nearest_facing_plain
from vasculo.mesh.predict import predicted_triangles
from vasculo.mesh.size import LAYER, size_field, sizes_at_plain, with_wall_edges
from vasculo.mesh.subdivide import SLACK, wall_nodes
from vasculo.mesh.subdivide_plain import cut_evenly_plain
from vasculo.mesh.walls import walls_of


@pytest.fixture(params=["plexus", "stars", "disks"])
def walls(request, make_plexus, make_stars, make_disk):
    if request.param == "plexus":
        return walls_of(make_plexus(12, 8, 8, 1, 0.25))
    if request.param == "stars":
        return walls_of(make_stars(5, 15))
    return walls_of(Domain.rectangle(7, 5, [make_disk(2, 2), make_disk(4.2, 2.2), make_disk(5, 4, 0.4)]))


def test_walls_have_the_fluid_on_the_left(make_disk):
    domain = Domain.rectangle(7, 5, [make_disk(2, 2), make_disk(5, 3)])
    walls = walls_of(domain)
    step = walls.segments[:, 2:] - walls.segments[:, :2]
    inward = walls.segments[:, :2] + step / 2 + 1e-3 * np.column_stack((-step[:, 1], step[:, 0]))
    centres = np.array([(2, 2), (5, 3)])
    for segment, place in zip(walls.body, inward, strict=True):
        if segment < 2:
            assert np.hypot(*(place - centres[segment])) > np.cos(np.pi / 35)
        else:
            assert (place > 0).all()
            assert (place < (7, 5)).all()
    assert walls.around[0] == pytest.approx(35 * walls.lengths[0])
    assert walls.arc[:3] == pytest.approx(walls.lengths[0] * np.arange(3))
    assert walls.arc[-1] == pytest.approx(19)
    assert np.array_equal(walls.edges[:35, 1], np.roll(walls.edges[:35, 0], -1))
    assert [domain.side_names[-1 - tag] for tag in walls.tags[-4:]] == list(domain.sides)


def test_kernel_and_twin_agree(walls):
    field = size_field(walls, 0.7, 0.3, 3, 0.25)
    tree = field.sources
    points = np.random.default_rng(0).uniform(-1, 9, (400, 2))
    plain = sizes_at_plain(points, tree.segments, tree.weights, field.slope, field.largest)
    assert field.at(points) == pytest.approx(plain, rel=1e-12)


def test_bounds_and_gradient(walls):
    field = size_field(walls, 0.7, 0.3, 3, 0.25)
    rng = np.random.default_rng(1)
    a, b = rng.uniform(0, 8, (2, 3000, 2))
    b = a + (b - a) * 10 ** rng.uniform(-4, 0, (3000, 1))
    here, there = field.at(a), field.at(b)
    assert np.all(np.abs(here - there) <= 0.25 * np.hypot(*(a - b).T) * (1 + 1e-9))
    assert here.max() <= 0.7
    assert here.min() > 0
    on_wall = field.at(0.5 * (walls.segments[:, :2] + walls.segments[:, 2:]))
    assert np.all(on_wall <= np.minimum(0.3, walls.lengths) * (1 + 1e-12))


def test_passage_between_two_plates_asks_for_its_layers():
    plates = [[(1, 1), (5, 1), (5, 2), (1, 2)], [(1, 2.3), (5, 2.3), (5, 3.3), (1, 3.3)]]
    walls = walls_of(Domain.rectangle(6, 4.3, plates))
    for across in (2, 4, 7):
        field = size_field(walls, 2.0, 2.0, across, 0.25)
        middle = np.column_stack((np.linspace(1.5, 4.5, 50), np.full(50, 2.15)))
        assert field.at(middle) == pytest.approx(0.3 * LAYER / across, rel=1e-9)


def test_passages_against_all_segments(walls):
    widest = 0.6
    passages = passages_of(walls, widest)
    assert len(passages.gap)
    assert passages.gap.max() < widest
    assert np.hypot(*(passages.points - passages.across).T) == pytest.approx(passages.gap, rel=1e-9)
    hits = 0
    for segment in range(len(walls.edges)):
        gap, hit, point = nearest_facing_plain(walls, segment, 0.0, widest)
        here = np.flatnonzero(np.abs(passages.points - walls.segments[segment, :2]).max(axis=1) < 1e-13)
        if hit >= 0:
            hits += 1
            assert gap == pytest.approx(passages.gap[here].min(), rel=1e-9)
            assert walls.body[hit] in passages.other[here]
            assert np.hypot(*(point - walls.segments[segment, :2])) == pytest.approx(gap)
        else:
            assert not len(here) or walls.body[segment] in passages.other[here]
    assert hits > 10
    assert nearest_facing.py_func.__name__ == "nearest_facing"


def test_passages_within_one_outline():
    # the two banks of a channel are one outline; those of a bay too; round pillars do not face themselves
    channel = passages_of(walls_of(Domain.rectangle(10, 1)), 2.0)
    middle = (channel.points[:, 0] > 2) & (channel.points[:, 0] < 8)
    assert channel.gap[middle] == pytest.approx(1.0)
    t = 2 * np.pi * np.arange(40) / 40
    round_pillar = np.column_stack((5 + 2 * np.cos(t), 5 + 0.2 * np.sin(t)))
    assert not len(passages_of(walls_of(Domain.rectangle(10, 10, [round_pillar])), 1.0).gap)
    bay = [(3, 3), (7, 3), (7, 7), (5.2, 7), (5.2, 4), (4.8, 4), (4.8, 7), (3, 7)]
    found = passages_of(walls_of(Domain.rectangle(10, 10, [bay])), 1.0)
    assert len(found.gap)
    assert found.gap.min() == pytest.approx(0.4)
    assert np.all((found.points[:, 0] > 4.7) & (found.points[:, 0] < 5.3))


def test_sizes_under_rotation(make_plexus):
    domain = make_plexus(6, 5, 5, 4, 0.3)
    turn = np.array([[0.6, -0.8], [0.8, 0.6]])
    turned = Domain(domain.outer @ turn.T, [p @ turn.T for p in domain.pillars], domain.sides)
    points = np.random.default_rng(2).uniform(0, 5, (500, 2))
    straight = size_field(walls_of(domain), 0.7, 0.3, 3, 0.25).at(points)
    rotated = size_field(walls_of(turned), 0.7, 0.3, 3, 0.25).at(points @ turn.T)
    assert rotated == pytest.approx(straight, rel=0.02)


def test_wall_nodes(walls):
    field = size_field(walls, 0.7, 0.3, 3, 0.25)
    points, edges, segment = wall_nodes(walls, field)
    assert np.array_equal(points[: len(walls.nodes)], walls.nodes)
    lengths = np.hypot(*(points[edges[:, 1]] - points[edges[:, 0]]).T)
    assert np.bincount(segment, weights=lengths) == pytest.approx(walls.lengths, rel=1e-12)
    assert np.array_equal(np.sort(edges[:, 0]), np.arange(len(points)))
    assert np.array_equal(np.sort(edges[:, 1]), np.arange(len(points)))
    sizes = field.at(0.5 * (points[edges[:, 0]] + points[edges[:, 1]]))
    assert np.all(lengths <= (1 + SLACK) * 1.15 * sizes)
    for s in np.unique(segment[np.bincount(segment)[segment] > 1])[:20]:
        inner = np.setdiff1d(edges[segment == s], walls.edges[s])
        line = walls.segments[s, :2] + np.linspace(0, 1, 2001)[:, None] * np.diff(
            walls.segments[s].reshape(2, 2), axis=0
        )
        edges_wanted = walls.lengths[s] * np.trapezoid(1 / field.at(line), dx=1 / 2000) - SLACK
        if abs(edges_wanted - round(edges_wanted)) < 0.02:
            continue  # the march in steps of half an edge may come out on the other side of the whole number
        places = cut_evenly_plain(walls.segments[s], field, SLACK)
        expected = walls.segments[s, :2] + places[:, None] * (walls.segments[s, 2:] - walls.segments[s, :2])
        assert len(inner) == len(expected)
        assert np.abs(points[inner] - expected).max() < 0.05 * sizes[segment == s].min()


def test_whole_segments_are_not_cut(walls):
    field = size_field(walls, 0.7, 0.05, 0, 0.25)
    _, edges, segment = wall_nodes(walls, field, whole=walls.tags >= 0)
    assert np.array_equal(np.bincount(segment)[walls.tags >= 0], np.ones(np.count_nonzero(walls.tags >= 0)))
    assert len(edges) > len(walls.edges)


def test_wall_edges_set_the_size_where_they_are(walls):
    field = size_field(walls, 0.7, 0.3, 0, 0.25)
    points, edges, _ = wall_nodes(walls, field)
    lengths = np.hypot(*(points[edges[:, 1]] - points[edges[:, 0]]).T)
    cut = with_wall_edges(field, points, edges)
    assert np.all(cut.at(0.5 * (points[edges[:, 0]] + points[edges[:, 1]])) <= lengths * (1 + 1e-9))


@pytest.mark.parametrize(("gap", "across", "wall"), [(0.3, 0, None), (0.3, 3, 0.15), (0.05, 0, None), (0.1, 4, None)])
def test_prediction_within_a_factor_of_two(gap, across, wall, make_plexus):
    domain = make_plexus(12, 8, 8, 2, gap)
    walls = walls_of(domain)
    total, dearest, (one, other, width) = predicted_triangles(
        walls, size_field(walls, 0.7, wall or 0.7, across, 0.25), domain.area
    )
    made = len(generate_mesh(domain, 0.7, wall, across=across).triangles)
    assert 0.5 < made / total < 1.5
    assert 0 < dearest < total
    assert 0 <= one <= other <= len(domain.pillars)
    assert 0.4 * gap < width < 1.3 * gap
