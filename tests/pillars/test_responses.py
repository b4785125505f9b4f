import numpy as np
import pytest

from vasculo.errors import ComputationError, InputError
from vasculo.pillars import responses
from vasculo.pillars.responses import cell_response, find_response, respond

SHEAR = np.array([0.0, 1.0, 2.0, 5.0])
WAY = np.array([0.0, 0.25, 0.5, 0.75])


@pytest.fixture(autouse=True)
def own_registry(monkeypatch):
    monkeypatch.setattr(responses, "_LAWS", dict(responses._LAWS))


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("linear", [-1.0, -0.5, 0.0, 1.0]),
        ("logarithm", [-1.0, -np.log(2.0), 0.0, np.log(2.5)]),
        ("sign", [-1.0, -1.0, 0.0, 1.0]),
    ],
)
def test_laws_by_hand(name, expected):
    np.testing.assert_allclose(respond(name, SHEAR, 2.0, WAY, 1.0), expected, atol=1e-15)


def test_the_limit_cuts_both_ways():
    assert np.abs(respond("linear", SHEAR, 2.0, WAY, 0.3)).max() == 0.3
    assert respond("linear", SHEAR, 2.0, WAY, 10.0)[3] == pytest.approx(1.5)


def test_a_law_of_the_user_gets_shear_mean_and_position():
    @cell_response("front-only")
    def front_only(shear, mean, position):
        return np.where(position < 0.5, shear / mean - 1.0, 0.0)

    assert find_response("front-only") is front_only
    np.testing.assert_allclose(respond("front-only", SHEAR, 2.0, WAY, 1.0), [-1.0, -0.5, 0.0, 0.0])


def test_a_taken_name_is_refused_but_the_same_law_may_come_twice():
    def make():
        def law(shear, _mean, _position):
            return 0.0 * shear

        return law

    cell_response("mine")(make())
    cell_response("mine")(make())
    with pytest.raises(InputError, match=r"'mine' is already defined in .*choose another name"):
        cell_response("mine")(lambda shear, _mean, _position: shear)
    with pytest.raises(InputError, match="'linear' is already defined"):
        cell_response("linear")(make())


@pytest.mark.parametrize("name", ["", "two words", "a=b", "päron"])
def test_names_are_plain(name):
    with pytest.raises(InputError, match="letters, digits"):
        cell_response(name)


def test_an_unknown_law_is_refused_with_the_known_ones():
    with pytest.raises(InputError, match="response = 'liner' is not one of linear, logarithm, sign"):
        find_response("liner")


@pytest.mark.parametrize(
    ("law", "words"),
    [
        (lambda s, _m, _w: s[:-1], r"gave shape \(3,\) for 4 membrane nodes"),
        (lambda _s, _m, _w: 1.0, r"gave shape \(\) for 4"),
        (
            lambda s, _m, _w: np.where(s > 4, np.nan, s),
            "gave nan at membrane node 3, where the shear is 5 and its mean 2",
        ),
        (lambda s, _m, _w: np.full(len(s), np.inf), "gave inf at membrane node 0"),
        (lambda _s, _m, _w: {}["no"], "failed: KeyError: 'no'"),
        (lambda s, _m: s, "failed: TypeError"),
        (lambda _s, _m, _w: "text", "failed: ValueError"),
    ],
)
def test_what_a_bad_law_does_is_said_in_one_line(law, words):
    responses._LAWS["bad"] = law
    with pytest.raises(ComputationError, match=f"cell response 'bad' {words}") as caught:
        respond("bad", SHEAR, 2.0, WAY, 1.0)
    assert "\n" not in str(caught.value)
