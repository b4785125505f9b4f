"""The two ways in which a call can end badly."""

from __future__ import annotations


class InputError(ValueError):
    """What was given cannot be used; the one-line message says what, where and what would be right."""


class ComputationError(RuntimeError):
    """A computation did not get there; the one-line message carries the numbers at which it stopped."""


def missing_extra(purpose: str, package: str, extra: str) -> InputError:
    """Make the error for a package that is not installed: one line with the command that brings it.

    Examples
    --------
    >>> print(missing_extra("pictures", "matplotlib", "draw"))
    pictures need matplotlib: pip install 'vasculo[draw]' brings it
    """
    return InputError(f"{purpose} need {package}: pip install 'vasculo[{extra}]' brings it")
