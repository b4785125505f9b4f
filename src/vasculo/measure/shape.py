"""Shape of pillars: size, elongation, direction, distance, chains."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import InputError
from vasculo.geometry.neighbours import pillar_gaps
from vasculo.geometry.outline import centroid, second_moments

if TYPE_CHECKING:
    from collections.abc import Sequence

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


@dataclass(frozen=True)
class Chains:
    """Chains: pillars that several original pillars have merged into.

    Attributes
    ----------
    sizes : ndarray of int64, shape (p,)
        Original pillars in each pillar; a chain has two or more.
    lengths : ndarray of float64, shape (p,)
        Extent of each pillar along its long axis (model length).
    largest : int
        Original pillars in the largest chain (1 when nothing has merged).
    fraction : float
        Share of the original pillars that are in chains, dimensionless.
    """

    sizes: NDArray[np.int64]
    lengths: Floats
    largest: int
    fraction: float


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
    """
    count = len(domain.pillars)
    moments = np.array([second_moments(outline) for outline in domain.pillars]).reshape(count, 2, 2)
    mean = 0.5 * (moments[:, 0, 0] + moments[:, 1, 1])
    half = 0.5 * (moments[:, 0, 0] - moments[:, 1, 1])
    spread = np.hypot(half, moments[:, 0, 1])
    return PillarTable(
        area=domain.pillar_areas.copy(),
        centroid=np.array([centroid(outline) for outline in domain.pillars]).reshape(count, 2),
        aspect_ratio=np.sqrt((mean + spread) / (mean - spread)),
        orientation=np.degrees(0.5 * np.arctan2(moments[:, 0, 1], half)),
        nearest_gap=pillar_gaps(domain.pillars),
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
    """
    _require(domain, "order")
    return float(np.mean(axis_cosines(pillars(domain), direction)))


def axis_cosines(table: PillarTable, directions: Floats | float) -> Floats:
    """Give cos 2 (orientation - direction) of each pillar (p,), directions in degrees; 0 for a round one."""
    return np.where(table.aspect_ratio > ROUND, np.cos(2.0 * np.radians(table.orientation - directions)), 0.0)


def mean_gap(domain: Domain) -> float:
    """Mean over the pillars of the distance to the nearest other pillar (model length); infinite for a single one.

    Raises
    ------
    InputError
        When the domain has no pillar.
    """
    _require(domain, "mean_gap")
    return float(np.mean(pillar_gaps(domain.pillars)))


def chains(domain: Domain, lineage: Sequence[Sequence[int]] | None = None) -> Chains:
    """Size and length of the chains that pillars have merged into.

    Parameters
    ----------
    domain : Domain
        At least one pillar.
    lineage : sequence of sequences of int, optional
        For each pillar the original pillars it is made of, as `remodel` reports them. Without it every pillar counts
        as one original.

    Returns
    -------
    Chains

    Raises
    ------
    InputError
        When the domain has no pillar, the lineage is not one entry a pillar, or an original appears twice or never.
    """
    _require(domain, "chains")
    count = len(domain.pillars)
    parents = [(index,) for index in range(count)] if lineage is None else [tuple(entry) for entry in lineage]
    everyone = [original for entry in parents for original in entry]
    if len(parents) != count or not all(parents) or len(set(everyone)) != len(everyone):
        raise InputError(
            f"lineage needs one entry for each of {count} pillars, none empty, each original once: got {len(parents)} "
            f"entries with {len(everyone)} originals, {len(set(everyone))} of them different"
        )
    sizes = np.array([len(entry) for entry in parents], dtype=np.int64)
    angles = np.radians(pillars(domain).orientation)
    lengths = [
        float(np.ptp(outline @ np.array([np.cos(angle), np.sin(angle)])))
        for outline, angle in zip(domain.pillars, angles, strict=True)
    ]
    return Chains(sizes, np.array(lengths), int(sizes.max()), float(sizes[sizes > 1].sum() / sizes.sum()))


def _require(domain: Domain, what: str) -> None:
    """Refuse domains without pillars."""
    if not domain.pillars:
        raise InputError(f"{what} needs at least one pillar, the domain has none")
