import numpy as np
import pytest
from tests.pillars.shapes import disk

from vasculo.pillars.memory import carry_reference, follow


def test_the_reference_follows_by_what_is_not_remembered():
    reference, points = np.zeros((3, 2)), np.full((3, 2), 2.0)
    np.testing.assert_array_equal(follow(reference, points, 0.0), points)
    np.testing.assert_array_equal(follow(reference, points, 1.0), reference)
    np.testing.assert_allclose(follow(reference, points, 0.75), 0.5)


def test_untouched_membranes_keep_their_reference_to_the_bit():
    one, two = disk(20), disk(24, 1.0, 4.0)
    references = [one * 1.1, two * 0.9]
    kept = carry_reference([one, two], references, [one, two.copy()])
    assert kept[0] is references[0]
    assert kept[1] is references[1]


def test_new_nodes_get_the_displacement_of_their_place():
    # a translation is linear along the sides, so it is carried exactly; new nodes on the old sides, other in number
    old = disk(30)
    reference = old - (0.3, -0.1)
    new = 0.5 * (old + np.roll(old, -1, axis=0))[::2]
    np.testing.assert_allclose(carry_reference([old], [reference], [new])[0], new - (0.3, -0.1), atol=1e-14)


@pytest.mark.parametrize("nodes", [40, 80, 160])
def test_a_stretch_is_carried_to_second_order(nodes):
    angle = np.linspace(0, 2 * np.pi, nodes, endpoint=False) + np.pi / nodes
    old, new = disk(nodes), np.column_stack((np.cos(angle), np.sin(angle)))
    carried = carry_reference([old], [old * (0.8, 1.25)], [new])[0]
    assert np.abs(carried - new * (0.8, 1.25)).max() < 2.0 / nodes**2 * np.pi**2
