"""What can be chosen about the extraction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from vasculo.errors import InputError
from vasculo.plexus.clearing import RULES


@dataclass(frozen=True)
class Extraction:
    """How pillars are read from a network. Lengths in L0 (mean initial spring length) unless said.

    Parameters
    ----------
    tubule_width : float or None
        Width w of the narrowest tubule. None: found so that the fluid fraction is met, within 0.25 to 1.25 L0 and wide
        enough that no pillars merge in the first remodelling step.
    fluid_fraction : float
        Wanted fluid area over tissue area, used when `tubule_width` is None.
    rule : str
        "offset": every outline moves inward by w/2. "minimum": only cords narrower than w are widened.
    smallest_radius : float
        Pillars of smaller equivalent radius are dropped.
    spacing : float
        Distance between outline nodes.
    strip : float
        Plain strip before and behind the tissue, in R0 (radius of the mean pillar).
    triangle_budget : int or None
        Largest mesh allowed. Above it the tubules are widened (to 1.25 L0), then the pillars beside the dearest
        passages are merged (at most 15 %), else the extraction is refused. None: no limit, nothing is merged.
    triangles_across : int
        Triangles across a passage for which the mesh is predicted.
    rays : int
        Test rays a void for the check of the outlines.
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
        if self.rule not in RULES:
            raise InputError(f"rule must be one of {', '.join(sorted(RULES))}, got {self.rule!r}")
        if self.tubule_width is not None and not 0.0 < self.tubule_width < np.inf:
            raise InputError(f"tubule_width must be positive, got {self.tubule_width}")
        if not 0.0 < self.fluid_fraction < 1.0:
            raise InputError(f"fluid_fraction must lie between 0 and 1, got {self.fluid_fraction}")
        for name in ("smallest_radius", "spacing", "strip"):
            value = getattr(self, name)
            if not 0.0 < value < np.inf:
                raise InputError(f"{name} must be positive, got {value}")
        for name, least in (("triangle_budget", 1), ("triangles_across", 1), ("rays", 3)):
            value = getattr(self, name)
            if value is not None and value < least:
                raise InputError(f"{name} must be at least {least}, got {value}")
