"""The even mesh between the pillars."""

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from vasculo.errors import InputError
from vasculo.geometry.domain import Domain
from vasculo.mesh.matrix import matrix_springs
from vasculo.mesh.quality import signed_areas


def check(domain, mesh):
    points, springs, triangles, pinned = mesh
    membrane = np.concatenate([*domain.pillars, np.empty((0, 2))])
    assert np.array_equal(points[: len(membrane)], membrane)
    areas = signed_areas(points, triangles)
    assert areas.min() > 0
    assert areas.sum() == pytest.approx(domain.area, rel=1e-12)
    sides = np.sort(triangles[:, [(0, 1), (1, 2), (2, 0)]].reshape(-1, 2), axis=1)
    edges, uses = np.unique(sides, axis=0, return_counts=True)
    assert np.array_equal(np.unique(np.sort(springs, axis=1), axis=0), edges)
    assert len(springs) == len(edges)
    # the edges of one triangle are exactly the membranes, uncut, and the outer boundary between pinned nodes
    rim = edges[uses == 1]
    outer = pinned[rim].all(axis=1)
    first = 0
    expected = []
    for pillar in domain.pillars:
        number = first + np.arange(len(pillar))
        expected.append(np.column_stack((number, np.roll(number, -1))))
        first += len(pillar)
    if expected:
        found = np.unique(np.sort(np.concatenate(expected), axis=1), axis=0)
        assert np.array_equal(rim[~outer], found)
    assert not pinned[: len(membrane)].any()
    box = shapely.LinearRing(domain.outer)
    on_box = shapely.distance(shapely.points(points), box) < 1e-12 * np.abs(domain.outer).max()
    assert np.array_equal(on_box, pinned)


def test_plexus_with_coarse_springs(make_plexus):
    for gap in (0.6, 0.3, 0.09):
        domain = make_plexus(14, 9, 9, 0, gap)
        mesh = matrix_springs(domain, 0.45)
        check(domain, mesh)
        lengths = np.hypot(*(mesh.points[mesh.springs[:, 1]] - mesh.points[mesh.springs[:, 0]]).T)
        # no place is farther than 1.25 spacings from a node, so no empty circle is wider than twice that
        assert lengths.max() < 2.5 * 0.45


def test_no_spring_runs_through_a_pillar(make_plexus):
    domain = make_plexus(14, 9, 9, 1, 0.09)
    mesh = matrix_springs(domain, 0.45)
    lines = shapely.linestrings(mesh.points[mesh.springs])
    tree = shapely.STRtree(lines)
    for pillar in domain.pillars:
        inset = shapely.Polygon(pillar).buffer(-1e-9)
        assert not len(tree.query(inset, predicate="intersects"))


def test_every_membrane_node_holds_a_matrix_spring(make_plexus):
    domain = make_plexus(14, 9, 9, 2, 0.2)
    mesh = matrix_springs(domain, 0.45)
    membrane = sum(len(p) for p in domain.pillars)
    owner = np.full(len(mesh.points), -1)
    owner[:membrane] = np.repeat(np.arange(len(domain.pillars)), [len(p) for p in domain.pillars])
    a, b = mesh.springs.T
    bridge = (owner[a] != owner[b]) | (owner[a] < 0)
    held = np.zeros(len(mesh.points), dtype=bool)
    held[a[bridge]] = held[b[bridge]] = True
    assert held[:membrane].mean() > 0.9


@settings(deadline=None, max_examples=25)
@given(seed=st.integers(0, 10**6), most=st.integers(0, 25), spacing=st.floats(0.3, 2.0))
def test_random_sharp_pillars(seed, most, spacing, make_stars):
    domain = make_stars(seed, most)
    check(domain, matrix_springs(domain, spacing))


def test_same_input_same_mesh(make_plexus):
    one, other = (matrix_springs(make_plexus(8, 6, 6, 3, 0.3), 0.45) for _ in range(2))
    assert all(np.array_equal(a, b) for a, b in zip(one, other, strict=True))


def test_empty_box_is_even():
    points, _, triangles, pinned = matrix_springs(Domain.rectangle(9, 6), 0.45)
    assert 0.8 < len(triangles) / (54 / (np.sqrt(3) / 4 * 0.45**2)) < 1.1
    assert pinned.sum() == pytest.approx(30 / 0.45, abs=4)
    assert signed_areas(points, triangles).std() < 0.3 * signed_areas(points, triangles).mean()


@pytest.mark.parametrize(
    ("spacing", "words"),
    [
        (0.0, "must be a positive length"),
        (np.nan, "must be a positive length"),
        (1e-5, "more than the limit of 5000000"),
    ],
)
def test_refused_spacing(spacing, words):
    with pytest.raises(InputError, match=words):
        matrix_springs(Domain.rectangle(9, 6), spacing)


def test_refused_passage(make_disk):
    domain = Domain.rectangle(10, 10, [make_disk(3, 5, k=36), make_disk(5 + 2e-9, 5, k=36)])
    with pytest.raises(InputError, match="pillar 0 and pillar 1 are 2e-09 apart"):
        matrix_springs(domain, 0.45)
