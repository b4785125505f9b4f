"""Watchers of the user: functions that are called once a step of a run, and what they may do there."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any, TypeVar

from vasculo.errors import InputError

STAGES = ("growth", "remodel")
"""What can be watched: the vasculogenesis, with a `GrowthStep`, and the angiogenesis, with a `RemodelStep`."""

Function = TypeVar("Function", bound=Callable[..., Any])
Watched = tuple[str, Callable[[Any], object]]
"""One of `STAGES`, and the function that is called there."""

_registered: list[Watched] = []


class StopRun(Exception):  # noqa: N818  # no error: a watcher has seen enough
    """Raised by a watcher to end the angiogenesis with the present step; the run counts as finished.

    Parameters
    ----------
    reason : str, optional
        For the log and the table of stages.

    Examples
    --------
    >>> from vasculo.study.watchers import StopRun
    >>> def one_left(step):
    ...     if len(step.domain.pillars) == 1:
    ...         raise StopRun("one pillar left")
    """


def watcher(stage: str) -> Callable[[Function], Function]:
    """Register a function that is called once a step of a run.

    A study names the file that holds it with `[study] uses = "my_watcher.py"`; in Python it can be given to
    `vasculo.run` as well.

    Parameters
    ----------
    stage : {"growth", "remodel"}
        "growth": called with a `GrowthStep` at every check of the vasculogenesis; "remodel": with a `RemodelStep` at
        every step of the angiogenesis, from 0.

    Returns
    -------
    callable
        Decorator that gives the function back unchanged. The function takes the step, which it must not change. It
        may return a dict of numbers, which become a row of `watch.csv` in the folder of the run, and in "remodel" it
        may raise `StopRun`. Any other exception ends the run with one line; what was recorded is kept.

    Raises
    ------
    InputError
        If the stage is none of these, or the function does not take one argument.

    Examples
    --------
    >>> import vasculo as vc
    >>> from vasculo.study.watchers import watcher
    >>> @watcher("remodel")
    ... def largest(step):
    ...     return {"largest_area": step.domain.pillar_areas.max()}
    """
    if stage not in STAGES:
        raise InputError(f"watcher({stage!r}) must be one of {', '.join(map(repr, STAGES))}")

    def register(function: Function) -> Function:
        try:
            inspect.signature(function).bind(None)
        except TypeError:
            name, taken = getattr(function, "__name__", repr(function)), inspect.signature(function)
            raise InputError(f"watcher {name}{taken} must take one argument, the step") from None
        _registered.append((stage, function))
        return function

    return register


def registered() -> tuple[Watched, ...]:
    """Return every watcher so far, in order."""
    return tuple(_registered)


def forget(first: int) -> None:
    """Take back all watchers but the first so many."""
    del _registered[first:]


def stages_of(function: object) -> tuple[str, ...]:
    """Return the stages that a function was registered for."""
    return tuple(stage for stage, other in _registered if other is function)
