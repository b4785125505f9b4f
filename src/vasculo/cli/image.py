"""From a picture to a study."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import typer

from vasculo.cli.app import app, one_line
from vasculo.cli.reading import Crop, Page, PixelSize, Side, Smallest, Smoothing, Threshold, Vessels


@app.command()
@one_line
def image(
    picture: Annotated[Path, typer.Argument(metavar="PICTURE", help="A micrograph or mask: PNG, TIFF or JPEG.")],
    out: Annotated[
        Path | None, typer.Option("--out", metavar="PATH", help="Study file (.toml) or folder; here when left out.")
    ] = None,
    vessels: Vessels = "bright",
    threshold: Threshold = "otsu",
    window: Annotated[
        str | None, typer.Option("--window", metavar="LENGTH", help="Neighbourhood of the local threshold.")
    ] = None,
    pixel_size: PixelSize = None,
    smoothing: Smoothing = "1px",
    smallest: Smallest = "2px",
    narrowest: Annotated[
        str | None, typer.Option("--narrowest", metavar="LENGTH", help="Narrower passages are widened to this.")
    ] = None,
    spacing: Annotated[
        str | None, typer.Option("--spacing", metavar="LENGTH", help="Distance between outline nodes.")
    ] = None,
    border: Annotated[
        Literal["open", "closed"], typer.Option("--border", help="Vessels that leave beside the flow: go on, or end.")
    ] = "open",
    inlet: Annotated[Side, typer.Option("--inlet", help="Side where the blood enters.")] = "left",
    outlet: Annotated[Side | None, typer.Option("--outlet", help="The opposite side.")] = None,
    crop: Crop = None,
    page: Page = 1,
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
