"""From a picture to a level field: positive in vessels, negative in tissue, zero on the outlines."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from scipy.ndimage import gaussian_filter

from vasculo.errors import InputError

if TYPE_CHECKING:
    from types import ModuleType

    from numpy.typing import ArrayLike, NDArray

    from vasculo.plexus.image_parameters import ImageExtraction

    Floats = NDArray[np.float64]

LEAST = 8
"""Fewest pixels of a side of a picture."""
NO_ZERO = 1e-6
"""Levels closer to zero than this share of the largest become tissue: no outline runs through the centre of a pixel."""
WINDOW = 0.125
"""Width of the window of a local threshold, as a share of the shorter side."""


def scikit_image(part: str) -> ModuleType:
    """Load a part of scikit-image.

    Raises
    ------
    InputError
        When scikit-image is not installed.
    """
    from importlib import import_module  # noqa: PLC0415  # heavy, and only here

    try:
        return import_module(f"skimage.{part}")
    except ImportError:
        raise InputError("pictures are read with scikit-image: pip install 'vasculo[image]' brings it") from None


def grey_values(picture: ArrayLike, crop: tuple[int, int, int, int] | None = None) -> Floats:
    """Grey values of a picture, checked.

    Parameters
    ----------
    picture : (h, w), (h, w, 3) or (h, w, 4) array of bool, integers or floats
        Grey, RGB or RGBA. Colours are weighted as in their luminance; what is transparent is white.
    crop : tuple of 4 int, optional
        Left column, top row, width and height of the part to take (pixels).

    Returns
    -------
    (h, w) float64
        In the numbers of the picture (0 and 1 for truth values).

    Raises
    ------
    InputError
        When it is no picture, has values that are not finite, or all pixels are alike.
    """
    values = np.asarray(picture)
    if values.dtype.kind not in "buif":
        raise InputError(f"a picture needs real numbers, not {values.dtype}")
    if not (values.ndim == 2 or (values.ndim == 3 and values.shape[2] in {3, 4})):
        raise InputError(
            f"a picture has shape (height, width), or 3 or 4 colours as a third axis, not {values.shape}: take one page"
        )
    values = cropped(values, crop)
    if min(values.shape[:2]) < LEAST:
        raise InputError(f"the picture is {_size(values)} pixels: {LEAST} x {LEAST} is the least")
    grey = values.astype(np.float64)
    wrong = int(np.count_nonzero(~np.isfinite(grey)))
    if wrong:
        raise InputError(f"{wrong} of the {grey.size} values of the picture are not finite")
    if grey.ndim == 3:
        white = float(np.iinfo(values.dtype.name).max) if values.dtype.kind in "ui" else 1.0
        grey = _luminance(grey, white)
    if grey.min() == grey.max():
        raise InputError(f"all {grey.size} pixels have the grey value {grey.flat[0]:g}: there is nothing to tell apart")
    return grey


def level_field(grey: Floats, wanted: ImageExtraction) -> tuple[Floats, float]:
    """Smooth a picture and set its threshold to zero.

    Strategy: the blur is 2 G(s) - G(2 s), with G a Gaussian. A Gaussian moves an outline of curvature 1/R inward by
    s^2/(2 R), because the integral of y^2 G along the tangent, s/sqrt(2 pi), is not zero; that of this blur is. So
    round islands keep their size, and narrow vessels their contrast.

    Parameters
    ----------
    grey : (h, w) float64
        Grey values.
    wanted : ImageExtraction

    Returns
    -------
    levels : (h, w) float64
        Positive in vessels, negative in tissue, never zero.
    threshold : float
        Grey value at zero; NaN for a local threshold.

    Raises
    ------
    InputError
        When the threshold lies outside the grey values of the picture.
    """
    sigma = wanted.smoothing
    smooth = grey
    if sigma > 0.0:
        smooth = 2.0 * gaussian_filter(grey, sigma) - gaussian_filter(grey, 2.0 * sigma)
    threshold = np.nan
    if wanted.threshold == "local":
        window = wanted.window or max(3.0, WINDOW * min(grey.shape))
        odd = 2 * int(window // 2) + 1
        levels = smooth - scikit_image("filters").threshold_local(grey, odd, method="mean")
    else:
        threshold = _threshold(grey, wanted.threshold)
        levels = smooth - threshold
    if wanted.vessels == "dark":
        levels = -levels
    least = NO_ZERO * float(np.abs(levels).max())
    return np.where(np.abs(levels) < least, -least, levels), threshold


def _threshold(grey: Floats, wanted: float | str) -> float:
    """Grey value between vessels and tissue.

    Half way between the means of the two classes is where a blurred edge stands; between two single values the
    methods themselves would take any value in between.
    """
    low, high = float(grey.min()), float(grey.max())
    if not isinstance(wanted, str):
        if not low <= wanted < high:
            raise InputError(f"threshold {wanted:g} is outside the grey values of the picture, {low:g} to {high:g}")
        return float(wanted)
    filters = scikit_image("filters")
    if wanted == "li" and np.any((grey > low) & (grey < high)):
        return float(filters.threshold_li(grey))
    above = grey > (filters.threshold_otsu(grey) if wanted == "otsu" else low)
    return 0.5 * float(grey[above].mean() + grey[~above].mean())


def cropped(values: NDArray[np.generic], crop: tuple[int, int, int, int] | None) -> NDArray[np.generic]:
    """Cut a part out of a picture: left column, top row, width, height."""
    if crop is None:
        return values
    left, top, width, height = crop
    if left + width > values.shape[1] or top + height > values.shape[0]:
        raise InputError(
            f"crop {width} x {height} at ({left}, {top}) does not fit into the picture of {_size(values)} pixels"
        )
    return values[top : top + height, left : left + width]


def _luminance(colours: Floats, white: float) -> Floats:
    """Grey values of colours, (h, w, 3) or (h, w, 4), by Rec. 709."""
    grey = colours[..., :3] @ np.array([0.2125, 0.7154, 0.0721])
    if colours.shape[2] == 3:
        return np.asarray(grey)
    cover = colours[..., 3] / white
    return np.asarray(grey * cover + white * (1.0 - cover))


def _size(values: NDArray[np.generic]) -> str:
    return f"{values.shape[1]} x {values.shape[0]}"
