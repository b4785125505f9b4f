"""Wall shear on the pillars: its mean, its distribution, and how it differs within and between pillars."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import InputError
from vasculo.flow.read.forces import pillar_walls

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from vasculo.flow.solution import Flow
    from vasculo.geometry.arrays import Flags, Floats


@dataclass(frozen=True, eq=False)
class ShearDistribution:
    """Magnitude of the wall shear over the length of all pillar walls, in force per length.

    Attributes
    ----------
    shear, length : ndarray of float64, shape (w,)
        Magnitude of the shear on each wall edge of a pillar, the smallest first, and the length of that edge.
    pillars : ndarray of int64, shape (q,)
        Pillars that have a wall.
    pillar_lengths : ndarray of float64, shape (q,)
        Length of the wall of each (model length).
    pillar_means, pillar_deviations : ndarray of float64, shape (q,)
        Mean of the magnitude over it, and standard deviation around that mean.

    Examples
    --------
    >>> import vasculo as vc
    >>> from vasculo.plexus.voronoi import voronoi_plexus
    >>> domain = voronoi_plexus(4, seed=1)
    >>> mesh = vc.generate_mesh(domain, edge_length=0.5)
    >>> flow = vc.solve_stokes(mesh, {"left": vc.Pressure(1.0), "right": vc.Pressure(0.0)})
    >>> spread = vc.measure.shear_distribution(flow)
    >>> len(spread.pillar_means), bool(spread.percentiles([50.0])[0] < spread.shear.max())
    (4, True)
    """

    shear: Floats
    length: Floats
    pillars: NDArray[np.int64]
    pillar_lengths: Floats
    pillar_means: Floats
    pillar_deviations: Floats

    @property
    def mean(self) -> float:
        """Mean over the wall."""
        return float(np.average(self.shear, weights=self.length))

    @property
    def deviation(self) -> float:
        """Standard deviation over the wall."""
        return float(np.sqrt(np.average((self.shear - self.mean) ** 2, weights=self.length)))

    def percentiles(self, shares: ArrayLike = (5.0, 50.0, 95.0)) -> Floats:
        """Smallest shears that so many per cent of the wall do not exceed; (k,) float64.

        Parameters
        ----------
        shares : (k,) array_like
            Per cent, 0 to 100.

        Raises
        ------
        InputError
            When a share is out of range.
        """
        wanted = np.atleast_1d(np.asarray(shares, dtype=np.float64))
        if not ((wanted >= 0.0) & (wanted <= 100.0)).all():
            raise InputError(f"percentiles must lie from 0 to 100, not {wanted.tolist()}")
        passed = np.cumsum(self.length)
        place = np.searchsorted(passed, wanted / 100.0 * passed[-1] * (1.0 - 1e-12))
        return np.asarray(self.shear[np.minimum(place, len(passed) - 1)])

    @property
    def variation(self) -> float:
        """Coefficient of variation over the wall: deviation over mean; 0 without shear."""
        return self.deviation / self.mean if self.mean > 0.0 else 0.0

    @property
    def within(self) -> float:
        """Spread around the pillars: root of the mean over the wall of (shear / mean of its pillar - 1)^2.

        It is the spread of what a cell senses, and 0 when the shear is uniform around every pillar. 0.483 for a disk in
        an unbounded flow. Pillars without shear are left out; 0 when no other is left.
        """
        felt = self.pillar_means > 0.0
        if not felt.any():
            return 0.0
        relative = self.pillar_deviations[felt] / self.pillar_means[felt]
        return float(np.sqrt(np.average(relative**2, weights=self.pillar_lengths[felt])))

    @property
    def between(self) -> float:
        """Spread between pillars: standard deviation of their means over the mean, weighted by length.

        0 when all have the same mean, as a single one does. The squares of `deviation`, of `between` times the mean and
        of the deviations of the pillars (mean over the wall) add up.
        """
        mean = np.average(self.pillar_means, weights=self.pillar_lengths)
        if not mean > 0.0:
            return 0.0
        squares = np.average((self.pillar_means - mean) ** 2, weights=self.pillar_lengths)
        return float(np.sqrt(squares) / mean)

    @property
    def ratio(self) -> float:
        """95th over 5th percentile of the means of the pillars, each counted once; infinite where the 5th is zero."""
        low, high = np.percentile(self.pillar_means, [5.0, 95.0])
        return float(high / low) if low > 0.0 else float("inf")


def shear_distribution(flow: Flow) -> ShearDistribution:
    """Distribution of the wall shear over the pillars.

    Parameters
    ----------
    flow : Flow
        A solved flow. Where a pillar has joined the border only its wetted wall counts.

    Returns
    -------
    ShearDistribution

    Raises
    ------
    InputError
        When no pillar has a wall.

    Examples
    --------
    >>> import vasculo as vc
    >>> from vasculo.plexus.voronoi import voronoi_plexus
    >>> domain = voronoi_plexus(4, seed=1)
    >>> mesh = vc.generate_mesh(domain, edge_length=0.5)
    >>> flow = vc.solve_stokes(mesh, {"left": vc.Pressure(1.0), "right": vc.Pressure(0.0)})
    >>> spread = vc.measure.shear_distribution(flow)
    >>> round(spread.mean / vc.measure.mean_wall_shear(flow), 9)
    1.0
    """
    mine, length = _pillar_walls(flow)
    shear = np.abs(flow.wall_shear[mine])
    pillars, owner = np.unique(flow.wall_pillar[mine], return_inverse=True)
    lengths = np.asarray(np.bincount(owner, weights=length), dtype=np.float64)
    means = np.bincount(owner, weights=length * shear) / lengths
    squares = np.bincount(owner, weights=length * (shear - means[owner]) ** 2) / lengths
    order = np.argsort(shear, kind="stable")
    return ShearDistribution(shear[order], length[order], pillars.astype(np.int64), lengths, means, np.sqrt(squares))


def mean_wall_shear(flow: Flow) -> float:
    """Mean of the absolute wall shear over the length of all pillar walls (force per length).

    Raises
    ------
    InputError
        When no pillar has a wall.

    Examples
    --------
    >>> import vasculo as vc
    >>> from vasculo.plexus.voronoi import voronoi_plexus
    >>> domain = voronoi_plexus(4, seed=1)
    >>> mesh = vc.generate_mesh(domain, edge_length=0.5)
    >>> flow = vc.solve_stokes(mesh, {"left": vc.Pressure(1.0), "right": vc.Pressure(0.0)})
    >>> round(vc.measure.mean_wall_shear(flow), 3)
    0.032
    """
    mine, lengths = _pillar_walls(flow)
    return float(np.average(np.abs(flow.wall_shear[mine]), weights=lengths))


def shear_ratio(flow: Flow) -> float:
    """Unevenness of the shear between pillars: 95th over 5th percentile of their mean absolute wall shear.

    Dimensionless, at least 1. Above about 20 the flow has left a part of the plexus.

    Raises
    ------
    InputError
        When no pillar has a wall, or the 5th percentile is zero.

    Examples
    --------
    >>> import vasculo as vc
    >>> from vasculo.plexus.voronoi import voronoi_plexus
    >>> domain = voronoi_plexus(4, seed=1)
    >>> mesh = vc.generate_mesh(domain, edge_length=0.5)
    >>> flow = vc.solve_stokes(mesh, {"left": vc.Pressure(1.0), "right": vc.Pressure(0.0)})
    >>> round(vc.measure.shear_ratio(flow), 1)
    1.3
    """
    found = shear_distribution(flow)
    if not np.isfinite(found.ratio):
        low, high = np.percentile(found.pillar_means, [5.0, 95.0])
        raise InputError(f"the shear ratio needs flow past the pillars: 5th percentile {low:.3g}, 95th {high:.3g}")
    return found.ratio


def _pillar_walls(flow: Flow) -> tuple[Flags, Floats]:
    """Which wall edges belong to pillars, and their lengths."""
    mine, lengths = pillar_walls(flow)
    if not mine.any():
        raise InputError(f"no pillar has a wall: {len(flow.wall_edges)} wall edges, all on the outer boundary")
    return mine, lengths
