import numpy as np
import pytest
from tests.pillars.shapes import disk

from vasculo.pillars.cell import filament_pairs, filaments, filaments_plain, node_lengths, ring, stack
from vasculo.pillars.relax import Network
from vasculo.pillars.relax_plain import forces_plain


def filament_network(points, starts):
    n = len(points)
    return Network(
        starts=starts,
        filaments=filaments(points, points, starts, np.zeros(n), 0.08, 10.0, 100.0),
        membrane_rest=np.ones(n),
        membrane_ratio=0.0,
        springs=np.zeros((0, 2), dtype=np.int32),
        spring_rest=np.zeros(0),
        rest_areas=np.ones(1),
        area_stiffness=0.0,
        bending=0.0,
        loads=np.zeros((n, 2)),
        pinned=np.zeros(n, dtype=bool),
    )


def filament_stress(nodes, strain):
    """Mean stress in a disk of filaments under a small homogeneous strain: virial of the filament forces."""
    points, starts = stack([disk(nodes)])
    network = filament_network(points, starts)
    moved = points + points @ strain.T
    force = forces_plain(moved, network)
    return -(force[:, :, None] * moved[:, None, :]).sum(axis=0) / np.pi


@pytest.mark.parametrize("nodes", [16, 32, 64, 128])
def test_modulus_of_a_disk_does_not_depend_on_its_nodes(nodes):
    e = 1e-6
    stress = filament_stress(nodes, np.diag([e, 0.0])) / e
    assert stress[0, 0] == pytest.approx(306.0, rel=0.02)
    assert stress[1, 1] == pytest.approx(102.0, rel=0.02)  # Poisson ratio 1/3
    assert abs(stress[0, 1]) < 1e-3 * stress[0, 0]


@pytest.mark.parametrize("angle", [0.3, 0.8, 1.3])
def test_modulus_is_isotropic(angle):
    n = np.array([np.cos(angle), np.sin(angle)])
    e = 1e-6
    straight = filament_stress(32, np.diag([e, 0.0]))[0, 0]
    turned = n @ filament_stress(32, e * np.outer(n, n)) @ n
    assert turned == pytest.approx(straight, rel=1e-3)


def test_sixteen_nodes_have_ten_springs_worth_each():
    points, starts = stack([disk(16)])
    made = filaments(points, points, starts, np.zeros(16), 0.08, 10.0, 3.5)
    stiffness = filament_pairs(starts, made)[2]
    assert len(stiffness) == 16 * 15 // 2
    # the sides of the 16-gon are chords, a little shorter than the arc
    np.testing.assert_allclose(stiffness, 10.0, rtol=0.013)


@pytest.mark.parametrize("reach", [0.3, 2.5, np.inf])
def test_filaments_match_plain_twin(reach):
    points, starts = stack([disk(20), disk(33, 2.0, 4.0, 1.0, 1.4), disk(16, 0.5, 9.0)])
    reference = points * (1.1, 0.95)
    activation = np.sin(np.arange(len(points)) * 1.7)
    made = filaments(points, reference, starts, activation, 0.08, 10.0, reach)
    fast = filament_pairs(starts, made)
    plain = filaments_plain(points, reference, starts, activation, 0.08, 10.0, reach)
    np.testing.assert_array_equal(fast[0], plain[0])
    for a, b in zip(fast[1:], plain[1:], strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-13)
    every = sum(n * (n - 1) // 2 for n in np.diff(starts))
    assert (len(plain[0]) == every) == np.isinf(reach)
    sums = np.bincount(plain[0].ravel(), np.repeat(plain[2], 2), minlength=len(points))
    np.testing.assert_allclose(made.sums, sums, rtol=1e-12)


def test_activation_shortens_and_its_absence_leaves_as_is():
    points, starts = stack([disk(20)])

    def rest(activation):
        return filament_pairs(starts, filaments(points, points, starts, activation, 0.08, 10.0, 3.5))[1]

    now, short, half = rest(np.zeros(20)), rest(np.ones(20)), rest((np.arange(20) == 0).astype(float))
    np.testing.assert_allclose(short, 0.92 * now)
    np.testing.assert_allclose(half[:19], 0.96 * now[:19])
    np.testing.assert_array_equal(half[19:], now[19:])


def test_ring_and_lengths():
    points, starts = stack([disk(16), disk(20, 3.0, 9.0)])
    previous, following = ring(starts)
    np.testing.assert_array_equal(following[previous], np.arange(36))
    assert previous[0] == 15
    assert following[35] == 16
    lengths = node_lengths(points, starts)
    assert lengths[:16].sum() == pytest.approx(16 * 2 * np.sin(np.pi / 16))
    assert lengths[16:].sum() == pytest.approx(20 * 6 * np.sin(np.pi / 20))
