"""What a watcher of vasculogenesis is told."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from vasculo.springs.network import SpringNetwork


class GrowthPhase(StrEnum):
    """The stages of vasculogenesis, in order."""

    GROWTH = "growth"
    RUPTURE = "rupture"
    TIGHTENING = "tightening"
    SETTLING = "settling"


@dataclass(frozen=True)
class GrowthStep:
    """What a watcher of `grow_plexus` is told.

    Attributes
    ----------
    phase : GrowthPhase
        A string: growth, rupture, tightening or settling.
    step, steps_total : int
        Time steps done, and how many there will be (an estimate until rupture is over).
    time : float
        Time since the start (sqrt(m / k)).
    rest_factor : float
        The factor s of all rest lengths.
    broken : int
        Springs that broke so far, and those of loose pieces.
    void_fraction : float
        Share of the area in voids.
    voids : int
        Number of voids.
    residual : float
        Largest force on a free node over the mean spring force (0 when nothing is stretched).
    network : SpringNetwork
        A copy of the network as it is, rest lengths shrunk, so that its `tensions()` are the present spring forces.
    """

    phase: GrowthPhase
    step: int
    steps_total: int
    time: float
    rest_factor: float
    broken: int
    void_fraction: float
    voids: int
    residual: float
    network: SpringNetwork
