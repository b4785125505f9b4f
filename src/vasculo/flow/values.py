"""Numbers and functions of the place, evaluated at points and checked: kind, shape, and whether they are finite."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from vasculo.errors import InputError

Array = NDArray[np.float64]
Scalar = float | Callable[[Array, Array], Array]
Field = Callable[[Array, Array], tuple[Array, Array]]


def scalar_at(value: object, points: Array, what: str) -> Array:
    """Evaluate a number, or a function of the two coordinates, at points.

    Parameters
    ----------
    value : float or callable
    points : (..., 2) float64, model length
    what : str
        What it is, for messages: "pressure on 'left'".

    Returns
    -------
    (...) float64

    Raises
    ------
    InputError
        It is no number and gives none, gives an array of another shape, or values that are not finite.
    """
    x, y = points[..., 0], points[..., 1]
    found = value(x, y) if callable(value) else value
    try:
        array = np.asarray(found)
    except ValueError:
        array = np.asarray(None)
    if array.dtype.kind not in "biuf":
        raise InputError(f"{what}: give numbers, or functions that return numbers or arrays of shape {x.shape}")
    if array.shape not in {(), x.shape}:
        raise InputError(f"{what}: a component has shape {array.shape}, its coordinates have {x.shape}")
    wrong = np.broadcast_to(~np.isfinite(array), x.shape)
    if wrong.any():
        first = np.unravel_index(np.argmax(wrong), x.shape)
        raise InputError(
            f"{what}: {np.count_nonzero(wrong)} of {x.size} values are not finite, "
            f"the first one at ({x[first]:.6g}, {y[first]:.6g})"
        )
    return np.broadcast_to(array, x.shape).astype(np.float64)


def vector_at(value: object, points: Array, what: str) -> Array:
    """Evaluate a vector at points: two numbers or functions, or one function that returns both components.

    Parameters
    ----------
    value : pair of float or callable, or callable
    points : (..., 2) float64, model length
    what : str
        What it is, for messages.

    Returns
    -------
    (..., 2) float64

    Raises
    ------
    InputError
        There are not two components, or one of them cannot be used (see `scalar_at`).
    """
    pair = value(points[..., 0], points[..., 1]) if callable(value) else value
    if not (isinstance(pair, (tuple, list)) or (isinstance(pair, np.ndarray) and pair.ndim)) or len(pair) != 2:
        raise InputError(f"{what}: give two components, or a function that returns both, (x, y) -> (first, second)")
    return np.stack([scalar_at(part, points, what) for part in pair], axis=-1)
