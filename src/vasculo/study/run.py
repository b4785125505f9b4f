"""Run a study: a folder with its record, table, figures and report."""

from __future__ import annotations

import shutil
from contextlib import suppress
from time import perf_counter
from typing import TYPE_CHECKING

import vasculo
from vasculo.errors import ComputationError, InputError
from vasculo.store.checkpoint import Checkpoint
from vasculo.store.read import CHECKPOINT, LOG, RECORD, STUDY, TABLE, Run, open_run
from vasculo.store.record import Record, first_line
from vasculo.store.table import write_whole
from vasculo.study.builtin import find_study
from vasculo.study.folder import Log, new_folder, old_folder
from vasculo.study.job import Job, peak_memory
from vasculo.study.outlines import take_along
from vasculo.study.patience import Patience
from vasculo.study.recorders import Table
from vasculo.study.settings import Settings, parse_study, read_study
from vasculo.study.watch import Silence

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

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
    progress: Progress | None = None,
) -> Run:
    """Run a study, or go on with one that was interrupted.

    Parameters
    ----------
    study : str or Path, optional
        A TOML file or the name of a built-in study; "paper" when left out.
    out : str or Path, optional
        Folder of the run; `runs/<study>` when left out, with a number behind it when that is taken.
    settings : mapping of "section.key" to value, optional
        Values that replace those of the study.
    resume : bool
        Go on with the run in the folder, from its last finished step, to the same numbers as without interruption.
    progress : Progress, optional
        Is told how far the run is; see `vasculo.study.watch`.

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
    return execute(study, out, settings, resume=resume, progress=progress, label="settings")


def execute(
    study: str | Path | None,
    out: str | Path | None,
    overrides: Mapping[str, object] | None,
    *,
    resume: bool,
    progress: Progress | None,
    label: str,
) -> Run:
    """Do what `run` does; `label` is what the overrides are called in messages."""
    shown, copied = progress or Silence(), None
    if resume:
        folder, settings = _old_run(study, out, overrides, label)
        checkpoint = Checkpoint.load(folder / CHECKPOINT)
        if not (folder / RECORD).is_file():
            raise InputError(f"{folder} cannot be continued: there is no {RECORD}; start the run anew")
        if checkpoint.settings != settings.to_toml():
            raise InputError(f"{folder / STUDY} was changed since the run began: start the run anew in another folder")
    else:
        path = find_study("paper" if study is None else study)
        settings = read_study(path, overrides, label)
        folder = new_folder(_name(path), out)
        if "file" in settings.domain:
            copied = take_along(settings.domain["file"], settings.folder, folder)
        checkpoint = Checkpoint(settings.to_toml())
    begun = checkpoint.frames > 0 or bool(checkpoint.stages)
    try:
        with Log(folder) as log, Patience() as pause:
            _compute(settings, folder, checkpoint, log, shown, pause)
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
        if not resume and not begun and not _has_frames(folder):
            _clear(folder, copied)
        raise
    except OSError as error:
        raise ComputationError(_disk_message(folder, error)) from error
    return run


def _name(path: Path) -> str:
    """Name of a study by its file; a `study.toml` goes by its folder."""
    return path.parent.name if path.name == STUDY else path.stem


def _old_run(
    study: str | Path | None, out: str | Path | None, overrides: Mapping[str, object] | None, label: str
) -> tuple[Path, Settings]:
    """Find the run to go on with; a study that is named besides must be the same."""
    folder = old_folder(_name(find_study("paper" if study is None else study)), out)
    text = (folder / STUDY).read_text(encoding="utf-8")
    settings = parse_study(text, str(folder / STUDY), folder=folder)
    if study is not None or overrides:
        path = folder / STUDY if study is None else find_study(study)
        asked = read_study(path, overrides, label).tables()
        kept = settings.tables()
        for name in sorted(asked.keys() | kept.keys()):
            one, two = asked.get(name, {}), kept.get(name, {})
            for key in sorted(one.keys() | two.keys()):
                if one.get(key) != two.get(key):
                    raise InputError(
                        f"{folder} was begun with {name}.{key} = {two.get(key)!r}, not {one.get(key)!r}: "
                        f"resume without changes, or start anew in another folder"
                    )
    return folder, settings


def _compute(
    settings: Settings, folder: Path, checkpoint: Checkpoint, log: Log, progress: Progress, pause: Patience
) -> None:
    """Go through the stages and leave a complete record; or an incomplete one, with a checkpoint to go on from."""
    path = folder / RECORD
    continued = path.exists()
    if continued:
        record, rows = _reopen(path, checkpoint)
    else:
        write_whole(folder / STUDY, checkpoint.settings)
        record, rows = Record.create(path, checkpoint.settings, vasculo.__version__), []
        checkpoint.save(folder / CHECKPOINT)
    table = Table(folder / TABLE, rows)
    log.line(f"vasculo {vasculo.__version__}: {settings.study.title} ({'continued' if continued else 'new'})")
    try:
        table.write()
        Job(settings, folder, record, table, log, checkpoint, progress, pause).work()
        record.finish()
    except BaseException as error:
        log.line(f"stopped: {type(error).__name__}: {error}")
        with suppress(OSError, RuntimeError):  # the first error is the one to tell
            record.close()
        raise
    record.close()


def _reopen(path: Path, checkpoint: Checkpoint) -> tuple[Record, list[tuple[str, dict[str, float]]]]:
    """Open the record behind the checkpoint, with the rows of the table up to there."""
    Record.reopen(path, checkpoint.frames).close()
    metrics = open_run(path).metrics
    names = [name for name in metrics if name != "stage"]
    rows = [(str(stage), {name: float(metrics[name][i]) for name in names}) for i, stage in enumerate(metrics["stage"])]
    return Record.reopen(path, checkpoint.frames), rows


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


def _clear(folder: Path, copied: Path | None) -> None:
    """Remove what a run left that never came to its first step."""
    for path in (*(folder / name for name in (STUDY, RECORD, CHECKPOINT, TABLE, LOG)), copied):
        if path is not None:
            path.unlink(missing_ok=True)
    with suppress(OSError):  # a folder with other things in it stays
        folder.rmdir()


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
