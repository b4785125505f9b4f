"""Boundary conditions: what can hold on a side of the domain or on a pillar, and which name has which."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import InputError
from vasculo.flow.parabola import Parabola
from vasculo.flow.values import Array, Field, Scalar, scalar_at, vector_at
from vasculo.geometry.outline import is_number

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from vasculo.mesh.triangulation import Triangulation

PILLARS = "pillars"
PILLAR = re.compile(r"pillar (0|[1-9][0-9]*)")


@dataclass(frozen=True)
class Rotation:
    """Velocity of a rigid body that turns: `rate` (angle per time, counter-clockwise) about `centre`."""

    rate: float
    centre: tuple[float, float] = (0.0, 0.0)

    def __call__(self, x: Array, y: Array) -> tuple[Array, Array]:
        """Return both components at places x, y."""
        return -self.rate * (y - self.centre[1]), self.rate * (x - self.centre[0])


@dataclass(frozen=True)
class Wall:
    """No-slip wall: the fluid has the velocity of the wall, which is at rest unless told.

    Parameters
    ----------
    velocity : pair of float or callable, or callable
        Velocity of the wall (model length per time): two components, each a number or a function of the coordinates
        (two float64 arrays) that returns an array of their shape, or one function that returns both.

    Examples
    --------
    >>> import vasculo as vc
    >>> mesh = vc.generate_mesh(vc.Domain.rectangle(2.0, 1.0), edge_length=0.25)
    >>> lid = {"top": vc.Wall((1.0, 0.0))}  # the other sides are walls at rest
    >>> flow = vc.solve_stokes(mesh, lid)
    >>> bool(flow.velocity_at([(1.0, 0.95)])[0, 0] > 0.5)
    True
    """

    velocity: tuple[Scalar, Scalar] | Field = (0.0, 0.0)

    @classmethod
    def turning(cls, rate: float, centre: tuple[float, float] = (0.0, 0.0)) -> Wall:
        """Wall that turns like a rigid body.

        Parameters
        ----------
        rate : float
            Angle per time, counter-clockwise.
        centre : pair of float, model length

        Raises
        ------
        InputError
            A rate or a centre that is not finite.
        """
        if not _is_finite(rate):
            raise InputError(f"rate of a turning wall is {rate!r}: give a finite number")
        if not (isinstance(centre, (tuple, list, np.ndarray)) and len(centre) == 2 and all(map(_is_finite, centre))):
            raise InputError(f"centre of a turning wall is {centre!r}: give two finite numbers")
        return cls(Rotation(float(rate), (float(centre[0]), float(centre[1]))))

    def at(self, points: Array, name: str) -> Array:
        """Evaluate at points, float64 (..., 2); `name` of the side is for messages only."""
        return vector_at(self.velocity, points, f"velocity of the wall {name!r}")


@dataclass(frozen=True)
class Velocity:
    """Prescribed velocity of an inlet or an outlet.

    Parameters
    ----------
    x, y : float or callable
        Velocity components (model length per time). A callable gets two float64 arrays, the coordinates, and returns an
        array of the same shape; without `y` it may return both components as a tuple. ``Velocity(1.0)`` means
        ``Velocity(1.0, 0.0)``.

    Examples
    --------
    >>> import vasculo as vc
    >>> mesh = vc.generate_mesh(vc.Domain.rectangle(2.0, 1.0), edge_length=0.25)
    >>> parabola = vc.Velocity(lambda x, y: 6 * y * (1 - y), 0.0)
    >>> flow = vc.solve_stokes(mesh, {"left": parabola, "right": vc.Pressure(0.0)})
    >>> round(flow.flow_rate("right"), 3)
    1.0
    """

    x: Scalar | Field | Parabola
    y: Scalar | None = None

    @classmethod
    def parabolic(cls, mean: float | None = None, *, peak: float | None = None) -> Velocity:
        """Parabolic inlet, the flow between parallel plates; see `vasculo.flow.parabola.Parabola` for bent sides.

        Parameters
        ----------
        mean : float
            Mean speed into the fluid (model length per time), negative for an outlet.
        peak : float
            Instead of it: the highest speed, 1.5 times the mean.

        Raises
        ------
        InputError
            Not one of them given, or not finite.
        """
        if (mean is None) == (peak is None):
            raise InputError(f"a parabolic velocity has mean {mean!r} and peak {peak!r}: give one of them")
        given = peak if mean is None else mean
        if not _is_finite(given):
            raise InputError(f"the {'peak' if mean is None else 'mean'} of a parabolic velocity is {given!r}")
        return cls(Parabola(float(given) / (1.5 if mean is None else 1.0)))  # type: ignore[arg-type]

    def at(self, points: Array, name: str) -> Array:
        """Evaluate at points, float64 (..., 2); `name` of the side is for messages only."""
        if isinstance(self.x, Parabola):
            return self.x.at(points, name)
        first = self.x(points[..., 0], points[..., 1]) if callable(self.x) else self.x
        pair = first if self.y is None and isinstance(first, tuple) else (first, 0.0 if self.y is None else self.y)
        return vector_at(pair, points, f"velocity on {name!r}")


@dataclass(frozen=True)
class Pressure:
    """Opening at a given pressure; the velocity along the opening is zero.

    Parameters
    ----------
    value : float or callable
        Pressure (force per length). A callable gets two float64 arrays, the coordinates, and returns an array of the
        same shape; it is evaluated at the middles of the edges.

    Examples
    --------
    >>> import vasculo as vc
    >>> mesh = vc.generate_mesh(vc.Domain.rectangle(2.0, 1.0), edge_length=0.25)
    >>> flow = vc.solve_stokes(mesh, {"left": vc.Pressure(2.0), "right": vc.Pressure(0.0)})
    >>> flow.pressure_at([(1.0, 0.5)]).round(6).tolist()
    [1.0]
    """

    value: Scalar

    def at(self, points: Array, name: str) -> Array:
        """Evaluate at points, float64 (..., 2); `name` of the side is for messages only."""
        return scalar_at(self.value, points, f"pressure on {name!r}")


@dataclass(frozen=True)
class Slip:
    """Mirror line: no flow through it and no tangential stress on it.

    Examples
    --------
    >>> import vasculo as vc
    >>> mesh = vc.generate_mesh(vc.Domain.rectangle(2.0, 1.0), edge_length=0.25)
    >>> plug = {"left": vc.Velocity(1.0, 0.0), "right": vc.Pressure(0.0), "top": vc.Slip(), "bottom": vc.Slip()}
    >>> flow = vc.solve_stokes(mesh, plug)
    >>> bool(abs(flow.velocity[:, 0] - 1.0).max() < 1e-9)
    True
    """


@dataclass(frozen=True)
class Periodic:
    """The flow leaves here and enters again on another side, a translated copy of this one.

    Parameters
    ----------
    other : str
        Name of the other side; it takes no condition of its own.
    pressure_drop : float
        Pressure here minus pressure at the matching point of the other side (force per length).

    Examples
    --------
    >>> import vasculo as vc
    >>> mesh = vc.generate_mesh(vc.Domain.rectangle(2.0, 1.0), edge_length=0.25)
    >>> flow = vc.solve_stokes(mesh, {"left": vc.Periodic("right", pressure_drop=1.0)})
    >>> round(flow.flow_rate("right"), 6)
    0.041667
    """

    other: str
    pressure_drop: float = 0.0


Condition = Wall | Velocity | Pressure | Slip | Periodic


def conditions_by_name(mesh: Triangulation, conditions: Mapping[str, Condition]) -> dict[str, Condition]:
    """Check the conditions and complete them.

    Parameters
    ----------
    mesh : Triangulation
    conditions : mapping of str to condition
        For names of sides, "pillars" for all pillars, and "pillar 3" for one of them, which goes before "pillars".

    Returns
    -------
    dict of str to condition
        For every side and "pillars", walls where nothing was given; then for the single pillars that were named.

    Raises
    ------
    InputError
        For an unknown name, something that is no condition, or sides that cannot be paired.
    """
    names = [*mesh.side_names, PILLARS]
    if not isinstance(conditions, Mapping):
        raise InputError(f"conditions are {conditions!r}: give a mapping of names of sides to conditions")
    for name, condition in conditions.items():
        if name not in names:
            _check_pillar(name, names, mesh)
        if not isinstance(condition, Condition):
            raise InputError(
                f"condition on {name!r} is {condition!r}: give Wall(), Velocity(x, y), Pressure(value), Slip() or "
                "Periodic(other)"
            )
        if isinstance(condition, Periodic):
            _check_pair(name, condition, conditions, mesh)
    partners = {c.other: Periodic(n, -c.pressure_drop) for n, c in conditions.items() if isinstance(c, Periodic)}
    return {name: partners.get(name, Wall()) for name in names} | dict(conditions)


def edges_by_name(mesh: Triangulation, names: list[str]) -> list[NDArray[np.int64]]:
    """Boundary edges of each name of `conditions_by_name`, sorted; those of single pillars are not in "pillars"."""
    sides, tags = len(mesh.side_names), mesh.boundary_tags
    which = np.full(sides + 1 + int(tags.max(initial=-1)), sides)
    which[:sides] = np.arange(sides)[::-1]  # tag -1 - j stands at place sides - 1 - j
    for k, name in enumerate(names[sides + 1 :], start=sides + 1):
        which[sides + pillar_number(name)] = k
    owner = which[tags + sides]
    order = np.argsort(owner, kind="stable")
    return np.split(order, np.searchsorted(owner[order], np.arange(1, len(names))))


def periodic_pairs(conditions: Mapping[str, Condition]) -> list[tuple[str, str, float]]:
    """Pairs (side, other side, pressure drop) as the caller gave them, sorted by name."""
    return sorted((n, c.other, float(c.pressure_drop)) for n, c in conditions.items() if isinstance(c, Periodic))


def pillar_number(name: object) -> int:
    """Give the number of a single pillar's name, "pillar 3"; -1 for any other."""
    found = PILLAR.fullmatch(name) if isinstance(name, str) else None
    return int(found[1]) if found else -1


def _check_pillar(name: object, names: list[str], mesh: Triangulation) -> None:
    """Refuse a name that is neither a side nor all pillars, unless it is that of a pillar that is there."""
    pillar = pillar_number(name)
    if pillar < 0:
        near = get_close_matches(str(name), names, n=1, cutoff=0.0)
        raise InputError(
            f"no side is named {name!r}: did you mean {near[0]!r}? (there are {', '.join(names)}, and 'pillar 0', ...)"
        )
    if not (mesh.boundary_tags == pillar).any():
        last = int(mesh.boundary_tags.max(initial=-1))
        there = ("no pillar", "pillar 0 only")[last + 1] if last < 1 else f"pillars 0 to {last}"
        raise InputError(f"there is no {name!r}: the mesh has {there}")


def _check_pair(name: str, condition: Periodic, conditions: Mapping[str, Condition], mesh: Triangulation) -> None:
    other = condition.other
    if name not in mesh.side_names or other not in mesh.side_names or other == name:
        near = [s for s in mesh.side_names if s != name]
        raise InputError(f"{name!r} cannot be periodic with {other!r}: pair two different sides ({', '.join(near)})")
    taken = [n for n, c in conditions.items() if n != name and isinstance(c, Periodic) and other in {c.other, n}]
    if other in conditions or taken:
        raise InputError(f"side {other!r}, paired with {name!r}, has another condition: leave it out")
    if not _is_finite(condition.pressure_drop):
        raise InputError(f"pressure drop on {name!r} is {condition.pressure_drop!r}: give a finite number")


def _is_finite(value: object) -> bool:
    return is_number(value) and bool(np.isfinite(value))  # type: ignore[call-overload]
