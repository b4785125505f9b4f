"""Artificial plexuses: blocks of rounded Voronoi cells between mirror walls, and the single disk.

These are the small layouts on which the flow-driven stage is studied by itself (Szczerba & Szekely 2005, Figs 4, 5).
The paper does not say how its layouts were drawn; the Voronoi block is ours.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import shapely
from scipy.optimize import brentq
from scipy.spatial import Voronoi

from vasculo.errors import InputError
from vasculo.geometry.domain import Domain
from vasculo.geometry.neighbours import as_polygons
from vasculo.geometry.outline import as_outline, is_number, resample

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

BLOCK_ASPECT = 13.0 / 9.0
"""Width over height of the block of cells when no size is asked for."""
LLOYD_SWEEPS = 3
"""Few sweeps: cells of unlike shape (mean aspect ratio about 1.4) with no preferred direction."""
ROUNDING = 0.3
"""Radius of the rounded corners, in mean pillar radii."""
WIDEST_CHANNEL = 3.0
"""Widest channel, in mean pillar radii: beyond it the pillars stand alone and the block is mostly fluid."""
MOST_PILLARS = 100_000
"""Most pillars of a block."""
FEWEST_NODES, MOST_NODES = 8, 100_000
"""Fewest and most nodes of a disk's outline."""
LARGEST = 1e6
"""Longest width, height or radius (R0, or model length for the disk)."""
WIDEST_PAD = 100.0
"""Longest plain strip before and behind the block (R0)."""
FINEST = 1e-3
"""Shortest distance between outline nodes (R0)."""
THINNEST = 0.35
"""Pillars with an equivalent radius below this many mean pillar radii are dropped."""


def voronoi_plexus(
    pillars: int = 16,
    *,
    width: float | None = None,
    height: float | None = None,
    channel: float = 0.6,
    pad: float = 1.5,
    seed: int = 0,
    spacing: float = 0.18,
) -> Domain:
    """Make a dense block of pillars: inset, rounded Voronoi cells of relaxed random points.

    The unit of length is R0, the radius of the mean pillar: with neither width nor height given, the block (13 : 9)
    is sized so that the mean pillar has radius 1 (within 0.5 %, resampling cuts the corners).

    Parameters
    ----------
    pillars : int
        Number of cells, 1 to 100,000. A cell too thin for a pillar is dropped, so there may be a few pillars less.
    width, height : float, optional
        Size of the whole box, pads included [R0], above 0 and at most 1e6. Give both or neither; with both, the mean
        radius follows from the box and is only about 1 (1.2 for 16 pillars in 16 x 9).
    channel : float
        Width of the channels between pillars [R0], above 0 and at most 3. At the top and bottom, mirror walls, the
        pillars keep half of it.
    pad : float
        Plain strip before and behind the block [R0], 0 to 100.
    seed : int
        Seed of the random points.
    spacing : float
        Distance between outline nodes [R0], at least 0.001.

    Returns
    -------
    Domain
        A rectangle with its corner at the origin, sides "bottom", "right", "top", "left".

    Raises
    ------
    InputError
        When a value is outside its range, only one of width and height is given, or no pillar is left.
    """
    if (width is None) != (height is None):
        raise InputError(f"give both width and height or neither, got width {width} and height {height}")
    for name, value in {"channel": channel, "spacing": spacing, "width": width, "height": height}.items():
        if value is not None:
            _check_length(name, value)
    if spacing < FINEST:
        raise InputError(f"spacing must be at least {FINEST:g} mean pillar radii, got {spacing:g}")
    if channel > WIDEST_CHANNEL:
        raise InputError(f"channel must be at most {WIDEST_CHANNEL:g} mean pillar radii, got {channel:g}")
    if not _is_whole(pillars) or not 1 <= pillars <= MOST_PILLARS:
        raise InputError(f"pillars = {pillars!r} must be a whole number: at least 1 pillar, at most {MOST_PILLARS}")
    if not is_number(pad) or not 0.0 <= pad <= WIDEST_PAD:
        raise InputError(f"pad must lie from 0 to {WIDEST_PAD:g} mean pillar radii, got {pad!r}")
    rng = np.random.default_rng(seed)
    if width is not None and height is not None:
        block = np.array([width - 2.0 * pad, height])
        if block[0] <= channel or height <= channel:
            raise InputError(f"no room for pillars: block {block[0]:g} x {height:g}, channel {channel:g}")
        cells = _cells(pillars, block, rng)
    else:
        block = np.sqrt(pillars * np.array([BLOCK_ASPECT, 1.0 / BLOCK_ASPECT]))
        cells = _cells(pillars, block, rng)
        scale = _unit_scale(cells, channel)
        block, cells = block * scale, [cell * scale for cell in cells]
    rings = [as_outline(shapely.get_coordinates(shape.exterior)) for shape in _inset(cells, channel)]
    outlines = [resample(ring + np.array([pad, 0.0]), spacing) for ring in rings]
    if not outlines:
        size = f"{block[0]:.3g} x {block[1]:.3g}"
        raise InputError(f"no pillar is left of {pillars} cells in a block of {size}: lower channel, now {channel:g}")
    return Domain.rectangle(float(block[0] + 2.0 * pad), float(block[1]), outlines)


def disk_domain(width: float = 12.0, height: float = 8.0, radius: float = 1.0, nodes: int = 35) -> Domain:
    """Make a box with one disk in its middle (Szczerba & Szekely 2005, Fig 4).

    Parameters
    ----------
    width, height : float
        Size of the box [model length], above 0 and at most 1e6; corner at the origin.
    radius : float
        Radius of the disk [model length], above 0 and at most 1e6.
    nodes : int
        Nodes of the disk's outline, evenly spaced on the circle; 8 to 100,000.

    Returns
    -------
    Domain
        Sides "bottom", "right", "top", "left".

    Raises
    ------
    InputError
        When a value is outside its range, or the disk does not fit.
    """
    for name, value in {"width": width, "height": height, "radius": radius}.items():
        _check_length(name, value)
    if not _is_whole(nodes) or not FEWEST_NODES <= nodes <= MOST_NODES:
        raise InputError(f"nodes must be a whole number from {FEWEST_NODES} to {MOST_NODES}, got {nodes!r}")
    if not 2.0 * radius < min(width, height):
        box = f"{width:g} x {height:g}"
        raise InputError(f"a disk of radius {radius:g} does not go into {box}: lower radius or raise width and height")
    angle = 2.0 * np.pi * np.arange(nodes) / nodes
    disk = np.stack([0.5 * width + radius * np.cos(angle), 0.5 * height + radius * np.sin(angle)], axis=1)
    return Domain.rectangle(width, height, [disk])


def _is_whole(value: object) -> bool:
    """Whether a value is a whole number (truth values are not)."""
    return isinstance(value, int | np.integer) and not isinstance(value, bool)


def _check_length(name: str, value: float) -> None:
    """Refuse what is no length, and what is too long."""
    if not is_number(value) or not 0.0 < value < np.inf:
        raise InputError(f"{name} must be positive and finite, got {value!r}")
    if value > LARGEST:
        raise InputError(f"{name} must be at most {LARGEST:g}, got {value:g}")


def _cells(count: int, block: Floats, rng: np.random.Generator) -> list[Floats]:
    """Voronoi cells of relaxed random points in a block, each as a closed ring's nodes.

    Strategy: points mirrored in the four walls bound the cells exactly by the walls, so no cell is clipped.
    """
    points = rng.random((count, 2)) * block
    for sweep in range(LLOYD_SWEEPS + 1):
        mirrored = [points]
        for axis in (0, 1):
            for wall in (0.0, block[axis]):
                image = points.copy()
                image[:, axis] = 2.0 * wall - image[:, axis]
                mirrored.append(image)
        diagram = Voronoi(np.concatenate(mirrored))
        rings = [diagram.vertices[diagram.regions[diagram.point_region[i]]] for i in range(count)]
        if sweep == LLOYD_SWEEPS:
            break
        points = shapely.get_coordinates(shapely.centroid(as_polygons(rings)))
    return rings


def _inset(cells: list[Floats], channel: float) -> NDArray[np.object_]:
    """Cells moved inward by half a channel, corners rounded, thin ones dropped, as shapely polygons."""
    shapes = shapely.buffer(as_polygons(cells), -0.5 * channel - ROUNDING)
    rounded = np.asarray(shapely.buffer(shapes, ROUNDING, quad_segs=16))
    areas = shapely.area(rounded)
    if not np.any(areas > 0.0):
        return np.empty(0, dtype=object)
    return rounded[areas > np.mean(areas[areas > 0.0]) * THINNEST**2]


def _unit_scale(cells: list[Floats], channel: float) -> float:
    """Find the factor on cells of mean area 1 that gives the mean pillar radius 1 for the given channel."""

    def excess(scale: float) -> float:
        shapes = _inset([cell * scale for cell in cells], channel)
        return float(np.mean(shapely.area(shapes))) - np.pi if len(shapes) else -np.pi

    return float(brentq(excess, 0.5, 4.0 + 2.0 * channel, xtol=1e-4))
