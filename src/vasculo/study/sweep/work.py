"""One run of a sweep, as a worker does it: begun, gone on with, or found complete."""

from __future__ import annotations

import traceback
from dataclasses import dataclass, field
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Any, Literal

import h5py

from vasculo.errors import ComputationError, InputError
from vasculo.store.read import RECORD, REPORT, open_run
from vasculo.study.run import execute
from vasculo.study.sweep.home import PLAN, RUNS, STOP, STUDY, claimed, clear
from vasculo.study.sweep.numbers import read_numbers
from vasculo.study.sweep.plan import laws_beside
from vasculo.study.watch import Silence

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from vasculo.store.read import Run

_LOOKS = 0.5
"""Seconds from one look for the stop file to the next."""
_PATIENCE = 60.0
"""Seconds for which a run waits for another process that still has its folder."""

Status = Literal["complete", "failed", "stopped"]


@dataclass(frozen=True)
class Outcome:
    """What became of a run.

    Attributes
    ----------
    name : str
        Its name.
    status : {"complete", "failed", "stopped"}
        Whether it came to its end.
    line : str
        Why not.
    seconds : float
        Wall time of its stages, s.
    numbers : dict
        Those of the table.
    """

    name: str
    status: Status
    line: str = ""
    seconds: float = float("nan")
    numbers: dict[str, float] = field(default_factory=dict)


class _Pulse(Silence):
    """Ends the run at its next step when the sweep is stopped."""

    def __init__(self, stop: Path) -> None:
        self._stop, self._next = stop, 0.0

    def advance(self, done: float, total: float, text: str) -> None:  # noqa: ARG002
        """Look for the stop file now and then."""
        if monotonic() >= self._next:
            self._next = monotonic() + _LOOKS
            if self._stop.exists():
                raise KeyboardInterrupt


def work(home: Path, name: str, overrides: dict[str, Any], names: Sequence[str]) -> Outcome:
    """Do one run, or what is left of it.

    Parameters
    ----------
    home : Path
        Folder of the sweep.
    name : str
        Name of the run.
    overrides : dict
        Settings that replace those of the study.
    names : sequence of str
        Numbers to read at the end.

    Returns
    -------
    Outcome
        Also of a run that failed; no error leaves this function.
    """
    try:
        return _outcome(_run(home, home / RUNS / name, overrides), name, names)
    except KeyboardInterrupt:
        return Outcome(name, "stopped")
    except (InputError, ComputationError) as error:
        return Outcome(name, "failed", " ".join(str(error).split()))
    except MemoryError as error:
        return Outcome(name, "failed", f"not enough memory ({error})")
    except Exception as error:  # noqa: BLE001  # whatever a user's law or a library does must not end the sweep
        place = traceback.extract_tb(error.__traceback__)[-1]
        line = f"{type(error).__name__}: {error} ({Path(place.filename).name}, line {place.lineno})"
        return Outcome(name, "failed", " ".join(line.split()))


def found_complete(home: Path, name: str, overrides: Mapping[str, Any], names: Sequence[str]) -> Outcome | None:
    """Return the outcome of a run that lies complete in its folder, None of any other."""
    run = _finished(home / RUNS / name, overrides)
    return None if run is None else _outcome(run, name, names)


def _outcome(run: Run, name: str, names: Sequence[str]) -> Outcome:
    seconds = sum(stage["seconds"] for stage in run.facts("stages") or ())
    return Outcome(name, "complete", "", float(seconds), read_numbers(run, names))


def _finished(folder: Path, overrides: Mapping[str, Any]) -> Run | None:
    """Open a run when it is complete, its report included where one is asked for."""
    if overrides["output.figures"] and not (folder / REPORT).is_file():
        return None
    try:
        run = open_run(folder)
    except InputError:
        return None
    return run if run.complete else None


def _run(home: Path, folder: Path, overrides: dict[str, Any]) -> Run:
    """Bring a run to its end: from where it is, or anew when it is too damaged for that."""
    if not (home / PLAN).is_file():
        raise InputError(f"this worker does not see {home}: a sweep at a scheduler needs a shared file system")
    pulse = _Pulse(home / STOP)
    words = f"{folder} is still worked in by another process: end it, then go on with --resume"
    with claimed(folder, words, _PATIENCE):
        if (done := _finished(folder, overrides)) is not None:
            return done
        record = folder / RECORD
        if record.is_file():
            _check_free(record)
            try:
                return execute(None, folder, None, resume=True, progress=pulse)
            except InputError:  # it was cut off before there was anything to go on from
                pass
        clear(folder)
        return execute(home / STUDY, folder, laws_beside(overrides, home), progress=pulse)


def _check_free(record: Path) -> None:
    """Refuse a record that a run outside the sweep is writing."""
    try:
        with h5py.File(record, "r+"):
            pass
    except BlockingIOError:
        raise InputError(f"{record} is being written by a run outside the sweep: wait for its end") from None
    except OSError:
        pass  # damaged: it is begun anew
