"""Keys, defaults and meanings come from signatures and docstrings."""

from dataclasses import dataclass
from typing import Literal

import pytest
from pydantic import ValidationError

from vasculo.study.schema import keys_of, kind_words, model_of, parameter_meanings
from vasculo.study.sections import DOMAIN_KINDS, SECTIONS, domain_section


@dataclass(frozen=True)
class Example:
    """An example.

    Parameters
    ----------
    one, two : float
        The first two, in
        model length.
    three : {"a", "b"}
        A choice.

    Notes
    -----
    four : this is no parameter
    """

    one: float = 1.0
    two: float | None = None
    three: Literal["a", "b"] = "a"


def example(number: int, *, flag: bool = False, seed: int = 0) -> None:
    """Do nothing.

    Parameters
    ----------
    number : int
        Of things.
    """


def test_a_dataclass_gives_its_keys():
    keys = keys_of(Example)
    assert list(keys) == ["one", "two", "three"]
    assert keys["one"].meaning == keys["two"].meaning == "The first two, in model length."
    assert keys["three"].words == "one of 'a', 'b'"
    assert keys["two"].words == "a number"
    assert keys["one"].default == 1.0


def test_a_function_too():
    assert list(keys_of(example, ("seed",))) == ["number", "flag"]
    model = model_of(example, ("seed",))
    assert model(number=3).flag is False
    with pytest.raises(ValidationError):
        model()


@pytest.mark.parametrize(
    "values", [{"one": "1"}, {"one": True}, {"two": "x"}, {"three": "c"}, {"four": 1}, {"one": [1.0]}]
)
def test_types_are_strict(values):
    with pytest.raises(ValidationError):
        model_of(Example)(**values)


def test_a_whole_number_is_a_number():
    assert model_of(Example)(one=2).one == 2.0


def test_words():
    assert kind_words(int) == "a whole number"
    assert kind_words(bool) == "true or false"
    assert kind_words(str | None) == "a text"
    assert kind_words(dict) == "of another type"


def test_no_docstring_no_meaning():
    assert parameter_meanings("") == {}


@pytest.mark.parametrize("name", [*SECTIONS, *DOMAIN_KINDS])
def test_every_key_of_every_section_has_a_meaning(name):
    section = SECTIONS[name] if name in SECTIONS else domain_section(name)
    for key in keys_of(section.target, section.skip).values():
        assert len(key.meaning) > 10, f"{name}.{key.name} has no description"
        assert key.words != "of another type"
