"""Interior nodes: the grids against all pairs, distances, the inside."""

import numpy as np
import pytest
import shapely
from scipy.spatial import cKDTree

from vasculo.geometry.domain import Domain
from vasculo.mesh.nearby import CLEAR
from vasculo.mesh.placement import OFF_WALL, STRIP, interior_nodes
from vasculo.mesh.placement_plain import interior_nodes_plain
from vasculo.mesh.size import size_field, with_wall_edges
from vasculo.mesh.subdivide import wall_nodes
from vasculo.mesh.walls import walls_of
from vasculo.springs.threads import get_threads, set_threads


def start(domain, *sizes):
    walls = walls_of(domain)
    field = size_field(walls, *sizes)
    points, edges, _ = wall_nodes(walls, field)
    return with_wall_edges(field, points, edges), points, edges


def place(field, points, edges, expected=1000, most=10**6):
    return interior_nodes(field, points, field.at(points), edges, expected, most)


@pytest.mark.parametrize("seed", range(3))
def test_kernel_and_twin_agree(seed, make_stars):
    field, points, edges = start(make_stars(seed, 6), 0.9, 0.4, 1.5, 0.3)
    found, sizes = place(field, points, edges)
    plain, wanted = interior_nodes_plain(field, points, edges)
    assert len(found) == len(plain) > 100
    assert np.abs(found - plain).max() < 1e-9
    assert np.abs(sizes - wanted).max() < 1e-9
    assert np.abs(sizes - field.at(found)).max() < 0.3


def test_nodes_are_inside_and_apart(make_plexus):
    domain = make_plexus(16, 9, 9, 3, 0.4)
    field, points, edges = start(domain, 0.7, 0.25, 3, 0.25)
    inner, _ = place(field, points, edges)
    sizes = field.at(inner)
    fluid = shapely.Polygon(domain.outer, [p[::-1] for p in domain.pillars])
    assert shapely.contains_properly(fluid, shapely.points(inner)).all()
    away = shapely.distance(shapely.points(inner), fluid.boundary)
    assert np.all(away >= OFF_WALL * (1 - 0.3) * sizes)
    distance, _ = cKDTree(np.concatenate((points, inner))).query(inner, k=2)
    assert np.all(distance[:, 1] >= CLEAR * (1 - 0.3) * sizes)
    # and no hole is left: every place in the fluid has a node near
    places = np.random.default_rng(0).uniform((-1, 0), (10, 9), (4000, 2))
    places = places[shapely.contains_properly(fluid, shapely.points(places))]
    distance, _ = cKDTree(np.concatenate((points, inner))).query(places)
    assert np.all(distance <= 1.25 * field.at(places))


def test_more_room_is_made_when_needed():
    domain = Domain.rectangle(10, 10)
    field, points, edges = start(domain, 0.1, 0.1, 0, 0.25)
    inner, _ = place(field, points, edges)
    again, _ = place(field, points, edges, expected=10)
    assert np.array_equal(inner, again)
    assert len(inner) > 10_000
    assert place(field, points, edges, most=len(points) + len(inner) - 1) is None
    assert len(place(field, points, edges, most=len(points) + len(inner))[0]) == len(inner)


def test_a_passage_too_narrow_for_a_row_gets_none():
    plates = [[(1, 1), (5, 1), (5, 2), (1, 2)], [(1, 2.1), (5, 2.1), (5, 3.1), (1, 3.1)]]
    field, points, edges = start(Domain.rectangle(6, 4.1, plates), 0.7, 0.7, 0, 0.25)
    inner, _ = place(field, points, edges)
    between = (np.abs(inner[:, 1] - 2.05) < 0.05) & (np.abs(inner[:, 0] - 3) < 1.9)
    assert not between.any()


@pytest.mark.parametrize("tall", [False, True])
def test_strips_leave_no_seam_and_do_not_depend_on_threads(tall, make_disk):
    swap = (lambda p: p[:, ::-1]) if tall else (lambda p: p)
    disks = [make_disk(x, y, 0.5) for x, y in ((1.5, 1.5), (3.3, 3.2), (5.02, 1.4), (6.6, 3.0), (8.4, 1.7))]
    outer = np.array([(0, 0), (10, 0), (10, 4.4), (0, 4.4)], dtype=float)
    domain = Domain(swap(outer), [swap(disk) for disk in disks], list("abcd"))
    field, points, edges = start(domain, 0.033, 0.02, 0, 0.25)
    expected = 0.5 * domain.area / 0.433 / 0.033**2
    assert expected > 2 * STRIP
    threads, found = get_threads(), []
    try:
        for number in (1, 3):
            set_threads(number)
            found.append(place(field, points, edges, expected))
    finally:
        set_threads(threads)
    (inner, sizes), (other, _) = found
    assert np.array_equal(inner, other)
    assert sizes == pytest.approx(field.at(inner), abs=0.3 * 0.033)
    everything = np.concatenate((points, inner))
    assert cKDTree(everything).query(inner, k=2)[0][:, 1].min() >= CLEAR * (1 - 0.25) * 0.02
    # no hole anywhere, and none at the cuts
    along = np.linspace(0.0, 1.0, 4001)[:, None]
    strips = int(expected // STRIP)
    cuts = np.arange(1, strips) / strips * 10.0
    places = [swap(np.hstack((np.full_like(along, cut), 4.4 * along))) for cut in cuts]
    places.append(np.random.default_rng(0).random((20_000, 2)) * np.ptp(domain.outer, axis=0))
    fluid = shapely.Polygon(domain.outer, [p[::-1] for p in domain.pillars])
    for some in places:
        inside = some[shapely.contains_xy(fluid, some)]
        assert np.all(cKDTree(everything).query(inside)[0] <= 1.25 * field.at(inside))
