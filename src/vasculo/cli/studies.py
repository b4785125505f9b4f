"""Studies: run one, list those that come with the package, write a new one, check one."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from vasculo.cli.app import Assignments, app, one_line
from vasculo.errors import InputError


@app.command()
@one_line
def run(
    study: Annotated[
        str | None,
        typer.Argument(metavar="[STUDY]", help="A TOML file or a built-in study; paper when left out."),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Folder of the run; runs/STUDY when left out.")
    ] = None,
    assignments: Assignments = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on with a run that was interrupted, or for more steps.")
    ] = False,
    branch: Annotated[
        Path | None, typer.Option("--branch", metavar="RUN", help="Branch off from a run: go on as --set says, in DIR.")
    ] = None,
    step: Annotated[
        int | None, typer.Option("--step", metavar="N", help="Last step that a branch keeps; the last one by default.")
    ] = None,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print nothing but errors.")] = False,
) -> None:
    """Run a study: every stage, then figures and a report."""
    from vasculo.study.bars import Bars  # noqa: PLC0415
    from vasculo.study.run import execute  # noqa: PLC0415
    from vasculo.study.settings import parse_assignment  # noqa: PLC0415
    from vasculo.study.show import show_end  # noqa: PLC0415

    overrides = dict(parse_assignment(text) for text in assignments or ())
    with Bars(quiet=quiet) as bars:
        done = execute(study, out, overrides, resume=resume, branch=branch, step=step, progress=bars, label="--set")
    if not quiet:
        show_end(done)


@app.command()
@one_line
def studies() -> None:
    """List the built-in studies."""
    from vasculo.study.builtin import titles  # noqa: PLC0415

    for name, title in titles().items():
        typer.echo(f"{name:<9} {title}")


@app.command()
@one_line
def new(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="Study file to write; must not exist.")],
) -> None:
    """Write a commented study file to start from."""
    from vasculo.store.table import write_whole  # noqa: PLC0415
    from vasculo.study.template import template  # noqa: PLC0415

    if file.exists():
        raise InputError(f"{file} exists already: name another file")
    if not file.parent.is_dir():
        raise InputError(f"{file.parent} is no folder: make it first")
    write_whole(file, template())
    typer.echo(f"{file} written; try: vasculo check {file}")


@app.command()
@one_line
def check(
    study: Annotated[str, typer.Argument(metavar="STUDY", help="A TOML file or a built-in study.")],
    assignments: Assignments = None,
) -> None:
    """Validate a study and print what it leads to: stability limit, nodes, memory, expected time."""
    from vasculo.study.builtin import find_study  # noqa: PLC0415
    from vasculo.study.forecast import forecast  # noqa: PLC0415
    from vasculo.study.settings import parse_assignment, read_study  # noqa: PLC0415

    overrides = dict(parse_assignment(text) for text in assignments or ())
    lines = forecast(read_study(find_study(study), overrides, "--set"))
    width = max(len(name) for name, _ in lines)
    for name, value in lines:
        typer.echo(f"{name:<{width}}  {value}")
