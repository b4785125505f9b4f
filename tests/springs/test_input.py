"""Bad input: each fault named with its spring or node and its numbers, in one line."""

import pickle

import numpy as np
import pytest

from vasculo.errors import InputError
from vasculo.springs.network import SpringNetwork

SQUARE = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
SIDES = [[0, 1], [1, 2], [2, 3]]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"points": [[0.0, 0.0, 0.0]]}, r"points have shape \(1, 3\), expected \(n, 2\)"),
        ({"points": []}, r"points have shape \(0,\), expected \(n, 2\) with n >= 1"),
        ({"points": [[0, 0], [1]]}, r"points do not form an \(n, 2\) array"),
        ({"points": [["a", "b"]], "springs": []}, "points are not numbers"),
        ({"points": [[0, 0], [1, 0], [np.nan, 1], [0, 1]]}, r"points of node 2 are not finite: \[nan, 1.0\]"),
        ({"springs": [[0, 1], [2, 4]]}, "spring 1 names node 4, but the nodes are 0 to 3"),
        ({"springs": [[0, 1], [-1, 2]]}, "spring 1 names node -1"),
        ({"springs": [[0, 1], [2, 2]]}, r"spring 1 names a node twice: \[2, 2\]"),
        ({"springs": [[0, 1], [1, 2], [1, 0]]}, r"springs 0 and 2 join the same nodes \[1, 0\]"),
        ({"springs": [[0.5, 1]]}, "springs are of type float64, expected whole numbers"),
        ({"springs": [[0, 1, 2]]}, r"springs have shape \(1, 3\), expected \(k, 2\)"),
        ({"springs": [[0, 1], [2]]}, "springs do not form"),
        ({"rest_lengths": [1.0, 1.0]}, r"rest lengths have shape \(2,\), expected \(3,\)"),
        ({"rest_lengths": [1.0, -0.5, 1.0]}, "rest length of spring 1 is -0.5, expected >= 0"),
        ({"stiffness": [1.0, 1.0, -2.0]}, "stiffness of spring 2 is -2, expected >= 0"),
        ({"stiffness": np.inf}, "stiffness of spring 0 are not finite: inf"),
        ({"masses": [1.0, 0.0, 1.0, 1.0]}, "mass of node 1 is 0, expected > 0"),
        ({"masses": [1.0, 1.0, 1.0, np.nan]}, "masses of node 3 are not finite: nan"),
        ({"damping": -1.0}, "damping is -1.0, expected a finite number >= 0"),
        ({"damping": "much"}, "damping is 'much'"),
        ({"tether": np.nan}, "tether is nan"),
        ({"pinned": [0, 7]}, "pinned names nodes 0 to 7, but the nodes are 0 to 3"),
        ({"pinned": [True, False]}, r"pinned has shape \(2,\), expected \(4,\)"),
        ({"pinned": [0.5]}, "pinned has type float64"),
        ({"triangles": [[0, 1, 9]]}, "triangle 0 names node 9"),
        ({"triangles": [[0, 1, 0]]}, "triangle 0 names a node twice"),
    ],
)
def test_a_network_that_cannot_be(change, message):
    given = {"points": SQUARE, "springs": SIDES} | change
    with pytest.raises(InputError, match=message) as caught:
        SpringNetwork(**given)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("arguments", "options", "message"),
    [
        ((0.0, 1), {}, "dt is 0.0, expected a finite number > 0"),
        ((np.nan, 1), {}, "dt is nan"),
        ((0.1, -1), {}, "steps is -1, expected a whole number >= 0"),
        ((0.1, 1.5), {}, "steps is 1.5"),
        ((5.0, 1), {}, r"time step 5 exceeds the stability limit \d.\d+ \(largest node stiffness 2 at node 1, mass 1"),
        ((0.1, 1), {"forces": np.zeros((3, 2))}, r"forces have shape \(3, 2\), expected \(4, 2\)"),
        ((0.1, 1), {"forces": np.full((4, 2), np.inf)}, "forces of node 0 are not finite"),
        ((0.1, 1), {"break_above": [1.0, 2.0]}, r"break_above has shape \(2,\), expected a number or \(3,\)"),
        ((0.1, 1), {"break_above": [1.0, np.nan, 2.0]}, "break_above of spring 1 is nan"),
        ((0.1, 1), {"break_above": -1.0}, "break_above of spring 0 is -1, expected a force >= 0"),
        ((0.1, 1), {"break_above": "strong"}, "break_above is not a number"),
        ((0.1, 1), {"rest_factor": -0.5}, "rest_factor is -0.5"),
        ((0.1, 1), {"rest_factor": (1.0, np.nan)}, "rest_factor is nan"),
    ],
)
def test_a_step_that_cannot_be(arguments, options, message):
    network = SpringNetwork(SQUARE, SIDES)
    with pytest.raises(InputError, match=message):
        network.advance(*arguments, **options)
    assert np.array_equal(network.points, network.reference)


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("points", np.zeros((3, 2)), r"points have shape \(3, 2\), expected \(4, 2\)"),
        ("velocities", np.full((4, 2), np.nan), "velocities of node 0 are not finite"),
        ("springs", np.array([[0, 9]]), "spring 0 names node 9"),
        ("rest_lengths", np.ones(2), "rest lengths have shape"),
        ("stiffness", -np.ones(3), "stiffness of spring 0 is -1"),
        ("masses", np.zeros(4), "mass of node 0 is 0"),
        ("damping", None, "damping is None"),
        ("pinned", np.zeros(2, bool), "pinned has shape"),
    ],
)
def test_what_is_changed_by_hand_is_checked(name, value, message):
    network = SpringNetwork(SQUARE, SIDES)
    network.advance(0.1, 1)
    setattr(network, name, value)
    with pytest.raises(InputError, match=message):
        network.advance(0.1, 1)


def test_changes_by_hand_count():
    network = SpringNetwork(SQUARE, SIDES, pinned=[0, 1, 2])
    network.advance(0.1, 1)
    network.rest_lengths[2] = 0.5
    network.stiffness[2] = 3.0
    network.masses[3] = 2.0
    network.advance(0.1, 1)
    np.testing.assert_allclose(network.velocities[3], [0.1 * 3.0 * 0.5 / 2.0, 0.0], rtol=1e-14)
    network.points = [[0, 0], [1, 0], [1, 1], [0, 2]]
    network.stiffness = network.stiffness.tolist()
    network.springs = network.springs.astype(np.int64)
    network.advance(0.1, 1)
    assert network.stiffness.dtype == np.float64
    assert network.springs.dtype == np.int32
    assert network.points.dtype == np.float64


def test_arrays_are_copied_and_copies_are_independent():
    points = np.array(SQUARE)
    network = SpringNetwork(points, SIDES, pinned=[0])
    twin = network.copy()
    points += 1.0
    twin.points += 0.5
    twin.advance(0.1, 5, break_above=0.1)
    assert network.points.tolist() == network.reference.tolist() == SQUARE
    assert len(network.springs) == 3
    again = pickle.loads(pickle.dumps(network))  # noqa: S301  our own bytes
    network.points[3] = again.points[3] = 0.0, 1.5
    network.advance(0.1, 7)
    again.advance(0.1, 7)
    assert np.array_equal(network.points, again.points)


def test_the_types_of_the_interface():
    network = SpringNetwork(SQUARE, SIDES, pinned=[True, False, False, False], triangles=[[0, 1, 2]])
    for name, dtype, shape in (
        ("points", np.float64, (4, 2)),
        ("velocities", np.float64, (4, 2)),
        ("reference", np.float64, (4, 2)),
        ("masses", np.float64, (4,)),
        ("pinned", np.bool_, (4,)),
        ("springs", np.int32, (3, 2)),
        ("rest_lengths", np.float64, (3,)),
        ("stiffness", np.float64, (3,)),
        ("triangles", np.int32, (1, 3)),
    ):
        array = getattr(network, name)
        assert array.dtype == dtype, name
        assert array.shape == shape, name
    assert network.advance(0.1, 0).tolist() == []
