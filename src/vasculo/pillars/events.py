"""What happens to pillars in a remodelling run, and to the run as a whole: a list of events."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

EventKind = Literal["merge", "border", "vanish", "split", "closure", "rest"]


@dataclass(frozen=True, slots=True)
class Event:
    """Something that happened at the end of a step.

    Attributes
    ----------
    step : int
    time : float
        Accumulated activation strain (effective steps when the cells hang), dimensionless.
    kind : {"merge", "border", "vanish", "split", "closure", "rest"}
        Two pillars became one; a pillar joined a closed side; one vanished; one parted in two; the shear ratio between
        pillars passed `Angiogenesis.closure_ratio`; nothing moves any more.
    place : tuple of 2 float
        Where, model length: between the nearest points of two pillars that merged or parted, on the border for one that
        joined it, the centroid of one that vanished, the middle of the domain otherwise.
    pillars : tuple of tuple of int
        The pillars concerned, each as the sorted original pillars in it; of a split the two parts, the larger first.
    angle : float
        Of a merge: direction between the two centroids, degrees against x, in (-90, 90]; NaN otherwise.
    """

    step: int
    time: float
    kind: EventKind
    place: tuple[float, float]
    pillars: tuple[tuple[int, ...], ...] = ()
    angle: float = float("nan")
