"""A run opened in the browser, in a window, or written to a file."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
import webbrowser
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from vasculo.errors import ComputationError, InputError
from vasculo.view import thin
from vasculo.view.sdk import rerun, without_statistics
from vasculo.view.serve import Server

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from vasculo.store.read import Run

APPLICATION = "vasculo"
_WINDOW = ("--port", "auto", "--bind", "127.0.0.1", "--memory-limit", "50%")
"""Options of the window: a free port of this machine only, and half of its memory, beyond which it forgets steps."""


def new_recording(name: str) -> rerun.RecordingStream:
    """Make an empty recording."""
    recording = rerun.RecordingStream(APPLICATION)
    recording.send_recording_name(name)
    return recording


def save_view(run: Run, path: Path, most: int = thin.MOST) -> None:
    """Write what the viewer shows of a run into a file (.rrd), which `rerun FILE` opens.

    Parameters
    ----------
    run : Run
    path : Path
    most : int
        Steps of a stage that are shown at most.

    Raises
    ------
    InputError
        When there is nothing to show, or the file cannot be written.
    """
    if path.is_dir() or not path.parent.is_dir():
        raise InputError(f"{path} cannot be written: name a file in a folder that is there")
    part = path.with_name(f".{path.name}.part")
    from vasculo.view.replay import Replay  # noqa: PLC0415  # heavy; the browser is opened before it

    shown, recording = Replay(run, most), new_recording(run.folder.name)
    try:
        recording.save(part, shown.layout())
        shown.send(recording)
        recording.disconnect()
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)


def show_window(run: Run, most: int = thin.MOST) -> None:
    """Show a run in a window of its own, until that is closed.

    Raises
    ------
    InputError
        When there is nothing to show, or no display.
    ComputationError
        When the window could not be opened.
    """
    if sys.platform.startswith("linux") and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise InputError("there is no display for a window here: leave --window out, a browser shows the same")
    with tempfile.TemporaryDirectory(prefix="vasculo-view-") as folder, without_statistics():
        path = Path(folder) / f"{run.folder.name}.rrd"
        save_view(run, path, most)
        command = [sys.executable, "-m", "rerun", str(path), *_WINDOW]
        done = subprocess.run(command, check=False, capture_output=True, text=True)  # noqa: S603  # rerun itself
    if done.returncode:
        reason = (done.stderr.strip() or "no reason given").splitlines()[-1]
        raise ComputationError(f"the window could not be opened: {reason}")


@contextmanager
def serving(port: int | None = None) -> Iterator[Server]:
    """Serve a recording that is yet to be made, into the file `path` of the server; it is deleted at the end."""
    with tempfile.TemporaryDirectory(prefix="vasculo-view-") as folder:
        server = Server(Path(folder) / "run.rrd", port)
        try:
            yield server
        finally:
            server.close()


def show_browser(
    run: Run,
    most: int = thin.MOST,
    port: int | None = None,
    *,
    open_it: bool = True,
    tell: Callable[[str], object] = print,
) -> None:
    """Show a run in the browser until the program is stopped.

    Parameters
    ----------
    run : Run
    most : int
        Steps of a stage that are shown at most.
    port : int, optional
        Port of the web server; a free one when left out.
    open_it : bool
        Open the browser, not only the address.
    tell : callable
        Is told the address.

    Raises
    ------
    InputError
        When there is nothing to show, or the port is in use.
    """
    thin.check(run, most)
    with serving(port) as server:
        open_browser(server.address, f"{run.folder}, until Ctrl-C,", tell, open_it=open_it)
        from vasculo.view.replay import Replay  # noqa: PLC0415  # meanwhile the browser loads the viewer

        shown, recording = Replay(run, most), new_recording(run.folder.name)
        recording.save(server.path, shown.layout())
        shown.send(recording)
        recording.disconnect()
        server.finish(patience=0.0)
        while True:
            time.sleep(3600.0)


def open_browser(address: str, what: str, tell: Callable[[str], object], *, open_it: bool = True) -> None:
    """Tell the address of the viewer, and open it in a browser if there is one."""
    tell(f"{what} is shown at {address}")
    if open_it and not webbrowser.open(address):
        tell("no browser was found here: open the address in one")
