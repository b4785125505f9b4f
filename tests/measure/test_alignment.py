import numpy as np
import pytest
from tests.measure.shapes import ellipse, solved, turned

from vasculo import measure
from vasculo.errors import InputError
from vasculo.flow.boundary import Slip
from vasculo.geometry.domain import Domain

SIDE = 9.0


@pytest.fixture(scope="module")
def oblique():
    """One ellipse at 30 degrees to the flow along x, and its flow."""
    domain = Domain.rectangle(SIDE, SIDE, [ellipse(2.0, 30.0, (SIDE / 2, SIDE / 2))])
    return domain, solved(domain)


@pytest.mark.parametrize("reference", ["velocity", "friction"])
@pytest.mark.parametrize(("degrees", "expected"), [(0.0, 0.0), (90.0, 90.0), (180.0, 0.0)])
def test_along_and_across(reference, degrees, expected):
    domain = Domain.rectangle(SIDE, SIDE, [ellipse(2.0, degrees, (SIDE / 2, SIDE / 2))])
    found = measure.local_angles(domain, solved(domain), reference)
    assert found.angle[0] == pytest.approx(expected, abs=0.5)
    assert found.flow_direction[0] == pytest.approx(0.0, abs=0.5)


def test_the_flow_turns_towards_a_pillar_and_the_friction_more_so(oblique):
    domain, flow = oblique
    near, far = (measure.local_angles(domain, flow, smoothing=width).angle[0] for width in (0.5, 3.0))
    friction = measure.local_angles(domain, flow, "friction").angle[0]
    assert 10.0 < friction < near < far < 30.0


def test_the_alignment_is_that_of_the_angles_to_the_friction(oblique):
    domain, flow = oblique
    angle = measure.local_angles(domain, flow, "friction").angle
    assert measure.alignment(domain, flow) == pytest.approx(np.cos(2.0 * np.radians(angle)).mean())


def test_a_turned_domain_has_the_same_angles(oblique):
    domain, flow = oblique
    for degrees in (40.0, 200.0):
        other = Domain(turned(domain.outer, degrees), [turned(p, degrees) for p in domain.pillars], domain.sides)
        again = solved(other)
        for reference in ("velocity", "friction"):
            found = measure.local_angles(other, again, reference)
            expected = measure.local_angles(domain, flow, reference)
            assert found.angle[0] == pytest.approx(expected.angle[0], abs=1.0)
            away = found.flow_direction[0] - expected.flow_direction[0] - degrees
            assert np.cos(np.radians(away)) == pytest.approx(1.0, abs=1e-3)


def test_round_pillars_and_pillars_without_friction_have_no_angle():
    pillars = [ellipse(1.0, 0.0, (3.0, 4.0)), ellipse(2.0, 20.0, (7.0, 4.0))]
    domain = Domain.rectangle(10.0, 8.0, pillars)
    found = measure.local_angles(domain, solved(domain))
    assert np.isnan(found.angle).tolist() == [True, False]
    assert found.summary().pillars == 1
    smooth = solved(domain, pillars=Slip())
    found = measure.local_angles(domain, smooth, "friction")
    assert np.isnan(found.angle).all()
    assert np.isnan(found.flow_direction).all()
    assert found.summary().pillars == 0
    assert np.isnan(found.summary().mean)
    with pytest.raises(InputError, match="none of 2"):
        measure.alignment(domain, smooth)


def angles_of(angle, aspect_ratio=2.0, area=1.0):
    angle = np.asarray(angle, dtype=float)
    same = np.ones(len(angle))
    return measure.LocalAngles(angle, 0.0 * same, angle, aspect_ratio * same, area * same)


def test_summaries():
    n = 9001
    even = angles_of(np.linspace(0.0, 90.0, n)).summary()
    assert even.pillars == n
    assert (even.mean, even.deviation, even.median) == pytest.approx((45.0, 90.0 / np.sqrt(12.0), 45.0), rel=1e-3)
    found = angles_of([10.0, 20.0, 60.0], np.array([1.2, 1.6, 3.0]), np.array([1.0, 3.0, 4.0]))
    assert found.summary() == pytest.approx((3, 30.0, np.sqrt(1400.0 / 3.0), 20.0))
    by_area = found.summary("area")
    assert by_area.mean == pytest.approx((10.0 + 60.0 + 240.0) / 8.0)
    assert found.summary(elongated=1.5)[:2] == pytest.approx((2, 40.0))
    assert found.summary(only=[True, False, False])[:2] == pytest.approx((1, 10.0))
    assert list(found.columns()) == ["angle", "flow_direction", "orientation", "aspect_ratio", "area"]
    # equal areas are no weight at all
    plain = angles_of([3.0, 5.0, 50.0, 80.0])
    assert plain.summary("area") == pytest.approx(plain.summary())
    assert plain.summary().median == pytest.approx(np.median(plain.angle))


def test_faults(oblique):
    domain, flow = oblique
    empty = Domain.rectangle(3.0, 2.0)
    assert len(measure.local_angles(empty, solved(empty, walls="no-slip"))) == 0
    with pytest.raises(InputError, match="reference of the angles is 'x'"):
        measure.local_angles(domain, flow, "x")
    with pytest.raises(InputError, match="smoothing of the velocity is 0"):
        measure.local_angles(domain, flow, smoothing=0.0)
    with pytest.raises(InputError, match="weight of the angles is 'x'"):
        angles_of([1.0]).summary("x")
    with pytest.raises(InputError, match="there are 1 pillars"):
        angles_of([1.0]).summary(only=[True, False])
