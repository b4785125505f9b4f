"""One check of a run: what was found, what counts as good, and what that means."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Check:
    """One check of a run.

    Attributes
    ----------
    name : str
        What was looked at.
    found : str
        What was found, with its numbers.
    threshold : str
        What counts as good.
    good : bool
        Whether it is.
    meaning : str
        What the threshold means.
    """

    name: str
    found: str
    threshold: str
    good: bool
    meaning: str
