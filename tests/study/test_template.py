"""The study file that a new study begins with: complete, commented, ready to run, and valid line by line."""

import tomllib
from pathlib import Path
from urllib.parse import urlparse
from urllib.request import url2pathname

import pytest

from vasculo.errors import InputError
from vasculo.study.builtin import NAMES, SCHEMA, builtin_path
from vasculo.study.schema import keys_of
from vasculo.study.sections import DOMAIN_KINDS, SECTIONS, domain_section
from vasculo.study.settings import parse_study, read_study
from vasculo.study.template import COMMON, template


def sections(text):
    """Lines of each section."""
    found = {}
    for line in text.splitlines():
        if line.startswith("["):
            found[line.strip("[]")] = lines = []
        elif found:
            lines.append(line)
    return found


def switched_off(text):
    """Section, kind of domain and key line of every key that is switched off."""
    for name, lines in sections(text).items():
        kind = "tissue"
        for line in lines:
            if line.startswith("# With kind = "):
                kind = line.split('"')[1]
            elif line.startswith("#") and not line.startswith("# "):
                yield name, kind, line.removeprefix("#")


def test_it_is_the_default_study():
    assert parse_study(template(), "new.toml") == parse_study("", "new.toml")


def test_every_key_stands_in_it_with_its_meaning():
    text = template()
    for section in [*SECTIONS.values(), *map(domain_section, DOMAIN_KINDS)]:
        for key in keys_of(section.target, section.skip).values():
            lines = [line.removeprefix("#") for line in sections(text)[section.name]]
            assert any(line.startswith(f"{key.name} = ") for line in lines), f"{section.name}.{key.name}"
            assert key.meaning.replace("`", "").split()[0] in text
    assert max(map(len, text.splitlines())) <= 120


@pytest.mark.parametrize(("section", "kind", "line"), list(switched_off(template())))
def test_a_key_that_is_switched_on_can_be_used(section, kind, line, tmp_path):
    (tmp_path / "my_laws.py").write_text("import vasculo\n\n@vasculo.watcher('remodel')\ndef see(step): ...\n")
    (tmp_path / "outlines.json").write_text(
        '{"outer": [[0, 0], [4, 0], [4, 4], [0, 4]], "sides": ["bottom", "right", "top", "left"], '
        '"pillars": [[[1, 1], [2, 1], [2, 2], [1, 2]]]}'
    )
    block = {section: [line]}
    if section == "domain" and kind != "tissue":
        block["domain"].insert(0, f'kind = "{kind}"')
        if line.startswith(("width", "height")):  # one needs the other
            block["domain"] += [other for name, of, other in switched_off(template()) if of == kind and other != line]
    text = "\n".join(f"[{name}]\n" + "\n".join(lines) for name, lines in block.items())
    settings = parse_study(text, "new.toml", folder=tmp_path)
    key, _, value = line.partition(" = ")
    assert settings.tables()[section][key] == tomllib.loads(f"value = {value}")["value"]


def test_the_keys_that_most_people_change_stand_on_top():
    for name, lines in sections(template()).items():
        keys = [line.removeprefix("#").split(" = ")[0] for line in lines if " = " in line and not line.startswith("# ")]
        common = [key for key in COMMON[name] if key in keys and name != "domain"]
        assert [key for key in keys if key != "preset"][: len(common)] == common


@pytest.mark.parametrize("name", NAMES)
def test_a_built_in_study_to_start_from(name):
    text = template(name)
    assert parse_study(text, "new.toml") == read_study(builtin_path(name))
    first = builtin_path(name).read_text().splitlines()[0].removeprefix("# ")
    assert first.split()[0] in text.splitlines()[2]
    assert ("[tissue]" in text) == (name in {"paper", "plexus", "small", "thousand"})


def test_no_other_study_to_start_from():
    with pytest.raises(
        InputError, match=r"^--from mine\.toml: no built-in study \(built in: paper, plexus, .*\); copy"
    ):
        template("mine.toml")


def test_it_names_a_schema_that_is_there():
    directive, _, place = template().splitlines()[0].partition(" ")
    assert directive == "#:schema"
    assert Path(url2pathname(urlparse(place).path)) == SCHEMA
    assert SCHEMA.is_file()
