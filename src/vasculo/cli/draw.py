"""Pictures and films of a run."""

from __future__ import annotations

from typing import Annotated, Literal

import typer

from vasculo.cli.app import RunFolder, app, one_line
from vasculo.errors import InputError


@app.command()
@one_line
def draw(
    run: RunFolder,
    what: Annotated[
        Literal["springs", "mesh", "flow", "shear", "pillars", "network"] | None,
        typer.Option("--what", help="One picture of one step; all figures when left out."),
    ] = None,
    step: Annotated[int | None, typer.Option("--step", metavar="N", help="Step to draw; the last by default.")] = None,
    movie: Annotated[bool, typer.Option("--movie", help="A film of all recorded steps instead.")] = False,
) -> None:
    """Draw pictures of a run into its folder figures."""
    from vasculo.store.read import open_run  # noqa: PLC0415

    found = open_run(run)
    from vasculo.draw.figures import draw_all  # noqa: PLC0415
    from vasculo.draw.single import draw_movie, draw_one  # noqa: PLC0415

    if what is None and (movie or step is not None):
        raise InputError("say what to draw: --what springs, mesh, flow, shear, pillars or network")
    if movie and step is not None:
        raise InputError("--movie takes all steps: leave --step out")
    if movie and what == "network":
        raise InputError("a network is drawn for one step: leave --movie out")
    if what is None:
        files = draw_all(found)
    elif what == "network":
        from vasculo.study.tubules import draw_tubules  # noqa: PLC0415

        files = [draw_tubules(found, step)]
    elif movie:
        files = [draw_movie(found, what)]
    else:
        files = [draw_one(found, what, step)]
    for file in files:
        typer.echo(str(file))
