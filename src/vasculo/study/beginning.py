"""How a run begins: in a new folder, behind the last finished step of an old one, or as a branch of one."""

from __future__ import annotations

from contextlib import ExitStack, closing
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import vasculo
from vasculo.errors import InputError
from vasculo.store.checkpoint import Checkpoint
from vasculo.store.read import CHECKPOINT, RECORD, STUDY, open_run
from vasculo.store.record import Record
from vasculo.store.table import write_whole
from vasculo.study.builtin import find_study
from vasculo.study.changes import Change, check_changes, differences, told
from vasculo.study.folder import filling, new_folder, old_folder
from vasculo.study.outlines import take_along
from vasculo.study.settings import Settings, parse_study, read_study

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from vasculo.pillars.state import RemodelState
    from vasculo.store.table import Row

    Rows = list[tuple[str, Row]]


@dataclass
class Beginning:
    """A run that can go to work.

    Attributes
    ----------
    folder : Path
        Its folder.
    settings : Settings
        The study.
    checkpoint : Checkpoint
        What is finished.
    record : Record
        Open for writing.
    rows : list of (stage, Row)
        The table so far.
    start : RemodelState or None
        Where the angiogenesis goes on, when it was begun.
    note : str
        What is special about it, for the log and whoever looks on.
    fresh : tuple of Path
        Files that were made for it, to be taken away when it never comes to a step.
    """

    folder: Path
    settings: Settings
    checkpoint: Checkpoint
    record: Record
    rows: Rows
    start: RemodelState | None
    note: str = ""
    fresh: tuple[Path, ...] = ()


@dataclass(frozen=True)
class Kept:
    """An old run as it lies in its folder."""

    folder: Path
    settings: Settings
    checkpoint: Checkpoint

    def changed(self, overrides: Mapping[str, object] | None, label: str) -> tuple[Settings, list[Change]]:
        """Return the settings with some values replaced, and what that changes.

        Raises
        ------
        InputError
            When something would change that was computed before the angiogenesis.
        """
        if not overrides:
            return self.settings, []
        text = self.settings.to_toml()
        settings = parse_study(text, str(self.folder / STUDY), overrides, label, self.folder)
        changes = differences(self.settings, settings)
        if settings.study.uses == self.settings.study.uses and laws_text(settings) != self.checkpoint.laws:
            changes.append(("study.uses", self.settings.study.uses, f"{settings.study.uses}, another file"))
        check_changes(changes, label)
        return settings, changes


def new_run(
    study: str | Path | None, out: str | Path | None, overrides: Mapping[str, object] | None, label: str
) -> Beginning:
    """Make the folder of a new run."""
    path = find_study("paper" if study is None else study)
    settings = read_study(path, overrides, label)
    folder = new_folder(study_name(path), out)
    checkpoint = Checkpoint(settings.to_toml(), laws=laws_text(settings))
    fresh = [*copy_files(settings, folder), folder / STUDY, folder / RECORD, folder / CHECKPOINT]
    with filling(folder, fresh) as stack:
        write_whole(folder / STUDY, checkpoint.settings)
        record = stack.enter_context(closing(Record.create(folder / RECORD, checkpoint.settings, vasculo.__version__)))
        checkpoint.save(folder / CHECKPOINT)
    return Beginning(folder, settings, checkpoint, record, [], None, fresh=tuple(fresh))


def old_run(
    study: str | Path | None, out: str | Path | None, overrides: Mapping[str, object] | None, label: str
) -> tuple[Kept, Settings, list[Change]]:
    """Find the run to go on with, and what shall change; a study that is named besides must be the same."""
    kept = find_run(old_folder(study_name(find_study("paper" if study is None else study)), out))
    if study is not None:
        named = read_study(find_study(study), overrides, label)
        mine, _ = kept.changed(overrides, label)
        for path, old, new in differences(mine, named):
            raise InputError(
                f"{kept.folder} was begun with {path} = {old!r}, not {new!r}: resume without naming the study, or "
                f"start anew in another folder"
            )
    return kept, *kept.changed(overrides, label)


def find_run(folder: Path) -> Kept:
    """Read what an old run left, and see that it fits together.

    Raises
    ------
    InputError
        When something is missing or was changed by hand.
    """
    for name in (STUDY, RECORD):
        if not (folder / name).is_file():
            raise InputError(f"{folder} cannot be continued: there is no {name}; start the run anew")
    checkpoint = Checkpoint.load(folder / CHECKPOINT)
    settings = read_study(folder / STUDY)
    text = settings.to_toml()
    if text != checkpoint.settings and text != parse_study(checkpoint.settings, "", folder=folder).to_toml():
        raise InputError(
            f"{folder / STUDY} was changed since the run began: change it back and give the new values with --set"
        )
    if laws_text(settings) != checkpoint.laws:
        raise InputError(f"{settings.laws} was changed since the run began: change it back, or start anew elsewhere")
    return Kept(folder, settings, checkpoint)


def reopen(kept: Kept) -> Beginning:
    """Go on where an old run stopped: behind its last finished stage, or the last recorded step of the angiogenesis."""
    run, checkpoint = open_run(kept.folder), kept.checkpoint
    behind = [frame for frame in run.frames[checkpoint.frames :] if frame.stage == "angiogenesis"]
    frames = checkpoint.frames + len(behind)
    rows = rows_of(run.metrics, frames)
    start = run.state() if run.steps() else None
    record = Record.reopen(kept.folder / RECORD, frames)
    return Beginning(kept.folder, kept.settings, checkpoint, record, rows, start)


def extend(kept: Kept, settings: Settings, changes: list[Change]) -> Beginning:
    """Go on with an old run under settings that leave what was computed as it is: more steps, other labels.

    Raises
    ------
    InputError
        When the run is beyond the steps that are asked for.
    """
    last = max(open_run(kept.folder).steps(), default=-1)
    if settings.angiogenesis.steps < last:
        raise InputError(
            f"{kept.folder} has come to step {last}, behind angiogenesis.steps = {settings.angiogenesis.steps}: "
            f"give {last} or more, or branch with --step"
        )
    begun = reopen(kept)
    checkpoint = replace(kept.checkpoint, settings=settings.to_toml(), stages=unfinished(kept.checkpoint.stages))
    with ExitStack() as stack:
        record = stack.enter_context(closing(begun.record))
        record.set_settings(checkpoint.settings, new=False)
        facts = record.facts("extended") or []
        record.set_facts("extended", [*facts, {"step": last, "changes": changes}])
        checkpoint.save(kept.folder / CHECKPOINT)
        write_whole(kept.folder / STUDY, checkpoint.settings)
        stack.pop_all()
    return replace(begun, settings=settings, checkpoint=checkpoint, note=f"goes on with {told(changes)}")


def unfinished(stages: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """Finished stages without the angiogenesis, which goes on."""
    return [stage for stage in stages if stage["name"] != "angiogenesis"]


def rows_of(metrics: Mapping[str, Any], frames: int) -> Rows:
    """Return the first rows of a table."""
    names = [name for name in metrics if name != "stage"]
    stages = metrics["stage"][:frames]
    return [(str(stage), {name: float(metrics[name][i]) for name in names}) for i, stage in enumerate(stages)]


def copy_files(settings: Settings, folder: Path) -> list[Path]:
    """Take the files along that a study needs beside it; return those that were not there."""
    files = [settings.folder / settings.domain["file"]] if "file" in settings.domain else []
    files += [settings.laws] if settings.laws is not None else []
    copies = (take_along(file.name, file.parent, folder) for file in files)
    return [copy for copy in copies if copy is not None]


def laws_text(settings: Settings) -> str:
    """Text of the Python file that a study uses, empty when it uses none."""
    return "" if settings.laws is None else settings.laws.read_text(encoding="utf-8")


def study_name(path: Path) -> str:
    """Name of a study by its file; a `study.toml` goes by its folder."""
    return path.parent.name if path.name == STUDY else path.stem
