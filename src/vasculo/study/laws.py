"""Laws from a file of the user: run before the settings are checked, so that these can name them."""

from __future__ import annotations

import sys
import traceback
from types import ModuleType
from typing import TYPE_CHECKING

from vasculo.errors import InputError
from vasculo.pillars.responses import Law, known_responses, restore_responses

if TYPE_CHECKING:
    from pathlib import Path

_MODULE = "vasculo_study_laws"
_loaded: dict[str, Law | None] = {}  # what the present file registered, and what stood there before


def load_laws(path: Path, where: str) -> tuple[str, ...]:
    """Run a Python file that registers cell responses; those of the file before it are forgotten.

    Parameters
    ----------
    path : Path
        The file.
    where : str
        Who names it, for messages.

    Returns
    -------
    tuple of str
        Names of the responses, sorted.

    Raises
    ------
    InputError
        When the file is not there, does not run to its end, or registers nothing or a taken name; one line, with the
        line of the file.
    """
    forget_laws()
    known = known_responses()
    try:
        text = path.read_text(encoding="utf-8")
    except OSError as error:
        raise InputError(f"{where} cannot be read in {path.parent}: {error.strerror}") from None
    except UnicodeDecodeError as error:
        raise InputError(f"{where} is no text file: byte {error.start} is not UTF-8") from None
    module = ModuleType(_MODULE)
    module.__file__ = str(path)
    sys.modules[_MODULE] = module
    try:
        exec(compile(text, str(path), "exec"), module.__dict__)  # noqa: S102  # what the study asks for
    except (Exception, SystemExit) as error:  # noqa: BLE001  # whatever the file raises
        message = f"{where} does not run: {_told(error, path)}"
        restore_responses(known)
        raise InputError(message) from None
    _loaded.update({name: known.get(name) for name, law in known_responses().items() if law is not known.get(name)})
    if not _loaded:
        raise InputError(f'{where} registers no cell response: write @vasculo.cell_response("name") above a function')
    return tuple(sorted(_loaded))


def forget_laws() -> None:
    """Take back what the present file registered."""
    laws = known_responses() | _loaded
    restore_responses({name: law for name, law in laws.items() if law is not None})
    _loaded.clear()


def _told(error: BaseException, path: Path) -> str:
    """Say on which line of the file an error came up, and what it was."""
    lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == str(path)]
    line = error.lineno if isinstance(error, SyntaxError) else (lines[-1] if lines else None)
    what = error.msg if isinstance(error, SyntaxError) else str(error)
    kind = "" if isinstance(error, InputError) else f"{type(error).__name__}: "
    return " ".join(f"line {line}: {kind}{what}".split())
