"""Truss relaxation, snapping and smoothing."""

import numpy as np
import pytest

from vasculo.geometry.domain import Domain
from vasculo.mesh.adjacency import adjacency, stars
from vasculo.mesh.charges import STRENGTH, relax_charges, repel, repel_plain
from vasculo.mesh.draft import Draft
from vasculo.mesh.generate import first_draft
from vasculo.mesh.improve import BLOCK, STILL, smooth, smooth_draft, star_energy
from vasculo.mesh.improve_plain import smooth_plain
from vasculo.mesh.quality import edge_lengths, signed_areas, triangle_quality
from vasculo.mesh.size import size_field
from vasculo.mesh.snap import snap_to_walls
from vasculo.mesh.triangulate.flips import retriangulate
from vasculo.mesh.truss import (
    DAMPING,
    PRESSURE,
    TIME_STEP,
    relax_truss,
    spring_forces,
    spring_forces_plain,
    step_masses,
    step_masses_plain,
    unique_edges,
)
from vasculo.mesh.walls import walls_of
from vasculo.springs.threads import get_threads, set_threads


@pytest.fixture
def draft(make_plexus):
    walls = walls_of(make_plexus(8, 6, 6, 1, 0.5))
    return first_draft(walls, size_field(walls, 0.6, 0.3, 2, 0.25), 1000, 10**6)


def hexagon(shift=(0.0, 0.0)):
    """Six wall nodes and one in the middle, moved."""
    angle = np.pi / 3 * np.arange(6)
    points = np.concatenate((np.column_stack((np.cos(angle), np.sin(angle))), [shift]))
    triangles = np.array([(i, (i + 1) % 6, 6) for i in range(6)], dtype=np.int32)
    edges = np.array([(i, (i + 1) % 6) for i in range(6)], dtype=np.int32)
    fixed = np.arange(7) < 6
    return Draft(points, np.ones(7), fixed, triangles, adjacency(triangles, 7), edges, np.arange(6, dtype=np.int32))


def test_unique_edges(draft):
    edges = unique_edges(draft.triangles, draft.neighbours)
    expected = np.unique(np.sort(draft.triangles[:, [(0, 1), (1, 2), (2, 0)]].reshape(-1, 2), axis=1), axis=0)
    assert np.array_equal(np.unique(np.sort(edges, axis=1), axis=0), expected)
    assert len(edges) == len(expected)


@pytest.mark.parametrize("push_only", [True, False])
@pytest.mark.parametrize("least", [0.0, 0.7])
def test_kernels_and_twins_agree(draft, least, push_only):
    rng = np.random.default_rng(0)
    draft.points[~draft.fixed] += 0.02 * rng.normal(size=(np.count_nonzero(~draft.fixed), 2))
    retriangulate(draft)
    springs = unique_edges(draft.triangles, draft.neighbours)
    floor = least * 2 * signed_areas(draft.points, draft.triangles)
    one, other = draft.points.copy(), draft.points.copy()
    speed, pace, old = np.zeros_like(one), np.zeros_like(one), np.empty_like(one)
    rest = (floor, TIME_STEP, DAMPING)
    for _ in range(6):
        force, pull = np.zeros_like(one), np.zeros_like(one)
        spring_forces(one, springs, draft.sizes, PRESSURE, force, push_only=push_only)
        spring_forces_plain(other, springs, draft.sizes, PRESSURE, pull, push_only=push_only)
        assert np.abs(force - pull).max() < 1e-12
        step_masses(one, speed, force, old, draft.triangles, draft.fixed, *rest)
        step_masses_plain(other, pace, pull, draft.triangles, draft.fixed, *rest)
    assert np.abs(one - other).max() < 1e-12
    assert np.abs(speed - pace).max() < 1e-12
    assert np.array_equal(one[draft.fixed], draft.points[draft.fixed])
    assert np.abs(one - draft.points)[~draft.fixed].max() > 1e-3
    assert np.all(2 * signed_areas(one, draft.triangles) >= floor)


@pytest.mark.parametrize("threads", [1, 3])
def test_repulsion_and_twin_agree(draft, threads):
    charges = np.sqrt(STRENGTH) * draft.sizes**1.5
    force, plain = np.zeros_like(draft.points), np.zeros_like(draft.points)
    for rank in range(threads):
        repel(rank, threads, draft.points, charges, draft.fixed, force)
    repel_plain(draft.points, charges, draft.fixed, plain)
    assert np.abs(force - plain).max() < 1e-12 * np.abs(plain).max()
    assert np.abs(force[draft.fixed]).max() == 0.0


def test_two_charges_repel_by_coulombs_law():
    points, charges = np.array([(0.0, 0.0), (3.0, 4.0)]), np.array([2.0, 5.0])
    force = np.zeros((2, 2))
    repel(0, 1, points, charges, np.zeros(2, dtype=bool), force)
    assert force == pytest.approx(np.array([(-0.6, -0.8), (0.6, 0.8)]) * 10.0 / 25.0)


def test_charges_find_the_middle_and_keep_the_triangles_positive(draft):
    star = hexagon((0.2, -0.1))
    for _ in range(8):
        relax_charges(star)
    assert np.abs(star.points[6]).max() < 1e-3
    rng = np.random.default_rng(2)
    draft.points[~draft.fixed] += 0.02 * rng.normal(size=(np.count_nonzero(~draft.fixed), 2))
    retriangulate(draft)
    before = triangle_quality(draft.points, draft.triangles).mean()
    for _ in range(3):
        relax_charges(draft)
        retriangulate(draft)
    assert triangle_quality(draft.points, draft.triangles).mean() > before + 0.01
    assert signed_areas(draft.points, draft.triangles).min() > 0


def test_springs_push_a_node_back_to_the_middle():
    draft = hexagon((0.2, -0.1))
    for _ in range(8):
        relax_truss(draft)
    assert np.abs(draft.points[6]).max() < 1e-6


def test_springs_only_push():
    # a sparse mesh: rest lengths follow the mean length, so no spring pulls, and one that is long enough does nothing
    draft = hexagon()
    relax_truss(draft)
    assert np.abs(draft.points[6]).max() < 1e-15


def test_relaxation_evens_out_the_lengths(draft):
    rng = np.random.default_rng(2)
    draft.points[~draft.fixed] += 0.02 * rng.normal(size=(np.count_nonzero(~draft.fixed), 2))
    assert signed_areas(draft.points, draft.triangles).min() > 0
    retriangulate(draft)

    def spread():
        wanted = draft.sizes[draft.triangles].mean(axis=1)
        return np.std(edge_lengths(draft.points, draft.triangles).mean(axis=1) / wanted)

    before = spread()
    for _ in range(3):
        relax_truss(draft)
        retriangulate(draft)
    assert spread() < 0.9 * before
    assert signed_areas(draft.points, draft.triangles).min() > 0


def test_a_node_close_to_a_wall_is_snapped_for_good():
    points = np.array([(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0), (1.1, 0.2)])
    triangles = np.array([(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)], dtype=np.int32)
    edges = np.array([(0, 1), (1, 2), (2, 3), (3, 0)], dtype=np.int32)
    draft = Draft(
        points, np.ones(5), np.arange(5) < 4, triangles, adjacency(triangles, 5), edges, np.arange(4, dtype=np.int32)
    )
    assert snap_to_walls(draft) == 1
    assert draft.points[4] == pytest.approx([1.1, 0.0])
    assert draft.fixed.all()
    assert len(draft.triangles) == 3
    assert signed_areas(draft.points, draft.triangles).sum() == pytest.approx(4.0)
    pairs = sorted(map(tuple, draft.edges.tolist()))
    assert pairs == [(0, 4), (1, 2), (2, 3), (3, 0), (4, 1)]
    assert sorted(draft.segment.tolist()) == [0, 0, 1, 2, 3]
    assert np.array_equal(draft.neighbours, adjacency(draft.triangles, 5))
    relax_truss(draft)
    assert draft.points[4] == pytest.approx([1.1, 0.0])
    assert snap_to_walls(draft) == 0


def test_nodes_away_from_the_middle_of_an_edge_or_far_from_it_stay():
    for place in ((0.2, 0.1), (1.0, 0.5)):
        points = np.array([(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0), place])
        triangles = np.array([(0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)], dtype=np.int32)
        edges = triangles[:, :2].copy()
        draft = Draft(
            points,
            np.ones(5),
            np.arange(5) < 4,
            triangles,
            adjacency(triangles, 5),
            edges,
            np.arange(4, dtype=np.int32),
        )
        assert snap_to_walls(draft) == 0
        assert draft.points[4] == pytest.approx(place)


def test_snapping_many_keeps_area_and_topology(draft):
    # push every third node in front of a wall against it, where no triangle folds
    rows, corner = np.nonzero(draft.neighbours < 0)
    apex = draft.triangles[rows, corner]
    a, b = (draft.points[draft.triangles[rows, (corner + k) % 3]] for k in (1, 2))
    for e in np.flatnonzero(~draft.fixed[apex])[::3]:
        old = draft.points[apex[e]].copy()
        draft.points[apex[e]] = 0.47 * a[e] + 0.47 * b[e] + 0.06 * old
        if signed_areas(draft.points, draft.triangles).min() <= 0:
            draft.points[apex[e]] = old
    area = signed_areas(draft.points, draft.triangles).sum()
    before, wall = len(draft.triangles), len(draft.edges)
    snapped = snap_to_walls(draft)
    assert snapped > 10
    assert len(draft.triangles) == before - snapped
    assert len(draft.edges) == wall + snapped
    assert signed_areas(draft.points, draft.triangles).sum() == pytest.approx(area, rel=1e-12)
    assert signed_areas(draft.points, draft.triangles).min() > 0
    assert np.count_nonzero(draft.neighbours < 0) == len(draft.edges) == len(draft.segment)
    assert np.array_equal(draft.fixed, np.isin(np.arange(len(draft.points)), draft.edges))


def test_smoothing_kernel_and_twin_agree(draft):
    plain = draft.points.copy()
    smooth(draft.points, draft.triangles, *stars(draft.triangles, len(plain)), draft.fixed, 1)
    smooth_plain(plain, draft.triangles, draft.fixed)
    assert np.abs(draft.points - plain).max() < 1e-10
    assert np.abs(draft.points - plain)[draft.fixed].max() == 0.0


def test_smoothing_finds_the_regular_star_and_raises_quality(draft):
    star = hexagon((0.3, 0.2))
    for _ in range(8):
        smooth_draft(star)
    assert np.abs(star.points[6]).max() < np.sqrt(STILL)
    before = triangle_quality(draft.points, draft.triangles)
    smooth_draft(draft)
    after = triangle_quality(draft.points, draft.triangles)
    assert after.mean() > before.mean()


def test_smoothing_is_the_same_on_any_number_of_threads(make_plexus):
    walls = walls_of(make_plexus(16, 9, 9, 1, 0.5))
    one = first_draft(walls, size_field(walls, 0.05, 0.05, 0, 0.25), 40_000, 10**6)
    assert len(one.points) > 4 * BLOCK
    first, star = stars(one.triangles, len(one.points))
    alone, together = one.points.copy(), one.points.copy()
    threads = get_threads()
    try:
        set_threads(1)
        smooth(alone, one.triangles, first, star, one.fixed, 2)
        set_threads(3)
        smooth(together, one.triangles, first, star, one.fixed, 2)
    finally:
        set_threads(threads)
    assert np.array_equal(alone, together)
    assert triangle_quality(alone, one.triangles).mean() > triangle_quality(one.points, one.triangles).mean() + 0.005
    assert signed_areas(alone, one.triangles).min() > 0


def test_stars_hold_every_corner_once(draft):
    first, star = stars(draft.triangles, len(draft.points))
    assert np.array_equal(np.sort(star), np.arange(draft.triangles.size))
    owner = np.repeat(np.arange(len(draft.points)), np.diff(first))
    assert np.array_equal(draft.triangles.ravel()[star], owner)


def test_star_energy_counts_from_one():
    star = hexagon()
    first, corners = stars(star.triangles, 7)
    assert star_energy(star.points, star.triangles, corners, first[6], first[7], 0.0, 0.0) == pytest.approx(6.0)
    assert star_energy(star.points, star.triangles, corners, first[6], first[7], 2.0, 0.0) == np.inf


def test_domain_of_one_triangle_needs_no_inner_node():
    walls = walls_of(Domain([(0, 0), (1, 0), (0, 1)], [], list("abc")))
    draft = first_draft(walls, size_field(walls, 5.0, 5.0, 0, 0.25), 1, 100)
    assert len(draft.triangles) == 1
    relax_truss(draft)
    snap_to_walls(draft)
    smooth_draft(draft)
    assert len(draft.triangles) == 1
