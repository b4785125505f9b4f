"""What a plexus is fitted to: a picture, a domain or a run, and its table."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from math import pi
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import InputError
from vasculo.measure.morphometry import SMALLEST, domain_of, morphometry
from vasculo.plexus.image import ImageExtraction, Pictured, domain_from_image
from vasculo.store.read import open_run
from vasculo.study.match.sample import Wanted
from vasculo.study.picture_file import read_picture

if TYPE_CHECKING:
    from vasculo.geometry.domain import Domain
    from vasculo.measure.morphometry import Morphometry

FEWEST = 20
"""Fewest whole islands that are fitted: below, chance decides on the table."""
MOST_SMALLEST = 0.25
"""Largest share of the mean area that the smallest island may have."""
VESSELS = 0.1, 0.8
"""Shares of vessels between which the model has plexuses."""


@dataclass(frozen=True, eq=False)
class Target:
    """What is fitted to.

    Attributes
    ----------
    name : str
        What it was read from.
    domain : Domain
        Its islands and vessels.
    table : Morphometry
        Its numbers.
    wanted : Wanted
        What they ask of a plexus.
    mark : str
        The same for the same outlines, to tell whether a fit that goes on has the same target.
    """

    name: str
    domain: Domain
    table: Morphometry
    wanted: Wanted
    mark: str


def target_of(image: object, parameters: ImageExtraction | None = None, page: int = 1) -> Target:
    """Read and measure what is fitted to.

    Parameters
    ----------
    image : path, array, Domain, Pictured or Run
        A picture file or the folder of a run, or what has been read already.
    parameters : ImageExtraction, optional
        How a picture is read.
    page : int
        Page of a picture file with several.

    Returns
    -------
    Target

    Raises
    ------
    InputError
        When it cannot be read, has fewer than 20 whole islands, or a share of vessels that no plexus has.
    """
    name, pattern = "picture", image
    if isinstance(image, str | Path):
        path = Path(image)
        name = path.name
        pattern = open_run(path) if path.is_dir() else domain_from_image(read_picture(path, page)[0], parameters)
    elif isinstance(image, np.ndarray):
        pattern = domain_from_image(image, parameters)
    domain = domain_of(pattern)
    smallest, reading = SMALLEST, None
    if isinstance(pattern, Pictured):
        reading = parameters or ImageExtraction()
        smallest = max(smallest, pi * reading.smallest_radius**2 / float(domain.pillar_areas.mean()))
    if smallest > MOST_SMALLEST:
        raise InputError(
            f"{name}: islands are kept from {100 * smallest:.0f} % of their mean area on, at most "
            f"{100 * MOST_SMALLEST:.0f} % can be fitted: lower the smallest radius, or take a picture with more pixels"
        )
    try:
        table = morphometry(pattern, smallest=smallest)
    except InputError as error:
        raise InputError(f"{name} cannot be fitted: {error}") from None
    if table.whole < FEWEST:
        raise InputError(
            f"{name} cannot be fitted: it has {table.whole} whole islands and {table.cut} cut ones, at least {FEWEST} "
            "whole ones are needed"
        )
    low, high = VESSELS
    if not low <= table.vessel_fraction <= high:
        raise InputError(
            f"{name} cannot be fitted: vessels take {100 * table.vessel_fraction:.0f} % of it, a plexus has "
            f"{100 * low:.0f} to {100 * high:.0f} %: check which side of the threshold is vessel"
        )
    x0, y0, x1, y1 = table.window
    pixels = None if reading is None else table.spacing
    wanted = Wanted(table.islands, (x1 - x0) / (y1 - y0), table.vessel_fraction, smallest, pixels, reading)
    outlines = np.concatenate([domain.outer, *domain.pillars]).round(6)
    return Target(name, domain, table, wanted, hashlib.sha256(outlines.tobytes()).hexdigest()[:16])
