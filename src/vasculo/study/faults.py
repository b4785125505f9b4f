"""Where an error of the user's own code came up: the line of the file, and what it was."""

from __future__ import annotations

import traceback
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from vasculo.errors import ComputationError, InputError

if TYPE_CHECKING:
    from collections.abc import Iterator


def fault_line(error: BaseException, file: str) -> str:
    """Say on which line of a file an error came up, and what it was, in one line.

    Parameters
    ----------
    error : BaseException
        As it was caught.
    file : str
        The file as its code names it; the last line of it that was reached is told.
    """
    syntax = isinstance(error, SyntaxError) and error.filename == file
    line = error.lineno if isinstance(error, SyntaxError) and syntax else last_line(error, file)
    what = error.msg if isinstance(error, SyntaxError) and syntax else str(error)
    kind = "" if isinstance(error, InputError) else f"{type(error).__name__}: "
    place = "" if line is None else f"line {line}: "
    return " ".join(f"{place}{kind}{what}".split())


def last_line(error: BaseException, file: str) -> int | None:
    """Last line of a file that was reached before an error, None when that was elsewhere."""
    lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == file]
    return lines[-1] if lines else None


@contextmanager
def naming_line(path: Path | None) -> Iterator[None]:
    """Put the line of the user's file behind the message of a computation that failed there, unless it is told.

    Raises
    ------
    ComputationError
        That of the block.
    """
    try:
        yield
    except ComputationError as error:
        first: BaseException = error
        while first.__cause__ is not None:
            first = first.__cause__
        line = None if path is None else last_line(first, str(path))
        if path is None or line is None or f"{path.name}, line" in str(error):
            raise
        raise ComputationError(f"{error} ({path.name}, line {line})") from error


def called_file(error: BaseException) -> str:
    """File of the function that was called where the error was caught; empty for one that is compiled."""
    frames = traceback.extract_tb(error.__traceback__)
    return frames[1].filename if len(frames) > 1 else ""


def fault(error: BaseException) -> str:
    """Say where in the user's file an error of a call came up, and what it was: `my_laws.py, line 3: ...`."""
    file = called_file(error)
    return f"{Path(file).name}, {fault_line(error, file)}" if file else fault_line(error, file)
