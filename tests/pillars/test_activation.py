import numpy as np
import pytest
from tests.pillars.shapes import disk, made_up_flow

from vasculo.errors import ComputationError
from vasculo.pillars.activation import (
    activation,
    node_shear,
    node_traction,
    pillar_means,
    rolled,
    wall_sides,
)
from vasculo.pillars.cell import node_lengths, stack


def lone_disk_shear(x, y):
    return 3.0 * np.sin(np.arctan2(y, x))


def test_activation_of_a_disk_in_unbounded_flow():
    # |tau| ~ |sin|: a = pi/2 |sin| - 1, standard deviation 0.483
    outline = disk(140)
    points, starts = stack([outline])
    shear = node_shear(made_up_flow([outline], lone_disk_shear), points, starts)
    a = activation(shear, points, starts)
    angle = np.arctan2(points[:, 1], points[:, 0])
    error = np.abs(a - (np.pi / 2 * np.abs(np.sin(angle)) - 1))
    assert error.max() < 0.06  # the smoothed kink at the tips
    assert np.sort(error)[-7] < 0.002
    assert a.std() == pytest.approx(0.483, abs=0.01)
    assert a[np.argmin(np.abs(angle - np.pi / 2))] > 0.55
    assert a[0] < -0.94


def test_mean_activation_is_zero_and_only_ratios_count():
    outlines = [disk(35), disk(50, 1.5, 4.0, 1.0, 1.3, 0.5)]
    points, starts = stack(outlines)

    def shear(x, y):
        return 1.0 + 0.5 * np.sin(3 * x) * np.cos(2 * y)

    tau = node_shear(made_up_flow(outlines, shear), points, starts)
    a = activation(tau, points, starts)
    assert np.abs(pillar_means(a, points, starts)).max() < 1e-12
    np.testing.assert_allclose(activation(7 * tau, points, starts), a, rtol=1e-12, atol=1e-14)
    reversed_tau = node_shear(made_up_flow(outlines, lambda x, y: -shear(x, y)), points, starts)
    np.testing.assert_array_equal(reversed_tau, tau)


def test_activation_is_clipped_and_zero_without_shear():
    outlines = [disk(32), disk(32, 1.0, 4.0)]
    points, starts = stack(outlines)
    tau = np.zeros(64)
    tau[5] = 9.0
    a = activation(tau, points, starts)
    assert a[5] == 1.0
    assert a[6] == -1.0
    np.testing.assert_array_equal(a[32:], 0.0)


@pytest.mark.parametrize("pieces", [1, 2, 5])
def test_constant_shear_stays_constant(pieces):
    outlines = [disk(35), disk(35, 1.0, 2.2)]
    points, starts = stack(outlines)
    tau = node_shear(made_up_flow(outlines, lambda x, _: 0 * x - 4.0, pieces), points, starts)
    np.testing.assert_allclose(tau, 4.0, rtol=1e-13)


def test_wall_edges_find_their_side_even_in_a_narrow_gap():
    outlines = [disk(36), disk(36, 1.0, 2.001)]
    points, starts = stack(outlines)
    following = np.concatenate([np.roll(o, -1, axis=0) for o in outlines])
    middles = 0.7 * points + 0.3 * following
    side, fraction = wall_sides(middles[::-1], np.repeat([1, 0], 36).astype(np.int32), points, starts)
    np.testing.assert_array_equal(side, np.arange(72)[::-1])
    np.testing.assert_allclose(fraction, 0.3, atol=1e-12)


@pytest.mark.parametrize("pieces", [1, 3])
def test_traction_keeps_force_and_moment(pieces):
    outlines = [disk(35), disk(21, 1.5, 4.0, 1.0, 1.3, 0.5)]
    points, starts = stack(outlines)
    flow = made_up_flow(outlines, lambda x, y: 1.0 + x - 0.4 * y**2, pieces)
    loads = node_traction(flow, points, starts)
    ends = flow.mesh.points[flow.wall_edges[:-1]]
    middles = ends.mean(axis=1)
    force = flow.wall_traction[:-1] * np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)[:, None]
    np.testing.assert_allclose(loads.sum(axis=0), force.sum(axis=0), rtol=1e-12)
    moment = (points[:, 0] * loads[:, 1] - points[:, 1] * loads[:, 0]).sum()
    assert moment == pytest.approx((middles[:, 0] * force[:, 1] - middles[:, 1] * force[:, 0]).sum(), rel=1e-12)


def test_a_side_without_wall_edge_is_reported():
    outline = disk(20)
    points, starts = stack([outline])
    flow = made_up_flow([outline], lambda x, _: x, 1)
    flow.wall_edges, flow.wall_pillar = flow.wall_edges[1:], flow.wall_pillar[1:]
    flow.wall_shear, flow.wall_traction = flow.wall_shear[1:], flow.wall_traction[1:]
    with pytest.raises(ComputationError, match=r"no edge on side \d+ of pillar 0"):
        node_shear(flow, points, starts)


def test_sealed_sides_feel_nothing_and_are_not_missed():
    outline = disk(20)
    points, starts = stack([outline])
    flow = made_up_flow([outline], lambda x, _: 0 * x + 2.0, 1)
    free = np.ones(len(flow.wall_edges), dtype=bool)
    free[:3] = False  # edges run clockwise from the last side
    for name in ("wall_edges", "wall_pillar", "wall_shear", "wall_traction"):
        setattr(flow, name, getattr(flow, name)[free])
    sealed = np.zeros(20, dtype=bool)
    sealed[-4:-1] = True
    tau = node_shear(flow, points, starts, 0, sealed)
    np.testing.assert_allclose(tau[:16], 2.0)
    np.testing.assert_allclose(tau[16:], [1.0, 0.0, 0.0, 1.0])
    with pytest.raises(ComputationError, match="no edge on side 18"):
        node_shear(flow, points, starts, 0, np.roll(sealed, -1) & sealed)


def test_smoothing_keeps_the_mean_and_flattens():
    outline = disk(40)
    points, starts = stack([outline])
    flow = made_up_flow([outline], lambda x, _: 2.0 + x)
    rough, fine, flat = (node_shear(flow, points, starts, passes) for passes in (0, 1, 10))
    assert rough.std() > fine.std() > flat.std()
    np.testing.assert_allclose([v.mean() for v in (fine, flat)], rough.mean())


def test_a_law_is_applied_membrane_by_membrane():
    outlines = [disk(24), disk(30, 1.0, 4.0)]
    points, starts = stack(outlines)
    shear = np.concatenate((np.linspace(1, 2, 24), np.linspace(10, 30, 30)))
    means = pillar_means(shear, points, starts)
    signs = activation(shear, points, starts, "sign")
    np.testing.assert_array_equal(signs[:24], np.sign(shear[:24] - means[0]))
    np.testing.assert_array_equal(signs[24:], np.sign(shear[24:] - means[1]))
    assert np.abs(activation(shear, points, starts, "linear", 0.1)).max() == 0.1


def test_rolling_moves_values_along_their_own_membrane_and_repeats():
    starts = np.array([0, 20, 50], dtype=np.int32)
    values = np.random.default_rng(1).random(50)
    once, again, later = rolled(values, starts, 3, 7), rolled(values, starts, 3, 7), rolled(values, starts, 3, 8)
    np.testing.assert_array_equal(once, again)
    assert not np.array_equal(once, later)
    for a, b in ((0, 20), (20, 50)):
        turns = [np.roll(values[a:b], k) for k in range(b - a)]
        assert any(np.array_equal(once[a:b], turn) for turn in turns)
        assert not np.array_equal(once[a:b], values[a:b])


def test_means_weigh_by_length():
    points, starts = stack([np.array([[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [0.0, 1.0]])])
    lengths = node_lengths(points, starts)
    np.testing.assert_allclose(lengths, 2.0)
    assert pillar_means(np.array([1.0, 2.0, 3.0, 4.0]), points, starts)[0] == pytest.approx(2.5)
