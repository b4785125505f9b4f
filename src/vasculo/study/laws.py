"""The user's own file: run before the settings are checked, so that these can name its laws."""

from __future__ import annotations

import sys
from types import ModuleType
from typing import TYPE_CHECKING

from vasculo.errors import InputError
from vasculo.pillars.responses import Law, known_responses, restore_responses
from vasculo.study.faults import fault_line
from vasculo.study.watchers import Watched, forget, registered

if TYPE_CHECKING:
    from pathlib import Path

_MODULE = "vasculo_study_laws"
_loaded: dict[str, Law | None] = {}  # what the present file registered, and what stood there before


def load_laws(path: Path, where: str) -> tuple[Watched, ...]:
    """Run a Python file that registers cell responses or watchers; those of the file before it are forgotten.

    Parameters
    ----------
    path : Path
        The file.
    where : str
        Who names it, for messages.

    Returns
    -------
    tuple of (str, callable)
        Its watchers, in order: the stage and the function.

    Raises
    ------
    InputError
        When the file is not there, does not run to its end, or registers nothing or a taken name; one line, with the
        line of the file.
    """
    forget_laws()
    known, watchers = known_responses(), len(registered())
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
        message = f"{where} does not run: {fault_line(error, str(path))}"
        restore_responses(known)
        forget(watchers)
        raise InputError(message) from None
    _loaded.update({name: known.get(name) for name, law in known_responses().items() if law is not known.get(name)})
    found = registered()[watchers:]
    forget(watchers)
    if not _loaded and not found:
        raise InputError(
            f'{where} registers nothing: write @vasculo.cell_response("name") above a law, or '
            '@vasculo.watcher("remodel") above a watcher'
        )
    return found


def forget_laws() -> None:
    """Take back what the present file registered."""
    laws = known_responses() | _loaded
    restore_responses({name: law for name, law in laws.items() if law is not None})
    _loaded.clear()
