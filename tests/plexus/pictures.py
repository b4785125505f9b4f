"""Small pictures to read: 1 in tissue, 0 in vessels."""

import numpy as np
import shapely

from vasculo.plexus.image import ImageExtraction, domain_from_image

DARK = {"vessels": "dark"}


def painted(shapes, width, height, fine=8):
    """Share of each pixel that shapes cover, y up."""
    x, y = (np.arange(width * fine) + 0.5) / fine, height - (np.arange(height * fine) + 0.5) / fine
    inside = shapely.contains_xy(shapely.union_all(shapes), *np.meshgrid(x, y))
    return inside.reshape(height, fine, width, fine).mean(axis=(1, 3))


def strips(rows, columns=60):
    """A picture from rows of 0 (vessel) and 1 (tissue), each repeated to the width."""
    return np.repeat(np.array(rows, dtype=float)[:, None], columns, axis=1)


def blocks(*boxes, shape=(60, 80)):
    """A picture with tissue in boxes (row, column, height, width)."""
    picture = np.zeros(shape)
    for row, column, height, width in boxes:
        picture[row : row + height, column : column + width] = 1.0
    return picture


def read(picture, **more):
    return domain_from_image(picture, ImageExtraction(**(DARK | {"smoothing": 0.5} | more)))
