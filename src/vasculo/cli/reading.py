"""How a picture is read: the options that all commands share which take one."""

from __future__ import annotations

from typing import Annotated, Literal

import typer

Vessels = Annotated[Literal["bright", "dark"], typer.Option("--vessels", help="Which side of the threshold is vessel.")]
Threshold = Annotated[str, typer.Option("--threshold", metavar="VALUE", help="A grey value, or otsu, li or local.")]
Smoothing = Annotated[
    str, typer.Option("--smoothing", metavar="LENGTH", help="Blur before outlines are taken, as 1.5px or 2um.")
]
Smallest = Annotated[
    str,
    typer.Option("--smallest", metavar="LENGTH", help="Smallest island: radius, as 2px, or area, as 12px2, 50um2."),
]
PixelSize = Annotated[
    float | None, typer.Option("--pixel-size", metavar="UM", help="Micrometres a pixel; lengths may be in um then.")
]
Crop = Annotated[
    str | None, typer.Option("--crop", metavar="X,Y,W,H", help="Part of the picture, pixels from its upper left.")
]
Page = Annotated[int, typer.Option("--page", metavar="N", help="Page of a file with several.")]
Side = Literal["left", "top", "right", "bottom"]
