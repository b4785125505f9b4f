import numpy as np
import pytest
from tests.pillars.shapes import disk

from vasculo.geometry.domain import Domain
from vasculo.pillars.angiogenesis import begin
from vasculo.pillars.motion import cap_factors, move
from vasculo.pillars.parameters import Angiogenesis


def along_x(state):
    """Activation of disks in an unbounded stream along x."""
    centres = [pillar.mean(axis=0) for pillar in state.pillars]
    x, y = np.concatenate([p - c for p, c in zip(state.pillars, centres, strict=True)]).T
    return np.pi / 2 * np.abs(np.sin(np.arctan2(y, x))) - 1


def test_the_cap_holds_for_each_pillar_by_itself():
    shift = np.zeros((8, 2))
    shift[1] = (0.3, 0.4)
    shift[5] = (0.0, 0.05)
    np.testing.assert_allclose(cap_factors(shift, np.array([0, 4, 8], dtype=np.int32), 0.1), [0.2, 1.0])


@pytest.mark.parametrize("parameters", [Angiogenesis(), Angiogenesis.hanging()])
def test_no_node_moves_further_than_the_cap(parameters):
    domain, state = begin(Domain.rectangle(14, 8, [disk(60, 1.8, 4, 4), disk(40, 0.4, 10, 4)]), parameters)
    unit = state.length_unit
    loads = np.tile((0.05, 0.0), (len(state.points), 1))
    motion = move(domain, state, along_x(state), loads, parameters)
    moved = np.hypot(*(motion.points - state.points).T)
    assert moved[: state.starts[1]].max() == pytest.approx(0.24 * 0.18 * unit)
    assert moved.max() < 0.24 * 0.18 * unit * (1 + 1e-9)
    assert motion.displacement == pytest.approx(0.24 * 0.18)
    assert 0.0 < motion.share < 1.0
    if parameters.is_hanging:
        np.testing.assert_array_equal(motion.matrix.points[: len(state.points)], motion.points)
    else:
        assert motion.matrix is None


def test_a_pillar_that_is_not_activated_hardly_moves():
    domain, state = begin(Domain.rectangle(14, 8, [disk(60, 1.0, 3, 4), disk(60, 1.0, 11, 4)]), Angiogenesis())
    activation = along_x(state)
    activation[state.starts[1] :] = 0.0
    motion = move(domain, state, activation, np.zeros_like(state.points), Angiogenesis())
    moved = np.hypot(*(motion.points - state.points).T)
    assert moved[state.starts[1] :].max() < 0.1 * moved[: state.starts[1]].max()
