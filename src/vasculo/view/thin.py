"""Which steps of a long run are shown, and in which order they are sent."""

from __future__ import annotations

from typing import TYPE_CHECKING, TypeVar

from vasculo.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from vasculo.store.read import Run

Step = TypeVar("Step")

MOST = 100
"""Steps of a stage that are shown at most, unless the user asks for more."""


def check(run: Run, most: int) -> None:
    """Look whether anything of a run can be shown.

    Raises
    ------
    InputError
        When no step was recorded, or `most` is below 2.
    """
    if most < 2:
        raise InputError(f"{most} steps of a stage cannot be shown: the first and the last one make 2")
    if not run.frames:
        raise InputError(f"{run.folder} has no recorded step to view: the run stopped before its first one")


def spacing(count: int, most: int = MOST) -> int:
    """Every how many-th of `count` steps is shown so that there are `most` at most, the last one in any case.

    Examples
    --------
    >>> spacing(100, 100), spacing(101, 100), spacing(200, 100), spacing(1000, 100)
    (1, 2, 3, 11)
    """
    every = 1
    while len(range(0, count, every)) + ((count - 1) % every > 0) > most and every < count:
        every += 1
    return every


def shown(count: int, every: int) -> list[int]:
    """Places of the steps that are shown, the first and the last one among them.

    Examples
    --------
    >>> shown(8, 3)
    [0, 3, 6, 7]
    """
    return sorted({*range(0, count, every), count - 1}) if count else []


def coarse_first(steps: Sequence[Step]) -> list[Step]:
    """Order in which steps are sent: the ends, then again and again the middle of each gap.

    So the whole run is there within a moment, and grows finer.

    Examples
    --------
    >>> coarse_first([0, 1, 2, 3, 4])
    [0, 4, 2, 1, 3]
    """
    if len(steps) < 3:
        return list(steps)
    order, gaps = [0, len(steps) - 1], [(0, len(steps) - 1)]
    while gaps:
        split = [(low, (low + high) // 2, high) for low, high in gaps if high - low > 1]
        order += [middle for _, middle, _ in split]
        gaps = [gap for low, middle, high in split for gap in ((low, middle), (middle, high))]
    return [steps[i] for i in order]
