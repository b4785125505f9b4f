"""Interior nodes: the grids against all pairs, distances, the inside."""

import numpy as np
import pytest
import shapely
from scipy.spatial import cKDTree

from vasculo.geometry.domain import Domain
from vasculo.mesh.nearby import CLEAR
from vasculo.mesh.placement import OFF_WALL, interior_nodes
from vasculo.mesh.placement_plain import interior_nodes_plain
from vasculo.mesh.size import size_field, with_wall_edges
from vasculo.mesh.subdivide import wall_nodes
from vasculo.mesh.walls import walls_of


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
