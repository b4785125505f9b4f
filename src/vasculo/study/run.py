"""Run a study: a folder with its record, table, figures and report."""

from __future__ import annotations

import shutil
from contextlib import suppress
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING

import vasculo
from vasculo.errors import ComputationError, InputError
from vasculo.store.read import RECORD, TABLE, Run, open_run
from vasculo.store.record import Record, first_line
from vasculo.study.beginning import Beginning, extend, find_run, new_run, old_run, reopen
from vasculo.study.branch import make_branch
from vasculo.study.changes import is_branch
from vasculo.study.folder import Log, clear_folder
from vasculo.study.job import Job, peak_memory
from vasculo.study.patience import Patience
from vasculo.study.recorders import Table
from vasculo.study.watch import Silence
from vasculo.study.watch_table import sort_watchers, user_watchers

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from vasculo.study.watch import Progress


class Interrupted(KeyboardInterrupt):
    """A run was stopped by the user; the message says how to go on.

    Parameters
    ----------
    folder : Path
        Folder of the run.
    """

    def __init__(self, folder: Path) -> None:
        super().__init__(f"stopped; what was done is kept, go on with: vasculo run --resume --out {folder}")
        self.folder = folder


def run(
    study: str | Path | None = None,
    out: str | Path | None = None,
    settings: Mapping[str, object] | None = None,
    *,
    resume: bool = False,
    branch: str | Path | None = None,
    step: int | None = None,
    progress: Progress | None = None,
    watchers: Sequence[object] = (),
) -> Run:
    """Run a study, go on with a run that was interrupted, or branch off from one.

    Parameters
    ----------
    study : str or Path, optional
        A TOML file or the name of a built-in study; "paper" when left out.
    out : str or Path, optional
        Folder of the run; `runs/<study>` when left out, with a number behind it when that is taken.
    settings : mapping of "section.key" to value, optional
        Values that replace those of the study, or of the run.
    resume : bool
        Go on with the run in the folder `out`, from its last finished step, to the same numbers as in one go.
        With `settings` that lead to other numbers a branch of it is made, in a folder beside it.
    branch : str or Path, optional
        Folder of a run to branch off from: its steps up to `step` are copied into the folder `out` (beside it, with
        "-branch" behind its name, when left out), and the run goes on there with the new `settings`. The old folder
        stays as it is.
    step : int, optional
        Last recorded step of the angiogenesis that a branch keeps; the last one when left out.
    progress : Progress, optional
        Is told how far the run is; see `vasculo.study.watch`.
    watchers : sequence
        Who looks on: functions that were registered with `vasculo.watcher`, or objects with any of the methods
        `growth(step)`, `remodel(step)` and `end()`. Those that the study's own file registers come first. A run does
        not keep these: give them again to go on.

    Returns
    -------
    Run
        The finished run, opened.

    Raises
    ------
    InputError
        When the study, the folder or what it leads to cannot be used.
    ComputationError
        When a stage did not get there or a file could not be written; the last good step is kept.
    KeyboardInterrupt
        When it was stopped; what was done is kept, see `resume`.

    Examples
    --------
    >>> import vasculo as vc
    >>> run = vc.run("disk", out="runs/disk", settings={"angiogenesis.steps": 5})  # doctest: +SKIP
    """
    return execute(study, out, settings, resume=resume, branch=branch, step=step, progress=progress, watchers=watchers)


def execute(
    study: str | Path | None,
    out: str | Path | None,
    overrides: Mapping[str, object] | None,
    *,
    resume: bool = False,
    branch: str | Path | None = None,
    step: int | None = None,
    progress: Progress | None = None,
    label: str = "settings",
    watchers: Sequence[object] = (),
) -> Run:
    """Do what `run` does; `label` is what the overrides are called in messages."""
    shown = progress or Silence()
    functions, others = sort_watchers(watchers)
    begun = _begin(study, out, overrides, resume=resume, branch=branch, step=step, label=label)
    folder, settings = begun.folder, begun.settings
    try:
        with Log(folder) as log, Patience() as pause:
            if begun.note:
                shown.note(begun.note)
                log.line(begun.note)
            own = user_watchers(begun, functions)
            _compute(begun, log, shown, pause, (*own, *others))
            run = open_run(folder)
            if settings.output.figures:
                _illustrate(run, log, shown, pause)
                run = open_run(folder)
            log.line("complete")
    except KeyboardInterrupt:
        raise Interrupted(folder) from None
    except ComputationError as error:
        raise ComputationError(f"{error}; what was done is kept in {folder}") from error
    except InputError:
        if begun.fresh and not _has_frames(folder):
            clear_folder(folder, begun.fresh)
        raise
    except OSError as error:
        raise ComputationError(_disk_message(folder, error)) from error
    finally:
        with suppress(OSError, RuntimeError):  # it is closed already, unless the run never began
            begun.record.close()
    return run


def _begin(
    study: str | Path | None,
    out: str | Path | None,
    overrides: Mapping[str, object] | None,
    *,
    resume: bool,
    branch: str | Path | None,
    step: int | None,
    label: str,
) -> Beginning:
    """Make or find the folder of the run and what it goes on from."""
    if branch is not None:
        if study is not None or resume:
            raise InputError(f"a branch of {branch} takes its study from there: leave the study and resume out")
        kept = find_run(Path(branch))
        return make_branch(kept, *kept.changed(overrides, label), out, step)
    if not resume:
        if step is not None:
            raise InputError(f"step = {step} goes with a branch: name the run to branch off from")
        return new_run(study, out, overrides, label)
    kept, settings, changes = old_run(study, out, overrides, label)
    if step is not None or is_branch(changes):
        return make_branch(kept, settings, changes, None, step)
    return extend(kept, settings, changes) if changes else reopen(kept)


def _compute(begun: Beginning, log: Log, progress: Progress, pause: Patience, watchers: Sequence[object]) -> None:
    """Go through the stages and leave a complete record; or an incomplete one to go on from."""
    record, table = begun.record, Table(begun.folder / TABLE, begun.rows)
    state = "continued" if begun.rows else "new"
    log.line(f"vasculo {vasculo.__version__}: {begun.settings.study.title} ({state})")
    try:
        table.write()
        Job(
            begun.settings, begun.folder, record, table, log, begun.checkpoint, begun.start, progress, pause, watchers
        ).work()
        record.finish()
    except BaseException as error:
        log.line(f"stopped: {type(error).__name__}: {error}")
        with suppress(OSError, RuntimeError):  # the first error is the one to tell
            record.close()
        raise
    record.close()


def _illustrate(run: Run, log: Log, progress: Progress, pause: Patience) -> None:
    """Draw the figures, note the time that took, and write the report; say so when matplotlib is missing."""
    progress.begin("pictures", "")
    try:
        from vasculo.draw.figures import draw_all  # noqa: PLC0415  # an extra; heavy
        from vasculo.draw.report import write_report  # noqa: PLC0415
    except InputError as error:
        log.line(f"no pictures: {error}")
        progress.end(f"left out: {error}")
        return
    clock = perf_counter()

    def tell(done: float, total: float, title: str) -> None:
        pause()
        progress.advance(done, total, title)

    figures = draw_all(run, tell)
    stages = [stage for stage in run.facts("stages") if stage["name"] != "pictures"]
    seconds = round(perf_counter() - clock, 3)
    result = f"{len(figures)} figures"
    stages.append({"name": "pictures", "seconds": seconds, "peak_mb": round(peak_memory()), "result": result})
    record = Record.amend(run.path)
    record.set_facts("stages", stages)
    record.close()
    write_report(open_run(run.folder))
    log.line(f"pictures: {result} ({seconds:.1f} s)")
    progress.end(f"{result} and the report")


def _has_frames(folder: Path) -> bool:
    try:
        return bool(open_run(folder).frames)
    except InputError:
        return False


def _disk_message(folder: Path, error: OSError) -> str:
    """Say in one line what could not be written, and how to go on; or that the record cannot be read."""
    if error.errno is None and "writing" not in str(error):  # from HDF5; what it writes fails with a number
        return f"{folder / RECORD} is damaged ({first_line(error)}): start the run anew"
    free = shutil.disk_usage(folder).free / 2**20
    what = error.strerror or first_line(error)
    where = error.filename or folder
    return (
        f"{where} cannot be written: {what} ({free:.0f} MB free); what was written before is kept, "
        f"go on with: vasculo run --resume --out {folder}"
    )
