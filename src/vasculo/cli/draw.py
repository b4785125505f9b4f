"""Pictures and films of a run."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from vasculo.cli.app import RunFolder, app, one_line
from vasculo.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from vasculo.store.read import Run

STILLS = ("springs", "mesh", "flow", "pressure", "shear", "pillars", "chains", "network")
FILMS = ("story", *STILLS[:-1])
PICTURES, MOVIES = ("png", "svg", "pdf"), ("mp4", "gif")
_LENGTHS = {"mm": 1.0 / 25.4, "cm": 1.0 / 2.54, "in": 1.0}
_NARROWEST, _WIDEST = 2.0, 40.0  # inches


@app.command()
@one_line
def draw(
    run: RunFolder,
    what: Annotated[
        str | None,
        typer.Option(
            "--what", metavar="WHAT", help=f"One picture of one step: {', '.join(STILLS)}. By default all figures."
        ),
    ] = None,
    step: Annotated[int | None, typer.Option("--step", metavar="N", help="Step to draw; the last by default.")] = None,
    movie: Annotated[
        bool, typer.Option("--movie", help="A film of all recorded steps; of both stages when --what is left out.")
    ] = False,
    formats: Annotated[
        list[str] | None,
        typer.Option("--format", metavar="FORMAT", help="png, svg or pdf, also png,pdf; mp4 or gif with --movie."),
    ] = None,
    width: Annotated[
        str | None,
        typer.Option(
            "--width", metavar="WIDTH", help="180mm, 85mm or 7in; 180mm by default. Pixels with --movie: 960."
        ),
    ] = None,
    dpi: Annotated[
        int | None, typer.Option("--dpi", metavar="N", help="Dots per inch; 200 by default, or more.")
    ] = None,
    fps: Annotated[
        float | None, typer.Option("--fps", metavar="N", help="Recorded steps a second; by default a film takes 10 s.")
    ] = None,
) -> None:
    """Draw pictures or a film of a run into its folder figures."""
    from vasculo.store.read import open_run  # noqa: PLC0415

    found = open_run(run)
    kinds = _kinds(formats, MOVIES if movie else PICTURES)
    _fits(what, FILMS if movie else STILLS, movie=movie)
    if movie:
        if step is not None or dpi is not None:
            raise InputError(f"--movie takes all steps, in pixels: leave {'--step' if dpi is None else '--dpi'} out")
        files = _films(found, what or "story", kinds, width, fps)
    else:
        if what is None and step is not None:
            raise InputError(f"say what to draw of step {step}: --what {', '.join(STILLS[:-1])} or {STILLS[-1]}")
        if fps is not None:
            raise InputError("--fps is for a film: add --movie")
        if dpi is not None and not 50 <= dpi <= 1200:
            raise InputError(f"--dpi {dpi} is not from 50 to 1200")
        files = _pictures(found, what, step, {"width": inches(width), "dpi": dpi, "formats": kinds})
    for file in files:
        typer.echo(str(file))


def inches(width: str | None) -> float:
    """Width in inches from text as 85mm, 8.5cm, 3.3in or 85, which are millimetres; 180 mm when there is none."""
    text = "180mm" if width is None else width.strip().lower()
    unit = next((name for name in _LENGTHS if text.endswith(name)), "")
    try:
        number = float(text.removesuffix(unit)) * _LENGTHS[unit or "mm"]
    except ValueError:
        raise InputError(f"--width {width} is no width: give millimetres as 85mm or inches as 3.3in") from None
    if not _NARROWEST <= number <= _WIDEST:
        raise InputError(f"--width {width} is {25.4 * number:.0f} mm, not from 51 to 1016 mm (2 to 40 inches)")
    return number


def _kinds(formats: list[str] | None, known: Sequence[str]) -> list[str]:
    """List the formats in the order given, each once."""
    asked = [word.strip().lower() for text in formats or known[:1] for word in text.split(",")]
    for word in asked:
        if word not in known:
            where = " with --movie" if known is MOVIES else " (mp4 and gif need --movie)" if word in MOVIES else ""
            raise InputError(f"--format {word} is not {', '.join(known[:-1])} or {known[-1]}{where}")
    return list(dict.fromkeys(asked))


def _fits(what: str | None, known: Sequence[str], *, movie: bool) -> None:
    """Refuse what cannot be drawn, with the nearest that can."""
    if what is None or what in known:
        return
    from difflib import get_close_matches  # noqa: PLC0415

    if what in STILLS or what in FILMS:
        told = "shows one step: leave --movie out" if movie else "is a film: add --movie"
        raise InputError(f"--what {what} {told}")
    near = get_close_matches(what, known, 1)
    hint = f", did you mean {near[0]!r}?" if near else ""
    raise InputError(f"--what {what} is not {', '.join(known[:-1])} or {known[-1]}{hint}")


def _pictures(run: Run, what: str | None, step: int | None, options: dict[str, Any]) -> list[Path]:
    from vasculo.draw.figures import draw_all  # noqa: PLC0415
    from vasculo.draw.single import draw_one  # noqa: PLC0415

    if what is None:
        return draw_all(run, **options)
    if what == "network":
        from vasculo.study.tubules import draw_tubules  # noqa: PLC0415

        return draw_tubules(run, step, **options)
    return draw_one(run, what, step, **options)  # type: ignore[arg-type]  # looked at before


def _films(run: Run, what: Any, kinds: Sequence[str], width: str | None, fps: float | None) -> list[Path]:
    from vasculo.draw.film import draw_film  # noqa: PLC0415
    from vasculo.study.bars import Bars  # noqa: PLC0415

    pixels = (width or "960").strip().lower().removesuffix("px")
    if not pixels.isdigit():
        raise InputError(f"--width {width} of a film is no number of pixels: give one as 960")
    files = []
    with Bars() as bars:
        for kind in kinds:
            bars.begin(f"film ({kind})", "")
            files.append(draw_film(run, what, width=int(pixels), rate=fps, kind=kind, tell=bars.advance))
            bars.end(f"{files[-1].stat().st_size / 2**20:.1f} MB")
    return files
