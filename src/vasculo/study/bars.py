"""Progress bars of a run in a terminal; plain lines where there is none."""

from __future__ import annotations

from time import perf_counter
from typing import TYPE_CHECKING, Self

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskID, TaskProgressColumn, TextColumn, TimeElapsedColumn

if TYPE_CHECKING:
    from types import TracebackType


class Bars:
    """A bar a stage, with its numbers beside it; written to the error stream, so that results stay apart.

    Parameters
    ----------
    quiet : bool
        Show nothing at all.
    """

    def __init__(self, *, quiet: bool = False) -> None:
        self._console = Console(stderr=True, quiet=quiet, highlight=False)
        self._live = self._console.is_terminal and not quiet
        self._progress = Progress(
            TextColumn("{task.fields[stage]:<15}", markup=False),
            BarColumn(bar_width=24),
            TaskProgressColumn(),
            TimeElapsedColumn(),
            TextColumn("{task.description}", markup=False),
            console=self._console,
            disable=not self._live,
        )
        self._task = TaskID(0)
        self._stage = ""
        self._clock = 0.0

    def __enter__(self) -> Self:
        self._progress.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._progress.stop()

    def begin(self, stage: str, text: str) -> None:
        """Start the bar of a stage."""
        self._stage, self._clock = stage, perf_counter()
        self._task = self._progress.add_task(text, total=None, stage=stage)

    def advance(self, done: float, total: float, text: str) -> None:
        """Move the bar of the present stage."""
        self._progress.update(self._task, completed=done, total=max(total, 1), description=text)

    def note(self, text: str) -> None:
        """Write a line above the bars."""
        stage = f"{self._stage:<15} " if self._stage else ""
        self._progress.console.print(f"{stage}{text}", soft_wrap=True, markup=False)

    def end(self, text: str) -> None:
        """Fill the bar of the present stage."""
        self._progress.update(self._task, completed=1, total=1, description=text)
        self._progress.stop_task(self._task)
        if not self._live:
            self._console.print(
                f"{self._stage:<15} {perf_counter() - self._clock:7.1f} s  {text}", soft_wrap=True, markup=False
            )
