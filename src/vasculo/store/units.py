"""Physical units of a run: all is computed in model units, and told in um and dyn/cm2 where these are known."""

from __future__ import annotations

from dataclasses import dataclass

from vasculo.errors import InputError

DIMENSIONS = ("", "length", "area", "pressure", "velocity", "flow rate", "resistance", "density", "angle", "seconds")
"""What a number can be; the empty one has no unit. Flow is in the plane: a flow rate is an area a time."""

_PLAIN = {"": "", "angle": "degrees", "seconds": "s"}
_LENGTHS = {"length": 1, "area": 2, "density": -2}


@dataclass(frozen=True)
class Units:
    """Physical units, for labels, tables and the report only; everything is computed in model units.

    Parameters
    ----------
    length : float, optional
        One model length [µm], > 0: the side of the tissue, R0 of a block of pillars, the unit of a disk's box, a pixel
        of a picture.
    shear : float, optional
        One model pressure [dyn/cm2], > 0.
    viscosity : float, optional
        Viscosity of the blood [mPa s], > 0, the same as cP: for velocities and flow rates.

    Raises
    ------
    InputError
        When a value is not a number above 0.
    """

    length: float | None = None
    shear: float | None = None
    viscosity: float | None = None

    def __post_init__(self) -> None:
        for name in ("length", "shear", "viscosity"):
            value = getattr(self, name)
            if value is not None and not 0.0 < value < float("inf"):
                raise InputError(f"{name} = {value!r} is not a number above 0")

    def known(self, dimension: str) -> bool:
        """Whether numbers of a dimension can be told in physical units; see `DIMENSIONS`."""
        return dimension in _PLAIN or self._physical(dimension) is not None

    def factor(self, dimension: str) -> float:
        """Physical unit in one model unit; 1 when it is not known.

        Examples
        --------
        >>> Units(length=1000.0).factor("area")
        1000000.0
        """
        found = self._physical(dimension)
        return 1.0 if found is None else found[0]

    def name(self, dimension: str) -> str:
        """Name of the unit: physical where it is known, else in model units; empty for a pure number.

        Examples
        --------
        >>> Units(length=1000.0).name("length"), Units().name("length"), Units().name("")
        ('µm', 'model length', '')
        """
        if dimension in _PLAIN:
            return _PLAIN[dimension]
        found = self._physical(dimension)
        return _MODEL[dimension] if found is None else found[1]

    def _physical(self, dimension: str) -> tuple[float, str] | None:
        """Factor and name of the physical unit of a dimension, None when it is not known."""
        if dimension in _PLAIN:
            return 1.0, _PLAIN[dimension]
        if dimension in _LENGTHS:
            if self.length is None:
                return None
            return self.length ** _LENGTHS[dimension], _PHYSICAL[dimension]
        if dimension == "pressure":
            return None if self.shear is None else (self.shear, _PHYSICAL[dimension])
        if self.length is None or self.shear is None or self.viscosity is None:
            return None
        speed = 100.0 * self.shear * self.length / self.viscosity  # 0.1 Pa, 1e-6 m and 1e-3 Pa s make 1e-4 m/s
        factors = {
            "velocity": speed,
            "flow rate": speed * self.length,
            "resistance": self.shear / (speed * self.length),
        }
        return factors[dimension], _PHYSICAL[dimension]


_PHYSICAL = {
    "length": "µm",
    "area": "µm²",
    "density": "1/µm²",
    "pressure": "dyn/cm²",
    "velocity": "µm/s",
    "flow rate": "µm²/s",
    "resistance": "dyn s/(cm² µm²)",
}
_MODEL = {
    "length": "model length",
    "area": "model length²",
    "density": "1/model length²",
    "pressure": "model pressure",
    "velocity": "model velocity",
    "flow rate": "model flow rate",
    "resistance": "model resistance",
}
