"""What differs between two studies, and which differences leave what was computed as it is."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from vasculo.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from vasculo.study.settings import Settings

Change = tuple[str, Any, Any]
"""A key as "section.key", its old and its new value; None where there is none."""

HARMLESS = ("study.title", "angiogenesis.steps", "output.", "units.")
"""Keys, and sections, that change no number of a step."""
OPEN = (*HARMLESS, "study.uses", "angiogenesis.")
"""Keys, and sections, that may change once the pillars are there."""


def differences(old: Settings, new: Settings) -> list[Change]:
    """List the keys that differ between two studies, in the order of their sections."""
    mine, theirs = old.tables(), new.tables()
    found = []
    for name in mine | theirs:
        one, two = mine.get(name, {}), theirs.get(name, {})
        found += [(f"{name}.{key}", one.get(key), two.get(key)) for key in one | two if one.get(key) != two.get(key)]
    return found


def check_changes(changes: Sequence[Change], label: str) -> None:
    """Refuse changes of what was computed before the angiogenesis.

    Raises
    ------
    InputError
        With the first of them.
    """
    for path, old, new in changes:
        if not path.startswith(OPEN):
            raise InputError(
                f"{label}: {path} = {new!r} would change what was computed with {old!r}: a run that goes on may change "
                f"[angiogenesis], [output], [units], study.title and study.uses only, start anew for the rest"
            )


def is_branch(changes: Sequence[Change]) -> bool:
    """Whether the changes lead to other numbers, so that the run parts from the one before."""
    return any(not path.startswith(HARMLESS) for path, _, _ in changes)


def told(changes: Sequence[Change]) -> str:
    """Write changes in one line."""
    texts = (f"{path} = {new!r} instead of {old!r}" for path, old, new in changes)
    return ", ".join(texts) or "the same settings"
