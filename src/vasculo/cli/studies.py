"""Studies: run one, list those that come with the package, write a new one, check one."""

from __future__ import annotations

from contextlib import ExitStack
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
    live: Annotated[bool, typer.Option("--live", help="Show the run in the browser while it goes.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print nothing but errors.")] = False,
) -> None:
    """Run a study: every stage, then figures and a report."""
    from vasculo.study.bars import Bars  # noqa: PLC0415
    from vasculo.study.run import execute  # noqa: PLC0415
    from vasculo.study.settings import parse_assignment  # noqa: PLC0415
    from vasculo.study.show import show_end  # noqa: PLC0415

    overrides = dict(parse_assignment(text) for text in assignments or ())
    with Bars(quiet=quiet) as bars, ExitStack() as stack:
        watchers: list[object] = []
        if live:
            import vasculo.view.sdk  # noqa: F401, PLC0415  # says at once which extra is missing
            from vasculo.study.live import live as shown  # noqa: PLC0415

            begun = shown(study, out, overrides, resume=resume, branch=branch, label="--set", tell=bars.note)
            watchers.append(stack.enter_context(begun))
        done = execute(
            study,
            out,
            overrides,
            resume=resume,
            branch=branch,
            step=step,
            progress=bars,
            label="--set",
            watchers=watchers,
        )
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
    study: Annotated[
        str | None,
        typer.Option("--from", metavar="STUDY", help="Built-in study to start from; the defaults otherwise."),
    ] = None,
) -> None:
    """Write a commented study file to start from."""
    from vasculo.store.table import write_whole  # noqa: PLC0415
    from vasculo.study.template import template  # noqa: PLC0415

    if file.exists():
        raise InputError(f"{file} exists already: name another file")
    if not file.parent.is_dir():
        raise InputError(f"{file.parent} is no folder: make it first")
    write_whole(file, template(study))
    typer.echo(f"{file} written; try: vasculo check {file}")


@app.command()
@one_line
def check(
    study: Annotated[str, typer.Argument(metavar="STUDY", help="A TOML file or a built-in study.")],
    assignments: Assignments = None,
) -> None:
    """Validate a study and print what it leads to: sizes, spacing, time step, expected time and memory."""
    from vasculo.study.builtin import find_study  # noqa: PLC0415
    from vasculo.study.forecast import forecast  # noqa: PLC0415
    from vasculo.study.settings import parse_assignment, read_study  # noqa: PLC0415

    overrides = dict(parse_assignment(text) for text in assignments or ())
    lines = forecast(read_study(find_study(study), overrides, "--set"))
    width = max(len(name) for name, _ in lines)
    for name, value in lines:
        typer.echo(f"{name:<{width}}  {value}")


@app.command()
@one_line
def schema(
    out: Annotated[
        Path | None, typer.Option("--out", metavar="FILE", help="Write it here instead of printing it.")
    ] = None,
) -> None:
    """Print the JSON schema of a study file, by which editors complete and check it."""
    from vasculo.store.table import write_whole  # noqa: PLC0415
    from vasculo.study.builtin import SCHEMA  # noqa: PLC0415

    text = SCHEMA.read_text(encoding="utf-8")
    if out is None:
        typer.echo(text, nl=False)
        return
    if out.is_dir() or not out.parent.is_dir():
        raise InputError(f"{out} cannot be written: name a file in a folder that is there")
    write_whole(out, text)
    typer.echo(f"{out} written; name it in the first line of a study: #:schema ./{out.name}")
