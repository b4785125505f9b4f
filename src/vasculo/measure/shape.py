"""Shape of pillars: size, elongation, direction, distance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from vasculo.errors import InputError
from vasculo.geometry.neighbours import pillar_gaps
from vasculo.geometry.outline import following

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.geometry.domain import Domain

    Floats = NDArray[np.float64]


ROUND = 1.0 + 1e-6
"""Pillars of a smaller aspect ratio have no long axis."""


@dataclass(frozen=True)
class PillarTable:
    """One row a pillar.

    Attributes
    ----------
    area : ndarray of float64, shape (p,)
        Model length squared.
    centroid : ndarray of float64, shape (p, 2)
        Centroid of the area (model length).
    aspect_ratio : ndarray of float64, shape (p,)
        Square root of the ratio of the principal second moments of area; for an ellipse, long over short axis.
    orientation : ndarray of float64, shape (p,)
        Direction of the long axis against x, degrees, above -90 and up to 90.
    nearest_gap : ndarray of float64, shape (p,)
        Distance to the nearest other pillar (model length); infinite for a single pillar.

    Examples
    --------
    >>> import vasculo as vc
    >>> from vasculo.plexus.voronoi import voronoi_plexus
    >>> domain = voronoi_plexus(4, seed=1)
    >>> list(vc.measure.pillars(domain).columns())
    ['area', 'centroid_x', 'centroid_y', 'aspect_ratio', 'orientation', 'nearest_gap']
    """

    area: Floats
    centroid: Floats
    aspect_ratio: Floats
    orientation: Floats
    nearest_gap: Floats

    def __len__(self) -> int:
        """Return the number of pillars."""
        return len(self.area)

    def columns(self) -> dict[str, Floats]:
        """Return the table as named columns, each of shape (p,)."""
        return {
            "area": self.area,
            "centroid_x": self.centroid[:, 0],
            "centroid_y": self.centroid[:, 1],
            "aspect_ratio": self.aspect_ratio,
            "orientation": self.orientation,
            "nearest_gap": self.nearest_gap,
        }


class Axes(NamedTuple):
    """Centroid, aspect ratio and orientation of each pillar, as in `PillarTable`."""

    centroid: Floats
    aspect_ratio: Floats
    orientation: Floats


def pillars(domain: Domain) -> PillarTable:
    """Measure every pillar.

    Parameters
    ----------
    domain : Domain
        Any domain; one without pillars gives an empty table.

    Returns
    -------
    PillarTable
        Area, centroid, aspect ratio, orientation and nearest gap of each pillar, in their order.

    Notes
    -----
    With the second moments Mxx, Mxy, Myy of the area, orientation is atan2(2 Mxy, Mxx - Myy) / 2. That of a round
    pillar is arbitrary.

    Examples
    --------
    >>> import vasculo as vc
    >>> domain = vc.Domain.rectangle(6.0, 3.0, [[(1, 1), (4, 1), (4, 2), (1, 2)]])
    >>> table = vc.measure.pillars(domain)
    >>> table.area.tolist(), table.aspect_ratio.round(6).tolist(), table.orientation.tolist()
    ([3.0], [3.0], [0.0])
    """
    shapes = axes(domain)
    return PillarTable(
        area=domain.pillar_areas.copy(),
        centroid=shapes.centroid,
        aspect_ratio=shapes.aspect_ratio,
        orientation=shapes.orientation,
        nearest_gap=pillar_gaps(domain.pillars),
    )


def axes(domain: Domain) -> Axes:
    """Find centroid and principal axes of every pillar; the same numbers as in `pillars`, without the gaps."""
    if not domain.pillars:
        return Axes(np.empty((0, 2)), np.empty(0), np.empty(0))
    # Strategy: all outlines behind one another, each about its first node and then about its centroid, so that no
    # digits are lost far from the origin; areas and moments add up over the segments of each outline.
    counts = np.array([len(outline) for outline in domain.pillars])
    first = np.cumsum(counts) - counts
    nodes, after = np.concatenate(domain.pillars), following(counts)
    corner = nodes[first]
    p = nodes - np.repeat(corner, counts, axis=0)
    q = p[after]
    cross = p[:, 0] * q[:, 1] - q[:, 0] * p[:, 1]
    twice = np.add.reduceat(cross, first)
    middle = np.add.reduceat((p + q) * cross[:, None], first) / (3.0 * twice[:, None])
    p -= np.repeat(middle, counts, axis=0)
    q = p[after]
    cross = (p[:, 0] * q[:, 1] - q[:, 0] * p[:, 1]) / np.repeat(12.0 * twice, counts)
    both = p + q

    def moment(i: int, j: int) -> Floats:
        parts = p[:, i] * p[:, j] + q[:, i] * q[:, j] + both[:, i] * both[:, j]
        return np.asarray(np.add.reduceat(cross * parts, first))

    xx, xy, yy = moment(0, 0), moment(0, 1), moment(1, 1)
    mean, half = 0.5 * (xx + yy), 0.5 * (xx - yy)
    spread = np.hypot(half, xy)
    return Axes(
        centroid=corner + middle,
        aspect_ratio=np.sqrt((mean + spread) / (mean - spread)),
        orientation=np.degrees(0.5 * np.arctan2(xy, half)),
    )


def order(domain: Domain, direction: float = 0.0) -> float:
    """Nematic order of the long axes: the mean of cos 2 (orientation - direction) over the pillars.

    Every pillar counts once, whatever its area. 1: all along the direction; -1: all across; 0: no order. A round pillar
    has no axis and counts zero.

    Parameters
    ----------
    domain : Domain
        At least one pillar.
    direction : float
        Direction of the mean flow against x, degrees.

    Returns
    -------
    float
        Dimensionless, -1 to 1.

    Raises
    ------
    InputError
        When the domain has no pillar.

    Examples
    --------
    >>> import vasculo as vc
    >>> bar = vc.Domain.rectangle(6.0, 3.0, [[(1, 1), (4, 1), (4, 2), (1, 2)]])
    >>> round(vc.measure.order(bar), 6), round(vc.measure.order(bar, direction=90.0), 6)
    (1.0, -1.0)
    """
    require_pillars(domain, "order")
    return float(np.mean(axis_cosines(axes(domain), direction)))


def axis_cosines(table: PillarTable | Axes, directions: Floats | float) -> Floats:
    """Give cos 2 (orientation - direction) of each pillar (p,), directions in degrees; 0 for a round one."""
    return np.where(table.aspect_ratio > ROUND, np.cos(2.0 * np.radians(table.orientation - directions)), 0.0)


def mean_gap(domain: Domain) -> float:
    """Mean over the pillars of the distance to the nearest other pillar (model length); infinite for a single one.

    Raises
    ------
    InputError
        When the domain has no pillar.

    Examples
    --------
    >>> import vasculo as vc
    >>> pair = [[(1, 1), (2, 1), (2, 2), (1, 2)], [(3, 1), (4, 1), (4, 2), (3, 2)]]
    >>> round(vc.measure.mean_gap(vc.Domain.rectangle(6.0, 3.0, pair)), 6)
    1.0
    """
    require_pillars(domain, "mean_gap")
    return float(np.mean(pillar_gaps(domain.pillars)))


def require_pillars(domain: Domain, what: str) -> None:
    """Refuse domains without pillars."""
    if not domain.pillars:
        raise InputError(f"{what} needs at least one pillar, the domain has none")
