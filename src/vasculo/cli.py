"""The command line. Each command loads what it needs when it is called, so that help comes at once."""

from __future__ import annotations

import functools
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, NoReturn

import typer

from vasculo.errors import ComputationError, InputError

if TYPE_CHECKING:
    from collections.abc import Callable

BAD_INPUT, FAILED, INTERRUPTED = 2, 1, 130

app = typer.Typer(
    name="vasculo",
    help="How small blood vessels form, mechanically: vasculogenesis, plexus flow and angiogenesis of one tissue.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)

RunFolder = Annotated[Path, typer.Argument(metavar="RUN", help="Folder of a run.", show_default=False)]


def one_line(command: Callable[..., None]) -> Callable[..., None]:
    """End a command that goes wrong with one line and its exit code."""

    @functools.wraps(command)
    def guarded(*args: Any, **kwargs: Any) -> None:  # whatever the command takes
        try:
            command(*args, **kwargs)
        except InputError as error:
            stop(error, BAD_INPUT)
        except ComputationError as error:
            stop(error, FAILED)
        except MemoryError as error:
            stop(f"not enough memory ({error}): use fewer nodes or pillars, or longer edges", FAILED)
        except OSError as error:
            named = error.filename is not None and error.strerror
            stop(f"{error.filename}: {error.strerror}" if named else error, FAILED)
        except KeyboardInterrupt as error:
            stop(error or "interrupted", INTERRUPTED)

    return guarded


def stop(message: object, code: int) -> NoReturn:
    """Print one line and exit."""
    typer.echo(f"vasculo: {' '.join(str(message).split()) or 'interrupted'}", err=True)
    raise typer.Exit(code)


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
    assignments: Annotated[
        list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Replace a value, as angiogenesis.steps=10.")
    ] = None,
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
    assignments: Annotated[
        list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Replace a value, as angiogenesis.steps=10.")
    ] = None,
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


@app.command()
@one_line
def measure(
    run: RunFolder,
    csv: Annotated[Path | None, typer.Option("--csv", metavar="FILE", help="Write the whole table here.")] = None,
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
    show_numbers(found)
    writers = ((csv, table_text), (passages, passages_text), (tubules, tubules_text), (events, all_events))
    for file, text_of in writers:
        if file is not None:
            from vasculo.store.table import write_whole  # noqa: PLC0415

            text = text_of(found)
            write_whole(file, text)
            typer.echo(f"{text.count(chr(10)) - 1} rows written to {file}")


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


@app.command()
@one_line
def report(run: RunFolder) -> None:
    """Write the report of a run: one self-contained HTML page."""
    from vasculo.store.read import open_run  # noqa: PLC0415

    found = open_run(run)
    from vasculo.draw.report import write_report  # noqa: PLC0415

    typer.echo(str(write_report(found)))


@app.command()
@one_line
def image(
    picture: Annotated[Path, typer.Argument(metavar="PICTURE", help="A micrograph or mask: PNG, TIFF or JPEG.")],
    out: Annotated[
        Path | None, typer.Option("--out", metavar="PATH", help="Study file (.toml) or folder; here when left out.")
    ] = None,
    vessels: Annotated[
        Literal["bright", "dark"], typer.Option("--vessels", help="Which side of the threshold is vessel.")
    ] = "bright",
    threshold: Annotated[
        str, typer.Option("--threshold", metavar="VALUE", help="A grey value, or otsu, li or local.")
    ] = "otsu",
    window: Annotated[
        str | None, typer.Option("--window", metavar="LENGTH", help="Neighbourhood of the local threshold.")
    ] = None,
    pixel_size: Annotated[
        float | None, typer.Option("--pixel-size", metavar="UM", help="Micrometres a pixel; lengths may be in um then.")
    ] = None,
    smoothing: Annotated[
        str, typer.Option("--smoothing", metavar="LENGTH", help="Blur before outlines are taken, as 1.5px or 2um.")
    ] = "1px",
    smallest: Annotated[
        str,
        typer.Option("--smallest", metavar="LENGTH", help="Smallest pillar: radius, as 2px, or area, as 12px2, 50um2."),
    ] = "2px",
    narrowest: Annotated[
        str | None, typer.Option("--narrowest", metavar="LENGTH", help="Narrower passages are widened to this.")
    ] = None,
    spacing: Annotated[
        str | None, typer.Option("--spacing", metavar="LENGTH", help="Distance between outline nodes.")
    ] = None,
    border: Annotated[
        Literal["open", "closed"], typer.Option("--border", help="Vessels that leave beside the flow: go on, or end.")
    ] = "open",
    inlet: Annotated[
        Literal["left", "top", "right", "bottom"], typer.Option("--inlet", help="Side where the blood enters.")
    ] = "left",
    outlet: Annotated[
        Literal["left", "top", "right", "bottom"] | None, typer.Option("--outlet", help="The opposite side.")
    ] = None,
    crop: Annotated[
        str | None, typer.Option("--crop", metavar="X,Y,W,H", help="Part of the picture, pixels from its upper left.")
    ] = None,
    page: Annotated[int, typer.Option("--page", metavar="N", help="Page of a file with several.")] = 1,
    replace: Annotated[bool, typer.Option("--replace", help="Write over files of an earlier try.")] = False,
) -> None:
    """Turn a picture of a vessel network into a study."""
    from vasculo.study.picture import study_of_picture  # noqa: PLC0415
    from vasculo.study.picture_options import extraction_of  # noqa: PLC0415
    from vasculo.study.show import show_picture  # noqa: PLC0415

    lengths = {"window": window, "smoothing": smoothing, "smallest_radius": smallest}
    lengths |= {"narrowest": narrowest, "spacing": spacing}
    choices = {"vessels": vessels, "border": border, "inlet": inlet, "outlet": outlet}
    wanted = extraction_of(threshold, crop, lengths, choices, pixel_size)
    show_picture(study_of_picture(picture, wanted, out, page=page, pixel_size=pixel_size, replace=replace))


def main() -> None:
    """Run the command line; a wrong option ends in one line too."""
    try:
        code = app(standalone_mode=False)
    except KeyboardInterrupt:
        typer.echo("vasculo: interrupted", err=True)
        code = INTERRUPTED
    except Exception as error:
        told = getattr(error, "format_message", None)
        if told is None:
            raise
        if message := " ".join(told().replace("Value error, ", "").split()):
            typer.echo(f"vasculo: {message} (see vasculo --help)", err=True)
        code = BAD_INPUT
    sys.exit(code)


if __name__ == "__main__":
    main()
