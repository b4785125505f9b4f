"""The folder of a sweep: what lies in it, where it goes, and that one process at a time works in it."""

from __future__ import annotations

import fcntl
import os
import re
from contextlib import contextmanager
from pathlib import Path
from time import monotonic, sleep
from typing import TYPE_CHECKING

from vasculo.errors import InputError
from vasculo.study.folder import free_folder

if TYPE_CHECKING:
    from collections.abc import Iterator

SWEEP, STUDY, PLAN = "sweep.toml", "study.toml", "plan.json"
"""The sweep as it was asked for, its study, and its runs with their settings."""
TABLE, PARQUET, SUMMARY, FAILURES = "table.csv", "table.parquet", "summary.csv", "failures.csv"
"""A row a run, twice; a row a point; a row a run that failed."""
DIAGRAM, GALLERY = "diagram.png", "gallery.png"
"""Numbers over the settings, and how the runs ended."""
PAGE, RUNS, STOP = "sweep.html", "runs", "stop"
"""The report, the folder with the runs, and a file that tells the workers to stop at the next step."""
LOCK, _PAUSE = ".lock", 0.5
HOME = Path("sweeps")
"""Where sweeps go when no folder is named."""


def new_home(name: str, out: str | Path | None) -> Path:
    """Make the folder of a new sweep: `out`, or `sweeps/<name>` with a number behind it when that is taken.

    Raises
    ------
    InputError
        When the folder holds a sweep or a run already, is a file, or cannot be made.
    """
    home = free_folder(name, HOME) if out is None else Path(out)
    if (home / PLAN).exists():
        raise InputError(f"{home} holds a sweep already: name another folder with --out, or go on with --resume")
    if taken := [file for file in (STUDY, SWEEP, RUNS) if (home / file).exists()]:
        raise InputError(f"{home} holds a {taken[0]} that the sweep would replace: name another folder with --out")
    try:
        (home / RUNS).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"{home} cannot be made: {error.strerror}") from None
    return home


def old_home(name: str | None, out: str | Path | None) -> Path:
    """Folder of the sweep to go on with: `out`, or the latest one of this name under `sweeps`.

    Raises
    ------
    InputError
        When there is none.
    """
    if out is not None:
        if not (Path(out) / PLAN).is_file():
            raise InputError(f"{out} holds no sweep: there is no {PLAN}")
        return Path(out)
    if name is None:
        raise InputError("say which sweep to go on with: --resume --out DIR")
    pattern = re.compile(rf"{re.escape(name)}(?:-(\d+))?")
    found = [
        (int(match.group(1) or 1), path)
        for path in (HOME.iterdir() if HOME.is_dir() else ())
        if (match := pattern.fullmatch(path.name)) and (path / PLAN).is_file()
    ]
    if not found:
        raise InputError(f"there is no sweep of {name} under {HOME} to go on with: name its folder with --out")
    return max(found)[1]


@contextmanager
def claimed(folder: Path, words: str, patience: float = 0.0) -> Iterator[None]:
    """Hold a folder for this process alone; its number stands in the lock.

    Parameters
    ----------
    folder : Path
        Is made when it is not there.
    words : str
        What is said when another process holds it.
    patience : float
        How long to wait for that one, s.

    Raises
    ------
    InputError
        When another process holds it for longer.
    """
    folder.mkdir(parents=True, exist_ok=True)
    end = monotonic() + patience
    with (folder / LOCK).open("a") as file:
        while True:
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                break
            except BlockingIOError:
                if monotonic() >= end:
                    raise InputError(words) from None
                sleep(_PAUSE)
        file.truncate(0)
        file.write(f"{os.getpid()}\n")  # for whoever wants to know, and may end it
        file.flush()
        yield


def clear(folder: Path) -> None:
    """Take everything out of the folder of a run but its lock."""
    for path in sorted(folder.rglob("*"), reverse=True):
        if path.is_dir():
            path.rmdir()
        elif path.name != LOCK:
            path.unlink()
