"""Chains: pillars that several original pillars have merged into."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import InputError
from vasculo.measure.middle_lines import middle_lines
from vasculo.measure.shape import axes, require_pillars

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from vasculo.geometry.arrays import Flags, Floats
    from vasculo.geometry.domain import Domain


@dataclass(frozen=True)
class Chains:
    """Pillars as chains of original ones; a chain has two originals or more.

    Attributes
    ----------
    sizes : ndarray of int64, shape (p,)
        Original pillars in each pillar.
    lengths : ndarray of float64, shape (p,)
        Extent of each pillar along its long axis (model length).
    largest : int
        Original pillars in the largest chain (1 when nothing has merged).
    fraction : float
        Share of the original pillars that are in chains, dimensionless.
    directions : ndarray of float64, shape (p,)
        Direction of the long axis of each pillar against x, degrees, above -90 and up to 90.
    path_lengths : ndarray of float64, shape (p,)
        Length of the middle line of each pillar, from tip to tip (model length).
    straightness : ndarray of float64, shape (p,)
        End-to-end distance of the middle line over its length; see `MiddleLines`. 1: straight; 2/pi: bent to half a
        circle; NaN: a pillar too short to be bent.

    Examples
    --------
    >>> import vasculo as vc
    >>> from vasculo.plexus.voronoi import voronoi_plexus
    >>> domain = voronoi_plexus(4, seed=1)
    >>> vc.measure.chains(domain).largest
    1
    """

    sizes: NDArray[np.int64]
    lengths: Floats
    largest: int
    fraction: float
    directions: Floats
    path_lengths: Floats
    straightness: Floats

    @property
    def is_chain(self) -> Flags:
        """Pillars (p,) that are chains."""
        return np.asarray(self.sizes > 1)

    @property
    def count(self) -> int:
        """Number of chains."""
        return int(np.count_nonzero(self.is_chain))

    @property
    def mean_straightness(self) -> float:
        """Straightness of the chains, mean weighted by the length of their middle lines; NaN when there are none."""
        counted = self.is_chain & np.isfinite(self.straightness)
        if not counted.any():
            return float("nan")
        return float(np.average(self.straightness[counted], weights=self.path_lengths[counted]))


def chains(domain: Domain, lineage: Sequence[Sequence[int]] | None = None) -> Chains:
    """Size, length, direction and straightness of the chains that pillars have merged into.

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

    Examples
    --------
    >>> import vasculo as vc
    >>> from vasculo.plexus.voronoi import voronoi_plexus
    >>> domain = voronoi_plexus(4, seed=1)
    >>> found = vc.measure.chains(domain, lineage=[(0,), (1,), (2, 3, 4), (5,)])
    >>> found.sizes.tolist(), found.largest, found.fraction
    ([1, 1, 3, 1], 3, 0.5)
    """
    require_pillars(domain, "chains")
    count = len(domain.pillars)
    parents = [(index,) for index in range(count)] if lineage is None else [tuple(entry) for entry in lineage]
    everyone = [original for entry in parents for original in entry]
    if len(parents) != count or not all(parents) or len(set(everyone)) != len(everyone):
        raise InputError(
            f"lineage needs one entry for each of {count} pillars, none empty, each original once: got {len(parents)} "
            f"entries with {len(everyone)} originals, {len(set(everyone))} of them different"
        )
    sizes = np.array([len(entry) for entry in parents], dtype=np.int64)
    directions = axes(domain).orientation
    lines = middle_lines(domain.pillars)
    return Chains(
        sizes=sizes,
        lengths=extents(domain, directions),
        largest=int(sizes.max()),
        fraction=float(sizes[sizes > 1].sum() / sizes.sum()),
        directions=directions,
        path_lengths=lines.lengths,
        straightness=lines.straightness,
    )


def extents(domain: Domain, directions: Floats) -> Floats:
    """Extent of each pillar along a direction of its own (p,), degrees against x; (p,) float64, model length."""
    counts = np.array([len(outline) for outline in domain.pillars])
    first = np.cumsum(counts) - counts
    turn = np.repeat(np.radians(directions), counts)
    x, y = np.concatenate(domain.pillars).T
    along = x * np.cos(turn) + y * np.sin(turn)
    return np.asarray(np.maximum.reduceat(along, first) - np.minimum.reduceat(along, first))
