"""Fit the vasculogenesis to a picture."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from vasculo.cli.app import app, one_line
from vasculo.cli.reading import Crop, Page, PixelSize, Side, Smallest, Smoothing, Threshold, Vessels


@app.command()
@one_line
def match(
    image: Annotated[Path, typer.Argument(metavar="IMAGE", help="A micrograph or mask, or the folder of a run.")],
    out: Annotated[
        Path | None, typer.Option("--out", metavar="DIR", help="Folder of the fit; matches/IMAGE when left out.")
    ] = None,
    vessels: Vessels = "bright",
    threshold: Threshold = "otsu",
    smoothing: Smoothing = "1px",
    smallest: Smallest = "2px",
    inlet: Annotated[
        Side,
        typer.Option("--inlet", help="Side from which a vessel leads to the opposite one."),
    ] = "left",
    crop: Crop = None,
    pixel_size: PixelSize = None,
    page: Page = 1,
    budget: Annotated[int, typer.Option("--budget", metavar="N", help="Most settings that are tried.")] = 96,
    seeds: Annotated[int, typer.Option("--seeds", metavar="N", help="Tissues that are grown of each.")] = 2,
    workers: Annotated[
        int | None, typer.Option("--workers", metavar="N", help="Processes; one a processor when left out.")
    ] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Go on with the fit in DIR.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print nothing but errors.")] = False,
) -> None:
    """Find the settings whose plexus looks most like a picture, and say how sure they are."""
    from vasculo.study.match.search import optimiser  # noqa: PLC0415

    optimiser()  # says at once which extra is missing
    from vasculo.study.match.files import PAGE, STUDY  # noqa: PLC0415
    from vasculo.study.match.fit import default_workers  # noqa: PLC0415
    from vasculo.study.match.fit import match as fit  # noqa: PLC0415
    from vasculo.study.match.words import sentences, setting_words  # noqa: PLC0415
    from vasculo.study.picture_options import extraction_of  # noqa: PLC0415

    lengths = {"smoothing": smoothing, "smallest_radius": smallest}
    wanted = extraction_of(threshold, crop, lengths, {"vessels": vessels, "inlet": inlet}, pixel_size)
    found = fit(
        image,
        out,
        wanted,
        page=page,
        pixel_size=pixel_size,
        budget=budget,
        seeds=seeds,
        workers=workers or default_workers(),
        resume=resume,
        tell=None if quiet else lambda line: typer.echo(line, err=True),
    )
    if quiet:
        return
    for text in sentences(found):
        typer.echo(text)
    for each in found.ranges:
        typer.echo(f"{each.name:<22} {each.best:<8g} {setting_words(each)}")
    typer.echo(f"{found.folder / STUDY} grows it, {found.folder / PAGE} shows it")
