import numpy as np
import pytest
from tests.measure.shapes import ellipse, solved

from vasculo import measure
from vasculo.errors import InputError
from vasculo.flow.boundary import Slip
from vasculo.geometry.domain import Domain


@pytest.fixture(scope="module")
def pair():
    domain = Domain.rectangle(11.0, 6.0, [ellipse(1.5, 20.0, (3.0, 1.8)), ellipse(1.0, 0.0, (7.5, 3.6))])
    return domain, solved(domain)


def test_a_disk_far_from_walls_has_the_spread_of_theory():
    domain = Domain.rectangle(16.0, 16.0, [ellipse(1.0, 0.0, (8.0, 8.0))])
    found = measure.shear_distribution(solved(domain, 0.45))
    # unbounded: shear in proportion to |sin|, sd of (pi/2) |sin| - 1
    assert found.within == pytest.approx(np.sqrt(np.pi**2 / 8.0 - 1.0), abs=0.025)
    assert found.between == 0.0
    assert found.ratio == 1.0
    assert found.variation == pytest.approx(found.within)
    low, middle, high = found.percentiles() / found.mean
    assert middle == pytest.approx(0.5 * np.pi * np.sin(np.pi / 4.0), abs=0.05)
    assert high == pytest.approx(0.5 * np.pi * np.sin(0.475 * np.pi), abs=0.07)
    assert low == pytest.approx(0.5 * np.pi * np.sin(0.025 * np.pi), abs=0.07)


def test_variances_add_up(pair):
    _, flow = pair
    found = measure.shear_distribution(flow)
    inner = np.average(found.pillar_deviations**2, weights=found.pillar_lengths)
    assert found.deviation**2 == pytest.approx((found.between * found.mean) ** 2 + inner)
    assert found.mean == pytest.approx(measure.mean_wall_shear(flow))
    assert found.ratio == pytest.approx(measure.shear_ratio(flow))
    assert found.pillars.tolist() == [0, 1]
    assert found.pillar_lengths.sum() == pytest.approx(found.length.sum())
    assert (np.diff(found.shear) >= 0.0).all()


def test_percentiles():
    one = np.ones(1)
    found = measure.ShearDistribution(
        np.array([1.0, 2.0, 3.0, 4.0]), np.array([1.0, 1.0, 1.0, 7.0]), np.zeros(1, dtype=np.int64), one, one, one
    )
    assert found.percentiles([0.0, 10.0, 10.1, 30.0, 31.0, 100.0]).tolist() == [1.0, 1.0, 2.0, 3.0, 4.0, 4.0]
    assert found.percentiles(50.0).tolist() == [4.0]
    assert found.mean == pytest.approx(3.4)
    with pytest.raises(InputError, match="from 0 to 100"):
        found.percentiles([101.0])


def test_a_pillar_without_shear_is_left_out_of_the_spread():
    zero, same = np.zeros(2), np.ones(2)
    found = measure.ShearDistribution(
        np.array([0.0, 1.0]), same, np.arange(2), same, np.array([0.0, 1.0]), np.array([0.0, 0.3])
    )
    assert found.within == pytest.approx(0.3)
    assert np.isinf(measure.ShearDistribution(zero, same, np.arange(2), same, zero, zero).ratio)
    rest = measure.ShearDistribution(zero, same, np.arange(2), same, zero, zero)
    assert (rest.within, rest.between, rest.variation) == (0.0, 0.0, 0.0)


def test_no_walls(pair):
    domain, _ = pair
    with pytest.raises(InputError, match="no pillar has a wall"):
        measure.shear_distribution(solved(domain, pillars=Slip()))
