"""A grown plexus as a picture, so that it is measured as the picture is: with its pixels, blur and smallest islands."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import shapely

from vasculo.geometry.neighbours import as_polygons
from vasculo.plexus.image import domain_from_image

if TYPE_CHECKING:
    from vasculo.geometry.arrays import Flags
    from vasculo.geometry.domain import Domain
    from vasculo.measure.morphometry import Window
    from vasculo.plexus.image import ImageExtraction, Pictured


def paint(domain: Domain, window: Window, shape: tuple[int, int]) -> Flags:
    """Mask of a window of a domain, true in the pillars.

    Parameters
    ----------
    domain : Domain
    window : tuple of 4 float
        Smallest x, smallest y, largest x, largest y (model length).
    shape : tuple of 2 int
        Rows and columns of pixels; a pixel is what its centre is.

    Returns
    -------
    ndarray of bool, shape (rows, columns)
        The first row is the uppermost.
    """
    x0, y0, x1, y1 = window
    rows, columns = shape
    across = x0 + (np.arange(columns) + 0.5) * (x1 - x0) / columns
    up = y1 - (np.arange(rows) + 0.5) * (y1 - y0) / rows
    mask: Flags = shapely.contains_xy(shapely.union_all(as_polygons(domain.pillars)), *np.meshgrid(across, up))
    return mask


def read_painted(mask: Flags, reading: ImageExtraction) -> Pictured:
    """Read what `paint` made as another picture was read: blur, smallest islands, outlines; lengths are pixels."""
    plain = replace(reading, vessels="dark", threshold=0.5, window=None, crop=None, inlet="left", outlet=None)
    return domain_from_image(mask, plain)
