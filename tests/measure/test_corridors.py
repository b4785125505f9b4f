import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.measure.shapes import bar, ellipse, solved, turned

from vasculo import measure
from vasculo.errors import InputError
from vasculo.flow.boundary import Pressure, Slip
from vasculo.flow.stokes import solve_stokes
from vasculo.geometry.boxtree import box_tree
from vasculo.geometry.domain import Domain
from vasculo.measure.corridors import nearest_distances, nearest_distances_plain
from vasculo.mesh.triangulation import Triangulation

LONG = 8.0


def box(low, high, left=1.0, right=1.0 + LONG):
    return np.array([(left, low), (right, low), (right, high), (left, high)])


def lanes(*cuts):
    """Domain with bars along x between the given pairs of heights; mirror walls at 0 and 4."""
    return Domain.rectangle(LONG + 2.0, 4.0, [box(low, high) for low, high in cuts])


@pytest.fixture(scope="module")
def three():
    domain = lanes((1.0, 1.5), (2.5, 3.0))
    return domain, solved(domain, 0.4, walls="no-slip")


def test_equal_lanes(three):
    domain, flow = three
    found = measure.corridors(domain, flow)
    assert found.direction == 0.0
    assert len(found.stations) == 100
    assert (found.counts == 3).all()
    assert found.count == 3.0
    assert found.effective_count == pytest.approx(3.0, rel=2e-3)
    assert found.mean_width == pytest.approx(1.0, rel=1e-3)
    assert found.mean_run == pytest.approx(LONG, rel=1e-9)
    total = np.bincount(found.station, found.flux)
    np.testing.assert_allclose(total, flow.flow_rate("right"), rtol=1e-9)
    assert found.is_through.all()


def test_unequal_lanes_count_by_their_flow():
    # widths 1 and 2 between no-slip walls: flows as 1 to 8
    domain = lanes((1.0, 2.0))
    found = measure.corridors(domain, solved(domain, 0.4, walls="no-slip"), spacing=0.5)
    assert len(found.stations) == 16
    assert found.effective_count == pytest.approx(81.0 / 65.0, rel=0.02)
    assert found.mean_width == pytest.approx((1.0 + 8.0 * 2.0) / 9.0, rel=0.02)
    assert found.count == 2.0


def test_half_lanes_at_mirror_walls_carry_half():
    domain = lanes((0.5, 1.5), (2.5, 3.5))
    found = measure.corridors(domain, solved(domain, 0.4))
    assert found.effective_count == pytest.approx(4.0 / 1.5, rel=0.01)
    assert sorted(set(np.round(found.width, 6))) == [0.5, 1.0]


def test_an_empty_channel_is_one_corridor():
    domain = Domain.rectangle(3.0, 2.0)
    found = measure.corridors(domain, solved(domain, walls="no-slip"))
    assert (found.count, found.effective_count) == (1.0, 1.0)
    assert found.mean_width == pytest.approx(2.0)
    assert found.mean_run == pytest.approx(3.0)


def test_width_is_across_the_lane_and_not_across_the_mean_flow():
    # two bars at 30 degrees, 0.8 apart
    off = np.array([-np.sin(np.pi / 6), np.cos(np.pi / 6)]) * 0.9
    centre = np.array([4.0, 5.0])
    pillars = [bar(5.0, 1.0, 0.0, 30.0, centre + side * off) for side in (-1, 1)]
    domain = Domain.rectangle(8.0, 10.0, pillars)
    found = measure.corridors(domain, solved(domain))
    middle = np.abs(found.ends.mean(axis=1) - centre).max(axis=1) < 0.5
    assert middle.any()
    assert found.width[middle] == pytest.approx(0.8, rel=0.03)
    across = np.hypot(*(found.ends[:, 1] - found.ends[:, 0])[middle].T)
    assert across == pytest.approx(0.8 / np.cos(np.pi / 6), rel=0.03)


@pytest.mark.parametrize("degrees", [90.0, 180.0, 33.0])
def test_any_direction(three, degrees):
    domain, flow = three
    names = dict(zip(("bottom", "right", "top", "left"), ("one", "out", "two", "in"), strict=True))
    other = Domain(
        turned(domain.outer, degrees),
        [turned(p, degrees) for p in domain.pillars],
        tuple(names[side] for side in domain.sides),
    )
    again = solved(other, 0.4, "in", "out", "no-slip")
    found, expected = measure.corridors(other, again, "in", "out"), measure.corridors(domain, flow)
    assert np.cos(np.radians(found.direction - degrees)) == pytest.approx(1.0)
    assert found.count == expected.count
    assert found.effective_count == pytest.approx(expected.effective_count, rel=5e-3)
    assert found.mean_width == pytest.approx(expected.mean_width, rel=5e-3)
    assert found.mean_run == pytest.approx(expected.mean_run, rel=1e-6)


def test_a_branch_ends_a_run():
    domain = Domain.rectangle(10.0, 4.0, [box(1.5, 2.5, 1.0, 3.0), box(1.5, 2.5, 3.5, 9.0)])
    flow = solved(domain, 0.4)
    found = measure.corridors(domain, flow)
    runs = np.unique(np.round(found.run, 2))
    assert runs == pytest.approx([0.48, 2.0, 5.52], abs=0.1)  # the gap between the bars is a lane of its own
    back = measure.corridors(domain, flow, "right", "left")
    assert back.mean_run == pytest.approx(found.mean_run)
    np.testing.assert_allclose(np.bincount(back.station, back.flux), -flow.flow_rate("right"), rtol=1e-9)


def test_a_bay_carries_nothing():
    bay = np.array([(2, 1), (6, 1), (6, 3), (2, 3), (2, 2.4), (5, 2.4), (5, 1.6), (2, 1.6)], dtype=float)
    domain = Domain.rectangle(8.0, 4.0, [bay])
    found = measure.corridors(domain, solved(domain, 0.5))
    bays = ~found.is_through
    assert bays.any()
    assert np.abs(found.flux[bays]).max() < 1e-12 * found.flux.max()
    assert (found.run[bays] == 0.0).all()
    assert (found.counts == 2).all()


def joined():
    """A pillar that has joined the bottom: the mesh goes around it as a part of the outer loop, with its tag."""
    rise = bar(3.0, 1.0, 0.0, 0.0, (4.0, 0.52))
    domain = Domain.rectangle(8.0, 3.0, [rise, ellipse(1.3, 10.0, (4.0, 2.0), 40) * [1.0, 0.5] + [0.0, 1.0]])
    outer = np.array([(0, 0), (2.5, 0), (2.5, 1.02), (5.5, 1.02), (5.5, 0), (8, 0), (8, 3), (0, 3)], dtype=float)
    sides = ("bottom", "joined", "joined", "joined", "bottom", "right", "top", "left")
    cut = solved(Domain(outer, domain.pillars[1:], sides)).mesh
    names = tuple(name for name in cut.side_names if name != "joined")
    tags = np.array([-1 - names.index(n) if n in names else 0 for n in cut.side_names])
    new = np.where(cut.boundary_tags >= 0, cut.boundary_tags + 1, tags[-1 - np.minimum(cut.boundary_tags, -1)])
    return domain, Triangulation(cut.points, cut.triangles, cut.boundary_edges, new, names, cut.neighbours)


def test_a_pillar_that_has_joined_the_border():
    domain, mesh = joined()
    flow = solve_stokes(mesh, {"left": Pressure(1.0), "right": Pressure(0.0), "top": Slip(), "bottom": Slip()})
    assert set(flow.wall_pillar.tolist()) == {0, 1}
    found = measure.corridors(domain, flow)
    np.testing.assert_allclose(np.bincount(found.station, found.flux), flow.flow_rate("right"), rtol=1e-9)
    # bottom, pillar and bottom again are one bank, so no lane ends where the pillar begins
    assert len(np.unique(found.banks)) == 3
    first, last = (domain.pillars[1][:, 0].min(), domain.pillars[1][:, 0].max())
    beside = (found.stations > first) & (found.stations < last)
    assert np.array_equal(found.counts, 1 + beside)
    assert found.run[found.counts[found.station] == 2] == pytest.approx(np.count_nonzero(beside) * 0.03)
    shear = measure.shear_distribution(flow)
    assert shear.pillars.tolist() == [0, 1]
    assert shear.pillar_lengths[0] == pytest.approx(3.0 + 2.0 * 1.02)
    angles = measure.local_angles(domain, flow)
    assert angles.angle[0] < 3.0
    assert measure.local_angles(domain, flow, "friction").angle[0] < 3.0
    assert measure.alignment(domain, flow) > 0.5
    assert measure.permeability(domain, flow) > 0.0


def test_faults(three):
    domain, flow = three
    for wrong in (0.0, -1.0, np.inf, "x"):
        with pytest.raises(InputError, match="spacing of stations"):
            measure.corridors(domain, flow, spacing=wrong)
    with pytest.raises(InputError, match="no side is called 'up'"):
        measure.corridors(domain, flow, "left", "up")
    still = solved(domain, 0.5, right=Pressure(1.0))
    with pytest.raises(InputError, match="nothing flows from left to right"):
        measure.corridors(domain, still)


@settings(max_examples=20, deadline=None)
@given(seed=st.integers(0, 10_000), count=st.integers(1, 60))
def test_distances_are_those_of_the_plain_twin(seed, count):
    rng = np.random.default_rng(seed)
    segments, points = rng.normal(size=(count, 4)), rng.normal(size=(20, 2))
    tree = box_tree(segments)
    found = nearest_distances(points, tree.segments, tree.weights, tree.boxes, tree.lowest)
    np.testing.assert_allclose(found, nearest_distances_plain(points, segments), rtol=1e-9, atol=1e-12)
