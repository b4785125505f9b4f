"""A commented study file with every key: its meaning and unit, what it takes, its default."""

from __future__ import annotations

import inspect
import textwrap

from vasculo.study.schema import keys_of
from vasculo.study.sections import DOMAIN_KINDS, ORDER, SECTIONS, Section, domain_section
from vasculo.study.settings import toml_value

_WIDTH = 100
_HEAD = """\
# A study for `vasculo run`. Every key stands here, switched off and with its default: take the "#" before a key away
# to change it. `vasculo check FILE` says whether the file is right and what it will take.
"""


def template() -> str:
    """Write the file."""
    return "\n".join([_HEAD, *(_domain() if name == "domain" else _block(SECTIONS[name]) for name in ORDER)])


def _block(section: Section) -> str:
    lines = [f"# {section.title}.", f"[{section.name}]"]
    if section.presets:
        names = ", ".join(map(repr, section.presets))
        lines += _comment(f"Start from a named set of values, of which the keys below replace single ones: {names}.")
        lines.append('#preset = "medium"')
    return "\n".join([*lines, *_keys(section)]) + "\n"


def _domain() -> str:
    """Write the section whose keys depend on its kind; only that of a tissue is switched on."""
    kinds = ", ".join(repr(kind) for kind in DOMAIN_KINDS)
    lines = [f"# {domain_section('tissue').title}: {kinds}."]
    lines += ['# Sections [tissue], [vasculogenesis] and [extraction] go with "tissue" only.']
    lines += ["[domain]", 'kind = "tissue"']
    for kind, target in DOMAIN_KINDS.items():
        if target is not None:
            lines += ["", f'# With kind = "{kind}":', *_keys(domain_section(kind))]
    return "\n".join(lines) + "\n"


def _keys(section: Section) -> list[str]:
    """Write the keys of a section: what each means, what it takes, and its default, switched off."""
    lines: list[str] = []
    before = ""
    for key in keys_of(section.target, section.skip).values():
        if key.meaning != before:
            lines += _comment(key.meaning.replace("`", ""))
        before = key.meaning
        empty = key.default is None or key.default is inspect.Parameter.empty
        value = f"#{key.name} =" if empty else f"#{key.name} = {toml_value(key.default)}"
        lines.append(f"{value}  # {key.words}{', no default' if empty else ''}")
    return lines


def _comment(text: str) -> list[str]:
    return [f"# {line}" for line in textwrap.wrap(text, _WIDTH - 2)]
