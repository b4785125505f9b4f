"""The outer boundary of a picture's domain: its frame, plain strips before and behind, and islands that are wall."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import shapely

from vasculo.errors import InputError
from vasculo.geometry.outline import segment_lengths
from vasculo.plexus.outlines import ring_nodes

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]
    Shapes = NDArray[np.object_]

CORNER = np.cos(np.radians(50.0))
"""Nodes at which the outline turns by more than 50 degrees stay where they are."""
STRAIGHT = 0.02
"""Nodes of a wall closer than this share of the spacing to a straight line are left out."""
ON_SIDE = 1e-9
"""Distance from a side, as a share of the width, within which a segment lies on it."""


def outer_boundary(
    width: float, height: float, strip: float, walls: Shapes, spacing: float
) -> tuple[Floats, tuple[str, ...]]:
    """Outline of the frame with its strips, less the walls, with evenly spaced nodes along the walls.

    Parameters
    ----------
    width, height : float
        Size of the picture (pixels), lower left corner at the origin.
    strip : float
        Length of the plain strips at the left and right (pixels).
    walls : (n,) array of shapely.Polygon
        Islands that are wall; they go on beyond the lower and upper side.
    spacing : float
        Distance between nodes along the walls (pixels).

    Returns
    -------
    outer : (k, 2) float64
        Counter-clockwise.
    sides : tuple of k str
        "left", "right", "bottom", "top" and "wall".

    Raises
    ------
    InputError
        When the walls leave no way from left to right.
    """
    frame = shapely.box(-strip, 0.0, width + strip, height)
    picture = shapely.box(0.0, -height, width, 2.0 * height)
    rest = shapely.difference(frame, shapely.union_all(shapely.intersection(walls, picture)))
    parts = [part for part in shapely.get_parts(rest) if part.bounds[0] < 0.0 and part.bounds[2] > width]
    if not parts:
        raise InputError("no vessel leads past the islands at the lower and upper side: lower narrowest or smoothing")
    ring = ring_nodes(shapely.simplify(parts[0], STRAIGHT * spacing))
    names = _names(ring, width, height, strip)
    breaks = _corners(ring) | (names != np.roll(names, 1))
    first = int(np.flatnonzero(breaks)[0])
    ring, names = np.roll(ring, -first, axis=0), np.roll(names, -first)
    starts = np.flatnonzero(np.roll(breaks, -first))
    nodes: list[Floats] = []
    sides: list[str] = []
    for start, end in zip(starts, np.append(starts[1:], len(ring)), strict=True):
        line = np.concatenate((ring[start:end], ring[end % len(ring)][None]))
        even = _even(line, spacing) if names[start] == "wall" else line[[0, -1]]
        nodes.append(even[:-1])
        sides += [str(names[start])] * (len(even) - 1)
    return np.concatenate(nodes), tuple(sides)


def _corners(ring: Floats) -> NDArray[np.bool_]:
    """Nodes at which the ring turns sharply."""
    step = np.roll(ring, -1, axis=0) - ring
    step /= np.hypot(*step.T)[:, None]
    return np.asarray((step * np.roll(step, 1, axis=0)).sum(axis=1) < CORNER)


def _names(ring: Floats, width: float, height: float, strip: float) -> NDArray[np.str_]:
    """Side on which each segment of the ring lies."""
    after = np.roll(ring, -1, axis=0)
    names = np.full(len(ring), "wall", dtype="<U6")
    for name, axis, place in (
        ("left", 0, -strip),
        ("right", 0, width + strip),
        ("bottom", 1, 0.0),
        ("top", 1, height),
    ):
        near = ON_SIDE * width
        names[(np.abs(ring[:, axis] - place) < near) & (np.abs(after[:, axis] - place) < near)] = name
    return names


def _even(line: Floats, spacing: float) -> Floats:
    """Put nodes at equal arc length along an open line; its ends stay."""
    lengths = segment_lengths(line)[:-1]
    arc = np.concatenate(([0.0], np.cumsum(lengths)))
    wanted = np.linspace(0.0, arc[-1], max(1, round(arc[-1] / spacing)) + 1)
    return np.column_stack([np.interp(wanted, arc, line[:, axis]) for axis in (0, 1)])
