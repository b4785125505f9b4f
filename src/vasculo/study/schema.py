"""The keys of a section, read from the thing it configures: its signature and its docstring are the one source."""

from __future__ import annotations

import inspect
import itertools
import re
import types
import typing
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel, ConfigDict, Field, create_model

from vasculo.study.ranges import ranges_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from vasculo.study.ranges import Range

_UNIT = re.compile(r"\[([^\]]*[A-Za-zµ][^\]]*)\]")
_HEADER = re.compile(r"^(\*{0,2}\w+(?:, \*{0,2}\w+)*) : ")
_REQUIRED: Any = ...


@dataclass(frozen=True)
class Key:
    """One key of a section.

    Attributes
    ----------
    name : str
        As in the study file and in Python.
    kind : type
        Annotation of the parameter.
    default : object
        Its default; None for a key that may be left out.
    meaning : str
        What the docstring says about it, with its unit in brackets.
    range : Range, optional
        Where a number must lie.
    """

    name: str
    kind: Any
    default: Any
    meaning: str
    range: Range | None = None

    @property
    def words(self) -> str:
        """What a value must be, in words."""
        return kind_words(self.kind)

    @property
    def unit(self) -> str:
        """Unit of the value, as the docstring has it in brackets; empty for a pure number, and for what is none."""
        found = _UNIT.search(self.meaning)
        return found.group(1) if found else ""

    @property
    def required(self) -> bool:
        """Whether the key has no default and must be given."""
        return self.default is inspect.Parameter.empty


@lru_cache(maxsize=32)
def keys_of(target: Callable[..., Any], skip: tuple[str, ...] = ()) -> dict[str, Key]:
    """Read the keys from the signature and the "Parameters" of a dataclass or function.

    Parameters
    ----------
    target : callable
        A dataclass or a function.
    skip : tuple of str
        Parameters that are no keys.
    """
    hints = typing.get_type_hints(target)
    meanings = parameter_meanings(inspect.getdoc(target) or "")
    ranges = ranges_of(target)
    return {
        name: Key(name, hints[name], parameter.default, meanings.get(name, ""), ranges.get(name))
        for name, parameter in inspect.signature(target).parameters.items()
        if name not in skip
    }


def parameter_meanings(text: str) -> dict[str, str]:
    """Meaning of each name under "Parameters" (or "Attributes") of a NumPy docstring, each on one line."""
    found: dict[str, list[str]] = {}
    current: list[str] = []
    inside = False
    lines = [*text.splitlines(), ""]
    for line, following in itertools.pairwise(lines):
        if following.startswith("---"):
            inside = line.strip() in {"Parameters", "Attributes"}
            current = []
        elif inside and (match := _HEADER.match(line)):
            current = []
            for name in match.group(1).split(", "):
                found.setdefault(name.lstrip("*"), current)
        elif inside and line.startswith("    "):
            current.append(line.strip())
    return {name: " ".join(words) for name, words in found.items()}


@lru_cache(maxsize=32)
def model_of(target: Callable[..., Any], skip: tuple[str, ...] = ()) -> type[BaseModel]:
    """Build the pydantic model that checks a section: frozen, strict types, unknown keys refused."""
    fields: dict[str, Any] = {
        key.name: (key.kind, Field(_REQUIRED if key.required else key.default, description=key.meaning))
        for key in keys_of(target, skip).values()
    }
    name = getattr(target, "__name__", "Section")
    return create_model(name, __config__=ConfigDict(frozen=True, extra="forbid", strict=True), **fields)


def kind_words(kind: Any) -> str:  # an annotation of any sort
    """Say what a value must be: "a number", "true or false", "one of ..."."""
    origin = get_origin(kind)
    if origin is Literal:
        return "one of " + ", ".join(repr(value) for value in get_args(kind))
    if origin in {Union, types.UnionType}:
        return " or ".join(kind_words(part) for part in get_args(kind) if part is not type(None))
    if origin is dict:
        return "a table"
    words = {int: "a whole number", float: "a number", bool: "true or false", str: "a text"}
    return words.get(kind, "of another type")
