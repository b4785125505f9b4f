"""Numbers of a run."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Annotated

import typer

from vasculo.cli.app import RunFolder, app, one_line
from vasculo.errors import InputError


@app.command()
@one_line
def measure(
    run: RunFolder,
    csv: Annotated[Path | None, typer.Option("--csv", metavar="FILE", help="Write the whole table here.")] = None,
    units: Annotated[
        bool, typer.Option("--units", help="Write that table in the physical units of the study, named in its headers.")
    ] = False,
    passages: Annotated[
        Path | None,
        typer.Option("--passages", metavar="FILE", help="Write the passages between the pillars here, as CSV."),
    ] = None,
    tubules: Annotated[
        Path | None,
        typer.Option("--tubules", metavar="FILE", help="Write the flow through the passages here, as CSV."),
    ] = None,
    events: Annotated[
        Path | None, typer.Option("--events", metavar="FILE", help="Write what happened to the pillars here, as CSV.")
    ] = None,
) -> None:
    """Print the numbers of a run."""
    from vasculo.store.read import open_run  # noqa: PLC0415
    from vasculo.study.show import all_events, passages_text, show_numbers, table_text  # noqa: PLC0415
    from vasculo.study.tubules import tubules_text  # noqa: PLC0415

    found = open_run(run)
    for file in (csv, passages, tubules, events):
        if file is not None and (file.is_dir() or not file.parent.is_dir()):
            raise InputError(f"{file} cannot be written: name a file in a folder that is there")
    if units and csv is None:
        raise InputError("--units goes with --csv FILE")
    whole = partial(table_text, physical=units)
    if units:
        whole(found)  # a study without units is refused before anything is printed
    show_numbers(found)
    writers = ((csv, whole), (passages, passages_text), (tubules, tubules_text), (events, all_events))
    for file, text_of in writers:
        if file is not None:
            from vasculo.store.table import write_whole  # noqa: PLC0415

            text = text_of(found)
            write_whole(file, text)
            typer.echo(f"{text.count(chr(10)) - 1} rows written to {file}")
