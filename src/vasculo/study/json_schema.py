"""The JSON schema of a study file, by which editors complete and check it while it is written.

It is of draft 4, the newest that taplo reads (behind Even Better TOML in VS Code, and in Helix and Neovim), and comes
with the package as `study.schema.json`. It is made from the same dataclasses that check a study.
"""

from __future__ import annotations

import json
from math import inf, isinf
from typing import TYPE_CHECKING, Any

from vasculo.study.builtin import SCHEMA
from vasculo.study.schema import keys_of, model_of
from vasculo.study.sections import BRANCH, DOMAIN_KINDS, KIND_WORDS, ORDER, SECTIONS, domain_section, unused_sections

if TYPE_CHECKING:
    from vasculo.study.schema import Key
    from vasculo.study.sections import Section

    Schema = dict[str, Any]


def schema_text() -> str:
    """Write the schema of a study file as JSON."""
    return json.dumps(study_schema(), indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def study_schema() -> Schema:
    """Return the schema: sections with their keys, each with its meaning, unit, default, choices and range."""
    sections = {name: _object(SECTIONS[name]) for name in ORDER if name != "domain"}
    sections["domain"] = {
        "title": "domain",
        "description": domain_section("tissue").title,
        "anyOf": [_domain(kind) for kind in DOMAIN_KINDS],
    }
    unused = sorted({name for kind in DOMAIN_KINDS for name in unused_sections(kind)})
    drawn = [kind for kind in DOMAIN_KINDS if unused_sections(kind)]
    return {
        "$schema": "http://json-schema.org/draft-04/schema#",
        "title": "vasculo study",
        "description": "A study for `vasculo run`",
        "type": "object",
        "additionalProperties": False,
        "properties": {name: sections[name] for name in ORDER}
        | {"branch": {"type": "array", "description": BRANCH.title, "items": _object(BRANCH)}},
        "anyOf": [  # the sections of the tissue go with a tissue only
            {"properties": {"domain": {"properties": {"kind": {"not": {"enum": drawn}}}}}},
            {"not": {"anyOf": [{"required": [name]} for name in unused]}},
        ],
    }


def _domain(kind: str) -> Schema:
    """Describe the domain of one kind; a tissue when no kind is given."""
    found = _object(domain_section(kind))
    choice = {"type": "string", "enum": [kind], "description": f"Where the pillars come from: {KIND_WORDS[kind]}"}
    found["properties"] = {"kind": choice} | found["properties"]
    if kind != "tissue":
        found["required"] = ["kind", *found.get("required", [])]
    return found


def _object(section: Section) -> Schema:
    """Describe one section."""
    keys = keys_of(section.target, section.skip)
    found = model_of(section.target, section.skip).model_json_schema()
    found["properties"] = {name: _key(found["properties"][name], keys[name]) for name in keys}
    if section.presets:
        choice = {"type": "string", "enum": list(section.presets), "description": "A named set of values to start from"}
        found["properties"] = {"preset": choice} | found["properties"]
    return found | {"title": section.name, "description": section.title}


def _key(found: Schema, key: Key) -> Schema:
    """Describe one key as pydantic does, with its unit and range, and without null, which TOML does not know."""
    made = {name: value for name, value in found.items() if name not in {"anyOf", "default"}}
    for choice in found.get("anyOf", ()):
        if choice.get("type") != "null":
            made |= choice
    made["title"] = f"{key.name} [{key.unit}]" if key.unit else key.name
    if isinstance(key.default, float) and isinf(key.default):
        made["description"] += " If not given there is no limit."
    elif not key.required and key.default is not None:
        made["default"] = key.default
    if key.range is not None:
        made |= _bounds(key.range.low, key.range.low_open, "minimum", "exclusiveMinimum")
        made |= _bounds(key.range.high, key.range.high_open, "maximum", "exclusiveMaximum")
    return made


def _bounds(end: float, out: bool, name: str, exclusive: str) -> Schema:
    """Write one end of a range as draft 4 has it."""
    if abs(end) == inf:
        return {}
    whole = int(end) if float(end).is_integer() and abs(end) < 1e10 else end
    return {name: whole} | ({exclusive: True} if out else {})


if __name__ == "__main__":
    SCHEMA.write_text(schema_text(), encoding="utf-8")
