"""What a sweep will take, and in which order its runs are best done."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from vasculo.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from vasculo.study.settings import Settings
    from vasculo.study.sweep.plan import PlannedRun

# Shares of the time of a run, from runs of `small`, `chains` and `paper`; only their order counts here.
_NODE, _PILLAR, _STEP = 1.4e-3, 4e-3, 0.06
_UNITS = (("days", 86400.0), ("h", 3600.0), ("min", 60.0))


def weight(settings: Settings) -> float:
    """About how long a run takes beside others, in no unit: for the order in which runs are handed out.

    The tissue goes by its nodes, the remodelling by its steps and pillars, whose number a tissue does not tell before
    it is torn: about one in eighty of its nodes.
    """
    nodes = settings.tissue["nodes"] if settings.kind == "tissue" else 0
    found = _NODE * nodes
    if "angiogenesis" in settings.stages:
        pillars = settings.domain.get("pillars", 1) if settings.kind == "voronoi" else max(1, nodes // 80)
        found += (settings.angiogenesis.steps + 1) * (_STEP + _PILLAR * pillars)
    return found


def longest_first(runs: Sequence[PlannedRun], weights: Mapping[int, float]) -> list[PlannedRun]:
    """Put the runs of the points with the largest weights first, so that no worker ends long after the others."""
    return sorted(runs, key=lambda run: -weights.get(run.point, 0.0))


@dataclass(frozen=True)
class Expected:
    """What a sweep is expected to take.

    Attributes
    ----------
    seconds : float
        Wall time with nothing else running, compiling not counted.
    memory : float
        Largest memory of a worker, MB.
    record : float
        Size of all records together, MB.
    """

    seconds: float
    memory: float
    record: float


def expected(samples: Mapping[int, Settings], runs: int, workers: int, threads: int) -> Expected:
    """Forecast a sweep from some of its points.

    Parameters
    ----------
    samples : mapping of int to Settings
        Checked studies of points, by their numbers.
    runs : int
        Runs of all points.
    workers, threads : int
        Worker processes, and threads of each.

    Raises
    ------
    InputError
        When one of these points has a time step that is too long, or cannot be meshed.
    """
    from vasculo.study.forecast import foresee  # noqa: PLC0415  # loads the flow, which a plan has no other use for
    from vasculo.study.pace import measure_pace  # noqa: PLC0415

    pace = replace(measure_pace(), threads=threads)
    found = []
    for number, settings in samples.items():
        try:
            found.append(foresee(settings, pace))
        except InputError as error:
            raise InputError(f"point {number}: {error}") from None
    share = runs / len(found)
    return Expected(
        share * sum(each.seconds for each in found) / min(workers, runs),
        max(each.memory for each in found),
        share * sum(each.record for each in found),
    )


def told_time(seconds: float) -> str:
    """Write a time in the unit that suits it."""
    for unit, length in _UNITS:
        if seconds >= 1.5 * length:
            return f"{seconds / length:.0f} {unit}"
    return f"{seconds:.0f} s"
