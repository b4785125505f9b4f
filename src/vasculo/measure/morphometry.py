"""Morphometry: the numbers of a plexus that do not depend on its size, the same from a picture and from a run."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely
from scipy.spatial import cKDTree

from vasculo.errors import InputError
from vasculo.geometry.domain import Domain
from vasculo.geometry.neighbours import as_polygons
from vasculo.geometry.outline import is_number
from vasculo.measure.cords import cords
from vasculo.measure.distribution import Distribution, distribution
from vasculo.measure.shape import ROUND, axes
from vasculo.measure.skeleton import shares
from vasculo.plexus.extract import extract_domain
from vasculo.plexus.image import SIDES, Pictured
from vasculo.plexus.outlines import ring_nodes
from vasculo.springs.network import SpringNetwork

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from vasculo.geometry.arrays import Flags

    Shapes = NDArray[np.object_]

Window = tuple[float, float, float, float]

SMALLEST = 0.05
"""Islands below this share of the mean area are left out, so that specks and gaps of a segmentation do not count."""
MARGIN = 0.5
"""The window of a grown plexus leaves out this much along its frame, over the spacing of its islands."""
FEWEST = 5
"""Fewest whole islands that give a table."""
QUANTILES = (0.1, 0.25, 0.5, 0.75, 0.9)
"""Shares of the islands that lie below the quantiles of the area."""
SAMPLES = 0.06
"""Distance of samples on outlines over the root of the mean area of an island, for the middle lines of the vessels."""
TOUCHES = 1e-9
"""An island this close to the window, over its width, is cut by it."""


@dataclass(frozen=True, eq=False)
class Morphometry:
    """Numbers of a plexus. Islands are its avascular parts (pillars), vessels the tubules between them.

    Only islands that lie whole in the window enter the numbers of size and shape. Large ones are cut more often, so
    each counts with the inverse of the share of places at which it would lie whole (Miles 1974; Lantuejoul 1980):
    1 / ((W - w)(H - h)) with the sides W, H of the window and w, h of the box around the island. Middle lines and
    junctions of the vessels are those of `cords`, made from all islands, cut ones with the piece inside.

    Every number but the first five is free of scale.

    Attributes
    ----------
    window : tuple of 4 float
        Smallest x, smallest y, largest x, largest y of the part that was measured (unit of the pattern).
    whole, cut : int
        Islands inside the window, and pieces of islands that its edge cuts.
    islands : float
        Expected islands in the window: its area times the density, which is the sum of the weights above.
    spacing : float
        Square root of the area an island (unit of the pattern): the scale. The density is 1 / spacing^2.
    vessel_fraction : float
        Area of the vessels over that of the window.
    vessel_length : float
        Length of the middle lines an area (density of vessel length), times the spacing.
    area_variation : float
        Standard deviation of the island areas over their mean.
    area_quantiles : tuple of float
        Area that a tenth, a quarter, half, three quarters and nine tenths of the islands do not exceed, over the mean.
    roundness : float
        Mean of 4 pi A / P^2, area and perimeter of an island (Cox 1927); 1 for a disk.
    solidity : float
        Mean of the area over that of the convex hull; 1 for convex islands.
    elongation : float
        Mean aspect ratio: root of the ratio of the principal second moments.
    order : float
        Nematic order of the long axes about their own mean direction, magnitude of the mean of exp(2 i theta): 0 to 1.
    regularity : float
        Mean distance from the centroid of an island to the nearest other one, over half of the spacing: 1 for random
        places (Clark & Evans 1954), 2 for squares, 2.149 for hexagons. Of islands whose neighbours are all whole; where
        there are none, of all whole ones away from the window's edge.
    neighbours : float
        Mean number of islands that a whole island shares a vessel with, those beside the window's edge left out.
    width, width_variation : float
        Width of the vessels along their middle lines: mean over the spacing; standard deviation over the mean.
    segment, segment_variation : float
        Length of a vessel from junction to junction: mean over the spacing; standard deviation over the mean.
    junctions : float
        Junctions an island.
    degree, three_way : float
        Mean number of vessels at a junction; share of the junctions with three.
    areas, roundnesses, solidities, elongations, widths, segments : Distribution
        The distributions themselves: areas over their mean, widths and segments over the spacing.

    Examples
    --------
    >>> import vasculo as vc
    >>> from vasculo.plexus.voronoi import voronoi_plexus
    >>> table = vc.measure.morphometry(voronoi_plexus(30, seed=1))
    >>> table.whole, 0.3 < table.vessel_fraction < 0.7
    (11, True)
    """

    window: Window
    whole: int
    cut: int
    islands: float
    spacing: float
    vessel_fraction: float
    vessel_length: float
    area_variation: float
    area_quantiles: tuple[float, ...]
    roundness: float
    solidity: float
    elongation: float
    order: float
    regularity: float
    neighbours: float
    width: float
    width_variation: float
    segment: float
    segment_variation: float
    junctions: float
    degree: float
    three_way: float
    areas: Distribution
    roundnesses: Distribution
    solidities: Distribution
    elongations: Distribution
    widths: Distribution
    segments: Distribution

    def rows(self) -> dict[str, float]:
        """Return every plain number by its name, the quantiles as area_10 to area_90."""
        plain = {
            field.name: float(value)
            for field in fields(self)
            if is_number(value := getattr(self, field.name)) and field.name != "window"
        }
        names = [f"area_{100 * share:.0f}" for share in QUANTILES]
        return plain | dict(zip(names, self.area_quantiles, strict=True))


def morphometry(pattern: object, *, window: Window | None = None, smallest: float = SMALLEST) -> Morphometry:
    """Measure a plexus, whatever it comes from.

    Parameters
    ----------
    pattern : Domain, SpringNetwork, picture or run
        A domain; a grown network, whose domain is extracted with default widths; what `domain_from_image` or `extract`
        returns; a run with a recorded step of the angiogenesis, of which the last domain is taken.
    window : tuple of 4 float, optional
        Smallest x, smallest y, largest x, largest y of the part to measure. By default of a picture all of it, but for
        the strip along its edge that the reading of the outlines keeps free; of anything else the box around the
        pillars, less half of their spacing along each edge, because the frame holds the islands beside it.
    smallest : float
        Islands, and pieces of cut ones, below this share of the mean area are left out, 0 to 0.5. They count as vessel.

    Returns
    -------
    Morphometry

    Raises
    ------
    InputError
        When it is nothing that can be measured, the window is outside of it or fewer than 5 islands are whole in it.

    Notes
    -----
    All islands are cut at the window first, so that a picture, whose islands its edge cuts, and a grown plexus, whose
    islands its frame holds, are treated alike.

    Examples
    --------
    >>> import vasculo as vc
    >>> from vasculo.plexus.voronoi import voronoi_plexus
    >>> table = vc.measure.morphometry(voronoi_plexus(30, seed=1))
    >>> table.whole, round(float(table.spacing), 1)
    (11, 2.4)
    """
    if not (is_number(smallest) and 0.0 <= smallest <= 0.5):
        raise InputError(f"the smallest island must be a share of the mean area from 0 to 0.5, not {smallest!r}")
    domain = domain_of(pattern)
    if len(domain.pillars) < FEWEST:
        raise InputError(f"morphometry needs at least {FEWEST} islands, there are {len(domain.pillars)}")
    bounds = default_window(pattern, domain) if window is None else _checked(window, domain)
    box = shapely.box(*bounds)
    walls = shapely.difference(box, shapely.Polygon(domain.outer))  # tissue at which the domain ends
    inside = shapely.get_parts([*shapely.intersection(as_polygons(domain.pillars), box), walls])
    area = shapely.area(inside)
    large = area > smallest * area[area > 0.0].mean() if area.any() else area > 0.0
    return _table(inside[large], bounds)


def pooled(tables: Sequence[Morphometry]) -> Morphometry:
    """One table of several, as of one window as large as all of them: numbers averaged, distributions put together.

    Parameters
    ----------
    tables : sequence of Morphometry
        At least one; of replicates. The window and the spacing are those of the first.

    Returns
    -------
    Morphometry
    """
    found: dict[str, Any] = {"window": tables[0].window, "spacing": tables[0].spacing}
    for field in fields(Morphometry):
        every = [getattr(table, field.name) for table in tables]
        if field.name in {"whole", "cut", "islands"}:
            found[field.name] = sum(every)
        elif isinstance(every[0], Distribution):
            values, weights = (
                np.concatenate([getattr(each, name) for each in every]) for name in ("values", "weights")
            )
            found[field.name] = distribution(values, weights)
        elif field.name == "area_quantiles":
            found[field.name] = tuple(np.mean(every, axis=0).tolist())
        elif field.name not in found:
            found[field.name] = float(np.mean(every))
    return Morphometry(**found)


def domain_of(pattern: object) -> Domain:
    """Domain of whatever can be measured, see `morphometry`."""
    if isinstance(pattern, Domain):
        return pattern
    if isinstance(pattern, SpringNetwork):
        return extract_domain(pattern)
    found = getattr(pattern, "domain", None)
    found = found() if callable(found) else found
    if isinstance(found, Domain):
        return found
    raise InputError(
        f"morphometry needs a domain, a network, a picture that was read or a run, not {type(pattern).__name__}"
    )


def default_window(pattern: object, domain: Domain) -> Window:
    """Return the part that is measured when none is named, see `morphometry`."""
    if isinstance(pattern, Pictured):
        height, width = pattern.mask.shape[:: -1 if SIDES.index(pattern.inlet) % 2 else 1]
        free = 0.5 * pattern.report.narrowest
        return free, free, width - free, height - free
    nodes = np.concatenate(domain.pillars)
    (x0, y0), (x1, y1) = nodes.min(axis=0), nodes.max(axis=0)
    free = MARGIN * float(np.sqrt((x1 - x0) * (y1 - y0) / len(domain.pillars)))
    return float(x0) + free, float(y0) + free, float(x1) - free, float(y1) - free


def _checked(window: Window, domain: Domain) -> Window:
    """Refuse a window that is not part of the domain."""
    x0, y0, x1, y1 = (float(value) for value in window)
    low_x, low_y, high_x, high_y = domain.bounds
    if not (low_x <= x0 < x1 <= high_x and low_y <= y0 < y1 <= high_y):
        raise InputError(
            f"the window {x0:g}, {y0:g} to {x1:g}, {y1:g} is no part of the domain {low_x:g}, {low_y:g} to "
            f"{high_x:g}, {high_y:g}"
        )
    return x0, y0, x1, y1


def _table(pieces: Shapes, window: Window) -> Morphometry:
    """Measure islands that were cut at the window."""
    x0, y0, x1, y1 = window
    width, height = x1 - x0, y1 - y0
    boxes = shapely.bounds(pieces)
    apart = np.min(np.abs(boxes - window), axis=1) if len(pieces) else np.empty(0)
    whole: Flags = apart > TOUCHES * width
    if np.count_nonzero(whole) < FEWEST:
        raise InputError(
            f"morphometry needs at least {FEWEST} whole islands in its window, there are {np.count_nonzero(whole)} and "
            f"{np.count_nonzero(~whole)} cut by its edge"
        )
    weights = 1.0 / ((width - boxes[whole, 2] + boxes[whole, 0]) * (height - boxes[whole, 3] + boxes[whole, 1]))
    density = float(weights.sum())
    spacing = 1.0 / np.sqrt(density)
    area = shapely.area(pieces)
    mine = area[whole]
    rings = [ring_nodes(piece) for piece in pieces]
    frame = np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)])
    graph = cords(rings, frame, spacing=SAMPLES * float(np.sqrt(area.mean())))
    inner = whole & ~graph.at_border
    if not (graph.inner.any() and inner.any()):
        raise InputError(
            f"no network: {len(graph.junctions)} junctions of vessels between the {len(pieces)} islands in the window, "
            f"{np.count_nonzero(inner)} of them surrounded by vessels"
        )
    deep = inner.copy()
    deep[graph.voids[~whole[graph.voids].all(axis=1)]] = False
    deep = deep if deep.any() else inner
    shape = axes(Domain(frame, [ring for ring, kept in zip(rings, whole, strict=True) if kept], {}))
    places = shapely.get_coordinates(shapely.centroid(pieces))
    nearest = np.asarray(cKDTree(places).query(places[deep], k=2)[0])[:, 1]
    turns = np.where(shape.aspect_ratio > ROUND, np.exp(2.0j * np.radians(shape.orientation)), 0.0)
    mean_area = float(np.average(mine, weights=weights))
    areas = distribution(mine / mean_area, weights)
    roundnesses = distribution(4.0 * np.pi * mine / shapely.length(pieces[whole]) ** 2, weights)
    solidities = distribution(mine / shapely.area(shapely.convex_hull(pieces[whole])), weights)
    elongations = distribution(shape.aspect_ratio, weights)
    along = shares(graph.points, graph.first)
    widths = distribution(graph.point_widths / spacing, along)
    lengths = graph.lengths[graph.inner] / spacing
    segments = distribution(lengths, np.ones(len(lengths)))
    islands = density * width * height
    return Morphometry(
        window=window,
        whole=int(np.count_nonzero(whole)),
        cut=int(np.count_nonzero(~whole)),
        islands=islands,
        spacing=spacing,
        vessel_fraction=1.0 - float(area.sum()) / (width * height),
        vessel_length=float(along.sum()) * spacing / (width * height),
        area_variation=areas.variation,
        area_quantiles=tuple(areas.quantile(share) for share in QUANTILES),
        roundness=roundnesses.mean,
        solidity=solidities.mean,
        elongation=elongations.mean,
        order=float(np.abs(np.average(turns, weights=weights))),
        regularity=float(nearest.mean()) / (0.5 * spacing),
        neighbours=float(graph.neighbours[inner].mean()),
        width=widths.mean,
        width_variation=widths.variation,
        segment=segments.mean,
        segment_variation=segments.variation,
        junctions=len(graph.junctions) / islands,
        degree=float(graph.degrees.mean()),
        three_way=float(np.mean(graph.degrees == 3)),
        areas=areas,
        roundnesses=roundnesses,
        solidities=solidities,
        elongations=elongations,
        widths=widths,
        segments=segments,
    )
