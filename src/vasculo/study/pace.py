"""How fast this machine is: a short benchmark of the spring engine, which costs are scaled by."""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter, thread_time

import numpy as np

from vasculo.springs.network import SpringNetwork
from vasculo.springs.threads import get_threads

REFERENCE = 4.1e-9
"""Seconds a spring and step that the benchmark took of one thread of the machine on which costs were measured."""

SECONDS, LONGEST = 0.2, 0.6
"""Time that the benchmark takes of a thread, and on the clock at most."""

_SIDE, _STEPS = 24, 1_000
_BUSY = 1.3
"""Time on the clock over time of the processor above which a machine counts as busy with other work."""


@dataclass(frozen=True)
class Pace:
    """Speed of a machine.

    Attributes
    ----------
    spring : float
        Seconds a spring and time step, of the processor.
    busy : float
        Time on the clock over time of the processor: 1 when nothing else runs.
    threads : int
        Threads that the spring engine uses.
    """

    spring: float = REFERENCE
    busy: float = 1.0
    threads: int = 1

    @property
    def factor(self) -> float:
        """Time that anything takes here over that on the machine on which costs were measured."""
        return self.spring / REFERENCE

    @property
    def words(self) -> str:
        """What the benchmark said."""
        plural = "s" if self.threads > 1 else ""
        text = (
            f"{1e9 * self.spring:.1f} ns a spring and step in a {SECONDS:g} s benchmark, {self.threads} thread{plural}"
        )
        if self.busy > _BUSY:
            text += f"; this machine is busy, it takes {self.busy:.1f} times as long now"
        return text


def measure_pace() -> Pace:
    """Time the spring engine on a small network for 0.2 s of a processor.

    Returns
    -------
    Pace
    """
    network = _sheet(_SIDE)
    network.advance(0.1, 1)  # loads what is compiled
    clock, processor, steps = perf_counter(), thread_time(), 0
    while thread_time() - processor < SECONDS and perf_counter() - clock < LONGEST:
        network.advance(0.1, _STEPS)
        steps += _STEPS
    took, had = perf_counter() - clock, thread_time() - processor
    return Pace(had / (steps * len(network.springs)), max(1.0, took / had), get_threads())


def _sheet(side: int) -> SpringNetwork:
    """Make a sheet of regular triangles, pinned at two corners."""
    column, row = np.meshgrid(np.arange(side, dtype=np.float64), np.arange(side, dtype=np.float64))
    points = np.stack([(column + 0.5 * row).ravel(), (np.sqrt(0.75) * row).ravel()], axis=1)
    number = np.arange(side * side).reshape(side, side)
    pairs = ((number[:, :-1], number[:, 1:]), (number[:-1], number[1:]), (number[:-1, 1:], number[1:, :-1]))
    springs = np.concatenate([np.stack([one.ravel(), other.ravel()], axis=1) for one, other in pairs])
    pinned = np.isin(number.ravel(), (number[0, 0], number[-1, -1]))
    return SpringNetwork(points, springs, damping=1.0, pinned=pinned)
