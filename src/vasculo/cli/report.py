"""The report of a run."""

from __future__ import annotations

import typer

from vasculo.cli.app import RunFolder, app, one_line


@app.command()
@one_line
def report(run: RunFolder) -> None:
    """Write the report of a run: one self-contained HTML page."""
    from vasculo.store.read import open_run  # noqa: PLC0415

    found = open_run(run)
    from vasculo.draw.report import write_report  # noqa: PLC0415

    typer.echo(str(write_report(found)))
