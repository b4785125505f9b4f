"""One grown plexus and its table: what an evaluation of the fit is made of."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
import shapely
from scipy.optimize import brentq

from vasculo.errors import ComputationError, InputError
from vasculo.measure.morphometry import default_window, morphometry
from vasculo.plexus.extract import extract_domain
from vasculo.plexus.outlines import repaired
from vasculo.plexus.parameters import Extraction
from vasculo.plexus.rules import near_pairs
from vasculo.plexus.survey import survey
from vasculo.plexus.width import cleared_at
from vasculo.study.match.painting import paint, read_painted
from vasculo.tissue.lattice import lattice
from vasculo.tissue.spacing import expected_spacing
from vasculo.tissue.vasculogenesis import grow_plexus

if TYPE_CHECKING:
    from collections.abc import Sequence

    from vasculo.geometry.domain import Domain
    from vasculo.measure.morphometry import Morphometry, Window
    from vasculo.plexus.image import ImageExtraction
    from vasculo.springs.network import SpringNetwork
    from vasculo.tissue.parameters import Vasculogenesis

NODES = 1.25
"""Nodes of a tissue over its area in squares of the mean spring length."""
MOST_NODES = 250_000
"""Larger tissues are not grown for a fit."""
FRAME = 2.0
"""Strip along each edge of the tissue, over the spacing of the islands, in which the window does not lie."""
SWALLOWED = 1.25
"""Distance of the islands over that of the voids by the measured law: small voids vanish where vessels are wide."""
ALIKE = 0.5
"""Power of the correlation length with which thresholds that are alike push the islands apart."""
FAR_OFF = 0.7
"""A tissue with fewer of the wanted islands than this share is grown anew, larger."""
FARTHEST = 20.0
"""Tissues whose islands are farther apart (spring lengths) are not grown for a fit: they cost too much."""
ALMOST, TRIES = 0.02, 6
"""A window has the wanted islands when it has this share more or less; so often its size is corrected."""
WIDTHS = 0.05, 4.0
"""Widths that are added to the cords (spring lengths)."""


@dataclass(frozen=True)
class Wanted:
    """What a plexus is compared with.

    Attributes
    ----------
    islands : float
        Islands in the window.
    aspect : float
        Width of the window over its height.
    vessel_fraction : float
        Area of the vessels over that of the window.
    smallest : float
        Smallest island over the mean area, as for `morphometry`.
    pixels : float, optional
        Spacing of the islands in pixels, of a picture: plexuses are painted with as many and read as it was.
    reading : ImageExtraction, optional
        How it was read.
    """

    islands: float
    aspect: float
    vessel_fraction: float
    smallest: float
    pixels: float | None = None
    reading: ImageExtraction | None = None

    def of(self, islands: float, aspect: float = 1.0) -> Wanted:
        """Ask for another number of islands, in a window of another shape."""
        return replace(self, islands=islands, aspect=aspect)

    @property
    def pillars(self) -> float:
        """Pillars of a square tissue out of which the window can be cut."""
        across = np.sqrt(self.islands * max(self.aspect, 1.0 / self.aspect))
        return float((across + 2.0 * FRAME) ** 2)

    def room(self, apart: float) -> float:
        """Most islands of a window of this shape for which a tissue is grown, at their distance in spring lengths."""
        across = np.sqrt(MOST_NODES / NODES) / apart - 2.0 * FRAME
        return float(across**2 / max(self.aspect, 1.0 / self.aspect))


@dataclass(frozen=True, eq=False)
class Sample:
    """A plexus that was grown for comparison.

    Attributes
    ----------
    domain : Domain
        Its pillars and tubules; where it was painted, as they were read from that.
    table : Morphometry
        Of a window in its middle.
    scale : float
        Unit of both in model lengths: 1, or a pixel.
    nodes, seed : int
        Of its tissue.
    spring : float
        Mean spring length of the tissue before growth (model length; its side is 1).
    lumen_width : float
        Width that was added to every cord, so that the plexus has the wanted share of vessels (spring lengths).
    """

    domain: Domain
    table: Morphometry
    scale: float
    nodes: int
    seed: int
    spring: float
    lumen_width: float

    @property
    def spacing(self) -> float:
        """Distance of the islands in model lengths."""
        return self.table.spacing * self.scale

    @property
    def apart(self) -> float:
        """Distance of the islands in spring lengths."""
        return self.spacing / self.spring


def grow_samples(
    settings: Vasculogenesis, wanted: Wanted, seeds: Sequence[int], apart: float | None = None
) -> list[Sample]:
    """Grow a plexus of each seed, in tissues that are large enough for the wanted number of islands.

    Parameters
    ----------
    settings : Vasculogenesis
    wanted : Wanted
    seeds : sequence of int
        Of tissue and thresholds.
    apart : float, optional
        Distance of the islands in mean spring lengths. When left out it is guessed from the measured law; the first
        tissue shows how good the guess is, and is grown anew where it is too small.

    Returns
    -------
    list of Sample

    Raises
    ------
    InputError, ComputationError
        When these settings give no plexus, or none with enough islands.
    """
    near = apart
    if near is None:
        alike = max(settings.threshold_correlation, 1.0) ** ALIKE
        near = expected_spacing(lattice(400), settings) * SWALLOWED * alike
        first = grow_sample(settings, wanted, seeds[0], near)
        if first.table.islands < FAR_OFF * wanted.islands:
            first = grow_sample(settings, wanted, seeds[0], first.apart)
        near = first.apart
        return [first, *(grow_sample(settings, wanted, seed, near) for seed in seeds[1:])]
    return [grow_sample(settings, wanted, seed, near) for seed in seeds]


def try_sample(settings: Vasculogenesis, wanted: Wanted, seed: int, apart: float) -> Sample | None:
    """Grow a plexus as `grow_sample` does, with fewer islands where the tissue would be too large; None without one."""
    apart = min(apart, FARTHEST)
    try:
        return grow_sample(settings, replace(wanted, islands=min(wanted.islands, wanted.room(apart))), seed, apart)
    except (InputError, ComputationError):
        return None


def grow_sample(settings: Vasculogenesis, wanted: Wanted, seed: int, apart: float) -> Sample:
    """Grow a plexus, and measure a window in its middle with the wanted shape, islands and share of vessels."""
    nodes = round(NODES * wanted.pillars * apart**2)
    if apart > FARTHEST:
        raise InputError(f"islands {apart:.3g} spring lengths apart, tissues are grown for at most {FARTHEST:g}")
    if nodes > MOST_NODES:
        raise InputError(
            f"{wanted.islands:.0f} islands {apart:.3g} spring lengths apart need a tissue of {nodes} nodes, at most "
            f"{MOST_NODES} are grown for a fit: take a crop of the picture"
        )
    tissue = lattice(nodes, seed)
    plexus = grow_plexus(tissue, settings, seed)
    width = find_width(plexus, wanted)
    domain = extract_domain(plexus, Extraction(lumen_width=width))
    return Sample(*measure_window(domain, wanted), nodes, seed, float(np.mean(tissue.rest_lengths)), width)


def find_width(plexus: SpringNetwork, wanted: Wanted) -> float:
    """Width to add to every cord (spring lengths) so that the vessels take the wanted share of the middle."""
    found = survey(plexus)
    found.require_voids()
    unit, box = found.length_unit, shapely.box(*found.bounds)
    raw = np.array([repaired(void.outline)[0] for void in found.voids], dtype=object)
    near = near_pairs(raw, WIDTHS[1] * unit)
    # about the window that will be measured: in the middle, with the wanted islands out of all pillars
    half_y = 0.5 * float(np.sqrt(box.area * wanted.islands / wanted.pillars / wanted.aspect))
    half_x, middle = half_y * wanted.aspect, box.centroid
    inside = shapely.box(middle.x - half_x, middle.y - half_y, middle.x + half_x, middle.y + half_y)

    def missing(width: float) -> float:
        shapes = cleared_at(raw, near, box, width * unit, unit, Extraction(lumen_width=width)).shapes
        area = shapely.area(shapes)
        shapes = shapes[area > wanted.smallest * area.mean()] if len(shapes) else shapes
        return (
            wanted.vessel_fraction - 1.0 + float(shapely.area(shapely.intersection(shapes, inside)).sum()) / inside.area
        )

    low, high = WIDTHS
    if missing(low) < 0.0:
        return low
    if missing(high) > 0.0:
        raise ComputationError(
            f"vessels take {wanted.vessel_fraction - missing(high):.2f} of the plexus where each is {high:g} spring "
            f"lengths wider than its cord, {wanted.vessel_fraction:.2f} are wanted"
        )
    return float(f"{brentq(missing, low, high, xtol=1e-3):.4g}")


def measure_window(domain: Domain, wanted: Wanted) -> tuple[Domain, Morphometry, float]:
    """Measure a window in the middle, in which the wanted number of islands is expected, as far as there is room.

    Returns what was measured, its table, and its unit in model lengths, see `Sample`.
    """
    x0, y0, x1, y1 = default_window(domain, domain)
    largest = height = min(y1 - y0, (x1 - x0) / wanted.aspect)
    middle = 0.5 * np.array([x0 + x1, y0 + y1])
    pixel = None
    if wanted.pixels is not None:
        pixel = morphometry(domain, smallest=wanted.smallest).spacing / wanted.pixels
    tried = []
    for _ in range(TRIES):
        half = 0.5 * height * np.array([wanted.aspect, 1.0])
        tried.append(_measured(domain, tuple(np.concatenate((middle - half, middle + half)).tolist()), wanted, pixel))
        ratio = wanted.islands / tried[-1][1].islands
        if abs(ratio - 1.0) < ALMOST or (ratio > 1.0 and height == largest):
            break
        height = min(largest, height * max(0.5, float(np.sqrt(ratio))))
    return min(tried, key=lambda each: abs(each[1].islands - wanted.islands))


def _measured(domain: Domain, window: Window, wanted: Wanted, pixel: float | None) -> tuple[Domain, Morphometry, float]:
    """Measure a window, painted and read where it is compared with a picture."""
    if pixel is None or wanted.reading is None:
        return domain, morphometry(domain, window=window, smallest=wanted.smallest), 1.0
    x0, y0, x1, y1 = window
    read = read_painted(paint(domain, window, (round((y1 - y0) / pixel), round((x1 - x0) / pixel))), wanted.reading)
    return read.domain, morphometry(read, smallest=wanted.smallest), pixel
