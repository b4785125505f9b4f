from itertools import pairwise

import numpy as np
import pytest
import shapely
from tests.pillars.shapes import disk, disk_domain, record, shape

from vasculo.geometry.domain import Domain
from vasculo.pillars.angiogenesis import Angiogenesis, remodel


@pytest.mark.slow
def test_a_disk_elongates_along_the_flow(disk_numbers):
    ratio, angle, spread, area, flow = disk_numbers.T
    assert ratio[0] == pytest.approx(1.0, abs=1e-3)
    assert ratio[10] > 1.6
    assert ratio[17] >= 2.0
    assert 2.1 < ratio[20] < 2.6
    assert np.abs(angle[1:]).max() < 2.0
    assert (np.diff(spread[[0, 5, 10, 15, 20]]) < 0).all()
    assert spread[0] == pytest.approx(0.49, abs=0.025)
    assert spread[20] < 0.2
    assert np.abs(area / area[0] - 1).max() < 0.01
    assert 1.1 < flow[20] / flow[0] < 1.25


@pytest.mark.slow
def test_every_step_is_watched_and_in_order(disk_run):
    assert [step.step for step in disk_run] == list(range(21))
    time = np.array([step.time for step in disk_run])
    assert time[0] == 0.0
    assert (np.diff(time) > 0).all()
    assert (np.diff(time) <= 0.08 + 1e-12).all()
    for before, after in pairwise(disk_run):
        ring = shapely.LinearRing(before.domain.pillars[0])
        off = shapely.distance(ring, shapely.points(after.domain.pillars[0]))
        if len(after.activation[0]) == len(before.activation[0]):  # new nodes lie beside the old sides
            assert off.max() <= 1.05 * Angiogenesis().step_cap * 0.18  # nodes slide along the membrane besides
    for step in disk_run:
        assert step.steps_total == 20
        assert step.lineage == ((0,),)
        assert len(step.activation[0]) == len(step.node_shear[0]) == len(step.domain.pillars[0])
        assert step.residual < 0.02


def test_reversed_flow_and_other_units_of_shear_change_nothing():
    forward = remodel(disk_domain(), Angiogenesis(steps=4)).pillars[0]
    backward = remodel(disk_domain(), Angiogenesis(steps=4, pressure_drop=-1.0)).pillars[0]
    scaled = remodel(disk_domain(), Angiogenesis(steps=4, pressure_drop=7.0, viscosity=5.0)).pillars[0]
    np.testing.assert_allclose(backward, forward, atol=1e-6)
    np.testing.assert_allclose(scaled, forward, atol=5e-3)  # rounding may change the triangulation


def test_another_length_unit_scales_the_result():
    small = remodel(disk_domain(), Angiogenesis(steps=2)).pillars[0]
    eight = Domain.rectangle(96, 64, [8 * disk(35, 1.0, 6.0, 4.0)])  # a power of two: no digit is rounded differently
    np.testing.assert_array_equal(remodel(eight, Angiogenesis(steps=2)).pillars[0] / 8, small)
    ten = Domain.rectangle(120, 80, [disk(35, 10.0, 60.0, 40.0)])  # another rounding may change the triangulation
    np.testing.assert_allclose(remodel(ten, Angiogenesis(steps=2)).pillars[0] / 10, small, atol=5e-3)


def test_a_mirrored_layout_gives_the_mirrored_result():
    layout = [disk(50, 1.3, 4.0, 3.5, 1.2, 0.6), disk(30, 0.8, 7.0, 5.0)]
    mirrored = [np.column_stack((o[:, 0], 8 - o[:, 1]))[::-1] for o in layout]
    here, _ = record(Domain.rectangle(11, 8, layout), Angiogenesis(steps=3))
    there, _ = record(Domain.rectangle(11, 8, mirrored), Angiogenesis(steps=3))
    for a, b in zip(here.pillars, there.pillars, strict=True):
        back = np.column_stack((b[:, 0], 8 - b[:, 1]))
        distance = np.linalg.norm(a[:, None] - back, axis=2).min(axis=1)
        assert distance.max() < 0.5 * 0.2  # nodes need not coincide, outlines do
        assert shape(a)[0] == pytest.approx(shape(back[::-1])[0], rel=0.01)


def test_without_activation_the_disk_stays_a_disk():
    final = remodel(disk_domain(), Angiogenesis(steps=4, activation=0.0))
    assert shape(final.pillars[0])[0] == pytest.approx(1.0, abs=1e-3)
    np.testing.assert_allclose(final.pillars[0], disk(35, 1.0, 6.0, 4.0), atol=0.005)


def test_the_rule_turned_round_elongates_the_disk_across_the_flow():
    final = remodel(disk_domain(), Angiogenesis(steps=6, activation=-0.08))
    ratio, angle = shape(final.pillars[0])
    assert ratio > 1.3
    assert abs(angle) > 85


@pytest.mark.slow
def test_finer_membranes_give_the_same_shape():
    ratios = []
    for spacing in (0.22, 0.18, 0.13):
        cap = 0.036 / spacing  # the same length, so that the steps count alike
        parameters = Angiogenesis(
            steps=8, membrane_spacing=spacing, step_cap=cap, merge_gap=0.09 / spacing, closing=0.18 / spacing
        )
        final = remodel(disk_domain(round(2 * np.pi / spacing)), parameters)
        ratios.append(shape(final.pillars[0])[0])
    assert max(ratios) < 1.05 * min(ratios)
