"""Cell responses: laws that turn the shear along a membrane into contraction or stretching, by name."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import ComputationError, InputError

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

Law = Callable[["Floats", float, "Floats"], "Floats"]

_LAWS: dict[str, Law] = {}


def cell_response(name: str) -> Callable[[Law], Law]:
    """Register a law under a name, which `Angiogenesis.response` then takes.

    A law is a function of the wall shear at the nodes of one membrane, its mean over the membrane, and the position
    of the nodes along it. It gives the activation: 1 contracts a filament by the whole of `Angiogenesis.activation`,
    -1 stretches it as much; larger values are cut at `Angiogenesis.activation_limit`.

    Parameters
    ----------
    name : str
        Letters, digits, "-" and "_".

    Returns
    -------
    callable
        Decorator that gives the law back unchanged. The law takes ``shear`` (k,) float64, magnitude, model pressure;
        ``mean`` float, weighted by membrane length, above 0; ``position`` (k,) float64, arc length from the first node
        over the perimeter, 0 to 1. It returns (k,) float64. It is called once a pillar and step and must not change
        its arguments.

    Raises
    ------
    InputError
        If the name is taken or has other characters.

    Examples
    --------
    >>> import numpy as np
    >>> from vasculo.pillars.responses import cell_response
    >>> @cell_response("threshold")
    ... def threshold(shear, mean, position):
    ...     return np.where(shear > 1.2 * mean, 1.0, np.where(shear < 0.8 * mean, -1.0, 0.0))
    """
    if not re.fullmatch(r"[A-Za-z0-9_-]+", name):
        raise InputError(f"cell response {name!r} needs a name of letters, digits, '-' and '_'")

    def register(law: Law) -> Law:
        known = _LAWS.get(name)
        if known is not None and _home(known) != _home(law):
            raise InputError(f"cell response {name!r} is already defined in {_home(known)[0]}: choose another name")
        _LAWS[name] = law
        return law

    return register


def find_response(name: str) -> Law:
    """Return the law of this name.

    Raises
    ------
    InputError
        If there is none.
    """
    if name not in _LAWS:
        raise InputError(f"response = {name!r} is not one of {', '.join(sorted(_LAWS))}")
    return _LAWS[name]


def known_responses() -> dict[str, Law]:
    """Return a copy of all laws, by name."""
    return dict(_LAWS)


def restore_responses(laws: Mapping[str, Law]) -> None:
    """Put the registry back to what `known_responses` gave."""
    _LAWS.clear()
    _LAWS.update(laws)


def respond(name: str, shear: Floats, mean: float, position: Floats, limit: float) -> Floats:
    """Apply a law to one membrane and cut its result at +- `limit`.

    Raises
    ------
    ComputationError
        If the law fails, or gives another shape or numbers that are not finite.
    """
    law = find_response(name)
    try:
        result = np.asarray(law(shear, mean, position), dtype=np.float64)
    except Exception as error:  # whatever a user's law raises
        raise ComputationError(f"cell response {name!r} failed: {type(error).__name__}: {error}") from error
    if result.shape != shear.shape:
        raise ComputationError(f"cell response {name!r} gave shape {result.shape} for {len(shear)} membrane nodes")
    if not np.isfinite(result).all():
        bad = int(np.argmin(np.isfinite(result)))
        raise ComputationError(
            f"cell response {name!r} gave {result[bad]} at membrane node {bad}, "
            f"where the shear is {shear[bad]:.3g} and its mean {mean:.3g}"
        )
    return np.clip(result, -limit, limit)


def _home(law: Law) -> tuple[str, str]:
    """File and name in which a law was written: the same law may be loaded twice."""
    code = getattr(law, "__code__", None)
    return (code.co_filename if code is not None else law.__module__, getattr(law, "__qualname__", ""))


@cell_response("linear")
def linear(shear: Floats, mean: float, _position: Floats) -> Floats:
    """Relative difference to the mean (ours for what Szczerba & Szekely 2005, section 4, say in words)."""
    return shear / mean - 1.0


@cell_response("logarithm")
def logarithm(shear: Floats, mean: float, _position: Floats) -> Floats:
    """Logarithm of the ratio to the mean: half and double the mean count alike."""
    return np.log(np.maximum(shear / mean, 1e-12))


@cell_response("sign")
def sign(shear: Floats, mean: float, _position: Floats) -> Floats:
    """Full contraction above the mean and full stretching below: only the sign of the difference counts."""
    return np.sign(shear - mean)
