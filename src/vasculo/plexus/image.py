"""From a picture of a vessel network to the flow domain: avascular islands become pillars, vessels the fluid.

The steps, in order: grey values to levels (`image_levels`), vessels that lead from inlet to outlet and the islands
between them (`image_islands`), passages of a given least width (`clearing`), even outlines, the frame (`image_frame`).
A model length is a pixel.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import shapely

from vasculo.errors import ComputationError, InputError
from vasculo.geometry.domain import Domain
from vasculo.geometry.neighbours import as_polygons
from vasculo.plexus.clearing import GAP_SHARE, HALVINGS, clear, even_outlines
from vasculo.plexus.image_frame import outer_boundary
from vasculo.plexus.image_islands import find_islands, island_shapes
from vasculo.plexus.image_levels import grey_values, level_field
from vasculo.plexus.image_parameters import SIDES, ImageExtraction, Side
from vasculo.plexus.image_report import ImageReport, make_report
from vasculo.plexus.width import FIRST_STEP

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from vasculo.plexus.clearing import Cleared
    from vasculo.plexus.image_islands import Islands

    Floats = NDArray[np.float64]
    Mask = NDArray[np.bool_]
    Shapes = NDArray[np.object_]

__all__ = ["SIDES", "ImageExtraction", "ImageReport", "Pictured", "domain_from_image"]

SPACING = 0.18
"""Distance of outline nodes (R0) when none is given: that of the membranes in the remodelling."""
ROUNDING = 0.3
"""Radius of rounded corners over the distance of nodes; at least the smoothing."""


@dataclass(frozen=True, eq=False)
class Pictured:
    """A domain and the picture it comes from.

    Attributes
    ----------
    domain : Domain
        Model length: a pixel. The flow runs along x, so a picture whose inlet is not at its left is turned. Sides
        "left", "right", "bottom", "top", and "wall" along islands that are wall.
    report : ImageReport
        What was found, dropped and changed.
    mask : (h, w) bool
        The vessels that lead from inlet to outlet, as the (cropped) picture lies.
    lost : (h, w) bool
        Vessel pixels that were left out.
    cut : (p,) bool
        Whether a side of the picture cuts the pillar.
    inlet : {"left", "top", "right", "bottom"}
        Side of the picture at which the blood enters.
    """

    domain: Domain
    report: ImageReport
    mask: Mask
    lost: Mask
    cut: Mask
    inlet: Side

    def in_picture(self, points: Floats) -> Floats:
        """Where points of the domain lie in the (cropped) picture.

        Parameters
        ----------
        points : (k, 2) float64
            Model length.

        Returns
        -------
        (k, 2) float64
            x to the right and y down from the upper left corner of the upper left pixel (pixels).
        """
        height, width = self.mask.shape
        quarters = SIDES.index(self.inlet)
        turned = (height, width) if quarters % 2 else (width, height)
        u, v = (points - 0.5 * np.array(turned)).T
        for _ in range(quarters):
            u, v = v, -u
        return np.column_stack((0.5 * width + u, 0.5 * height - v))


def domain_from_image(picture: ArrayLike, parameters: ImageExtraction | None = None) -> Pictured:
    """Make the flow domain of a picture of a vessel network.

    Parameters
    ----------
    picture : (h, w), (h, w, 3) or (h, w, 4) array of bool, integers or floats
        Grey, RGB or RGBA; a mask or a micrograph.
    parameters : ImageExtraction, optional
        Defaults to `ImageExtraction()`.

    Returns
    -------
    Pictured

    Raises
    ------
    InputError
        When it is no picture, has one colour or values that are not finite, the threshold is outside its grey values,
        no vessel leads from inlet to outlet, no pillar is there or left, or scikit-image is missing.
    ComputationError
        When outlines cannot be made even and apart.

    Notes
    -----
    Islands that reach from inlet to outlet along the border are wall. What else the sides cut is a pillar, flush with
    the plain strip at inlet and outlet, and half of the narrowest passage from the sides beside the flow, which are
    mirror walls (with border "closed": wall too).

    Examples
    --------
    >>> import numpy as np
    >>> import vasculo as vc
    >>> y, x = np.mgrid[0:60, 0:90]
    >>> vessels = np.minimum(abs(x % 30 - 15), abs(y % 30 - 15)) < 5  # a grid of streets
    >>> found = vc.domain_from_image(vessels)
    >>> found.domain.bounds[2] > 90, len(found.domain.pillars)
    (True, 12)
    """
    wanted = ImageExtraction() if parameters is None else parameters
    grey = grey_values(picture, wanted.crop)
    levels, threshold = level_field(grey, wanted)
    islands = find_islands(np.rot90(levels, wanted.quarters), wanted.smallest_radius)
    height, width = islands.levels.shape
    wall = islands.beside & (islands.spanning | (wanted.border == "closed"))
    if wall.all():
        raise InputError(f"no pillars: all {len(wall)} islands belong to the border: take a larger crop or border open")
    unit = math.sqrt(float(islands.areas[~wall].mean()) / math.pi)
    narrowest = max(1.0, FIRST_STEP * unit) if wanted.narrowest is None else wanted.narrowest
    spacing = SPACING * unit if wanted.spacing is None else wanted.spacing
    rounding = max(wanted.smoothing, ROUNDING * spacing)
    raw = _raw_shapes(islands, wall, narrowest, rounding)
    cleared = _clear(raw, width, height, narrowest, rounding, wanted.smallest_radius)
    pillars = ~wall[cleared.void]
    if not pillars.any():
        raise InputError(
            f"no pillar is left of {np.count_nonzero(~wall)} islands when passages are {narrowest:.3g} pixels wide: "
            "lower narrowest or smallest_radius"
        )
    shapes = cleared.shapes[pillars]
    radius = math.sqrt(float(shapely.area(shapes).mean()) / math.pi)
    walls = cleared.shapes[~pillars]
    domain = _domain(shapes, walls, (width, height), wanted.strip * radius, spacing, narrowest)
    report = make_report(
        islands,
        wall,
        raw,
        cleared,
        domain,
        size=(grey.shape[1], grey.shape[0]),
        threshold=threshold,
        narrowest=narrowest,
        spacing=spacing,
    )
    back = -wanted.quarters
    return Pictured(
        domain,
        report,
        np.rot90(islands.levels > 0.0, back),
        np.rot90(islands.lost, back),
        islands.cut[cleared.void][pillars],
        wanted.inlet,
    )


def _raw_shapes(islands: Islands, wall: Mask, narrowest: float, rounding: float) -> Shapes:
    """Outlines of the islands without dead ends too narrow to keep; pillars end at the picture's border.

    Closing an island by half the narrowest passage fills blind vessels in it that are narrower than that.
    """
    height, width = islands.levels.shape
    shapes = island_shapes(islands, math.ceil(2.0 * rounding + narrowest) + 1)
    shapes = np.asarray(shapely.buffer(shapely.buffer(shapes, 0.5 * narrowest), -0.5 * narrowest))
    room = shapely.box(0.0, 0.5 * narrowest, width, height - 0.5 * narrowest)
    shapes[~wall] = shapely.intersection(shapes[~wall], room)
    return shapes


def _clear(raw: Shapes, width: int, height: int, narrowest: float, rounding: float, smallest: float) -> Cleared:
    """Widen the passages; the picture's border is no matter here."""
    far = 2.0 * (width + height)
    everywhere = shapely.box(-far, -far, width + far, height + far)
    return clear(raw, everywhere, narrowest, "minimum", rounding, smallest)


def _domain(
    shapes: Shapes, walls: Shapes, size: tuple[int, int], strip: float, spacing: float, narrowest: float
) -> Domain:
    """Put the pillars into their frame, with finer nodes where chords would come too close to the border."""
    outlines, _ = even_outlines(shapes, spacing, narrowest)
    for halving in range(HALVINGS + 1):
        finer = spacing / 2.0**halving
        outer, sides = outer_boundary(*size, strip, walls, finer)
        ends = np.stack((outer, np.roll(outer, -1, axis=0)), axis=1)
        wall = shapely.multilinestrings(shapely.linestrings(ends[np.array(sides) == "wall"]))
        polygons, border = as_polygons(outlines), shapely.LinearRing(outer)
        close = shapely.distance(polygons, border) < GAP_SHARE * 0.5 * narrowest
        close |= shapely.distance(polygons, wall) < GAP_SHARE * narrowest
        if border.is_simple and not close.any():
            return Domain(outer, outlines, sides)
        for index in np.flatnonzero(close):
            outlines[index] = even_outlines(shapes[[index]], 0.5 * finer, narrowest)[0][0]
    raise ComputationError(
        f"{np.count_nonzero(close)} of {len(outlines)} pillars stay too close to the border for a narrowest passage of "
        f"{narrowest:.3g}: raise narrowest or lower spacing, now {spacing:.3g}"
    )
