"""A commented study file with every key: its meaning and unit, what it takes, its default."""

from __future__ import annotations

import textwrap
import tomllib
from typing import TYPE_CHECKING, Any

from vasculo.errors import InputError
from vasculo.study.builtin import NAMES, SCHEMA, builtin_path
from vasculo.study.schema import keys_of
from vasculo.study.sections import (
    DOMAIN_KINDS,
    FORMAT,
    KIND_WORDS,
    ORDER,
    SECTIONS,
    Section,
    domain_section,
    unused_sections,
)
from vasculo.study.settings import toml_value

if TYPE_CHECKING:
    from collections.abc import Mapping

    from vasculo.study.schema import Key

_WIDTH = 100
_HEAD = """\
What most people change first is switched on and stands at the top of each section. The other keys
stand below it, switched off and with their defaults: take the "#" before a key away to change it.

vasculo check FILE   says whether the file is right, what it leads to, and how long that takes
vasculo run FILE     runs it
"""

COMMON: dict[str, tuple[str, ...]] = {
    "study": ("format", "title", "seed"),
    "domain": ("pillars", "channel", "width", "height", "radius"),
    "tissue": ("nodes",),
    "vasculogenesis": ("pillar_spacing",),
    "extraction": ("fluid_fraction",),
    "angiogenesis": ("steps", "activation"),
    "output": ("figures",),
    "units": ("length", "shear", "viscosity"),
}
"""Keys that most people change first, by section."""

USUAL: dict[str, Any] = {
    "uses": "my_laws.py",
    "width": 16.0,
    "height": 9.0,
    "file": "outlines.json",
    "growth_time": 600.0,
    "pillar_spacing": 0.08,
    "time_step": 0.1,
    "fluid_fraction": 0.4,
    "lumen_width": 0.5,
    "minimum_width": 0.5,
    "triangle_budget": 500_000,
    "growth_every": 5,
    "length": 1000.0,
    "shear": 20.0,
    "viscosity": 3.0,
}
"""Values to begin with for keys that have no default."""


def template(study: str | None = None) -> str:
    """Write the file.

    Parameters
    ----------
    study : str, optional
        A built-in study to start from; its keys are switched on.

    Raises
    ------
    InputError
        When there is no such built-in study.
    """
    head, given = (["A study for vasculo."], {}) if study is None else _builtin(study)
    given.setdefault("study", {}).setdefault("format", FORMAT)
    given.setdefault("domain", {}).setdefault("kind", "tissue")
    kind = given["domain"]["kind"]
    blocks = [f"#:schema {SCHEMA.as_uri()}", "\n".join(_comment(line) for line in (*head, "", *_HEAD.splitlines()))]
    for name in ORDER:
        if name == "domain":
            blocks.append(_domain(kind, given["domain"], whole=study is None))
        elif name not in unused_sections(kind):
            blocks.append(_block(SECTIONS[name], given.get(name, {})))
    return "\n\n".join(blocks) + "\n"


def _builtin(study: str) -> tuple[list[str], dict[str, Any]]:
    """Return the first comment of a built-in study, and its keys."""
    if study not in NAMES:
        raise InputError(f"--from {study}: no built-in study (built in: {', '.join(NAMES)}); copy a file of your own")
    text = builtin_path(study).read_text(encoding="utf-8")
    lines = [line.removeprefix("#").strip() for line in text.partition("[")[0].splitlines() if line.startswith("#")]
    return lines, tomllib.loads(text)


def _block(section: Section, given: Mapping[str, Any]) -> str:
    """Write a section: the keys that are given or common, then the rest."""
    lines = [_title(section), f"[{section.name}]"]
    if section.presets:
        preset = given.get(
            "preset", next(name for name, values in section.presets.items() if values == section.target())
        )
        lines += [_comment("A named set of values, of which the keys below replace single ones.")]
        lines += [f"preset = {toml_value(preset)}  # one of {', '.join(map(repr, section.presets))}"]
    return "\n".join([*lines, *_keys(section, given)])


def _domain(kind: str, given: Mapping[str, Any], *, whole: bool) -> str:
    """Write the section whose keys depend on its kind; those of the other kinds too when the whole file is wanted."""
    section = domain_section(kind)
    lines = [_title(section), "[domain]"]
    if whole:
        lines += [_comment(f'"{name}": {words}.'.replace("`", "")) for name, words in KIND_WORDS.items()]
        lines += [_comment('The sections tissue, vasculogenesis and extraction go with "tissue" only.')]
    lines += [f"kind = {toml_value(kind)}", *_keys(section, given)]
    for other in DOMAIN_KINDS if whole else ():
        if other != kind:
            lines += ["", f'# With kind = "{other}":', *_keys(domain_section(other), {}, switched_off=True)]
    return "\n".join(lines)


def _title(section: Section) -> str:
    return _comment(f"{section.title}.{f' Units: {section.units}.' if section.units else ''}")


def _keys(section: Section, given: Mapping[str, Any], *, switched_off: bool = False) -> list[str]:
    """Write the keys of a section: those that are given or common first."""
    keys = keys_of(section.target, section.skip)
    first = [key for key in keys.values() if key.name in given or key.name in COMMON.get(section.name, ())]
    rest = [key for key in keys.values() if key not in first]
    lines = _lines(first, given, switched_off=switched_off)
    if first and rest and not switched_off:
        lines += ["", "# Less often changed:"]
    return lines + _lines(rest, given, switched_off=True)


def _lines(keys: list[Key], given: Mapping[str, Any], *, switched_off: bool) -> list[str]:
    """Write keys, each below its meaning and with its unit and what it takes behind it."""
    lines: list[str] = []
    before = ""
    for key in keys:
        if key.meaning != before:
            lines.append(_comment(_without_unit(key)))
        before = key.meaning
        usual = key.required or key.default is None
        value = given.get(key.name, USUAL[key.name] if usual else key.default)
        off = switched_off or (usual and key.name not in given)
        lines.append(f"{'#' if off else ''}{key.name} = {_value(value)}{_takes(key)}")
    return lines


def _without_unit(key: Key) -> str:
    text = key.meaning.replace("`", "")
    return text.replace(f" [{key.unit}]", "") if key.unit else text


def _takes(key: Key) -> str:
    """Say behind a key its unit, and what it takes where that is not plain."""
    words = [key.unit] if key.unit else []
    if key.words.startswith("one of"):
        words.append(key.words)
    elif key.range is not None and key.range.low < key.range.high <= 1e4:
        words.append(key.range.words)
    return f"  # {', '.join(words)}" if words else ""


def _value(value: object) -> str:
    """Write a value; long whole numbers with their thousands apart."""
    return f"{value:_}" if type(value) is int and value >= 10_000 else toml_value(value)


def _comment(text: str) -> str:
    return "\n".join(f"# {line}".rstrip() for line in textwrap.wrap(text, _WIDTH - 2) or [""])
