"""The settings that the fit searches, and the ranges in which it does."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from vasculo.tissue.parameters import Vasculogenesis

if TYPE_CHECKING:
    from collections.abc import Sequence


@dataclass(frozen=True)
class Searched:
    """A setting of the vasculogenesis that is searched.

    Attributes
    ----------
    name : str
        Name of a parameter of `Vasculogenesis`.
    low, high : float
        Ends of the range.
    scale : {"linear", "log"}
        How values lie between the ends.
    least : float
        Smaller values count as 0.
    """

    name: str
    low: float
    high: float
    scale: Literal["linear", "log"] = "linear"
    least: float = 0.0

    def value(self, place: float) -> float:
        """Value at a place from 0 (low) to 1 (high), with four digits."""
        if self.scale == "log":
            found = self.low * (self.high / self.low) ** place
        else:
            found = self.low + place * (self.high - self.low)
        return float(f"{found:.4g}") if found >= self.least else 0.0

    def place(self, value: float) -> float:
        """Place of a value, from 0 to 1; that of the nearer end for one outside of the range."""
        value = min(max(value, self.low), self.high)
        if self.scale == "log":
            return float(np.log(value / self.low) / np.log(self.high / self.low))
        return (value - self.low) / (self.high - self.low)


SEARCHED: tuple[Searched, ...] = (
    Searched("growth_rate", 0.0008, 0.008, "log"),
    Searched("tether", 0.001, 0.1, "log"),
    Searched("stop_void_fraction", 0.25, 0.45),
    Searched("threshold_spread", 0.05, 0.4),
    Searched("threshold_correlation", 0.5, 4.0, least=1.0),
    Searched("final_rest_factor", 0.05, 0.4),
)


def vasculogenesis_of(places: Sequence[float], searched: Sequence[Searched] = SEARCHED) -> Vasculogenesis:
    """Make settings of places from 0 to 1, one for each that is searched; the others are the defaults."""
    values = {each.name: each.value(float(place)) for each, place in zip(searched, places, strict=True)}
    return Vasculogenesis(**values)  # type: ignore[arg-type]  # names and values belong together
