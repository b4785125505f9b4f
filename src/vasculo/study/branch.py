"""A branch: the steps of a run up to one of them in a new folder, where it goes on under other settings."""

from __future__ import annotations

import shutil
from contextlib import closing
from dataclasses import asdict, replace
from typing import TYPE_CHECKING

from vasculo.errors import InputError
from vasculo.pillars.angiogenesis import is_done
from vasculo.store.read import CHECKPOINT, RECORD, STUDY, open_run
from vasculo.store.record import Record, require_room
from vasculo.store.table import write_whole
from vasculo.study.beginning import Beginning, Kept, copy_files, laws_text, rows_of, unfinished
from vasculo.study.changes import told
from vasculo.study.folder import branch_folder, filling, new_folder
from vasculo.study.sections import BranchKeys
from vasculo.study.watch_table import WATCH_TABLE

if TYPE_CHECKING:
    from pathlib import Path

    from vasculo.pillars.state import RemodelState
    from vasculo.store.read import Run
    from vasculo.study.changes import Change
    from vasculo.study.settings import Settings


def make_branch(
    kept: Kept, settings: Settings, changes: list[Change], out: str | Path | None, step: int | None
) -> Beginning:
    """Copy a run up to a step into a new folder; the old one stays as it is.

    Parameters
    ----------
    kept : Kept
        The run.
    settings : Settings
        What the branch shall do; what goes before it is added.
    changes : list of Change
        What is new in it.
    out : str or Path, optional
        The new folder; beside the old one, with `-branch` behind its name, when left out.
    step : int, optional
        Last step to keep; the last one recorded when left out.

    Raises
    ------
    InputError
        When the step was not recorded, nothing is left to do behind it, or the folder cannot be used.
    """
    run = open_run(kept.folder)
    last = _last_step(run, step)
    start = run.state(last) if last >= 0 else None
    if start is not None:
        _check_future(kept, settings, start)
        settings = replace(settings, branches=_branches(kept, settings, last, f"{kept.folder.resolve().name} {run.id}"))
    frames = sum(frame.stage != "angiogenesis" or frame.step <= last for frame in run.frames)
    settled = sum(frame.stage != "angiogenesis" for frame in run.frames)
    checkpoint = replace(
        kept.checkpoint,
        settings=settings.to_toml(),
        stages=unfinished(kept.checkpoint.stages),
        frames=min(settled, kept.checkpoint.frames),
        laws=laws_text(settings),
    )
    folder = new_folder("", out or branch_folder(kept.folder))
    fresh = [*copy_files(settings, folder), *(folder / name for name in (RECORD, CHECKPOINT, STUDY, WATCH_TABLE))]
    origin = {"run": run.id, "folder": kept.folder.resolve().name, "step": last, "changes": changes}
    with filling(folder, fresh) as stack:
        require_room(folder / RECORD, run.path.stat().st_size)
        shutil.copyfile(run.path, folder / RECORD)
        if (kept.folder / WATCH_TABLE).is_file():
            shutil.copyfile(kept.folder / WATCH_TABLE, folder / WATCH_TABLE)
        record = stack.enter_context(closing(Record.reopen(folder / RECORD, frames)))
        record.set_settings(checkpoint.settings, new=True)
        record.set_facts("branch", [*(run.facts("branch") or []), origin])
        record.set_facts("stages", checkpoint.stages)
        checkpoint.save(folder / CHECKPOINT)
        write_whole(folder / STUDY, checkpoint.settings)
    where = f"step {last}" if last >= 0 else "the beginning of the angiogenesis"
    note = f"branch of {kept.folder} behind {where}, into {folder}: {told(changes)}"
    settings = replace(settings, folder=folder)
    return Beginning(folder, settings, checkpoint, record, rows_of(run.metrics, frames), start, note, tuple(fresh))


def _last_step(run: Run, step: int | None) -> int:
    """Return the last step to keep, -1 when there is none."""
    steps = run.steps()
    if step is None:
        return steps[-1] if steps else -1
    if step not in steps:
        near = sorted(sorted(steps, key=lambda other: abs(other - step))[:2])
        known = f"the nearest are {' and '.join(map(str, near))}" if near else "no step of the angiogenesis was"
        raise InputError(f"{run.folder}: step {step} was not recorded, {known}")
    return step


def _check_future(kept: Kept, settings: Settings, start: RemodelState) -> None:
    """Refuse a branch that would end where it begins."""
    keys = settings.angiogenesis
    if is_done(start, keys):
        why = f"angiogenesis.steps = {keys.steps}"
        if start.step < keys.steps:
            why = f"angiogenesis.strain_limit = {keys.strain_limit:g}, or rest,"
        raise InputError(
            f"{kept.folder} at step {start.step} has come to its end by {why}: raise that with --set, or branch from "
            f"an earlier step with --step"
        )


def _branches(kept: Kept, settings: Settings, last: int, name: str) -> tuple[BranchKeys, ...]:
    """List the changes on the way to the branch, the new one behind those that lie before it."""
    earlier = tuple(branch for branch in kept.settings.branches if branch.step < last)
    until, after = asdict(kept.settings.phases()[len(earlier)]), asdict(settings.angiogenesis)
    before = {key: value for key, value in until.items() if key != "steps" and value != after[key]}
    return (*earlier, BranchKeys(last, before, name))
