"""What can be chosen about the extraction."""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import InputError
from vasculo.geometry.outline import is_number
from vasculo.plexus.clearing import RULES

if TYPE_CHECKING:
    from collections.abc import Mapping

_RANGES: Mapping[str, tuple[float, float, bool]] = MappingProxyType(
    # name: lowest, highest, are these two themselves allowed
    {
        "tubule_width": (0.0, 100.0, False),
        "fluid_fraction": (0.0, 1.0, False),
        "smallest_radius": (0.0, 100.0, False),
        "spacing": (0.05, 10.0, True),
        "strip": (0.05, 100.0, True),
    }
)
_WHOLE: Mapping[str, tuple[int, float]] = MappingProxyType(
    {"triangle_budget": (1, np.inf), "triangles_across": (1, 20), "rays": (3, 4096)}
)
_OPTIONAL = ("tubule_width", "triangle_budget")
"""Parameters that may be None."""


@dataclass(frozen=True)
class Extraction:
    """How pillars are read from a network. Lengths in L0 (mean initial spring length) unless said.

    Parameters
    ----------
    tubule_width : float or None
        Width w of the narrowest tubule, above 0, below 100. None: found so that the fluid fraction is met, within 0.25
        to 1.25 L0 and wide enough that no pillars merge in the first remodelling step.
    fluid_fraction : float
        Wanted fluid area over tissue area, between 0 and 1, used when `tubule_width` is None.
    rule : str
        "offset": every outline moves inward by w/2. "minimum": only cords narrower than w are widened.
    smallest_radius : float
        Pillars of smaller equivalent radius are dropped; above 0, below 100.
    spacing : float
        Distance between outline nodes, 0.05 to 10.
    strip : float
        Plain strip before and behind the tissue, 0.05 to 100 R0 (radius of the mean pillar).
    triangle_budget : int or None
        Largest mesh allowed, 1 or more. Above it the tubules are widened (to 1.25 L0), then the pillars beside the
        dearest passages are merged (at most 15 %), else the extraction is refused. None: no limit, nothing is merged.
    triangles_across : int
        Triangles across a passage for which the mesh is predicted, 1 to 20.
    rays : int
        Test rays a void for the check of the outlines, 3 to 4096.

    Raises
    ------
    InputError
        When a value is outside its range.
    """

    tubule_width: float | None = None
    fluid_fraction: float = 0.40
    rule: str = "offset"
    smallest_radius: float = 0.6
    spacing: float = 0.6
    strip: float = 1.0
    triangle_budget: int | None = None
    triangles_across: int = 3
    rays: int = 64

    def __post_init__(self) -> None:
        """Check the parameters."""
        if not isinstance(self.rule, str) or self.rule not in RULES:
            raise InputError(f"rule must be one of {', '.join(sorted(RULES))}, got {self.rule!r}")
        for name, (low, high, closed) in _RANGES.items():
            value = getattr(self, name)
            if value is None and name in _OPTIONAL:
                continue
            inside = is_number(value) and (low <= value <= high if closed else low < value < high)
            if not inside:
                raise InputError(f"{name} must {_words(low, high, closed=closed)}, got {value!r}")
        for name, (least, most) in _WHOLE.items():
            value = getattr(self, name)
            if value is None and name in _OPTIONAL:
                continue
            whole = isinstance(value, int | np.integer) and not isinstance(value, bool)
            if not (whole and least <= value <= most):
                upper = f"to {most}" if np.isfinite(most) else "up"
                raise InputError(f"{name} must be a whole number from {least} {upper}, got {value!r}")


def _words(low: float, high: float, *, closed: bool) -> str:
    """Say a range."""
    if closed:
        return f"lie from {low:g} to {high:g}"
    return f"lie between {low:g} and {high:g}"
