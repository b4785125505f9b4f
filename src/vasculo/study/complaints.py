"""What is said about a study file that cannot be used: one line with the place, the value and what would be right."""

from __future__ import annotations

import re
from difflib import get_close_matches
from typing import TYPE_CHECKING

from vasculo.study.schema import keys_of
from vasculo.study.sections import DOMAIN_KINDS, SECTIONS, Section, domain_section

if TYPE_CHECKING:
    import tomllib
    from collections.abc import Iterable, Mapping

    from pydantic import ValidationError

    from vasculo.study.schema import Key

_PLACE = re.compile(r"^(?P<what>.*?) \(at (?P<place>.*)\)$", re.DOTALL)


def parse_error(source: str, text: str, error: tomllib.TOMLDecodeError) -> str:
    """Say where text stops being TOML."""
    match = _PLACE.match(str(error))
    what, place = (match["what"], match["place"]) if match else (str(error), "")
    if not place.startswith("line"):
        lines = text.splitlines() or [""]
        place = f"line {len(lines)}, column {len(lines[-1]) + 1}"
    return f"{source}: not TOML at {place}: {what[:1].lower()}{what[1:]}".replace("\n", " ")


def unknown_section(source: str, name: str, known: Iterable[str]) -> str:
    """Say that there is no such section, and which is nearest; a stray key is recognised too."""
    sections = list(known)
    homes = [home for home in _homes(name) if home.partition(".")[2] == name]
    near = get_close_matches(name, sections, n=1, cutoff=0.5)
    hint = homes or [f"[{section}]" for section in near]
    also = f", did you mean {' or '.join(hint)}?" if hint else ""
    return f"{source}: unknown section [{name}]{also} (sections: {', '.join(sections)})"


def one_line(error: ValidationError, section: Section, keys: Mapping[str, Key]) -> tuple[str, str]:
    """Turn the first thing that pydantic found into the key it is about and one line."""
    problems = error.errors(include_url=False)
    # An unknown key explains more than a value that is missing because of it.
    first = min(problems, key=lambda problem: problem["type"] != "extra_forbidden")
    name = str(first["loc"][0])
    path = f"{section.name}.{name}"
    more = f" (and {len(problems) - 1} more)" if len(problems) > 1 else ""
    if first["type"] == "extra_forbidden":
        return path, f"unknown key {path}{_nearest(name, section, keys)}{more}"
    if first["type"] == "missing":
        return path, f"{path} is missing: it must be {keys[name].words}{more}"
    return path, f"{path} = {first['input']!r} must be {keys[name].words}{more}"


def _nearest(name: str, section: Section, keys: Mapping[str, Key]) -> str:
    """Suggest the key that was probably meant: of this section first, then of another one."""
    here = [*keys, "preset"] if section.presets else list(keys)
    elsewhere = [path for path in _homes(name) if not path.startswith(f"{section.name}.")]
    exact = [path for path in elsewhere if path.partition(".")[2] == name]
    if near := get_close_matches(name, here, n=1, cutoff=0.6):
        return f", did you mean {section.name}.{near[0]}?"
    if exact or elsewhere:
        return f", did you mean {' or '.join(exact or elsewhere)}?"
    if near := get_close_matches(name, here, n=1, cutoff=0.0):
        return f", the nearest key is {section.name}.{near[0]} ([{section.name}] has: {', '.join(here)})"
    return f": [{section.name}] takes no further key here"


def _homes(name: str) -> list[str]:
    """Keys of any section that are called like `name`, nearest first, at most one a section."""
    found = []
    sections = [*SECTIONS.values(), *(domain_section(kind) for kind in DOMAIN_KINDS)]
    for section in sections:
        near = get_close_matches(name, list(keys_of(section.target, section.skip)), n=1, cutoff=0.75)
        found += [f"{section.name}.{key}" for key in near]
    return sorted(set(found), key=lambda path: path.partition(".")[2] != name)
