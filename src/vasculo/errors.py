"""The two ways in which a call can end badly."""

from __future__ import annotations


class InputError(ValueError):
    """What was given cannot be used; the one-line message says what, where and what would be right.

    Examples
    --------
    >>> import vasculo as vc
    >>> try:
    ...     vc.Domain.rectangle(2.0, -1.0)
    ... except vc.InputError as error:
    ...     print(error)
    a rectangle needs a positive, finite height, not -1.0
    """


class ComputationError(RuntimeError):
    """A computation did not get there; the one-line message carries the numbers at which it stopped.

    Examples
    --------
    >>> import vasculo as vc
    >>> isinstance(vc.ComputationError("step 3 of 9: no equilibrium"), RuntimeError)
    True
    """


def missing_extra(purpose: str, package: str, extra: str) -> InputError:
    """Make the error for a package that is not installed: one line with the command that brings it.

    Examples
    --------
    >>> print(missing_extra("pictures", "matplotlib", "draw"))
    pictures need matplotlib: pip install 'vasculo[draw]' brings it
    """
    return InputError(f"{purpose} need {package}: pip install 'vasculo[{extra}]' brings it")
