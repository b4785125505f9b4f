"""The schema that editors read: in step with the code, and of one mind with it about what is right and wrong."""

import json
import tomllib
from math import inf, nextafter

import pytest
from jsonschema import Draft4Validator

from vasculo.errors import InputError
from vasculo.study.builtin import NAMES, SCHEMA, builtin_path
from vasculo.study.json_schema import schema_text, study_schema
from vasculo.study.schema import keys_of
from vasculo.study.sections import DOMAIN_KINDS, SECTIONS, domain_section
from vasculo.study.settings import parse_study, read_study
from vasculo.study.template import template

VALID = Draft4Validator(study_schema())

BEYOND = {  # a study that the schema lets pass, and what only the stages know
    "[vasculogenesis]\nthreshold = nan": "is nan",
    "[domain]\nkind = 'disk'\nradius = 9.0": "does not go into",
    "[domain]\nkind = 'disk'\n[study]\nuntil = 'extraction'": "there is no tissue",
    "[angiogenesis]\nresponse = 'other'": "is not one of linear",
    "[angiogenesis]\ninlet = 'right'": "is the outlet too",
    "[extraction]\nlumen_width = 1.0\nminimum_width = 1.0": "exclude each other",
}
WRONG = [
    "[angiogenesi]\nsteps = 3",
    "[angiogenesis]\nstep = 3",
    "[angiogenesis]\nsteps = 3.5",
    "[angiogenesis]\nsteps = 100001",
    "[angiogenesis]\nwalls = 'soft'",
    "[tissue]\nnodes = '300'",
    "[tissue]\nnodes = true",
    "[tissue]\nnodes = 24",
    "[vasculogenesis]\npreset = 'fin'",
    "[vasculogenesis]\nthreshold = 0",
    "[extraction]\nfluid_fraction = 1.0",
    "[domain]\nkind = 'box'",
    "[domain]\nradius = 2.0",
    "[domain]\nkind = 'outlines'",
    "[domain]\nkind = 'voronoi'\nradius = 1.0",
    "[domain]\nkind = 'disk'\n[tissue]\nnodes = 99",
    "[study]\nformat = 2",
    "[study]\nseed = -1",
    "[units]\nlength = 0",
    "[output]\nfigures = 1",
    "[[branch]]\nbefore = {}",
]


def numbers():
    """Each number of a study with a range: the section, the keys that go with it, its name, kind and range."""
    sections = [*SECTIONS.values(), *(domain_section(kind) for kind in DOMAIN_KINDS)]
    for section in sections:
        kind = next((name for name, target in DOMAIN_KINDS.items() if target is section.target and target), "")
        for key in keys_of(section.target, section.skip).values():
            if key.range is not None:
                yield pytest.param(section, kind, key, id=f"{kind or section.name}.{key.name}")


def study_with(section, kind, key, value):
    """A study with one value, and what that value needs beside it."""
    tables = {section.name: {key.name: value}}
    if kind:
        tables["domain"]["kind"] = kind
        if kind == "voronoi" and key.name in {"width", "height"}:
            tables["domain"] = {"width": 20.0, "height": 20.0} | tables["domain"]
    return "\n".join(
        f"[{name}]\n" + "\n".join(f"{k} = {v!r}" for k, v in table.items()) for name, table in tables.items()
    )


def test_it_is_of_draft_4():
    Draft4Validator.check_schema(study_schema())


def test_the_file_in_the_package_is_in_step():
    """Write it anew after a change of the settings: `python -m vasculo.study.json_schema`."""
    assert SCHEMA.read_text(encoding="utf-8") == schema_text()


@pytest.mark.parametrize("name", NAMES)
def test_built_in_studies_are_valid(name):
    for text in (builtin_path(name).read_text(), read_study(builtin_path(name)).to_toml(), template(name)):
        VALID.validate(tomllib.loads(text))


def test_a_new_study_is_valid():
    VALID.validate(tomllib.loads(template()))
    VALID.validate({})


@pytest.mark.parametrize("text", WRONG)
def test_what_is_wrong_is_refused_by_both(text):
    assert not VALID.is_valid(tomllib.loads(text))
    with pytest.raises(InputError):
        parse_study(text, "study.toml")


@pytest.mark.parametrize(("text", "words"), list(BEYOND.items()))
def test_what_only_the_stages_know(text, words):
    VALID.validate(tomllib.loads(text))
    with pytest.raises(InputError, match=words):
        parse_study(text, "study.toml")


@pytest.mark.parametrize(("section", "kind", "key"), list(numbers()))
def test_ranges_are_those_of_the_stages(section, kind, key):
    """Just beyond each end both refuse, at it both accept or the stage has another reason."""
    whole = "whole" in key.words
    for end, out, beyond in ((key.range.low, key.range.low_open, -inf), (key.range.high, key.range.high_open, inf)):
        if abs(end) == inf:
            continue
        step = (1 if beyond > 0 else -1) if whole else nextafter(end, beyond) - end
        outside = end if out else end + step
        text = study_with(section, kind, key, outside)
        assert not VALID.is_valid(tomllib.loads(text)), text
        with pytest.raises(InputError, match=key.name):
            parse_study(text, "study.toml")
        if not out:
            text = study_with(section, kind, key, int(end) if whole else float(end))
            assert VALID.is_valid(tomllib.loads(text)), text


def test_every_key_says_what_it_is():
    found = study_schema()["properties"]
    for name, section in SECTIONS.items():
        for key in keys_of(section.target, section.skip).values():
            told = found[name]["properties"][key.name]
            assert told["description"].startswith(key.meaning)
            assert told["title"] == (f"{key.name} [{key.unit}]" if key.unit else key.name)
            if not key.required and key.default not in {None, inf}:
                assert told["default"] == key.default
    assert found["vasculogenesis"]["properties"]["growth_rate"]["title"] == "growth_rate [1 / sqrt(m / k)]"
    assert found["angiogenesis"]["properties"]["walls"]["enum"] == ["slip", "no-slip"]
    assert json.loads(schema_text()) == study_schema()
