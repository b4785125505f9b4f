"""Local repair: valid meshes of the domain after, for every small change of the outlines."""

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from vasculo.errors import ComputationError, InputError
from vasculo.geometry.domain import Domain
from vasculo.geometry.outline import resample
from vasculo.mesh.generate import generate_mesh
from vasculo.mesh.repair import steps as repair_steps
from vasculo.mesh.repair.repair import repair_mesh
from vasculo.mesh.size import size_field
from vasculo.mesh.triangulation import Triangulation
from vasculo.mesh.walls import walls_of

LENGTHS = (0.7, 0.25)


def shifted(domain, rng, size, *, share=1.0):
    """Pillars moved by `size` in random directions, those that can; a share of them gets other nodes."""
    outlines = list(domain.pillars)
    for k, outline in enumerate(domain.pillars):
        angle = 2.0 * np.pi * rng.random()
        moved = outline + size * rng.random() * np.array([np.cos(angle), np.sin(angle)])
        if rng.random() > share:
            moved = resample(moved, 0.9 * np.hypot(*(moved - np.roll(moved, 1, axis=0)).T).mean(), minimum=8)
        try:
            domain.with_pillars([*outlines[:k], moved, *outlines[k + 1 :]])
        except InputError:
            continue
        outlines[k] = moved
    return domain.with_pillars(outlines)


def same(one, other):
    return all(
        np.array_equal(getattr(one, name), getattr(other, name))
        for name in ("points", "triangles", "boundary_edges", "boundary_tags")
    )


@pytest.fixture(scope="module")
def tissue(make_plexus):
    domain = make_plexus(12, 8.0, 6.0, 3, 0.4)
    return domain, generate_mesh(domain, *LENGTHS, across=2)


def test_no_move_gives_the_same_mesh(tissue):
    domain, mesh = tissue
    done = repair_mesh(mesh, domain, domain, *LENGTHS, across=2)
    assert done.moved == done.inserted == done.refilled == 0
    assert not done.remeshed
    assert np.array_equal(done.node_origin, np.arange(len(mesh.points)))


def test_small_moves_keep_a_mesh_good(tissue, check_mesh):
    domain, mesh = tissue
    rng = np.random.default_rng(0)
    for _ in range(10):
        after = shifted(domain, rng, 0.02)
        done = repair_mesh(mesh, domain, after, *LENGTHS, across=2)
        check_mesh(done.mesh, after)
        assert not done.remeshed
        assert done.refilled == 0
        domain, mesh = after, done.mesh
    fresh = generate_mesh(domain, *LENGTHS, across=2).quality()
    quality = mesh.quality()
    assert quality.mean() > fresh.mean() - 0.01
    assert quality.min() > 0.4


def test_moves_in_a_row_hand_on_the_wanted_lengths(make_plexus, check_mesh):
    domain = make_plexus(12, 8.0, 6.0, 3, 0.5)
    mesh = generate_mesh(domain, 0.12)
    rng, let_be = np.random.default_rng(1), 0
    for _ in range(12):
        after = shifted(domain, rng, 0.012)
        done = repair_mesh(mesh, domain, after, 0.12)
        check_mesh(done.mesh, after)
        if np.array_equal(done.mesh.sizes, mesh.sizes):
            let_be += 1
            assert len(done.mesh.triangles) == len(mesh.triangles)
            assert (done.inserted, done.deleted, done.refilled) == (0, 0, 0)
            assert 0 < done.moved < len(mesh.points)
        domain, mesh = after, done.mesh
    assert let_be > 8
    fresh = generate_mesh(domain, 0.12)
    assert mesh.quality().mean() > fresh.quality().mean() - 0.02
    # without them, or with lengths that the mesh does not have, the mesh is looked at as a whole
    for sizes in (None, 2.0 * mesh.sizes):
        after = shifted(domain, rng, 0.012)
        bare = Triangulation(
            mesh.points, mesh.triangles, mesh.boundary_edges, mesh.boundary_tags, mesh.side_names, sizes=sizes
        )
        done = repair_mesh(bare, domain, after, 0.12)
        check_mesh(done.mesh, after)
        assert np.abs(np.log(done.mesh.sizes / mesh.sizes.mean())).max() < 1.0


def test_walls_are_as_short_as_their_passages_demand(tissue):
    domain, mesh = tissue
    # one pillar comes near another: the edges in between must become shorter
    away = np.hypot(*(domain.pillars[1].mean(axis=0) - [p.mean(axis=0) for p in domain.pillars]).T)
    near = int(np.argsort(away)[1])
    way = domain.pillars[near].mean(axis=0) - domain.pillars[1].mean(axis=0)
    for _ in range(5):
        outlines = list(domain.pillars)
        outlines[1] = outlines[1] + 0.05 * way / np.hypot(*way)
        after = domain.with_pillars(outlines)
        done = repair_mesh(mesh, domain, after, *LENGTHS, across=2)
        assert not done.remeshed
        domain, mesh = after, done.mesh
    ends = mesh.points[mesh.boundary_edges]
    field = size_field(walls_of(domain), *LENGTHS, 2, 0.25)
    ratio = np.hypot(*(ends[:, 1] - ends[:, 0]).T) / field.at(ends.mean(axis=1))
    assert ratio.max() < 1.7
    assert field.passage_sizes.min() < 0.15


@settings(max_examples=25, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    size=st.floats(0.0, 0.8),
    across=st.sampled_from([0, 2]),
    share=st.sampled_from([0.7, 1.0]),
)
def test_every_change_gives_a_valid_mesh(make_stars, check_mesh, seed, size, across, share):
    rng = np.random.default_rng(seed)
    domain = make_stars(seed, 6)
    mesh = generate_mesh(domain, 1.0, 0.4, across=across)
    for _ in range(2):
        after = shifted(domain, rng, size, share=share)
        done = repair_mesh(mesh, domain, after, 1.0, 0.4, across=across)
        check_mesh(done.mesh, after)
        assert done.remeshed == bool(done.reason)
        assert len(done.node_origin) == len(done.mesh.points)
        kept = done.triangle_origin >= 0
        old = mesh.triangles[done.triangle_origin[kept]]
        assert np.array_equal(np.sort(done.node_origin[done.mesh.triangles[kept]], axis=1), np.sort(old, axis=1))
        again = repair_mesh(mesh, domain, after, 1.0, 0.4, across=across)
        assert same(done.mesh, again.mesh)
        domain, mesh = after, done.mesh


@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), size=st.floats(0.0, 0.3), share=st.sampled_from([0.6, 0.9]))
def test_a_plexus_whose_outlines_get_other_nodes(make_plexus, check_mesh, seed, size, share):
    rng = np.random.default_rng(seed)
    domain = make_plexus(6, 6.0, 4.0, seed, 0.4)
    mesh = generate_mesh(domain, *LENGTHS, across=2)
    after = shifted(domain, rng, size, share=share)
    done = repair_mesh(mesh, domain, after, *LENGTHS, across=2)
    check_mesh(done.mesh, after)


def test_pillars_merge_vanish_and_appear(tissue, check_mesh):
    domain, mesh = tissue
    pillars = list(domain.pillars)
    away = np.hypot(*(pillars[0].mean(axis=0) - [p.mean(axis=0) for p in pillars]).T)
    near = int(np.argsort(away)[1])
    joined = shapely.union_all([shapely.Polygon(pillars[0]).buffer(0.3), shapely.Polygon(pillars[near]).buffer(0.3)])
    ring = resample(np.array(joined.buffer(-0.3).exterior.coords)[:-1], 0.18)
    merged = domain.with_pillars([ring, *[p for k, p in enumerate(pillars) if k not in (0, near)]])
    done = repair_mesh(mesh, domain, merged, *LENGTHS, across=2)
    check_mesh(done.mesh, merged)
    assert not done.remeshed
    assert 0 < done.refilled < 0.5 * len(mesh.triangles)
    fewer = domain.with_pillars(pillars[1:])
    done = repair_mesh(mesh, domain, fewer, *LENGTHS, across=2)
    check_mesh(done.mesh, fewer)
    assert not done.remeshed
    back = repair_mesh(done.mesh, fewer, domain, *LENGTHS, across=2)
    check_mesh(back.mesh, domain)
    assert not back.remeshed


def test_what_cannot_be_repaired_is_made_anew(tissue, check_mesh):
    domain, mesh = tissue
    other = Domain.rectangle(3.0, 3.0, [np.array([(1.0, 1.0), (2.0, 1.0), (1.5, 2.0)])])
    done = repair_mesh(mesh, domain, other, *LENGTHS, across=2)
    check_mesh(done.mesh, other)
    assert done.remeshed
    assert "triangles" in done.reason
    assert same(done.mesh, generate_mesh(other, *LENGTHS, across=2))


def test_a_hole_that_cannot_be_filled_is_made_larger_and_then_given_up(tissue, monkeypatch):
    domain, mesh = tissue
    taken = []

    def fail(*given):
        taken.append(np.count_nonzero(given[1]))
        raise ComputationError("no")

    monkeypatch.setattr(repair_steps, "refill", fail)
    done = repair_mesh(mesh, domain, domain.with_pillars(domain.pillars[1:]), *LENGTHS, across=2)
    assert done.remeshed
    assert done.reason == "no"
    assert len(taken) == repair_steps.ATTEMPTS
    assert taken[0] < taken[1] < taken[2]


def test_a_mesh_of_another_domain_is_refused(tissue):
    domain, mesh = tissue
    with pytest.raises(InputError, match=r"does not begin with the \d+ outline nodes"):
        repair_mesh(mesh, shifted(domain, np.random.default_rng(1), 0.1), domain, *LENGTHS)
