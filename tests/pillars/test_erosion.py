import numpy as np

from vasculo.pillars.erosion import erode, vanishing


def test_only_small_pillars_in_fast_flow_lose_area():
    areas = np.pi * np.array([0.2, 0.2, 0.5, 0.29, 0.31]) ** 2
    shear = np.array([2.0, 0.5, 2.0, 1.1, 1.1])
    rest = areas * 1.01
    new = erode(rest, areas, shear, 1.0, 0.3, 0.25)
    np.testing.assert_allclose(new / rest, [0.75, 1.0, 1.0, 0.75, 1.0])


def test_the_rest_area_waits_for_the_area():
    area = np.full(4, 0.1)
    rest = np.array([0.1, 0.09, 0.08, 0.07])
    new = erode(rest, area, np.ones(4), 0.5, 0.3, 0.2)
    np.testing.assert_allclose(new, [0.08, 0.08, 0.08, 0.07])


def test_no_rate_and_no_flow_change_nothing():
    areas = np.full(3, 0.01)
    np.testing.assert_array_equal(erode(areas, areas, np.array([1.0, 2.0, 3.0]), 2.0, 0.3, 0.0), areas)
    np.testing.assert_array_equal(erode(areas, areas, np.zeros(3), 0.0, 0.3, 0.5), areas)


def test_steady_erosion_ends_in_vanishing():
    area = np.array([np.pi * 0.3**2 * 0.99])
    steps = 0
    while not vanishing(area, 0.1)[0]:
        area = erode(area, area, np.ones(1), 0.5, 0.3, 0.1)
        steps += 1
    assert steps == np.ceil(np.log((0.1 / 0.3) ** 2 / 0.99) / np.log(0.9))


def test_pillars_turned_over_or_lost_vanish():
    limit = np.pi * 0.01
    areas = np.array([1.0, limit * 1.001, limit * 0.999, 0.0, -1.0, np.nan])
    np.testing.assert_array_equal(vanishing(areas, 0.1), [False, False, True, True, True, True])
    np.testing.assert_array_equal(vanishing(areas, 0.0), [False, False, False, False, True, True])
