"""How fibres are stretched: the common rest-length factor s(t) falls along straight lines.

A tissue that grows by 1/s inside a fixed frame stretches its fibres as much as fibres whose rest lengths shrink by s.
Szczerba & Szekely 2005, section 2, speak of a growing tissue; to shrink the fibres instead is ours.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

CHECK_FACTOR = 0.005
"""Change of the rest-length factor between two looks at the voids."""

CHECK_TIME = 5.0
"""Longest time between two looks (sqrt(m / k))."""


def pieces(first: float, last: float, steps: int, every: int) -> Iterator[tuple[int, float, float]]:
    """Cut a straight run of the factor from first to last into pieces of at most `every` steps.

    Yields
    ------
    steps, first, last
        Steps of the piece and the factor at its beginning and end.
    """
    for begin in range(0, steps, every):
        end = min(begin + every, steps)
        yield end - begin, first + (last - first) * begin / steps, first + (last - first) * end / steps


def growth_steps(rate: float, limit: float, time_step: float) -> int:
    """Time steps in which the factor falls from 1 to the limit at a rate (1 / time)."""
    return max(1, round((1.0 - limit) / (rate * time_step)))


def steps_in(time: float, time_step: float) -> int:
    """Time steps in a time."""
    return max(0, round(time / time_step))


def check_interval(rate: float, time_step: float) -> int:
    """Time steps between two looks while the factor falls at this rate (1 / time)."""
    time = min(CHECK_TIME, CHECK_FACTOR / rate) if rate > 0.0 else CHECK_TIME
    return max(1, round(time / time_step))
