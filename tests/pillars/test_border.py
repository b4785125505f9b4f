import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.pillars.blobs import BORDERS, SPACING, scene
from tests.pillars.shapes import disk

from vasculo.flow.boundary import Pressure, Slip
from vasculo.flow.stokes import solve_stokes
from vasculo.geometry.domain import Domain
from vasculo.geometry.outline import resample
from vasculo.mesh.generate import generate_mesh
from vasculo.pillars.activation import wall_sides
from vasculo.pillars.border import flow_mesh
from vasculo.pillars.cell import ring, side_lengths, stack
from vasculo.pillars.contact import closed_stretches, find_seals, rolled_outer
from vasculo.pillars.merge import merge
from vasculo.pillars.outlines import MARGIN, inner_polygon

OPENINGS = ("left", "right")
HELD = 0.25 * SPACING  # where a membrane is held that presses on the border


def joined_mesh(domain):
    return flow_mesh(domain, OPENINGS, HELD, SPACING, 0.7, SPACING, across=2)


def solved(domain, mesh):
    conditions = dict.fromkeys(domain.side_names, Slip()) | {"left": Pressure(1.0), "right": Pressure(0.0)}
    return solve_stokes(mesh, conditions, pockets="rest")


def check(domain, found):
    """Tags, coverage of the membranes and the border, area; returns the covered length of each membrane side."""
    mesh = found.mesh
    mesh.check()
    points, starts = stack(domain.pillars)
    ends = mesh.points[mesh.boundary_edges]
    length = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
    on = mesh.boundary_tags >= 0
    middles = ends[on].mean(axis=1)
    side, fraction = wall_sides(middles, mesh.boundary_tags[on], points, starts)
    after = ring(starts)[1][side]
    on_side = np.hypot(*(points[side] + fraction[:, None] * (points[after] - points[side]) - middles).T) < 1e-9
    covered = np.bincount(side[on_side], length[on][on_side], len(points))
    np.testing.assert_allclose(covered[~found.sealed], side_lengths(points, starts)[~found.sealed])
    assert covered[found.sealed].max(initial=0.0) < 1e-9
    assert mesh.side_names == domain.side_names
    for name in OPENINGS:
        mine = np.array([side == name for side in domain.sides])
        step = np.roll(domain.outer, -1, axis=0) - domain.outer
        tag = -1 - domain.side_names.index(name)
        assert length[mesh.boundary_tags == tag].sum() == pytest.approx(np.hypot(*step[mine].T).sum())
    # every edge of a closed side lies on the outline of the domain
    assert mesh.areas.sum() <= domain.area * (1 + 1e-12)
    touches = np.logical_or.reduceat(found.sealed, starts[:-1])
    np.testing.assert_array_equal(touches, found.touching)
    return covered


def test_no_contact_no_change():
    domain = Domain.rectangle(12, 8, [disk(35, 1.0, 6.0, 1.0 + 0.3 * SPACING), disk(35, 1.0, 3.0, 4.0)])
    found = joined_mesh(domain)
    mesh = generate_mesh(domain, 0.7, SPACING, across=2)
    assert not found.touching.any()
    assert not found.sealed.any()
    assert not found.blocked
    for name in ("points", "triangles", "boundary_edges", "boundary_tags", "neighbours"):
        np.testing.assert_array_equal(getattr(found.mesh, name), getattr(mesh, name))


def test_a_disk_on_the_border_is_sealed_and_the_flow_hardly_feels_it():
    domain = Domain.rectangle(12, 8, [disk(35, 1.0, 3.0, 4.0), disk(35, 1.0, 6.0, 1.0 + HELD)])
    found = joined_mesh(domain)
    np.testing.assert_array_equal(found.touching, [False, True])
    check(domain, found)
    assert 3 <= found.sealed.sum() <= 7
    lowest = 35 + int(np.argmin(domain.pillars[1][:, 1]))
    assert found.sealed[lowest]
    before = generate_mesh(domain, 0.7, SPACING, across=2)
    assert len(found.mesh.triangles) < len(before.triangles)
    sealed, open_ = solved(domain, found.mesh), solved(domain, before)
    assert sealed.flow_rate("right") == pytest.approx(open_.flow_rate("right"), rel=1e-3)
    assert set(sealed.wall_pillar) == {0, 1}
    np.testing.assert_allclose(sealed.drag("viscous")[0], open_.drag("viscous")[0], atol=2e-3)
    np.testing.assert_allclose(sealed.drag()[:, 0], open_.drag()[:, 0], rtol=0.02)


def test_a_mirror_wall_and_the_image_behind_it_give_the_same_flow():
    # the other half of the picture, with the pillar and its image merged
    half = Domain.rectangle(8, 4, [disk(35, 1.0, 4.0, 1.0 + HELD)])
    pair = [disk(35, 1.0, 4.0, 5.0 + HELD), disk(35, 1.0, 4.0, 3.0 - HELD)]
    one = merge(pair, np.ones(2), ((0,), (1,)), 2.01 * HELD, SPACING, SPACING, 0, 0.0).outlines
    whole = Domain.rectangle(8, 8, one)
    through = solved(half, joined_mesh(half).mesh).flow_rate("right")
    both = solved(whole, generate_mesh(whole, 0.7, SPACING, across=2)).flow_rate("right")
    assert 2 * through == pytest.approx(both, rel=3e-3)


def test_a_pillar_on_both_sides_blocks_the_channel():
    domain = Domain.rectangle(12, 4, [disk(70, 2 - HELD, 6.0, 2.0), disk(30, 0.5, 2.0, 2.0)])
    found = joined_mesh(domain)
    assert found.blocked
    np.testing.assert_array_equal(found.touching, [True, False])
    check(domain, found)
    flow = solved(domain, found.mesh)
    assert abs(flow.flow_rate("right")) < 1e-12
    assert flow.report["parts"] == 2


def test_enclosed_fluid_is_filled_unless_a_pillar_is_in_it():
    t = np.linspace(0, np.pi, 40)
    rings = [np.column_stack((6 + r * np.cos(a), r * np.sin(a))) for r, a in ((2.0, t), (1.3, t[::-1]))]
    arch = resample(np.concatenate(rings), SPACING)
    arch[:, 1] = np.maximum(arch[:, 1], HELD)
    empty = Domain.rectangle(12, 8, [arch])
    found = joined_mesh(empty)
    check(empty, found)
    assert empty.area - found.mesh.areas.sum() > 0.9 * np.pi * 1.3**2 / 2
    full = Domain.rectangle(12, 8, [arch, disk(16, 0.3, 6.0, 0.6)])
    also = joined_mesh(full)
    check(full, also)
    np.testing.assert_array_equal(also.touching, [True, False])
    flow = solved(full, also.mesh)
    inner = flow.wall_pillar == 1
    assert inner.any()
    assert np.abs(flow.wall_shear[inner]).max() < 1e-12
    assert full.area - also.mesh.areas.sum() < 0.5


def test_two_neighbours_on_the_border_and_one_in_the_corner():
    pillars = [disk(35, 1.0, 4.0, 1.0 + HELD), disk(35, 1.0, 6.1, 1.0 + HELD), disk(35, 0.8, 10.2, 0.8 + HELD)]
    outer = [(0, 0), (11.0 + HELD, 0), (11.0 + HELD, 4), (14, 4), (14, 8), (0, 8)]
    domain = Domain(outer, pillars, ("bottom", "end", "step", "right", "top", "left"))
    found = joined_mesh(domain)
    assert found.touching.all()
    check(domain, found)
    # the corner between the two contacts of the third one is enclosed
    assert not (found.mesh.points == outer[1]).all(axis=1).any()


def test_a_pillar_that_another_one_buries_is_wall_altogether():
    corners = [(3, HELD), (3.2, HELD), (3.3, 0.17), (4.7, 0.17), (4.8, HELD), (5, HELD), (5, 1), (3, 1)]
    lid = resample(np.array(corners), SPACING, corners=30.0)
    domain = Domain.rectangle(8, 4, [disk(35, 0.7, 6.5, 2.0), lid, disk(16, 0.03, 4.0, 0.09)])
    found = joined_mesh(domain)
    np.testing.assert_array_equal(found.touching, [False, True, True])
    assert found.sealed[-16:].all()
    check(domain, found)
    solved(domain, found.mesh)


def test_closed_stretches_and_order_of_seals():
    domain = BORDERS["step"].with_pillars([disk(35, 1.0, 2.0, 1.0 + HELD), disk(35, 1.0, 8.0, 1.0 + HELD)])
    outer, sides = rolled_outer(domain, OPENINGS)
    assert sides[0] in OPENINGS
    assert [sides[first:last] for first, last in closed_stretches(sides, OPENINGS)] == [
        ("top",),
        ("b1", "b2", "b3", "b4", "b5"),
    ]
    seals = find_seals(domain.pillars, outer, sides, OPENINGS, HELD, SPACING)
    assert [seal.pillar for seal in seals] == [0, 1]
    assert seals[0].begin < seals[0].end < seals[1].begin < seals[1].end


@given(st.integers(0, 10**6), st.sampled_from(sorted(BORDERS)))
@settings(max_examples=40, deadline=None)
def test_any_pillars_at_any_border(seed, border):
    outlines = scene(seed, border)
    if not outlines:
        return
    base = BORDERS[border]
    limit = inner_polygon(base.outer, MARGIN * SPACING)
    lineage = tuple((k,) for k in range(len(outlines)))
    merged = merge(outlines, np.ones(len(outlines)), lineage, 0.5 * SPACING, SPACING, SPACING, 0, 0.0, limit)
    domain = base.with_pillars(merged.outlines)
    check(domain, joined_mesh(domain))
