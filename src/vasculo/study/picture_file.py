"""Picture files: PNG, TIFF, JPEG and what else Pillow reads, one page as an array."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import InputError
from vasculo.plexus.image_levels import scikit_image

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

PLAIN_MODES = ("1", "L", "I", "I;16", "F", "RGB", "RGBA")
"""Modes of Pillow that are grey values or colours as they are."""


def read_picture(path: Path, page: int = 1) -> tuple[NDArray[np.generic], int]:
    """Read a picture: PNG, TIFF or JPEG.

    Parameters
    ----------
    path : Path
    page : int
        Page of a file with several, from 1 on.

    Returns
    -------
    picture : (h, w), (h, w, 3) or (h, w, 4) array
        As it is shown: in a TIFF in which 0 is white, the values are turned round.
    pages : int
        Pages of the file.

    Raises
    ------
    InputError
        When there is no such file or page, it is no picture, or scikit-image is missing.
    """
    if not path.is_file():
        raise InputError(f"{path}: no such file")
    scikit_image("measure")  # brings the readers of both kinds
    try:
        picture = _read_tiff(path) if path.suffix.lower() in {".tif", ".tiff"} else _read_other(path)
    except MemoryError:
        raise
    except Exception as error:  # noqa: BLE001  # whatever the readers make of a broken file
        reason = " ".join(str(error).split())[:120]
        raise InputError(f"{path} is no picture that can be read ({reason or type(error).__name__})") from None
    if picture.size == 0:
        raise InputError(f"{path} is empty: {' x '.join(map(str, picture.shape))} pixels")
    colours = picture.ndim == 3 and picture.shape[2] in {3, 4}
    if picture.ndim == 2 or colours:
        stack = picture[None]
    else:
        deep = picture.ndim - (3 if picture.ndim > 3 and picture.shape[-1] in {3, 4} else 2)
        stack = picture.reshape(-1, *picture.shape[deep:])
    if not 1 <= page <= len(stack):
        raise InputError(f"{path} has no page {page}: it has {len(stack)}")
    return stack[page - 1], len(stack)


def _read_tiff(path: Path) -> NDArray[np.generic]:
    """Read all pages of a TIFF, turned round where 0 is white."""
    from tifffile import PHOTOMETRIC, TiffFile  # noqa: PLC0415  # comes with scikit-image

    with TiffFile(path) as file:
        values = np.asarray(file.asarray())
        if file.pages[0].photometric == PHOTOMETRIC.MINISWHITE and values.dtype.kind in "bu":
            return ~values
        return values


def _read_other(path: Path) -> NDArray[np.generic]:
    """Read PNG, JPEG and whatever else Pillow knows; palettes become colours."""
    from PIL import Image, ImageOps  # noqa: PLC0415  # comes with scikit-image

    with Image.open(path) as file:
        shown = ImageOps.exif_transpose(file)
        return np.asarray(shown if shown.mode in PLAIN_MODES else shown.convert("RGBA"))
