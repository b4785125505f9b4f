"""The range of every number of a study, read from the tables that the stages check by."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING, Any

from vasculo.pillars import parameters as pillars
from vasculo.plexus import parameters as plexus
from vasculo.plexus import voronoi
from vasculo.store.units import Units
from vasculo.tissue import lattice as tissue
from vasculo.tissue import parameters as growth

if TYPE_CHECKING:
    from collections.abc import Callable


@dataclass(frozen=True)
class Range:
    """Where a number must lie.

    Attributes
    ----------
    low, high : float
        Its ends; infinite where there is none.
    low_open, high_open : bool
        Whether the end itself is left out.
    """

    low: float = -inf
    high: float = inf
    low_open: bool = False
    high_open: bool = False

    @property
    def words(self) -> str:
        """The range in words: "from 0 to 1", "above 0 to 100", "from 1 up"."""
        if self.high == inf:
            return f"above {self.low:g}" if self.low_open else f"from {_whole(self.low)} up"
        low = f"above {self.low:g}" if self.low_open else f"from {_whole(self.low)}"
        return f"{low} {'to below' if self.high_open else 'to'} {_whole(self.high)}"


def _whole(value: float) -> str:
    """Write an end of a range; whole numbers with all of their digits."""
    return str(int(value)) if float(value).is_integer() and abs(value) < 1e10 else f"{value:g}"


_LENGTH = Range(0.0, voronoi.LARGEST, low_open=True)
_FUNCTIONS: dict[Callable[..., Any], dict[str, Range]] = {
    tissue.lattice: {"nodes": Range(tissue.FEWEST, tissue.MOST), "jitter": Range(0.0, tissue.MOST_JITTER)},
    voronoi.voronoi_plexus: {
        "pillars": Range(1, voronoi.MOST_PILLARS),
        "width": _LENGTH,
        "height": _LENGTH,
        "channel": Range(0.0, voronoi.WIDEST_CHANNEL, low_open=True),
        "pad": Range(0.0, voronoi.WIDEST_PAD),
    },
    voronoi.disk_domain: {"width": _LENGTH, "height": _LENGTH, "radius": _LENGTH},
    growth.Vasculogenesis: {
        name: Range(low, high, low_open=not closed) for name, (low, high, closed) in growth.RANGES.items()
    },
    plexus.Extraction: {
        name: Range(low, high, low_open=not closed, high_open=not closed)
        for name, (low, high, closed) in plexus.RANGES.items()
    }
    | {name: Range(low, high) for name, (low, high) in plexus.WHOLE.items()},
    pillars.Angiogenesis: {name: Range(low, high) for name, (low, high) in pillars.RANGES.items()},
    Units: dict.fromkeys(("length", "shear", "viscosity"), Range(0.0, low_open=True)),
}


def ranges_of(target: Callable[..., Any]) -> dict[str, Range]:
    """Ranges of the numbers of a section, by key.

    Parameters
    ----------
    target : callable
        What the section configures: a function or dataclass of a stage, or one that has its own `RANGES`.
    """
    return _FUNCTIONS.get(target) or getattr(target, "RANGES", {})
