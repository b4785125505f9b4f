"""Networks that repeat: exact moduli without borders, momentum, and the same bits wherever the seam lies."""

import numpy as np
import pytest

from vasculo.errors import InputError
from vasculo.springs.motion import damped_steps_plain
from vasculo.springs.network import SpringNetwork


def torus(rows, columns):
    """A triangular lattice with spacing 1 on a torus: points, springs, box; an even number of rows."""
    index = np.arange(rows * columns).reshape(rows, columns)
    row, column = np.divmod(index.ravel(), columns)
    points = np.column_stack([column + 0.5 * (row % 2), row * np.sqrt(0.75)])
    right = np.roll(index, -1, axis=1)
    up = np.roll(index, -1, axis=0)
    odd = (np.arange(rows) % 2 == 1)[:, None]
    other = np.where(odd, np.roll(up, -1, axis=1), np.roll(up, 1, axis=1))
    springs = np.concatenate([np.column_stack([index.ravel(), to.ravel()]) for to in (right, up, other)])
    return points, springs, np.array([columns, rows * np.sqrt(0.75)])


def test_all_springs_of_a_torus_have_length_one():
    points, springs, box = torus(24, 20)
    network = SpringNetwork(points, springs, box=box)
    np.testing.assert_allclose(network.lengths(), 1.0, rtol=1e-14)
    assert np.bincount(springs.ravel()).tolist() == [6] * 480


@pytest.mark.parametrize("size", [12, 24, 48])
def test_elastic_constants_of_the_infinite_lattice(size):
    # Energy density of a small uniform strain; C11 = 3 sqrt3 k / 4, C12 = C66 = sqrt3 k / 4, K = sqrt3 k / 2.
    points, springs, box = torus(size, size)
    area = float(np.prod(box))
    small = 1e-6
    constants = {}
    for name, change in {
        "C11": np.array([[1.0, 0.0], [0.0, 0.0]]),
        "C22": np.array([[0.0, 0.0], [0.0, 1.0]]),
        "K": np.eye(2) / 2.0,
        "C66": np.array([[0.0, 0.5], [0.5, 0.0]]),
    }.items():
        network = SpringNetwork(points, springs, rest_lengths=1.0, box=box)
        arms = network.arms() @ (np.eye(2) + small * change)
        stretch = np.hypot(*arms.T) - 1.0
        constants[name] = float(np.sum(stretch**2) / area / small**2)
    root = np.sqrt(3.0)
    expected = {"C11": 3 * root / 4, "C22": 3 * root / 4, "K": root / 2, "C66": root / 4}
    for name, value in expected.items():
        assert abs(constants[name] / value - 1.0) < 1e-5, name
    c11, c12 = constants["C11"], 2.0 * constants["K"] - constants["C11"]
    assert abs((c11**2 - c12**2) / c11 - 2.0 / root) < 1e-5  # E
    assert abs(c12 / c11 - 1.0 / 3.0) < 1e-5  # nu


def test_a_cut_bond_on_a_torus_loads_its_neighbours_as_in_the_infinite_lattice():
    # Isotropic strain 1e-4 by shorter rest lengths. Images of the cut add ~ 1 / size^2, which two sizes remove.
    ratios = []
    for size in (24, 48):
        points, springs, box = torus(size, size)
        network = SpringNetwork(points, springs, rest_lengths=1.0 - 1e-4, box=box, pinned=[size * size // 2 + 7])
        network.remove_springs([0])
        network.relax(tolerance=1e-13)
        forces = np.sort(network.tensions())[::-1] / 1e-4
        assert np.count_nonzero(forces > forces[0] - 1e-4) == 4
        ratios.append(forces[0])
    assert abs(ratios[1] + (ratios[1] - ratios[0]) / 3.0 - 1.2405) < 0.0003, ratios


def test_the_seam_is_nowhere():
    points, springs, box = torus(32, 40)
    rng = np.random.default_rng(3)
    shaken = points + rng.uniform(-0.2, 0.2, points.shape)
    limits = rng.uniform(0.1, 0.5, len(springs))
    moved = []
    for shift in ([0.0, 0.0], [13.0, 0.0], [7.25, 11.5]):
        places = shaken + shift
        network = SpringNetwork(places - box * np.floor(places / box), springs, 0.75, box=box, damping=1.0)
        broken = network.advance(0.2, 60, break_above=limits)
        moved.append((network.points - network.reference, broken))
    assert len(moved[0][1]) > 50
    for path, broken in moved[1:]:
        assert np.array_equal(broken, moved[0][1])
        np.testing.assert_allclose(path, moved[0][0], rtol=0.0, atol=1e-11)


def test_kernel_and_twin_on_a_torus():
    points, springs, box = torus(32, 32)
    rng = np.random.default_rng(4)
    network = SpringNetwork(points + rng.uniform(-0.2, 0.2, points.shape), springs, 0.8, box=box, damping=0.5)
    shifts = box * np.round((network.points[springs[:, 1]] - network.points[springs[:, 0]]) / box)
    assert 2 * 32 < np.count_nonzero(shifts.any(axis=1)) < 6 * 32
    state = network.points.copy(), network.velocities.copy()
    limit, broken = rng.uniform(0.1, 0.5, len(springs)), np.zeros(len(springs), bool)
    ones = np.ones(len(points))
    fixed = 0.2 * ones, ones / (1.0 + 0.1), 0.0, network.reference, np.zeros_like(points), 0.2, 1.0, 0.0, 80, broken
    damped_steps_plain(*state, springs, shifts, np.ones(len(springs)), network.rest_lengths, limit.copy(), *fixed)
    gone = network.advance(0.2, 80, break_above=limit)
    assert len(gone) > 50
    assert np.array_equal(np.flatnonzero(broken), gone)
    np.testing.assert_allclose(network.points, state[0], rtol=0.0, atol=1e-11)


def test_momentum_is_kept_and_nodes_may_leave_the_box():
    points, springs, box = torus(12, 12)
    rng = np.random.default_rng(5)
    network = SpringNetwork(points, springs, box=box)
    network.velocities = rng.normal(0.0, 0.1, points.shape) + np.array([3.0, -2.0])
    before = network.velocities.sum(axis=0)
    network.advance(0.1, 200)
    np.testing.assert_allclose(network.velocities.sum(axis=0), before, rtol=1e-12)
    assert network.points[:, 0].min() > box[0]
    assert network.lengths().max() < 2.0


def test_one_direction_only():
    points, springs, box = torus(12, 12)
    arms = points[springs[:, 1]] - points[springs[:, 0]]
    inner = np.abs(arms[:, 1]) < 2.0  # without the springs across the top
    network = SpringNetwork(points, springs[inner], box=[box[0], np.inf])
    np.testing.assert_allclose(network.lengths(), 1.0, rtol=1e-14)
    network.advance(0.1, 10)
    np.testing.assert_allclose(network.points, points, atol=1e-12)


def test_copies_keep_the_box():
    points, springs, box = torus(12, 12)
    network = SpringNetwork(points, springs, 0.9, box=box)
    twin = network.copy()
    assert np.array_equal(twin.box, box)
    assert twin.box is not network.box


@pytest.mark.parametrize(
    ("box", "message"),
    [
        ([1.0], r"box is \[1.0\], expected two periods > 0"),
        ([1.0, -2.0], r"box is \[1.0, -2.0\], expected two periods > 0"),
        ([np.nan, 1.0], "expected two periods > 0"),
        ("wide", "box is not two numbers"),
        (
            [1.9, 9.0],
            r"spring 1 spans \[-?0.9\d*, 0.0\] of a box of \[1.9, 9.0\]: it must be shorter than half a period",
        ),
    ],
)
def test_bad_boxes(box, message):
    with pytest.raises(InputError, match=message):
        SpringNetwork([[0.0, 0.0], [0.5, 0.0], [1.45, 0.0]], [[0, 1], [1, 2]], box=box)
