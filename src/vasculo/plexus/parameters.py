"""What can be chosen about the extraction."""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import InputError
from vasculo.geometry.outline import is_number

if TYPE_CHECKING:
    from collections.abc import Mapping

USUAL_FRACTION = 0.40
"""Fluid fraction that is met when nothing is asked for."""
WAYS = ("fluid_fraction", "lumen_width", "minimum_width")
"""The ways to say how wide tubules are; one at a time."""

RANGES: Mapping[str, tuple[float, float, bool]] = MappingProxyType(
    {
        "fluid_fraction": (0.0, 1.0, False),
        "lumen_width": (0.0, 100.0, False),
        "minimum_width": (0.0, 100.0, False),
        "smallest_radius": (0.0, 100.0, False),
        "spacing": (0.05, 10.0, True),
        "strip": (0.05, 100.0, True),
        "edge_length": (0.02, 10.0, True),
    }
)
"""Lowest and highest value of each number, and whether these two themselves are allowed."""
WHOLE: Mapping[str, tuple[int, float]] = MappingProxyType(
    {"triangle_budget": (1, np.inf), "triangles_across": (1, 20), "rays": (3, 4096)}
)
"""Lowest and highest value of each whole number, both allowed."""
_OPTIONAL = (*WAYS, "triangle_budget")
"""Parameters that may be None."""


@dataclass(frozen=True)
class Extraction:
    """How pillars are read from a network. Lengths in L0 (mean initial spring length) unless said.

    How wide tubules become is said by `fluid_fraction`, `lumen_width` or `minimum_width`, never by two of them; by none
    of them it is a fluid fraction of 0.40.

    Parameters
    ----------
    fluid_fraction : float, optional
        Fluid area over tissue area, between 0 and 1. The lumen width that meets it is looked for within 0.25 to 1.25
        L0, and no narrower than what keeps pillars apart in the first remodelling step. Excludes `lumen_width` and
        `minimum_width`; 0.40 if none of the three is given.
    lumen_width : float, optional
        Width that is added to every cord [L0], above 0, below 100: a cord of n springs becomes a tubule as wide as the
        cord plus this. Excludes `fluid_fraction` and `minimum_width`.
    minimum_width : float, optional
        Width of the narrowest tubules [L0], above 0, below 100: only cords that are narrower are widened. Excludes
        `fluid_fraction` and `lumen_width`.
    smallest_radius : float
        Pillars of smaller equivalent radius are dropped [L0]; above 0, below 100.
    spacing : float
        Distance between outline nodes [L0], 0.05 to 10.
    strip : float
        Plain strip before and behind the tissue [R0], 0.05 to 100; R0 is the radius of the mean pillar.
    triangle_budget : int, optional
        Largest flow mesh allowed, in expected triangles, 1 or more. Above it the tubules are widened (to 1.25 L0), then
        the pillars beside the dearest passages are merged (at most 15 %), else the extraction is refused. If not given
        there is no limit and nothing is merged.
    triangles_across : int
        Triangles across a passage of the mesh that is predicted, 1 to 20.
    edge_length : float
        Plain edge length of the mesh that is predicted [R0], 0.02 to 10.
    rays : int
        Test rays a void for the check of the outlines, 3 to 4096.

    Raises
    ------
    InputError
        When a value is outside its range, or two of the widths are given.

    Examples
    --------
    >>> import vasculo as vc
    >>> tissue = vc.lattice(nodes=1_000, seed=1)
    >>> torn = vc.grow_plexus(tissue, vc.Vasculogenesis(pillar_spacing=0.35), seed=1)
    >>> vc.extract_domain(torn, vc.Extraction(strip=2.0)).side_names
    ('bottom', 'left', 'right', 'top')
    """

    fluid_fraction: float | None = None
    lumen_width: float | None = None
    minimum_width: float | None = None
    smallest_radius: float = 0.6
    spacing: float = 0.6
    strip: float = 1.0
    triangle_budget: int | None = None
    triangles_across: int = 3
    edge_length: float = 0.7
    rays: int = 64

    def __post_init__(self) -> None:
        """Check the parameters."""
        for name, (low, high, closed) in RANGES.items():
            value = getattr(self, name)
            if value is None and name in _OPTIONAL:
                continue
            inside = is_number(value) and (low <= value <= high if closed else low < value < high)
            if not inside:
                raise InputError(f"{name} must {_words(low, high, closed=closed)}, got {value!r}")
        for name, (least, most) in WHOLE.items():
            value = getattr(self, name)
            if value is None and name in _OPTIONAL:
                continue
            whole = isinstance(value, int | np.integer) and not isinstance(value, bool)
            if not (whole and least <= value <= most):
                upper = f"to {most}" if np.isfinite(most) else "up"
                raise InputError(f"{name} must be a whole number from {least} {upper}, got {value!r}")
        given = [f"{name} = {getattr(self, name)!r}" for name in WAYS if getattr(self, name) is not None]
        if len(given) > 1:
            raise InputError(f"{' and '.join(given)} exclude each other: give one of {', '.join(WAYS)}")

    @property
    def rule(self) -> str:
        """Which of the rules of `vasculo.plexus.rules` makes the tubules: "offset" or "minimum"."""
        return "offset" if self.minimum_width is None else "minimum"

    @property
    def width(self) -> float | None:
        """Tubule width that is given (L0), by either rule; None where a fluid fraction is to be met."""
        return self.lumen_width if self.minimum_width is None else self.minimum_width


def _words(low: float, high: float, *, closed: bool) -> str:
    """Say a range."""
    if closed:
        return f"lie from {low:g} to {high:g}"
    return f"lie between {low:g} and {high:g}"
