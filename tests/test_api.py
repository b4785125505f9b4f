"""The reference of the Python interface: every public name is on its page, and comes with an example that is run."""

import doctest
import inspect
import re
from importlib import import_module
from pathlib import Path

import pytest

import vasculo as vc

PAGE = Path(__file__).parents[1] / "docs" / "api.md"
NAMES = [f"vasculo.{name}" for name in vc.__all__] + [f"vasculo.measure.{name}" for name in vc.measure.__all__]
DEFINED = {
    "vasculo.StopRun",
    "vasculo.cell_response",
    "vasculo.match",
    "vasculo.run",
    "vasculo.sweep",
    "vasculo.watcher",
}
"""Their examples define what a run then uses, or take as long as a run."""


def called(name):
    """What a public name stands for."""
    thing = vc
    for part in name.split(".")[1:]:
        thing = getattr(thing, part)
    return thing


OBJECTS = {name: called(name) for name in NAMES if not inspect.ismodule(called(name))}


@pytest.fixture(scope="module")
def listed():
    """Names that have a place of their own on the page."""
    return set(re.findall(r"^\.\. auto(?:function|class|exception):: (\S+)$", PAGE.read_text(), re.MULTILINE))


@pytest.mark.parametrize("name", OBJECTS)
def test_a_public_name_is_on_the_page(name, listed):
    home = f"{OBJECTS[name].__module__}.{name.rsplit('.', 1)[1]}"
    assert {name, home} & listed


@pytest.mark.parametrize("name", OBJECTS)
def test_a_public_name_has_an_example_that_checks_something(name):
    text = inspect.getdoc(OBJECTS[name])
    assert "Examples\n--------" in text
    examples = doctest.DocTestParser().get_examples(text.split("Examples\n--------", 1)[1])
    assert examples
    if name not in DEFINED:
        assert any(example.want or example.exc_msg for example in examples)


def test_what_the_page_lists_is_there(listed):
    for name in listed:
        module, _, last = name.rpartition(".")
        assert hasattr(import_module(module), last), name


def test_public_names_are_sorted_and_have_a_home():
    assert vc.__all__ == sorted(vc.__all__)
    assert vc.measure.__all__ == sorted(vc.measure.__all__)
