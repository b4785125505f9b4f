"""What the command line says about a picture: lengths in pixels or micrometres, and the parameters made of them."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import numpy as np

from vasculo.errors import InputError
from vasculo.plexus.image import ImageExtraction

if TYPE_CHECKING:
    from collections.abc import Mapping

_LENGTH = re.compile(r"(\d+\.?\d*|\.\d+)\s*(?:(px|um|µm)(2?))?")


def extraction_of(
    threshold: str,
    crop: str | None,
    lengths: Mapping[str, str | None],
    choices: Mapping[str, str | None],
    pixel_size: float | None,
) -> ImageExtraction:
    """Read the words of a command line.

    Parameters
    ----------
    threshold : str
        A number, or the name of a method.
    crop : str, optional
        Four whole numbers with commas between them.
    lengths : mapping of str to str
        Lengths by the name of the parameter, see `pixels_of`; None leaves a default.
    choices : mapping of str to str
        Other parameters.
    pixel_size : float, optional
        Size of a pixel, micrometres.

    Raises
    ------
    InputError
        When something cannot be read or is out of range.
    """
    check_pixel_size(pixel_size)
    values: dict[str, Any] = dict(choices)
    values |= {name: pixels_of(text, pixel_size) for name, text in lengths.items() if text is not None}
    try:
        values["threshold"] = float(threshold)
    except ValueError:
        values["threshold"] = threshold
    if crop is not None:
        try:
            values["crop"] = tuple(int(part) for part in crop.split(","))
        except ValueError:
            raise InputError(f"crop {crop!r} must be four whole numbers: left,top,width,height") from None
    return ImageExtraction(**values)


def pixels_of(text: str, pixel_size: float | None) -> float:
    """Length in pixels of "3", "3px" or "2.5um"; of an area, as "50um2", the radius of a disk as large.

    Raises
    ------
    InputError
        When it is no length, or micrometres are given without the size of a pixel.
    """
    match = _LENGTH.fullmatch(text.strip())
    if match is None:
        raise InputError(f"{text!r} is no length: give pixels, as 3 or 3px, or micrometres, as 2.5um")
    value = float(match[1])
    if match[2] in {"um", "µm"}:
        if pixel_size is None:
            raise InputError(f"{text!r} is in micrometres: give the size of a pixel too, with --pixel-size")
        value /= pixel_size ** (2 if match[3] else 1)
    if match[3]:
        return float(np.sqrt(max(value, 0.0) / np.pi))
    return value


def check_pixel_size(pixel_size: float | None) -> None:
    """Refuse what is no size of a pixel."""
    if pixel_size is not None and not 0.0 < pixel_size < np.inf:
        raise InputError(f"pixel size must be a number of micrometres above 0, got {pixel_size:g}")
