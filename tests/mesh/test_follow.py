"""A mesh that follows its walls: same triangles, valid, as good as asked for, or none at all."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vasculo.errors import InputError
from vasculo.geometry.domain import Domain
from vasculo.geometry.outline import resample
from vasculo.mesh.generate import generate_mesh
from vasculo.mesh.repair.carry import mark_broken_plain
from vasculo.mesh.repair.follow import POOR, follow_mesh
from vasculo.mesh.triangulation import Triangulation

LENGTHS = (0.7, 0.2)


def stretched(domain, share):
    """All pillars longer along x and thinner along y by a share."""
    centres = [outline.mean(axis=0) for outline in domain.pillars]
    factors = np.array([1.0 + share, 1.0 / (1.0 + share)])
    return domain.with_pillars([c + (p - c) * factors for c, p in zip(centres, domain.pillars, strict=True)])


@pytest.fixture(scope="module")
def wide(make_plexus):
    domain = make_plexus(12, 8.0, 6.0, 3, 0.6)
    return domain, generate_mesh(domain, *LENGTHS, across=2)


def test_triangles_walls_and_sizes_stay(wide, check_mesh):
    domain, mesh = wide
    after = stretched(domain, 0.03)
    moved = follow_mesh(mesh, domain, after)
    check_mesh(moved, after)
    for name in ("triangles", "boundary_edges", "boundary_tags", "neighbours", "sizes"):
        assert np.array_equal(getattr(moved, name), getattr(mesh, name)), name
    fresh = generate_mesh(after, *LENGTHS, across=2).quality()
    assert moved.quality().mean() > fresh.mean() - 0.01
    assert np.array_equal(follow_mesh(mesh, domain, after).points, moved.points)


def test_the_mesh_given_is_not_changed(wide):
    domain, mesh = wide
    before = mesh.points.copy()
    assert follow_mesh(mesh, domain, stretched(domain, 0.03)) is not mesh
    assert np.array_equal(mesh.points, before)
    assert follow_mesh(mesh, domain, domain) is mesh


def test_none_for_other_outlines(wide, make_disk):
    domain, mesh = wide
    fewer = domain.with_pillars(domain.pillars[1:])
    other = domain.with_pillars([resample(domain.pillars[0], 0.3, minimum=8), *domain.pillars[1:]])
    more = domain.with_pillars([*domain.pillars, make_disk(-0.5, 3.0, 0.2)])
    swapped = domain.with_pillars([domain.pillars[1], domain.pillars[0], *domain.pillars[2:]])
    assert all(follow_mesh(mesh, domain, after) is None for after in (fewer, other, more, swapped))


def test_none_where_edges_no_longer_fit(wide):
    domain, mesh = wide
    assert follow_mesh(mesh, domain, stretched(domain, 0.2)) is None  # pillars one behind the other come near
    bare = Triangulation(mesh.points, mesh.triangles, mesh.boundary_edges, mesh.boundary_tags, mesh.side_names)
    assert follow_mesh(bare, domain, stretched(domain, 0.03)) is None


def test_a_mesh_of_another_domain_is_refused(wide):
    domain, mesh = wide
    with pytest.raises(InputError, match="does not begin with the"):
        follow_mesh(mesh, stretched(domain, 0.01), domain)


@settings(max_examples=30, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), size=st.floats(0.001, 0.4))
def test_what_comes_out_is_valid(make_stars, check_mesh, seed, size):
    rng = np.random.default_rng(seed)
    domain = make_stars(seed, 6)
    mesh = generate_mesh(domain, 1.0, 0.4, across=2)
    angle = 2.0 * np.pi * rng.random(len(domain.pillars))
    ways = size * np.column_stack((np.cos(angle), np.sin(angle)))
    try:
        after = domain.with_pillars([outline + way for outline, way in zip(domain.pillars, ways, strict=True)])
    except InputError:
        return
    moved = follow_mesh(mesh, domain, after)
    if moved is not None:
        check_mesh(moved, after)
        between = (mesh.neighbours < 0).sum(axis=1) > 1
        fine = ~mark_broken_plain(moved.points, moved.triangles, 0.5 * POOR)
        touched = (moved.points != mesh.points).any(axis=1)[moved.triangles].any(axis=1)
        assert (fine | between | ~touched).all()


def test_a_channel_without_pillars_stays_as_it_is():
    domain = Domain.rectangle(2.0, 1.0)
    mesh = generate_mesh(domain, 0.3)
    assert follow_mesh(mesh, domain, Domain.rectangle(2.0, 1.0)) is mesh
