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


def test_the_cap_holds_across_the_membrane_for_each_pillar_by_itself():
    square = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])
    points = np.concatenate((square, square + np.array([3.0, 0.0])))
    starts = np.array([0, 4, 8], dtype=np.int32)
    shift = np.zeros((8, 2))
    shift[1] = (0.5, 0.5)  # at a corner of a square the membrane runs along (1, 1)
    np.testing.assert_allclose(cap_factors(shift, points, starts, 0.1), [1.0, 1.0])
    shift[1] = (0.3, -0.3)
    shift[5] = (0.0, 0.05)
    np.testing.assert_allclose(cap_factors(shift, points, starts, 0.1), [0.1 / np.hypot(0.3, 0.3), 1.0])


@pytest.mark.parametrize("parameters", [Angiogenesis(), Angiogenesis.hanging()])
def test_no_outline_moves_further_than_the_cap(parameters):
    domain, state = begin(Domain.rectangle(14, 8, [disk(60, 1.8, 4, 4), disk(40, 0.4, 10, 4)]), parameters)
    unit = state.length_unit
    loads = np.tile((0.05, 0.0), (len(state.points), 1))
    motion = move(domain, state, along_x(state), loads, parameters)
    moved = motion.points - state.points
    along = [np.roll(p, -1, axis=0) - np.roll(p, 1, axis=0) for p in state.pillars]
    along = np.concatenate(along)
    across = np.abs(along[:, 0] * moved[:, 1] - along[:, 1] * moved[:, 0]) / np.hypot(*along.T)
    cap = parameters.step_cap * parameters.membrane_spacing * unit
    assert across[: state.starts[1]].max() == pytest.approx(cap)
    assert across.max() < cap * (1 + 1e-9)
    assert motion.displacement == pytest.approx(np.hypot(*moved.T).max() / unit)
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
