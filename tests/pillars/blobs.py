"""Borders and random outlines for the tests of valid geometry."""

from __future__ import annotations

import numpy as np
import shapely
from tests.pillars.shapes import disk

from vasculo.geometry.domain import Domain
from vasculo.geometry.outline import as_outline, is_simple, resample
from vasculo.pillars.outlines import MARGIN, inner_polygon

SPACING = 0.18
BORDERS = {
    "box": Domain.rectangle(10.0, 6.0),
    "step": Domain(
        [(0, 0), (4, 0), (4, 1.5), (6, 1.5), (6, 0), (10, 0), (10, 6), (0, 6)],
        (),
        ("b1", "b2", "b3", "b4", "b5", "right", "top", "left"),
    ),
    "slanted": Domain([(0, 0), (10, 3), (10, 8), (0, 5)], (), ("bottom", "right", "top", "left")),
    "jagged": Domain(
        [(0, 0), (2, 0.4), (4, 0), (5, 1.3), (6, 0), (8, 0.3), (10, 0), (10, 6), (5, 4.5), (0, 6)],
        (),
        ("a", "b", "c", "d", "e", "f", "right", "t1", "t2", "left"),
    ),
    "round": Domain(
        disk(40, 4.0, 5.0, 4.0),
        (),
        ["right" if i in {0, 39} else "left" if i in {19, 20} else "wall" for i in range(40)],
    ),
}


def inside(outline, border):
    """The largest piece of a polygon inside the margin of a border, evenly spaced; None if it is too small."""
    limit = inner_polygon(BORDERS[border].outer, MARGIN * SPACING)
    pieces = shapely.get_parts(shapely.intersection(shapely.Polygon(outline), limit))
    largest = max(pieces, key=lambda piece: piece.area, default=shapely.Polygon())
    if largest.area < 0.05:
        return None
    outline = resample(as_outline(largest.exterior.coords), SPACING, corners=30.0)
    return outline if is_simple(outline) else None


def blob(random, radius, x, y):
    """A round outline with random waves, star-shaped and so simple; (200, 2)."""
    angle = np.linspace(0, 2 * np.pi, 200, endpoint=False)
    waves = np.arange(2, 6)[:, None]
    size = random.normal(0, 0.25, (2, 4, 1)) / waves
    r = radius * np.maximum(1 + (size[0] * np.cos(waves * angle) + size[1] * np.sin(waves * angle)).sum(axis=0), 0.3)
    return np.column_stack((x + r * np.cos(angle), y + r * np.sin(angle)))


def scene(seed, border, most=9):
    """Up to `most` random outlines inside a border; they may overlap."""
    random = np.random.default_rng(seed)
    found = [
        inside(blob(random, random.uniform(0.15, 1.3), random.uniform(0, 10), random.uniform(-0.3, 7)), border)
        for _ in range(random.integers(1, most))
    ]
    return [outline for outline in found if outline is not None]
