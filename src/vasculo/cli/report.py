"""The report of a run, or of a few side by side."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from vasculo.cli.app import app, one_line
from vasculo.errors import InputError


@app.command()
@one_line
def report(
    runs: Annotated[
        list[Path], typer.Argument(metavar="RUN...", help="Folder of a run, or of two to four.", show_default=False)
    ],
    out: Annotated[Path | None, typer.Option("--out", metavar="FILE", help="Where to write it.")] = None,
) -> None:
    """Write the report of a run, or of a few side by side: one HTML page that can be mailed."""
    from vasculo.store.read import open_run  # noqa: PLC0415

    if out is not None and (out.is_dir() or not out.parent.is_dir()):
        why = "it is a folder" if out.is_dir() else f"there is no folder {out.parent}"
        raise InputError(f"--out {out}: {why}, name a file such as report.html")
    found = [open_run(run) for run in runs]
    from vasculo.draw.report import write_report, write_side_by_side  # noqa: PLC0415

    typer.echo(str(write_report(found[0], out) if len(found) == 1 else write_side_by_side(found, out)))
