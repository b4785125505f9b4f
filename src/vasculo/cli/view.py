"""The viewer."""

from __future__ import annotations

import signal
from contextlib import suppress
from pathlib import Path
from typing import Annotated

import typer

from vasculo.cli.app import RunFolder, app, one_line
from vasculo.errors import InputError


@app.command()
@one_line
def view(
    run: RunFolder,
    save: Annotated[
        Path | None, typer.Option("--save", metavar="FILE", help="Write a file (.rrd) for the viewer instead.")
    ] = None,
    window: Annotated[bool, typer.Option("--window", help="In a window of its own instead of the browser.")] = False,
    port: Annotated[
        int | None, typer.Option("--port", metavar="N", help="Port of the web server; a free one by default.")
    ] = None,
    no_open: Annotated[bool, typer.Option("--no-open", help="Print the address, open no browser.")] = False,
    steps: Annotated[int, typer.Option("--steps", metavar="N", help="Steps of a stage shown at most.")] = 100,
) -> None:
    """Look at a run: springs, flow, pillars and numbers over all steps."""
    from vasculo.store.read import open_run  # noqa: PLC0415

    found = open_run(run)
    from vasculo.view.show import save_view, show_browser, show_window  # noqa: PLC0415

    if save is not None and window:
        raise InputError("a view is saved or shown: leave --save or --window out")
    if (save is not None or window) and (port is not None or no_open):
        raise InputError("--port and --no-open are for the browser: leave them out with --save and --window")
    if save is not None:
        save_view(found, save, steps)
        typer.echo(str(save))
    elif window:
        show_window(found, steps)
    else:
        signal.signal(signal.SIGTERM, signal.default_int_handler)  # a stopped viewer tidies up too
        with suppress(KeyboardInterrupt):  # that is how it ends
            show_browser(found, steps, port, open_it=not no_open, tell=typer.echo)
