"""The report of a picture: what was found, dropped, filled and widened."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

import numpy as np
import shapely

from vasculo.geometry.neighbours import as_polygons, pillar_gaps

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.geometry.domain import Domain
    from vasculo.plexus.clearing import Cleared
    from vasculo.plexus.image_islands import Islands

FEW_PILLARS = 8
"""Fewer pillars make no network: statistics of them mean little."""
TALL = 0.5
"""A pillar taller than this share of the picture's height is a barrier to the flow."""


@dataclass(frozen=True)
class ImageReport:
    """What was found in a picture. Lengths in pixels, areas in square pixels.

    Attributes
    ----------
    width, height : int
        Size of the (cropped) picture.
    threshold : float
        Grey value between vessels and tissue; NaN where it is local.
    islands : int
        Islands found, small ones too.
    pillars, cut, walls : int
        Pillars of the domain, those of them that a side of the picture cuts, and islands that are wall.
    small : int
        Islands dropped because they are small, before or after the passages were widened.
    vanished : int
        Islands of which nothing was left then, or that lay inside another one.
    split : int
        Islands that came apart; their largest piece is the pillar.
    lost_parts, lost_area : int
        Vessel parts that join neither inlet nor outlet, and their area; they are tissue now.
    widened : int
        Passages between islands that were narrower than `narrowest`.
    vessel_fraction : float
        Vessel area over the area of the picture, as it was segmented.
    fluid_fraction : float
        The same in the domain, strips left out.
    narrowest : float
        Passages were widened to this.
    narrowest_gap : float
        Narrowest gap between two pillars of the domain; infinite for a single one.
    narrowest_wall_gap : float
        Narrowest gap between a pillar and the outer boundary.
    mean_radius : float
        R0 = sqrt(mean pillar area / pi).
    spacing : float
        Wanted distance between outline nodes.
    tallest : float
        Height of the tallest pillar across the flow, over that of the picture.
    notes : tuple of str
        What should be looked at.
    """

    width: int
    height: int
    threshold: float
    islands: int
    pillars: int
    cut: int
    walls: int
    small: int
    vanished: int
    split: int
    lost_parts: int
    lost_area: int
    widened: int
    vessel_fraction: float
    fluid_fraction: float
    narrowest: float
    narrowest_gap: float
    narrowest_wall_gap: float
    mean_radius: float
    spacing: float
    tallest: float
    notes: tuple[str, ...]

    def rows(self) -> dict[str, int | float]:
        """Return every number by its name."""
        return {field.name: getattr(self, field.name) for field in fields(self) if field.name != "notes"}


def make_report(
    islands: Islands,
    wall: NDArray[np.bool_],
    raw: NDArray[np.object_],
    cleared: Cleared,
    domain: Domain,
    *,
    size: tuple[int, int],
    threshold: float,
    narrowest: float,
    spacing: float,
) -> ImageReport:
    """Gather the report; see `ImageReport`."""
    height, width = islands.levels.shape
    first, second = shapely.STRtree(raw).query(raw, predicate="dwithin", distance=0.99 * narrowest)
    x0, _, x1, _ = domain.bounds
    strips = (x1 - x0 - width) * height
    polygons = as_polygons(domain.pillars)
    bottom, top = shapely.bounds(polygons)[:, [1, 3]].T
    tallest = float((top - bottom).max()) / height
    fluid = (domain.area - strips) / (width * height)
    notes = []
    if len(domain.pillars) < FEW_PILLARS:
        notes.append(f"few pillars ({len(domain.pillars)}): numbers of the network mean little")
    if tallest > TALL:
        notes.append(f"a pillar takes {tallest:.0%} of the height: it may grow to a barrier across the flow")
    return ImageReport(
        width=size[0],
        height=size[1],
        threshold=threshold,
        islands=len(islands.areas) + islands.small,
        pillars=len(domain.pillars),
        cut=int(np.count_nonzero(islands.cut[cleared.void] & ~wall[cleared.void])),
        walls=int(np.count_nonzero(wall)),
        small=islands.small + cleared.small,
        vanished=cleared.vanished + cleared.nested,
        split=cleared.split,
        lost_parts=islands.lost_parts,
        lost_area=int(np.count_nonzero(islands.lost)),
        widened=int(np.count_nonzero(first < second)),
        vessel_fraction=float(np.mean((islands.levels > 0.0) | islands.lost)),
        fluid_fraction=float(fluid),
        narrowest=narrowest,
        narrowest_gap=float(pillar_gaps(domain.pillars).min()),
        narrowest_wall_gap=float(shapely.distance(polygons, shapely.Polygon(domain.outer).exterior).min()),
        mean_radius=domain.mean_radius,
        spacing=spacing,
        tallest=tallest,
        notes=tuple(notes),
    )
