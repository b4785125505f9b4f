"""A team of threads for compiled loops that let go of the interpreter, and how large it is.

The loops divide the work by fixed pieces and add in a fixed order, so the number of threads changes no result.
"""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from threading import Lock
from time import perf_counter, thread_time
from typing import TYPE_CHECKING

from vasculo.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Callable
    from concurrent.futures import Future

VARIABLE = "VASCULO_THREADS"
"""Environment variable with the number of threads; without it, the processors that this process may use."""


CROWDED = 0.6
"""Share of the time on the clock that the caller must have had a processor; below, others want the processors too."""

PAUSE = 0.1
"""Seconds for which loops then run on one thread before a team is tried again: waiting for a stopped thread is dear."""

LONG = 1e-3
"""Seconds from which on a loop tells how crowded the machine is."""


class _Team:
    """The helpers of this process. One loop at a time has them; a second one meanwhile runs alone."""

    def __init__(self) -> None:
        self.size: int | None = None
        self.busy = Lock()
        self.pool: ThreadPoolExecutor | None = None
        self.process = -1
        self.helpers = 0
        self.paused_until = 0.0

    def get_pool(self, helpers: int) -> ThreadPoolExecutor:
        """Return a pool with as many threads; one from before a fork has lost its threads."""
        if self.pool is None or self.process != os.getpid() or self.helpers < helpers:
            self.pool = ThreadPoolExecutor(helpers, "vasculo")
            self.process, self.helpers = os.getpid(), helpers
        return self.pool


_TEAM = _Team()


def get_threads() -> int:
    """Return the number of threads that the mass-spring engine may use, 1 or more.

    Raises
    ------
    InputError
        When the environment variable `VASCULO_THREADS` is no whole number from 1 up.
    """
    if _TEAM.size is None:
        given = os.environ.get(VARIABLE, "")
        if given and not (given.isdecimal() and int(given) >= 1):
            raise InputError(f"{VARIABLE} is {given!r}, expected a whole number >= 1")
        _TEAM.size = int(given) if given else len(os.sched_getaffinity(0))
    return _TEAM.size


def set_threads(threads: int) -> None:
    """Set the number of threads that the mass-spring engine may use in this process. It changes no result.

    Raises
    ------
    InputError
        When it is no whole number from 1 up.
    """
    if isinstance(threads, bool) or not isinstance(threads, int) or threads < 1:
        raise InputError(f"threads is {threads!r}, expected a whole number >= 1")
    _TEAM.size = threads


def run_team(loop: Callable[..., int], most: int, *arguments: object) -> int:
    """Call `loop(rank, threads, *arguments)` once on each thread of a team, at the same time; return what rank 0 did.

    Parameters
    ----------
    loop : callable
        Compiled, without the interpreter lock. Its threads may wait for each other.
    most : int
        Most threads that the work is worth.
    """
    threads = min(get_threads(), most)
    if threads <= 1 or perf_counter() < _TEAM.paused_until or not _TEAM.busy.acquire(blocking=False):
        return loop(0, 1, *arguments)
    clock, processor = perf_counter(), thread_time()
    try:
        pool = _TEAM.get_pool(threads - 1)
        others: list[Future[int]] = [pool.submit(loop, rank, threads, *arguments) for rank in range(1, threads)]
        done = loop(0, threads, *arguments)
        # what the caller lost on its own way counts, not that others have more to do
        took, had = perf_counter() - clock, thread_time() - processor
        for other in others:
            other.result()
        if took > LONG and had < CROWDED * took:
            _TEAM.paused_until = perf_counter() + PAUSE
    finally:
        _TEAM.busy.release()
    return done
