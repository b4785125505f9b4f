"""Run a sweep: plan it, hand its runs to workers, keep its tables in step with what is done."""

from __future__ import annotations

import queue
import shutil
from contextlib import suppress
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Any

from vasculo.errors import ComputationError, InputError
from vasculo.store.table import write_whole
from vasculo.study.beginning import copy_files
from vasculo.study.patience import Patience
from vasculo.study.sweep.cost import longest_first, told_time
from vasculo.study.sweep.file import read_sweep
from vasculo.study.sweep.home import PLAN, STOP, STUDY, SWEEP, claimed, new_home, old_home
from vasculo.study.sweep.plan import look, make_plan, plan_from_json
from vasculo.study.sweep.results import Sweep, open_sweep
from vasculo.study.sweep.work import Outcome, found_complete, work
from vasculo.study.watch import Silence

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from distributed import Client, Future

    from vasculo.study.sweep.plan import Looked, PlannedRun
    from vasculo.study.watch import Progress

_TICK = 0.2
"""Seconds for which the sweep waits for a run to end before it looks whether it shall stop."""
_GRACE = 10.0
"""Seconds that the runs have to come to their next step when the sweep is stopped."""
_SHARE = 20.0
"""Tables are written after every run, unless that would take more than one part in so many of the time."""


_LINES = 10
"""Lines that are written on the way, for logs, where there is no bar."""


class Stopped(KeyboardInterrupt):
    """A sweep was stopped by the user; the message says how to go on.

    Parameters
    ----------
    folder : Path
        Folder of the sweep.
    """

    def __init__(self, folder: Path) -> None:
        super().__init__(f"stopped; what was done is kept, go on with: vasculo sweep --resume --out {folder}")
        self.folder = folder


def sweep(
    file: str | Path | Mapping[str, Any] | None = None,
    out: str | Path | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    progress: Progress | None = None,
    *,
    resume: bool = False,
) -> Sweep:
    """Run a study many times under varied settings and seeds, on the processors of this machine or at a dask scheduler.

    Parameters
    ----------
    file : str, Path or mapping
        A sweep file (TOML), or a mapping of the same shape, see docs/sweeps.md. May be left out with `resume`.
    out : str or Path, optional
        Folder of the sweep; `sweeps/<name of the file>` when left out, with a number behind it when that is taken.
    workers : int, optional
        Worker processes on this machine; one a processor when left out.
    scheduler : str, optional
        Address of a dask scheduler, as "tcp://host:8786", whose workers do the runs instead.
    progress : Progress, optional
        Is told how far the sweep is; see `vasculo.study.watch`.
    resume : bool
        Go on with the sweep in `out`: runs that are complete stay as they are, one that was interrupted goes on behind
        its last step, those that failed are tried again. With a `file` that has more points or seeds these are added.

    Returns
    -------
    Sweep
        With `table`, `summary`, `failures` and `folder`. Runs that failed are in `failures` and stop nothing.

    Raises
    ------
    InputError
        When the sweep, its study or one of its points cannot be used, before anything is run; when the scheduler does
        not answer.
    ComputationError
        When the scheduler goes away or the tables cannot be written; what was done is kept.
    KeyboardInterrupt
        When it was stopped; what was done is kept, see `resume`.

    Examples
    --------
    >>> import vasculo as vc
    >>> plan = {"sweep": {"study": "disk", "seeds": 1}, "vary": {"domain.height": [6.0, 8.0, 10.0]}}
    >>> found = vc.sweep(plan, out="sweeps/height")  # doctest: +SKIP
    >>> found.table["domain.height"], found.table["aspect_ratio"]  # doctest: +SKIP
    """
    if workers is not None and (isinstance(workers, bool) or not isinstance(workers, int) or workers < 1):
        raise InputError(f"workers = {workers!r} is not a whole number from 1 up")
    if workers is not None and scheduler is not None:
        raise InputError(f"workers = {workers} are of this machine, not of scheduler {scheduler}: give one of them")
    from vasculo.study.sweep.cluster import local_cluster, remote_cluster  # noqa: PLC0415  # an extra

    shown = progress or Silence()
    found = _go_on(file, out) if resume else _begin(file, out)
    home = found.folder
    busy = f"{home} is worked in by another process: wait for its end"
    with claimed(home, busy), Patience() as pause:
        (home / STOP).unlink(missing_ok=True)
        todo = _still_to_do(found)
        found.write_tables()
        shown.note(f"{len(found.plan.runs)} runs of {len(found.plan.points)} points in {home}, {len(todo)} to do")
        try:
            if todo:
                seen = home.resolve()
                where = remote_cluster(scheduler, seen) if scheduler else local_cluster(workers, seen)
                with where as client:
                    count = len(client.nthreads())
                    shown.note(f"{count} worker{'s' * (count > 1)}, dashboard: {client.dashboard_link}")
                    _Work(found, client, shown, pause).through(todo)
        except KeyboardInterrupt:
            raise Stopped(home) from None
        except OSError as error:
            raise ComputationError(_broken(home, error)) from error
        finally:
            (home / STOP).unlink(missing_ok=True)
        _illustrate(found, shown)
    return found


def plan_sweep(file: str | Path | Mapping[str, Any]) -> Sweep:
    """Plan a sweep and check every point of it; nothing is written.

    Raises
    ------
    InputError
        For the first point that cannot be run.
    """
    asked = read_sweep(file)
    plan, path = make_plan(asked)
    return Sweep(Path(), asked, plan, look(plan, path, asked.source))


def _begin(file: str | Path | Mapping[str, Any] | None, out: str | Path | None) -> Sweep:
    """Plan a sweep, check every point, and make its folder."""
    if file is None:
        raise InputError("say what to sweep: a sweep file, as `vasculo sweep --new FILE` writes one")
    asked = read_sweep(file)
    plan, path = make_plan(asked)
    looked = look(plan, path, asked.source)
    found = Sweep(Path(), asked, plan, looked)
    found.folder = new_home(_name_of(file), out)
    write_whole(found.folder / STUDY, path.read_bytes())
    _keep(found, looked)
    return found


def _go_on(file: str | Path | Mapping[str, Any] | None, out: str | Path | None) -> Sweep:
    """Open the sweep to go on with, and add what a file has beyond it."""
    home = old_home(None if file is None else _name_of(file), out)
    if file is None:
        return open_sweep(home)
    asked = read_sweep(file)
    new, path = make_plan(asked)
    if path.read_bytes() != (home / STUDY).read_bytes():
        raise InputError(f"{home} was begun with another {path.name}: change it back, or start anew with --out")
    plan = plan_from_json((home / PLAN).read_text(encoding="utf-8"), str(home / PLAN)).grown(new)
    looked = look(plan, path, asked.source)
    found = Sweep(home, asked, plan, looked)
    _keep(found, looked)
    return found


def _keep(found: Sweep, looked: Looked) -> None:
    """Write the sweep and its plan, and the files that its study needs, into its folder."""
    for settings in looked.files:
        copy_files(settings, found.folder)
    write_whole(found.folder / SWEEP, found.file.text)
    write_whole(found.folder / PLAN, found.plan.to_json())


def _name_of(file: str | Path | Mapping[str, Any]) -> str:
    return Path(file).stem if isinstance(file, (str, Path)) else "sweep"


def _still_to_do(found: Sweep) -> list[PlannedRun]:
    """Take stock of the folders of the runs, which know best what is complete; return the others, longest first."""
    todo = []
    for run in found.plan.runs:
        found.outcomes.pop(run.name, None)
        outcome = found_complete(found.folder, run.name, found.plan.overrides(run), found.names)
        if outcome is None:
            todo.append(run)
        else:
            found.outcomes[run.name] = outcome
    return longest_first(todo, found.weights)


class _Work:
    """Hands runs to workers and keeps the tables in step.

    Parameters
    ----------
    found : Sweep
        Gets the outcomes.
    client : distributed.Client
        Where the workers are.
    shown : Progress
        Is told how far it is.
    pause : callable
        Raises KeyboardInterrupt when the sweep shall stop.
    """

    def __init__(self, found: Sweep, client: Client, shown: Progress, pause: Callable[[], None]) -> None:
        self.found, self.client, self.shown, self.pause = found, client, shown, pause
        self.ended: queue.SimpleQueue[Future] = queue.SimpleQueue()
        self.clock = perf_counter()
        self.next_write = 0.0

    def through(self, todo: list[PlannedRun]) -> None:
        """Do all runs; the first to be handed out are the first in the list."""
        found = self.found
        home, names = found.folder.resolve(), found.names
        self.shown.begin("runs", "")
        pending = {}
        for run in todo:
            key = ("sweep", run.name, str(id(self)))
            future = self.client.submit(work, home, run.name, found.plan.overrides(run), names, key=key, pure=False)
            future.add_done_callback(self.ended.put)
            pending[future.key] = run, future
        try:
            while pending:
                self.pause()
                with suppress(queue.Empty):
                    future = self.ended.get(timeout=_TICK)
                    run, _ = pending.pop(future.key)
                    self._take(run, future, len(todo), len(todo) - len(pending))
        except KeyboardInterrupt:
            self._stop(pending)
            raise
        finally:
            found.write_tables()
        complete, failed = found.count("complete"), found.count("failed")
        self.shown.end(f"{complete} complete" + (f", {failed} failed" if failed else ""))

    def _take(self, run: PlannedRun, future: Future, total: int, done: int) -> None:
        """Keep what became of a run."""
        outcome = _outcome_of(run, future, self.found.folder)
        self.found.outcomes[run.name] = outcome
        if outcome.status == "failed":
            self.shown.note(f"run {run.name} failed ({run.words}): {outcome.line}")
        now = perf_counter()
        if now >= self.next_write:
            self.found.write_tables()
            took = perf_counter() - now
            self.next_write = now + _SHARE * took if took > 0.05 else 0.0
        left = (now - self.clock) / done * (total - done)
        text = f"run {run.name}, about {told_time(left)} left"
        self.shown.advance(done, total, text)
        if total >= 2 * _LINES and _LINES * done // total > _LINES * (done - 1) // total:
            self.shown.note(f"{done} of {total} done, about {told_time(left)} left")

    def _stop(self, pending: dict[Any, tuple[PlannedRun, Future]]) -> None:
        """Let the runs that are being done come to their next step, and take the others back."""
        (self.found.folder / STOP).touch()
        self.shown.note("stopping at the next step of each run")
        active = {key for keys in self.client.processing().values() for key in keys}
        self.client.cancel([future for key, (_, future) in pending.items() if key not in active])
        end = perf_counter() + _GRACE
        waiting = {key for key in pending if key in active}
        while waiting and perf_counter() < end:
            with suppress(queue.Empty):
                future = self.ended.get(timeout=_TICK)
                waiting.discard(future.key)
                run = pending[future.key][0]
                if future.status == "finished" and future.result().status != "stopped":
                    self.found.outcomes[run.name] = future.result()


def _outcome_of(run: PlannedRun, future: Future, home: Path) -> Outcome:
    """Tell what became of a run, by its worker, or by dask where that one is gone."""
    if future.status == "finished":
        return future.result()
    if future.status == "cancelled":
        raise ComputationError(
            f"the scheduler went away; what was done is kept, go on with: vasculo sweep --resume --out {home}"
        )
    error = future.exception()
    if type(error).__name__ == "KilledWorker":
        times = error.allowed_failures + 1
        return Outcome(run.name, "failed", f"its worker was killed {times} times, most likely it ran out of memory")
    return Outcome(run.name, "failed", " ".join(f"{type(error).__name__}: {error}".split()))


def _illustrate(found: Sweep, shown: Progress) -> None:
    """Draw the diagrams and write the page; say so when matplotlib is missing."""
    shown.begin("pictures", "")
    try:
        from vasculo.study.sweep.pictures import illustrate  # noqa: PLC0415  # an extra; heavy
    except InputError as error:
        shown.end(f"left out: {error}")
        return
    shown.end(str(illustrate(found)))


def _broken(home: Path, error: OSError) -> str:
    """Say in one line what could not be written or reached, and how to go on."""
    go_on = f"what was done is kept, go on with: vasculo sweep --resume --out {home}"
    if error.errno is None:  # not of a file, but of a connection
        return f"the scheduler went away ({error}); {go_on}"
    free = shutil.disk_usage(home).free / 2**20
    return f"{error.filename or home} cannot be written: {error.strerror or error} ({free:.0f} MB free); {go_on}"
