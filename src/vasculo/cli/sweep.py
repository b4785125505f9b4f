"""Sweeps: many runs of one study."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from vasculo.cli.app import app, one_line
from vasculo.errors import ComputationError, InputError


@app.command()
@one_line
def sweep(
    file: Annotated[
        Path | None,
        typer.Argument(metavar="[SWEEP]", help="A sweep file, as --new writes one.", show_default=False),
    ] = None,
    workers: Annotated[
        int | None, typer.Option("--workers", metavar="N", help="Worker processes; one a processor when left out.")
    ] = None,
    scheduler: Annotated[
        str | None,
        typer.Option("--scheduler", metavar="ADDRESS", help="A dask scheduler instead, as tcp://host:8786."),
    ] = None,
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Folder of the sweep; sweeps/SWEEP when left out.")
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on with a sweep; points and seeds that are new in SWEEP are added.")
    ] = False,
    plan: Annotated[bool, typer.Option("--plan", help="Check every point, print the plan and end.")] = False,
    new: Annotated[
        Path | None, typer.Option("--new", metavar="FILE", help="Write a commented sweep file to start from and end.")
    ] = None,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print nothing but errors.")] = False,
) -> None:
    """Run a study many times under varied settings and seeds: one table, a phase diagram, a report."""
    if new is not None:
        from vasculo.study.sweep.template import write_template  # noqa: PLC0415

        write_template(new)
        typer.echo(f"{new} written; try: vasculo sweep {new} --plan")
        return
    from vasculo.study.sweep.show import show_plan, show_sweep  # noqa: PLC0415
    from vasculo.study.sweep.sweep import plan_sweep  # noqa: PLC0415
    from vasculo.study.sweep.sweep import sweep as run_sweep  # noqa: PLC0415

    if plan:
        if file is None:
            raise InputError("say which sweep to plan: vasculo sweep SWEEP --plan")
        if workers is not None and workers < 1:
            raise InputError(f"--workers {workers} is not a whole number from 1 up")
        show_plan(plan_sweep(file), workers)
        return
    from vasculo.study.bars import Bars  # noqa: PLC0415

    with Bars(quiet=quiet) as bars:
        done = run_sweep(file, out, workers, scheduler, bars, resume=resume)
    if not quiet:
        show_sweep(done)
    if done.failures:
        raise ComputationError(
            f"{len(done.failures)} of {len(done.plan.runs)} runs failed, {done.folder / 'failures.csv'} says why; try "
            f"them again with: vasculo sweep --resume --out {done.folder}"
        )
