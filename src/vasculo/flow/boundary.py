"""Boundary conditions: what can hold on a side of the domain, and which edge has which."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from math import isfinite
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from vasculo.errors import InputError

if TYPE_CHECKING:
    from vasculo.mesh.triangulation import Triangulation

Array = NDArray[np.float64]
Component = float | Callable[[Array, Array], Array]
Field = Callable[[Array, Array], tuple[Array, Array]]

PILLARS = "pillars"


@dataclass(frozen=True)
class Wall:
    """No-slip wall at rest: the velocity is zero."""


@dataclass(frozen=True)
class Velocity:
    """Prescribed velocity: an inlet, an outlet or a moving wall.

    Parameters
    ----------
    x, y : float or callable
        Velocity components (model length per time). A callable gets two float64 arrays, the coordinates, and returns an
        array of the same shape; without `y` it may return both components as a tuple. ``Velocity(1.0)`` means
        ``Velocity(1.0, 0.0)``.
    """

    x: Component | Field
    y: Component | None = None

    def at(self, points: NDArray[np.float64], name: str) -> NDArray[np.float64]:
        """Evaluate at points, float64 (..., 2); `name` of the side is for messages only."""
        x, y = points[..., 0], points[..., 1]
        first = self.x(x, y) if callable(self.x) else self.x
        second = self.y(x, y) if callable(self.y) else self.y
        if second is None:
            first, second = first if isinstance(first, tuple) and len(first) == 2 else (first, 0.0)
        values = np.empty(points.shape)
        for part in (first, second):
            if np.shape(part) not in {(), x.shape}:
                raise InputError(
                    f"velocity on {name!r}: a component has shape {np.shape(part)}, its coordinates have {x.shape}"
                )
        try:
            values[..., 0], values[..., 1] = first, second
        except (TypeError, ValueError) as error:
            raise InputError(
                f"velocity on {name!r}: components must be numbers or arrays of shape {x.shape}"
            ) from error
        bad = int(np.count_nonzero(~np.isfinite(values).all(axis=-1)))
        if bad:
            raise InputError(f"velocity on {name!r}: {bad} of {x.size} values are not finite")
        return values


@dataclass(frozen=True)
class Pressure:
    """Opening at a given pressure; the velocity along the opening is zero.

    Parameters
    ----------
    value : float
        Pressure (force per length).
    """

    value: float


@dataclass(frozen=True)
class Slip:
    """Mirror line: no flow through it and no tangential stress on it."""


@dataclass(frozen=True)
class Periodic:
    """The flow leaves here and enters again on another side, a translated copy of this one.

    Parameters
    ----------
    other : str
        Name of the other side; it takes no condition of its own.
    pressure_drop : float
        Pressure here minus pressure at the matching point of the other side (force per length).
    """

    other: str
    pressure_drop: float = 0.0


Condition = Wall | Velocity | Pressure | Slip | Periodic


def conditions_by_name(mesh: Triangulation, conditions: Mapping[str, Condition]) -> dict[str, Condition]:
    """Check the conditions and complete them: every side, and "pillars", gets one; the default is a wall.

    Raises
    ------
    InputError
        For an unknown name, something that is no condition, or sides that cannot be paired.
    """
    names = [*mesh.side_names, PILLARS]
    for name, condition in conditions.items():
        if name not in names:
            near = get_close_matches(str(name), names, n=1, cutoff=0.0)
            raise InputError(f"no side is named {name!r}: did you mean {near[0]!r}? (there are {', '.join(names)})")
        if not isinstance(condition, Condition):
            raise InputError(
                f"condition on {name!r} is {condition!r}: give Wall(), Velocity(x, y), Pressure(value), Slip() or "
                "Periodic(other)"
            )
        if isinstance(condition, Pressure) and not _is_finite(condition.value):
            raise InputError(f"pressure on {name!r} is {condition.value!r}: give a finite number")
        if isinstance(condition, Periodic):
            _check_pair(name, condition, conditions, mesh)
    partners = {c.other: Periodic(n, -c.pressure_drop) for n, c in conditions.items() if isinstance(c, Periodic)}
    return {name: conditions.get(name, partners.get(name, Wall())) for name in names}


def periodic_pairs(conditions: Mapping[str, Condition]) -> list[tuple[str, str, float]]:
    """Pairs (side, other side, pressure drop) as the caller gave them, sorted by name."""
    return sorted((n, c.other, float(c.pressure_drop)) for n, c in conditions.items() if isinstance(c, Periodic))


def _check_pair(name: str, condition: Periodic, conditions: Mapping[str, Condition], mesh: Triangulation) -> None:
    other = condition.other
    if name == PILLARS or other not in mesh.side_names or other == name:
        near = [s for s in mesh.side_names if s != name]
        raise InputError(f"{name!r} cannot be periodic with {other!r}: pair two different sides ({', '.join(near)})")
    taken = [n for n, c in conditions.items() if n != name and isinstance(c, Periodic) and other in {c.other, n}]
    if other in conditions or taken:
        raise InputError(f"side {other!r}, paired with {name!r}, has another condition: leave it out")
    if not _is_finite(condition.pressure_drop):
        raise InputError(f"pressure drop on {name!r} is {condition.pressure_drop!r}: give a finite number")


def _is_finite(value: object) -> bool:
    return isinstance(value, (int, float, np.floating, np.integer)) and isfinite(value)
