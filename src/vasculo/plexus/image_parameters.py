"""What can be chosen about reading a plexus from a picture."""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np

from vasculo.errors import InputError
from vasculo.geometry.outline import is_number

if TYPE_CHECKING:
    from collections.abc import Mapping

Vessels = Literal["bright", "dark"]
Automatic = Literal["otsu", "li", "local"]
Side = Literal["left", "top", "right", "bottom"]
Border = Literal["open", "closed"]

SIDES: tuple[Side, ...] = get_args(Side)
"""Sides of a picture, clockwise: a picture whose inlet is side k is turned k quarters anticlockwise."""

_CHOICES: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {"vessels": get_args(Vessels), "inlet": SIDES, "outlet": SIDES, "border": get_args(Border)}
)
_RANGES: Mapping[str, tuple[float, float]] = MappingProxyType(
    # both ends are allowed
    {
        "window": (3.0, 1e5),
        "smoothing": (0.0, 100.0),
        "smallest_radius": (0.5, 1e4),
        "narrowest": (0.1, 1e4),
        "spacing": (0.1, 1e4),
        "strip": (0.05, 100.0),
    }
)
_OPTIONAL = ("window", "narrowest", "spacing", "outlet")
"""Parameters that may be None."""


@dataclass(frozen=True)
class ImageExtraction:
    """How pillars are read from a picture. Lengths are in pixels unless said.

    Parameters
    ----------
    vessels : {"bright", "dark"}
        Which pixels are vessel: those above the threshold, or those below.
    threshold : float or {"otsu", "li", "local"}
        A grey value of the picture, or how it is found: one value by the method of Otsu or of Li, or the local mean.
    window : float, optional
        Width of the neighbourhood of the local mean, 3 or more; an eighth of the picture's shorter side by default.
    smoothing : float
        Standard deviation of the blur before the outlines are taken, 0 to 100. It does not shrink what is round.
    smallest_radius : float
        Islands of smaller equivalent radius are dropped, 0.5 or more.
    narrowest : float, optional
        Narrower passages are widened to this, 0.1 or more. By default 1 or 0.177 R0, whichever is more, so that no
        pillars merge in their first step.
    spacing : float, optional
        Distance between outline nodes, 0.1 or more; 0.18 R0 by default.
    border : {"open", "closed"}
        What closes vessels that leave the picture beside the flow. "open": islands that these sides cut are pillars,
        half of `narrowest` from a mirror wall. "closed": such islands are wall, and the vessels between them end blind.
    inlet, outlet : {"left", "top", "right", "bottom"}
        Side at which the blood enters, and the one at which it leaves, which can only be the opposite one.
    crop : tuple of 4 int, optional
        Part of the picture to take: left column, top row, width and height, in pixels from its upper left corner.
    strip : float
        Plain strip before and behind the picture, 0.05 to 100 R0 (radius of the mean pillar).

    Raises
    ------
    InputError
        When a value is outside its range.

    Examples
    --------
    >>> import vasculo as vc
    >>> vc.ImageExtraction(vessels="dark", smoothing=2.0).threshold
    'otsu'
    """

    vessels: Vessels = "bright"
    threshold: float | Automatic = "otsu"
    window: float | None = None
    smoothing: float = 1.0
    smallest_radius: float = 2.0
    narrowest: float | None = None
    spacing: float | None = None
    border: Border = "open"
    inlet: Side = "left"
    outlet: Side | None = None
    crop: tuple[int, int, int, int] | None = None
    strip: float = 1.0

    def __post_init__(self) -> None:
        """Check the parameters."""
        for name, known in _CHOICES.items():
            value = getattr(self, name)
            if not (value in known or (value is None and name in _OPTIONAL)):
                raise InputError(f"{name} must be one of {', '.join(known)}, got {value!r}")
        for name, (low, high) in _RANGES.items():
            value = getattr(self, name)
            if value is None and name in _OPTIONAL:
                continue
            if not (is_number(value) and low <= value <= high):
                raise InputError(f"{name} must lie from {low:g} to {high:g} pixels, got {value!r}")
        automatic = get_args(Automatic)
        if not (self.threshold in automatic if isinstance(self.threshold, str) else is_number(self.threshold)):
            raise InputError(f"threshold must be a grey value or one of {', '.join(automatic)}, got {self.threshold!r}")
        opposite = SIDES[(SIDES.index(self.inlet) + 2) % 4]
        if self.outlet not in {None, opposite}:
            raise InputError(f"outlet {self.outlet} is not opposite inlet {self.inlet}: it must be {opposite}")
        if self.crop is not None and not (
            len(self.crop) == 4 and all(isinstance(value, int | np.integer) and value >= 0 for value in self.crop)
        ):
            raise InputError(f"crop must be four whole numbers: left, top, width, height, got {self.crop!r}")

    @property
    def quarters(self) -> int:
        """Quarter turns anticlockwise that bring the inlet to the left."""
        return SIDES.index(self.inlet)
