"""How the pillars lie in the flow that passes them: the angle between long axis and local flow."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, NamedTuple, get_args

import numpy as np

from vasculo.errors import InputError
from vasculo.measure.local_flow import friction, local_velocity
from vasculo.measure.shape import ROUND, axes, axis_cosines

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from vasculo.flow.solution import Flow
    from vasculo.geometry.arrays import Flags, Floats
    from vasculo.geometry.domain import Domain

Weight = Literal["count", "area"]
Reference = Literal["velocity", "friction"]


class AngleSummary(NamedTuple):
    """Mean, standard deviation and median of acute angles, degrees, and how many pillars they are of.

    All 0 for pillars along the flow; 45, 26 and 45 for pillars in no order; 90, 0 and 90 for pillars across it.

    Parameters
    ----------
    pillars : int
        How many they are of.
    mean, deviation, median : float
        Of the angles, degrees.

    Examples
    --------
    >>> import vasculo as vc
    >>> from vasculo.plexus.voronoi import voronoi_plexus
    >>> domain = voronoi_plexus(4, seed=1)
    >>> mesh = vc.generate_mesh(domain, edge_length=0.5)
    >>> flow = vc.solve_stokes(mesh, {"left": vc.Pressure(1.0), "right": vc.Pressure(0.0)})
    >>> angles = vc.measure.local_angles(domain, flow)
    >>> summary = angles.summary()
    >>> summary.pillars, 0.0 < summary.mean < 45.0
    (4, True)
    """

    pillars: int
    mean: float
    deviation: float
    median: float


@dataclass(frozen=True, eq=False)
class LocalAngles:
    """Pillars against the flow that passes them; one row a pillar.

    Attributes
    ----------
    angle : ndarray of float64, shape (p,)
        Acute angle between long axis and local flow, degrees, 0 to 90; NaN for a round pillar, and where nothing
        flows.
    flow_direction : ndarray of float64, shape (p,)
        Direction of the local flow, degrees against x, above -180 and up to 180; NaN where nothing flows.
    orientation : ndarray of float64, shape (p,)
        Direction of the long axis, degrees against x, above -90 and up to 90.
    aspect_ratio, area : ndarray of float64, shape (p,)
        As in `PillarTable`.

    Examples
    --------
    >>> import vasculo as vc
    >>> from vasculo.plexus.voronoi import voronoi_plexus
    >>> domain = voronoi_plexus(4, seed=1)
    >>> mesh = vc.generate_mesh(domain, edge_length=0.5)
    >>> flow = vc.solve_stokes(mesh, {"left": vc.Pressure(1.0), "right": vc.Pressure(0.0)})
    >>> angles = vc.measure.local_angles(domain, flow)
    >>> len(angles), list(angles.columns())
    (4, ['angle', 'flow_direction', 'orientation', 'aspect_ratio', 'area'])
    """

    angle: Floats
    flow_direction: Floats
    orientation: Floats
    aspect_ratio: Floats
    area: Floats

    def __len__(self) -> int:
        """Return the number of pillars."""
        return len(self.angle)

    def columns(self) -> dict[str, Floats]:
        """Return the table as named columns, each of shape (p,)."""
        names = ("angle", "flow_direction", "orientation", "aspect_ratio", "area")
        return {name: getattr(self, name) for name in names}

    def summary(
        self, weight: Weight = "count", *, elongated: float = 1.0, only: ArrayLike | None = None
    ) -> AngleSummary:
        """Mean, standard deviation and median of the angles.

        Parameters
        ----------
        weight : {"count", "area"}
            Whether every pillar counts once, or by its area.
        elongated : float
            Only pillars of a larger aspect ratio; 1.5 is what can be told by eye.
        only : (p,) array_like of bool, optional
            Only these pillars, for instance the chains.

        Returns
        -------
        AngleSummary
            With NaN when no pillar is left.

        Raises
        ------
        InputError
            For another weight, or a selection of another length.
        """
        if weight not in get_args(Weight):
            raise InputError(f"the weight of the angles is {weight!r}: give one of {', '.join(get_args(Weight))}")
        chosen: Flags = np.isfinite(self.angle) & (self.aspect_ratio > elongated)
        if only is not None:
            given = np.asarray(only, dtype=np.bool_)
            if given.shape != chosen.shape:
                raise InputError(f"the selection has shape {given.shape}, but there are {len(self)} pillars")
            chosen &= given
        angles = self.angle[chosen]
        if not len(angles):
            return AngleSummary(0, float("nan"), float("nan"), float("nan"))
        weights = self.area[chosen] if weight == "area" else np.ones(len(angles))
        mean = float(np.average(angles, weights=weights))
        deviation = float(np.sqrt(np.average((angles - mean) ** 2, weights=weights)))
        order = np.argsort(angles, kind="stable")
        middles = np.cumsum(weights[order]) - 0.5 * weights[order]
        return AngleSummary(len(angles), mean, deviation, float(np.interp(0.5 * weights.sum(), middles, angles[order])))


def local_angles(
    domain: Domain, flow: Flow, reference: Reference = "velocity", *, smoothing: float | None = None
) -> LocalAngles:
    """Angle of every pillar to the local flow.

    Parameters
    ----------
    domain : Domain
        The domain of the flow; without pillars the table is empty.
    flow : Flow
        Its solution; for "friction" with no-slip pillars.
    reference : {"velocity", "friction"}
        What the local flow is. "velocity": the mean velocity of the fluid around the pillar, smoothed by a Gaussian,
        which stands for the axis of the vessel that holds the pillar. "friction": the friction on the pillar, as in
        `alignment`.
    smoothing : float, optional
        Standard deviation of that Gaussian (model length); the radius of the mean pillar if left out.

    Returns
    -------
    LocalAngles

    Raises
    ------
    InputError
        For another reference, or a smoothing that is no positive number.

    Notes
    -----
    A pillar bends the flow beside it, and the friction leans towards the long axis. A lone ellipse of aspect ratio 3 at
    45 degrees to the flow has an angle of 23 degrees to its friction, and of 35 to the velocity around it. Pillars in
    no order at all therefore come out below 45 degrees: compare with the start, or with a control.

    Examples
    --------
    >>> import vasculo as vc
    >>> from vasculo.plexus.voronoi import voronoi_plexus
    >>> domain = voronoi_plexus(4, seed=1)
    >>> mesh = vc.generate_mesh(domain, edge_length=0.5)
    >>> flow = vc.solve_stokes(mesh, {"left": vc.Pressure(1.0), "right": vc.Pressure(0.0)})
    >>> vc.measure.local_angles(domain, flow).angle.round().tolist()
    [7.0, 15.0, 3.0, 32.0]
    """
    if reference not in get_args(Reference):
        raise InputError(f"the reference of the angles is {reference!r}: give one of {', '.join(get_args(Reference))}")
    shape = axes(domain)
    by_friction = reference == "friction"
    vectors, moving = friction(domain, flow) if by_friction else local_velocity(domain, flow, smoothing)
    direction = np.full(len(vectors), np.nan)
    direction[moving] = np.degrees(np.arctan2(vectors[moving, 1], vectors[moving, 0]))
    turn = np.mod(shape.orientation - direction, 180.0)
    angle = np.where(shape.aspect_ratio > ROUND, np.minimum(turn, 180.0 - turn), np.nan)
    return LocalAngles(angle, direction, shape.orientation, shape.aspect_ratio, domain.pillar_areas.copy())


def alignment(domain: Domain, flow: Flow) -> float:
    """Order of the long axes against the local flow: the mean of cos 2 (orientation - direction of the friction drag).

    The fairer measure where paths of flow are oblique. The friction on a pillar points where the fluid slides past it;
    the pressure part is left out, because it points down the pressure gradient, which in a network of tubules need not
    be the way that the fluid goes. Every pillar counts once, a round one zero; those without friction are left out.

    Parameters
    ----------
    domain : Domain
        The domain of the flow.
    flow : Flow
        Its solution, with no-slip pillars.

    Returns
    -------
    float
        Dimensionless, -1 to 1.

    Raises
    ------
    InputError
        When no pillar is dragged.

    Examples
    --------
    >>> import vasculo as vc
    >>> from vasculo.plexus.voronoi import voronoi_plexus
    >>> domain = voronoi_plexus(4, seed=1)
    >>> mesh = vc.generate_mesh(domain, edge_length=0.5)
    >>> flow = vc.solve_stokes(mesh, {"left": vc.Pressure(1.0), "right": vc.Pressure(0.0)})
    >>> round(vc.measure.alignment(domain, flow), 2)
    0.89
    """
    drag, dragged = friction(domain, flow)
    if not dragged.any():
        raise InputError(f"alignment needs a pillar with drag, none of {len(domain.pillars)} has any")
    along = axis_cosines(axes(domain), np.degrees(np.arctan2(drag[:, 1], drag[:, 0])))
    return float(np.mean(along[dragged]))
