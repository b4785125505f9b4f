"""Springs with width and grey by force, as in the paper's Figs 1 and 2."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from vasculo.draw.canvas import RESOLUTION, WIDTH, panel
from vasculo.draw.seam import images

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.draw.canvas import Box
    from vasculo.store.read import Springs

CLIP = 98.0  # percentile of the tensions that is drawn full black and full width
WIDTHS = (0.15, 1.2)  # points, whole mesh
GREYS = (0.82, 0.04)
REST = 0.25
"""How springs are drawn when none is stretched: as if by this share of the scale."""
CROWD = 100_000
"""Springs in view above which they are drawn as an image instead of as lines."""
_THIN = 35_000  # springs that print well in the widths above
_SHARPEST = 290  # dots per inch


def force_scale(springs: Springs) -> float:
    """Tension that is drawn full black: the 98th percentile."""
    pulls = np.maximum(springs.forces, 0.0)
    return float(np.percentile(pulls, CLIP)) if pulls.size else 0.0


def whole_tissue(period: tuple[float, float] | None = None) -> Box:
    """Region of the whole tissue: the box of a periodic one; else the unit square, with a hair of margin."""
    return (-0.005, -0.005, 1.005, 1.005) if period is None else (0.0, 0.0, *period)


def zoom(springs: int) -> float:
    """Factor on the line widths: wider for a coarse mesh, thinner where there are more springs than print well."""
    return min(2.5, (_THIN / max(springs, 1)) ** 0.4)


def fit(axes: Any) -> float:
    """Factor on the line widths for the size of axes on the page: less, but not in proportion, in a small picture."""
    inches = axes.get_position().width * axes.figure.get_figwidth()
    return float((inches / WIDTH) ** 0.6)


def sharpness(springs: int) -> int:
    """Dots per inch of a picture of so many springs in all: more where the cords are fine."""
    return round(min(_SHARPEST, RESOLUTION * max(1.0, (springs / CROWD) ** 0.2)))


def look(pull: Any) -> tuple[Any, Any]:
    """Width in points and grey of springs by their force over the scale, from 0 to 1."""
    return WIDTHS[0] + (WIDTHS[1] - WIDTHS[0]) * pull, GREYS[0] + (GREYS[1] - GREYS[0]) * pull**0.7


def draw_springs(
    axes: Any,
    springs: Springs,
    box: Box,
    title: str = "",
    widen: float = 1.0,
    scale: float | None = None,
    *,
    image: bool | None = None,
) -> None:
    """Draw the springs inside `box`.

    Parameters
    ----------
    axes : matplotlib Axes
        Where.
    springs : Springs
        The tissue at one step. A periodic one is wrapped into its box and cut off there.
    box : tuple of float
        Region xmin, ymin, xmax, ymax; model length.
    title : str
        Caption.
    widen : float
        Factor on the line widths, for fragments.
    scale : float, optional
        Tension drawn full black; by default the 98th percentile of this step.
    image : bool, optional
        Draw an image of the springs instead of lines; by default when there are many.
    """
    points, pairs, forces = _in_view(springs, box)
    top = force_scale(springs) if scale is None else scale
    pull = np.clip(forces / top, 0.0, 1.0) if top > 0.0 else np.full(len(forces), REST)
    order = np.argsort(pull, kind="stable")
    ends, pull = points[pairs[order]], pull[order]
    widths, grey = look(pull)
    lines = _crowd if (len(ends) > CROWD if image is None else image) else _lines
    artist = lines(axes, ends, widen * widths, grey)
    panel(axes, box, title)
    if springs.box is not None:
        from matplotlib.patches import Rectangle  # noqa: PLC0415  # heavy, and only here

        left, right = max(box[0], 0.0), min(box[2], springs.box[0])
        bottom, top = max(box[1], 0.0), min(box[3], springs.box[1])
        inside = Rectangle((left, bottom), max(right - left, 0.0), max(top - bottom, 0.0), transform=axes.transData)
        artist.set_clip_path(inside)


def _in_view(springs: Springs, box: Box) -> tuple[NDArray[np.float64], NDArray[np.int32], NDArray[np.float64]]:
    """Points, and pairs (k, 2) of them with forces (k,) of the springs whose bounding box meets the region."""
    pairs, points, forces = springs.springs, springs.points, springs.forces
    if springs.box is not None:
        ends, origin = images(points, pairs, springs.box)
        points, forces = ends.reshape(-1, 2), forces[origin]
        pairs = np.arange(len(points), dtype=np.int32).reshape(-1, 2)
    seen = np.ones(len(pairs), dtype=bool)
    for axis in (0, 1):  # one coordinate after the other, to spare memory
        one, two = points[pairs[:, 0], axis], points[pairs[:, 1], axis]
        seen &= (np.minimum(one, two) < box[2 + axis]) & (np.maximum(one, two) > box[axis])
    return points, pairs[seen], forces[seen]


def _lines(axes: Any, ends: NDArray[np.float64], widths: NDArray[np.float64], grey: NDArray[np.float64]) -> Any:
    """Add lines as vectors."""
    from matplotlib.collections import LineCollection  # noqa: PLC0415  # heavy, and only here

    lines = LineCollection(
        ends,  # type: ignore[arg-type]  # takes arrays
        linewidths=widths,
        colors=np.repeat(grey[:, None], 3, axis=1),
        capstyle="round",
        rasterized=True,
    )
    return axes.add_collection(lines)


def _crowd(axes: Any, ends: NDArray[np.float64], widths: NDArray[np.float64], grey: NDArray[np.float64]) -> Any:
    """Add lines as an image."""
    from vasculo.draw.crowd import Crowd  # noqa: PLC0415  # brings Numba, and only here

    return axes.add_artist(Crowd(*(values.astype(np.float32) for values in (ends, widths, grey))))
