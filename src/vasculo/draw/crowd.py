"""Lines that are too many for vector graphics: an image, made anew at the size in which the panel is shown."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.artist import Artist, allow_rasterization

from vasculo.draw.raster import raster

if TYPE_CHECKING:
    from numpy.typing import NDArray


class Crowd(Artist):
    """Lines of their own width and grey, in the order in which they are drawn.

    Parameters
    ----------
    ends : (m, 2, 2) float32
        Both ends, in the data coordinates of the axes.
    widths : (m,) float32
        Widths, points.
    greys : (m,) float32
        Brightness, from 0 (black) to 1 (white).
    """

    zorder = 2  # as matplotlib's lines

    def __init__(self, ends: NDArray[np.float32], widths: NDArray[np.float32], greys: NDArray[np.float32]) -> None:
        super().__init__()
        self.set_in_layout(False)
        self.set_rasterized(True)
        self.ends, self.widths, self.greys = ends, widths, greys
        self._last: tuple[tuple[float, ...], NDArray[np.uint8]] | None = None

    @allow_rasterization
    def draw(self, renderer: Any) -> None:
        """Draw onto a renderer of matplotlib; called by it."""
        if not self.get_visible():
            return
        # A figure is drawn twice, the first time for its layout: the image is kept from one to the other.
        axes: Any = self.axes
        box, points = axes.bbox, axes.figure.dpi / 72.0
        left, bottom = np.floor([box.x0, box.y0])
        wide, high = np.ceil([box.x1, box.y1]) - (left, bottom)
        key = (left, bottom, wide, high, points, *axes.viewLim.extents)
        if self._last is None or self._last[0] != key:
            corners = axes.transData.transform([(0.0, 0.0), (1.0, 1.0)])
            scale = (corners[1] - corners[0]).astype(np.float32)
            shift = (corners[0] - (left, bottom)).astype(np.float32)
            segments = (self.ends * scale + shift).reshape(-1, 4)
            shape = int(high), int(wide)
            self._last = key, raster(segments, np.float32(points) * self.widths, self.greys, shape)
        graphics = renderer.new_gc()
        graphics.set_clip_rectangle(self.get_clip_box())
        graphics.set_clip_path(self.get_clip_path())
        renderer.draw_image(graphics, left, bottom, self._last[1])  # its first row is the lowest
        graphics.restore()
