import numpy as np
import pytest
from tests.pillars.shapes import disk

from vasculo.errors import InputError
from vasculo.geometry.domain import Domain
from vasculo.pillars.angiogenesis import begin
from vasculo.pillars.parameters import Angiogenesis
from vasculo.pillars.state import RemodelState


def start_state():
    domain = Domain.rectangle(12, 8, [disk(60, 1.0, 3, 3), disk(60, 2.0, 8, 4)])
    return begin(domain, Angiogenesis())


def test_a_start_has_even_membranes_and_its_own_unit():
    domain, state = start_state()
    assert state.length_unit == pytest.approx(np.sqrt(2.5), rel=0.01)
    assert state.lineage == ((0,), (1,))
    assert (state.step, state.time, state.merges_total) == (0, 0.0, 0)
    sides = [np.linalg.norm(np.roll(p, -1, axis=0) - p, axis=1) for p in domain.pillars]
    for side in sides:
        assert side.mean() == pytest.approx(0.18 * state.length_unit, rel=0.05)
    for a, b in zip(state.pillars, domain.pillars, strict=True):
        np.testing.assert_array_equal(a, b)


def test_arrays_and_back():
    _, state = start_state()
    again = RemodelState.from_arrays({name: value.copy() for name, value in state.arrays().items()})
    for name, value in state.arrays().items():
        other = again.arrays()[name]
        assert other.dtype == value.dtype
        np.testing.assert_array_equal(other, value)


def test_a_state_that_lacks_an_array_is_refused():
    arrays = start_state()[1].arrays()
    del arrays["rest_areas"], arrays["points"]
    with pytest.raises(InputError, match="lacks points, rest_areas"):
        RemodelState.from_arrays(arrays)


def test_a_domain_without_pillars_is_refused():
    with pytest.raises(InputError, match="at least one pillar"):
        begin(Domain.rectangle(3, 2), Angiogenesis())
