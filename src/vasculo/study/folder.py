"""The folder of a run: where it goes, and its log."""

from __future__ import annotations

import os
import re
import time
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Self

from vasculo.errors import ComputationError, InputError
from vasculo.store.read import CHECKPOINT, LOG, RECORD, STUDY, TABLE

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from types import TracebackType

HOME = Path("runs")
"""Where runs go when no folder is named."""


def new_folder(name: str, out: str | Path | None) -> Path:
    """Make the folder of a new run.

    Parameters
    ----------
    name : str
        Name of the study.
    out : str or Path, optional
        The folder; without it `runs/<name>`, or `runs/<name>-2` and so on when that is taken.

    Raises
    ------
    InputError
        When the folder holds a run already, is a file, cannot be made, or cannot be written in.
    """
    folder = free_folder(name) if out is None else Path(out)
    if any((folder / file).exists() for file in (RECORD, CHECKPOINT)):
        raise InputError(f"{folder} holds a run already: name another folder with --out, or go on with --resume")
    if (folder / STUDY).exists():
        raise InputError(f"{folder} holds a {STUDY} that the run would replace: name another folder with --out")
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{folder} cannot be made: {error.strerror}") from None
    if not os.access(folder, os.W_OK | os.X_OK):
        raise InputError(f"{folder} cannot be written in: name another folder with --out")
    return folder


def free_folder(name: str, home: Path = HOME) -> Path:
    """First of `runs/<name>`, `runs/<name>-2`, ... that is not there yet."""
    number = 1
    while (folder := home / (name if number == 1 else f"{name}-{number}")).exists():
        number += 1
    return folder


def branch_folder(folder: Path) -> Path:
    """Folder for a branch of the run in `folder`: beside it, with `-branch` behind its name."""
    whole = folder.resolve()
    return free_folder(f"{whole.name}-branch", folder.parent if folder.name == whole.name else whole.parent)


def old_folder(name: str, out: str | Path | None) -> Path:
    """Folder of the run to go on with: `out`, or the latest one of the study under `runs`.

    Raises
    ------
    InputError
        When there is none.
    """
    if out is not None:
        folder = Path(out)
        if not (folder / STUDY).is_file():
            raise InputError(f"{folder} holds no run to go on with: there is no {STUDY}")
        return folder
    pattern = re.compile(rf"{re.escape(name)}(?:-(\d+))?")
    found = [
        (int(match.group(1) or 1), path)
        for path in (HOME.iterdir() if HOME.is_dir() else ())
        if (match := pattern.fullmatch(path.name)) and (path / STUDY).is_file()
    ]
    if not found:
        raise InputError(f"there is no run of {name} under {HOME} to go on with: name its folder with --out")
    return max(found)[1]


def clear_folder(folder: Path, fresh: Iterable[Path]) -> None:
    """Take away the files that were made for a run that never began, and the folder when nothing else is in it."""
    for path in (*fresh, folder / TABLE, folder / LOG):
        path.unlink(missing_ok=True)
    with suppress(OSError):  # a folder with other things in it stays
        folder.rmdir()


@contextmanager
def filling(folder: Path, fresh: Iterable[Path]) -> Iterator[ExitStack]:
    """Make the files of a new run in the block; leave nothing behind, and nothing on the stack open, when that fails.

    Raises
    ------
    ComputationError
        When the files cannot be written.
    """
    try:
        with ExitStack() as stack:
            yield stack
            stack.pop_all()
    except OSError as error:
        clear_folder(folder, fresh)
        what = error.strerror or str(error)
        raise ComputationError(f"{error.filename or folder} cannot be written: {what}; nothing was begun") from None
    except BaseException:
        clear_folder(folder, fresh)
        raise


class Log:
    """A log file; each line is written at once, with the time of day.

    Parameters
    ----------
    folder : Path
        Folder of the run; the log is continued when there is one.
    """

    def __init__(self, folder: Path) -> None:
        self._file = (folder / LOG).open("a", encoding="utf-8")

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._file.close()

    def line(self, text: str) -> None:
        """Write one line."""
        self._file.write(f"{time.strftime('%Y-%m-%d %H:%M:%S')}  {text}\n")
        self._file.flush()
