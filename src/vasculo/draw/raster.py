"""Very many lines as an image: exact coverage of every pixel, laid over each other like thin paint."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numba import njit

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.geometry.arrays import Floats

CAP = np.pi / 8.0
"""Widths by which a strip reaches beyond each end of its line: there it covers what a round cap would."""


def raster(
    segments: NDArray[np.floating[Any]],
    widths: NDArray[np.floating[Any]],
    greys: NDArray[np.floating[Any]],
    shape: tuple[int, int],
) -> NDArray[np.uint8]:
    """Draw lines into a transparent image.

    Parameters
    ----------
    segments : (m, 4) float64 or float32
        Lines x0, y0, x1, y1 in pixels, in the order in which they are drawn; the last lies on top. Pixel (i, j) covers
        y from i to i + 1 and x from j to j + 1. What lies outside the image is cut off.
    widths : (m,) float64 or float32
        Widths, pixels, > 0; thinner than a pixel is paler.
    greys : (m,) float64 or float32
        Brightness, from 0 (black) to 1 (white).
    shape : tuple of int
        Height and width of the image, pixels.

    Returns
    -------
    (height, width, 4) uint8
        Red, green, blue (all the grey) and opacity.
    """
    canvas = np.zeros((*shape, 2), dtype=np.float32)
    paint(canvas, segments, widths, greys)
    return to_rgba(canvas)


def to_rgba(canvas: NDArray[np.float32]) -> NDArray[np.uint8]:
    """Turn a canvas of grey times opacity, and opacity, (h, w, 2), into an image (h, w, 4)."""
    opacity = canvas[:, :, 1]
    grey = canvas[:, :, 0] / np.where(opacity > 0.0, opacity, np.float32(1.0))
    image = np.empty((*opacity.shape, 4), dtype=np.uint8)
    image[:, :, :3] = np.rint(255.0 * np.clip(grey, 0.0, 1.0))[:, :, None]
    image[:, :, 3] = np.rint(255.0 * np.clip(opacity, 0.0, 1.0))
    return image


@njit(cache=True, error_model="numpy")
def paint(canvas: Floats, segments: Floats, widths: Floats, greys: Floats) -> None:
    """Lay lines over a canvas (h, w, 2) of grey times opacity, and opacity; overwrites it.

    Segments (m, 4), widths and greys (m,) as in `raster`. The plain twin is `raster_plain.paint_plain`.
    """
    # Strategy: a line is a rectangle. Row by row, each of its four edges adds its signed slope to the cells it crosses;
    # the running sum over the cells is the exact area of the rectangle in each pixel (as font renderers do). With that
    # coverage c the pixel becomes (1 - c) old + c new: so many thin lines add up, and never to more than full ink.
    high, wide = canvas.shape[:2]
    widest = 0.0
    for width in widths:
        widest = max(widest, width)
    cells = np.zeros(wide + 8 + 4 * int(np.ceil(widest + 2.0)))
    corners = np.empty((4, 2))
    for s in range(len(segments)):
        width = float(widths[s])
        if not shape_of(segments[s], width, wide, high, corners):
            continue
        left = min(corners[0, 0], corners[1, 0], corners[2, 0], corners[3, 0])
        bottom = min(corners[0, 1], corners[1, 1], corners[2, 1], corners[3, 1])
        top = max(corners[0, 1], corners[1, 1], corners[2, 1], corners[3, 1])
        first = int(np.floor(left))
        for row in range(max(0, int(np.floor(bottom))), min(high, int(np.ceil(top)))):
            low, up = add_edges(cells, corners, row, first)
            covered = 0.0
            for cell in range(low, up + 1):
                covered += cells[cell]
                cells[cell] = 0.0
                column = first + cell
                if 0 <= column < wide:
                    c = min(abs(covered), 1.0)
                    canvas[row, column, 0] += c * (greys[s] - canvas[row, column, 0])
                    canvas[row, column, 1] += c * (1.0 - canvas[row, column, 1])


@njit(cache=True, error_model="numpy")
def shape_of(segment: Floats, width: float, wide: int, high: int, corners: Floats) -> bool:
    """Write the four corners of a line of some width into `corners`; False when it lies outside the image."""
    x = float(segment[0])
    y = float(segment[1])
    dx = float(segment[2]) - x
    dy = float(segment[3]) - y
    length = np.sqrt(dx * dx + dy * dy)
    margin = width + 2.0
    start = 0.0
    stop = 1.0
    for at, run, size in ((x, dx, wide), (y, dy, high)):
        if -margin <= min(at, at + run) and max(at, at + run) <= size + margin:
            continue
        if run == 0.0:
            if not -margin <= at <= size + margin:
                return False
            continue
        one = (-margin - at) / run
        two = (size + margin - at) / run
        start = max(start, min(one, two))
        stop = min(stop, max(one, two))
    if not (start <= stop and length >= 0.0):
        return False
    ux = 1.0
    uy = 0.0
    if length > 0.0:
        ux = dx / length
        uy = dy / length
    before = start * length - CAP * width
    behind = stop * length + CAP * width
    half = 0.5 * width
    for k, along, across in ((0, before, half), (1, before, -half), (2, behind, -half), (3, behind, half)):
        corners[k, 0] = x + along * ux - across * uy
        corners[k, 1] = y + along * uy + across * ux
    return True


@njit(cache=True, error_model="numpy")
def add_edges(cells: Floats, corners: Floats, row: int, first: int) -> tuple[int, int]:
    """Add to `cells` what the edges of a polygon contribute in a row of pixels; return the outermost cells touched.

    Cell k stands for the pixel first + k. The running sum of the cells is the signed area of the polygon in each pixel.
    """
    low = len(cells)
    up = -1
    for k in range(4):
        xa, ya = corners[k]
        xb, yb = corners[(k + 1) % 4]
        sign = 1.0
        if ya > yb:
            xa, ya, xb, yb = xb, yb, xa, ya
            sign = -1.0
        bottom = max(ya, float(row))
        top = min(yb, row + 1.0)
        if top <= bottom:
            continue
        slope = (xb - xa) / (yb - ya)
        left = xa + slope * (bottom - ya) - first
        right = xa + slope * (top - ya) - first
        if left > right:
            left, right = right, left
        rise = sign * (top - bottom)
        i = max(0, int(np.floor(left)))
        j = max(i, int(np.ceil(right)) - 1)
        low = min(low, i)
        up = max(up, j + 1)
        if i == j:
            share = 1.0 - (0.5 * (left + right) - i)
            cells[i] += rise * share
            cells[i + 1] += rise * (1.0 - share)
            continue
        # The running sum behind this edge, pixel by pixel: a triangle, then trapezia, then all of it.
        steep = 1.0 / (right - left)
        before = 0.0
        for m in range(i, j + 1):
            near = max(left, float(m))
            far = min(right, m + 1.0)
            area = steep * ((near - left) * (far - near) + 0.5 * (far - near) ** 2 + (far - left) * (m + 1.0 - far))
            cells[m] += rise * (area - before)
            before = area
        cells[j + 1] += rise * (1.0 - before)
    return low, up
