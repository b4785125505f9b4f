"""The lines of `raster.py` in plain NumPy: every rectangle cut by every pixel; the reference in the tests."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.draw.raster import CAP

if TYPE_CHECKING:
    from numpy.typing import NDArray


def paint_plain(
    canvas: NDArray[np.float32],
    segments: NDArray[np.float64],
    widths: NDArray[np.float64],
    greys: NDArray[np.float64],
) -> None:
    """Plain twin of `raster.paint`: lay lines over a canvas (h, w, 2); overwrites it."""
    high, wide = canvas.shape[:2]
    for segment, width, grey in zip(segments, widths, greys, strict=True):
        corners = strip(segment, width)
        low, up = np.floor(corners.min(axis=0)).astype(int), np.ceil(corners.max(axis=0)).astype(int)
        for row in range(max(low[1], 0), min(up[1], high)):
            for column in range(max(low[0], 0), min(up[0], wide)):
                covered = area(cut(corners, column, row))
                canvas[row, column] += covered * (np.array([grey, 1.0]) - canvas[row, column])


def strip(segment: NDArray[np.float64], width: float) -> NDArray[np.float64]:
    """Corners of a line of some width, with its caps; (4, 2) float64."""
    start, end = np.reshape(segment, (2, 2)).astype(np.float64)
    length = np.linalg.norm(end - start)
    along = (end - start) / length if length > 0.0 else np.array([1.0, 0.0])
    across = 0.5 * width * np.array([-along[1], along[0]])
    start, end = start - CAP * width * along, end + CAP * width * along
    return np.array([start + across, start - across, end - across, end + across])


def cut(corners: NDArray[np.float64], column: int, row: int) -> NDArray[np.float64]:
    """Part of a convex polygon inside one pixel, side after side of the pixel (Sutherland & Hodgman 1974)."""
    for axis, at, sign in ((0, column, 1.0), (0, column + 1, -1.0), (1, row, 1.0), (1, row + 1, -1.0)):
        inside = sign * (corners[:, axis] - at)
        kept = []
        for k in range(len(corners)):
            m = (k + 1) % len(corners)
            if inside[k] >= 0.0:
                kept.append(corners[k])
            if inside[k] * inside[m] < 0.0:
                kept.append(corners[k] + inside[k] / (inside[k] - inside[m]) * (corners[m] - corners[k]))
        corners = np.reshape(kept, (-1, 2))
    return corners


def area(corners: NDArray[np.float64]) -> float:
    """Area of a polygon, 0 for one without corners."""
    x, y = corners.T
    return abs(0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))))
