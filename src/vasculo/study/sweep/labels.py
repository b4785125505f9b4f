"""Settings and numbers in words, for axes and tables."""

from __future__ import annotations

from typing import TYPE_CHECKING

from vasculo.study.schema import keys_of
from vasculo.study.sections import DOMAIN_KINDS, SECTIONS, domain_section

if TYPE_CHECKING:
    from collections.abc import Sequence

    from vasculo.study.schema import Key


def keys_called(path: str, kind: str | None = None) -> list[Key]:
    """Keys of a study file by "section.key"; one in each kind of domain that has it, or in this kind."""
    name, _, rest = path.partition(".")
    if name == "domain":
        sections = [domain_section(each) for each in (DOMAIN_KINDS if kind is None else (kind,))]
    else:
        sections = [SECTIONS[name]] if name in SECTIONS else []
    found = (keys_of(section.target, section.skip).get(rest) for section in sections)
    return [key for key in found if key is not None]


def setting_label(path: str, kind: str, among: Sequence[str] = ()) -> str:
    """Name of a setting with its unit, in a study with this kind of domain.

    With its section where another one of `among` is called the same.
    """
    section, _, name = path.partition(".")
    same = any(other != path and other.partition(".")[2] == name for other in among)
    words = f"{section} {name}" if same else name
    unit = next((key.unit for key in keys_called(path, kind)), "")
    return f"{words.replace('_', ' ')}, {unit}" if unit else words.replace("_", " ")


def setting_meaning(path: str, kind: str) -> str:
    """Say what a setting means."""
    known = (key.meaning.replace("`", "") for key in keys_called(path, kind))
    return next(known, "a named set of values")
