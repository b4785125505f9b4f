"""Kernels of the repair against their plain twins."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vasculo.mesh.adjacency import stars
from vasculo.mesh.generate import generate_mesh
from vasculo.mesh.quality import signed_areas
from vasculo.mesh.repair.carry import carry, carry_plain, layers_from, mark_around, mark_broken, mark_broken_plain
from vasculo.mesh.repair.edit import cut_edge, draw_into, fan
from vasculo.mesh.repair.light import ACROSS_LONG, ACROSS_SHORT, LONG, SHORT, SLACK, is_misfit, is_misfit_plain
from vasculo.mesh.repair.match import follow_segments_plain, match_outlines, wall_segments
from vasculo.mesh.repair.plain import (
    cut_edge_plain,
    draw_into_plain,
    nearest_wall_plain,
    spread_sizes_plain,
    triangle_set,
)
from vasculo.mesh.repair.sizes import Wanted, foot, mesh_sizes, nearest_walls, ring_walls, spread_sizes
from vasculo.mesh.repair.work import wall_edges, work_on
from vasculo.mesh.size import with_wall_edges
from vasculo.mesh.triangulation import adjacency
from vasculo.mesh.walls import walls_of


@pytest.fixture(scope="module")
def piece(make_plexus):
    domain = make_plexus(5, 5.0, 4.0, 2, 0.4)
    mesh = generate_mesh(domain, 0.6, 0.2, across=2)
    return domain, mesh, stars(mesh.triangles, len(mesh.points))


def test_wall_edges_find_their_segments(piece):
    domain, mesh, _ = piece
    walls = walls_of(domain)
    assert np.array_equal(wall_segments(mesh, walls), follow_segments_plain(mesh.boundary_edges, walls.edges))


def test_outlines_are_paired_whatever_their_numbers(piece):
    domain, _, _ = piece
    order = np.random.default_rng(0).permutation(len(domain.pillars))
    after = domain.with_pillars([domain.pillars[k] + 0.01 for k in order[1:]])
    match = match_outlines(walls_of(domain), walls_of(after))
    assert np.array_equal(match.after[np.argsort(match.before)][:-1], np.argsort(order)[np.sort(order[1:])] - 1)
    kept = match.nodes >= 0
    assert np.count_nonzero(~kept) == len(domain.pillars[order[0]])
    away = walls_of(after).nodes[match.nodes[kept]] - walls_of(domain).nodes[kept]
    assert np.abs(away).max() < 0.01 + 1e-12
    assert len(match.fresh) == 0


def test_carrying_against_its_twin(piece):
    _, mesh, (first, star) = piece
    rng = np.random.default_rng(1)
    wall = np.zeros(len(mesh.points), dtype=np.bool_)
    wall[mesh.boundary_edges.ravel()] = True
    layer = np.where(mesh.boundary_tags.max() == -1, -1, np.full(len(mesh.points), -1)).astype(np.int32)
    layer[mesh.boundary_edges[mesh.boundary_tags == 1].ravel()] = 0
    order = np.empty(len(layer), dtype=np.int32)
    count = layers_from(mesh.triangles, first, star, wall, 3, layer, order)
    assert layer[order[:count]].max() == 3
    assert (np.diff(layer[order[:count]]) >= 0).all()
    moves = np.where((layer == 0)[:, None], rng.normal(size=(len(layer), 2)), 0.0)
    twin = moves.copy()
    carry(mesh.triangles, first, star, layer, order, count, 3, 3, moves)
    carry_plain(mesh.triangles, layer, order[:count], 3, 3, twin)
    assert moves == pytest.approx(twin, abs=1e-12)
    assert not moves[layer < 0].any()


def test_marks_against_their_twins(piece):
    _, mesh, _ = piece
    rng = np.random.default_rng(2)
    points = mesh.points + rng.normal(scale=0.05, size=mesh.points.shape)
    marked = np.empty(len(mesh.triangles), dtype=np.bool_)
    number = mark_broken(points, mesh.triangles, 0.5, marked)
    assert np.array_equal(marked, mark_broken_plain(points, mesh.triangles, 0.5))
    assert number == marked.sum() > 0
    nodes = rng.random(len(points)) < 0.01
    mark_around(mesh.triangles, nodes, marked)
    assert np.array_equal(marked, nodes[mesh.triangles].any(axis=1))


def test_nearest_walls_and_sizes_against_all_pairs(piece):
    domain, mesh, (first, star) = piece
    walls = walls_of(domain)
    work, _ = work_on(mesh, walls, walls, match_outlines(walls, walls))
    count = len(mesh.points)
    onward, own = np.full((count, 2), -1, dtype=np.int32), np.full(count, -1, dtype=np.int32)
    ring_walls(work.triangles, work.neighbours, onward, own)
    layer, order, wall = np.where(own >= 0, 0, -1).astype(np.int32), *np.empty((2, count), dtype=np.int32)
    layers_from(mesh.triangles, first, star, np.zeros(count, dtype=np.bool_), count, layer, order)
    nearest_walls(mesh.points, mesh.triangles, first, star, onward, order, 10.0, wall)
    found = np.sqrt([foot(mesh.points, onward, w, *p)[0] for w, p in zip(wall, mesh.points, strict=True)])
    exact = nearest_wall_plain(mesh.points, mesh.boundary_edges)
    # the search goes from neighbour to neighbour: seldom another wall is a little nearer
    assert np.percentile(found - exact, 97) < 1e-12
    assert (found - exact).max() < 0.1
    sizes = np.random.default_rng(3).uniform(0.01, 1.0, (count, 2))
    wanted = spread_sizes_plain(mesh.points, mesh.triangles, 0.25, sizes)
    spread_sizes(mesh.points, mesh.triangles, first, star, order, 0.25, 40, sizes)
    assert sizes == pytest.approx(wanted, rel=1e-9)


@pytest.mark.parametrize("across", [0, 3])
def test_sizes_from_the_mesh_against_the_size_field(piece, across):
    domain, _, _ = piece
    walls = walls_of(domain)
    wanted = Wanted(0.6, 0.2, across, 0.25, 0.0, None)
    mesh = generate_mesh(domain, 0.6, 0.2, across=across)
    work, _ = work_on(mesh, walls, walls, match_outlines(walls, walls))
    field = wanted.field(walls)
    wished, sizes = mesh_sizes(work, walls, wanted)
    on_wall = mesh.boundary_edges[:, 0]
    ratio = wished[on_wall] / field.at(mesh.points[on_wall])
    assert np.percentile(ratio, 1) > 0.8
    assert np.percentile(ratio, 99) < 1.25
    ratio = sizes / with_wall_edges(field, mesh.points, mesh.boundary_edges).at(mesh.points)
    assert 0.7 < ratio.min() <= ratio.max() < 1.4


def test_a_wish_for_curvature_or_by_a_function_is_the_size_fields(piece):
    domain, mesh, _ = piece
    walls = walls_of(domain)
    work, _ = work_on(mesh, walls, walls, match_outlines(walls, walls))
    for curvature, size in ((40.0, None), (0.0, lambda places: 0.1 + 0.05 * places[:, 0] ** 2)):
        wanted = Wanted(0.6, 0.2, 2, 0.25, curvature, size)
        field = wanted.field(walls)
        wished, sizes = mesh_sizes(work, walls, wanted)
        assert np.array_equal(wished, field.at(mesh.points))
        assert np.array_equal(sizes, with_wall_edges(field, mesh.points, wall_edges(work)[0]).at(mesh.points))


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 2**32 - 1))
def test_edits_against_their_twins(piece, seed):
    _, mesh, _ = piece
    rng = np.random.default_rng(seed)
    count, nodes = len(mesh.triangles), len(mesh.points)
    triangles, neighbours = np.empty((count + 2, 3), dtype=np.int32), np.empty((count + 2, 3), dtype=np.int32)
    triangles[:count], neighbours[:count] = mesh.triangles, mesh.neighbours
    dirty = np.zeros(count + 2, dtype=np.bool_)
    t, c = int(rng.integers(count)), int(rng.integers(3))
    start, end = (int(triangles[t, (c + k) % 3]) for k in (1, 2))
    points = np.concatenate((mesh.points, mesh.points[[start, end]].mean(axis=0)[None]))
    wanted = cut_edge_plain(triangle_set(mesh.triangles), start, end, nodes)
    now = cut_edge(triangles, neighbours, dirty, t, c, nodes, count)
    assert triangle_set(triangles[:now]) == wanted
    assert np.array_equal(neighbours[:now], adjacency(triangles[:now], nodes + 1))
    # draw an inner node into a neighbour
    inner = np.setdiff1d(np.arange(nodes + 1), mesh.boundary_edges)
    node = int(rng.choice(inner))
    t = int(np.flatnonzero((triangles[:now] == node).any(axis=1))[0])
    if (neighbours[:now][(triangles[:now] == node).any(axis=1)] < 0).any() and node == nodes:
        return
    around = np.empty(64, dtype=np.int32)
    number = fan(triangles[:now], neighbours[:now], t, node, around)
    ring = triangles[around[:number] // 3, (around[:number] % 3 + 1) % 3]
    assert number == np.count_nonzero(triangles[:now] == node)
    into = int(rng.choice(ring))
    before = triangles[:now].copy()
    done = draw_into(points, triangles[:now], neighbours[:now], dirty, around, number, into)
    if not done:
        assert np.array_equal(triangles[:now], before)
        return
    alive = triangles[:now, 0] >= 0
    assert triangle_set(triangles[:now]) == draw_into_plain(triangle_set(before), node, into)
    assert signed_areas(points, triangles[:now][alive]).min() > 0.0
    assert signed_areas(points, triangles[:now][alive]).sum() == pytest.approx(mesh.areas.sum(), rel=1e-12)
    place = np.cumsum(alive) - 1
    kept = neighbours[:now][alive]
    assert np.array_equal(np.where(kept >= 0, place[kept], -1), adjacency(triangles[:now][alive], nodes + 1))


def test_misfits_against_their_twin(make_plexus):
    mesh = generate_mesh(make_plexus(6, 5.0, 5.0, 1, 0.5), 0.2)
    on_wall = np.zeros(len(mesh.points), dtype=bool)
    on_wall[mesh.boundary_edges] = True
    rng = np.random.default_rng(0)
    outcomes = []
    for move in np.geomspace(1e-4, 0.1, 40):
        points = mesh.points + move * rng.normal(size=mesh.points.shape)
        touched = rng.random(len(points)) < 0.1
        facts = points, mesh.points, mesh.triangles, mesh.neighbours, on_wall, touched, mesh.sizes, 0.5
        outcomes.append(is_misfit(*facts))
        assert outcomes[-1] == is_misfit_plain(*facts)
    assert 5 < sum(outcomes) < 35
    # each reason alone: flat, short, long; walls may be short, and a triangle between two walls may be flat
    square = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    triangles = np.array([(0, 1, 2), (0, 2, 3)], dtype=np.int32)
    walls, inner = np.array([(-1, 1, -1), (-1, -1, 0)], dtype=np.int32), np.zeros((2, 3), dtype=np.int32)

    def found(points, wanted, sides, least=0.0, from_wall=False, before=1e3):
        walls, everywhere = np.full(4, from_wall), np.ones(4, dtype=bool)
        facts = points, before * points, triangles, sides, walls, everywhere, np.full(4, wanted), least
        assert is_misfit(*facts) == is_misfit_plain(*facts)
        return is_misfit(*facts)

    assert not found(square, 1.0, inner)
    assert found(square, 1.01 / SHORT, inner)
    assert not found(square, 1.01 / SHORT, walls)
    assert found(square, 0.99 * np.sqrt(2.0) / LONG, inner, before=1e-3)
    # what was so before may be so, until it is much more so
    assert not found(square, 1.01 / SHORT, inner, before=1.0)
    assert found(square, 1.01 * SLACK / SHORT, inner, before=1.0)
    assert not found(square, 0.99 * np.sqrt(2.0) / LONG, inner, before=1.0)
    assert found(square, 0.99 * np.sqrt(2.0) / LONG / SLACK, inner, before=1.0)
    assert found(square, 1.01 / ACROSS_SHORT, inner, from_wall=True)
    assert not found(square, 1.01 / ACROSS_SHORT, inner)
    assert found(square, 0.99 * np.sqrt(2.0) / ACROSS_LONG, inner, from_wall=True, before=1e-3)
    assert found(square, 1.0, inner, least=0.9)
    assert not found(square, 1.0, walls, least=0.9)
