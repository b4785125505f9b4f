"""Input of a spring network, looked at once: every fault named with its spring or node and its numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import InputError
from vasculo.springs.box import nearest_periods

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    Ints = NDArray[np.int32]
    Floats = NDArray[np.float64]


def as_floats(name: str, values: ArrayLike, shape: tuple[int, ...], of: str) -> Floats:
    """Copy of the values as contiguous float64 of this shape; a single number fills it. Finite, or InputError."""
    try:
        array = np.array(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(f"{name} are not numbers: {error}") from error
    if array.ndim == 0:
        array = np.full(shape, array)
    if array.shape != shape:
        raise InputError(f"{name} have shape {array.shape}, expected {shape}")
    bad = ~np.isfinite(array)
    if bad.any():
        where = tuple(int(index[0]) for index in np.nonzero(bad))
        raise InputError(f"{name} of {of} {where[0]} are not finite: {array[where[0]].tolist()}")
    return np.ascontiguousarray(array)


def as_points(values: ArrayLike) -> Floats:
    """Node positions (n, 2), at least one, finite."""
    try:
        shape = np.shape(values)
    except ValueError as error:
        raise InputError(f"points do not form an (n, 2) array: {error}") from error
    if len(shape) != 2 or shape[1] != 2 or shape[0] == 0:
        raise InputError(f"points have shape {shape}, expected (n, 2) with n >= 1")
    return as_floats("points", values, (shape[0], 2), "node")


def as_indices(name: str, values: ArrayLike, columns: int, nodes: int) -> Ints:
    """Copy of node indices (k, columns) as int32; whole numbers that name existing nodes, no row a node twice."""
    try:
        array = np.asarray(values)
    except ValueError as error:
        raise InputError(f"{name}s do not form a (k, {columns}) array: {error}") from error
    if array.size == 0:
        return np.empty((0, columns), dtype=np.int32)
    if array.ndim != 2 or array.shape[1] != columns:
        raise InputError(f"{name}s have shape {array.shape}, expected (k, {columns})")
    if not np.issubdtype(array.dtype, np.integer):
        raise InputError(f"{name}s are of type {array.dtype}, expected whole numbers (node indices)")
    missing = (array < 0) | (array >= nodes)
    if missing.any():
        row = int(np.argmax(missing.any(axis=1)))
        raise InputError(
            f"{name} {row} names node {int(array[row][missing[row]][0])}, but the nodes are 0 to {nodes - 1}"
        )
    same = np.zeros(len(array), dtype=bool)
    for column in range(columns):
        same |= array[:, column] == array[:, column - 1]
    if same.any():
        row = int(np.argmax(same))
        raise InputError(f"{name} {row} names a node twice: {array[row].tolist()}")
    return np.ascontiguousarray(array, dtype=np.int32)


def as_springs(values: ArrayLike, nodes: int) -> Ints:
    """Springs (m, 2) that name existing nodes, none twice, none from a node to itself."""
    springs = as_indices("spring", values, 2, nodes)
    low, high = springs.min(axis=1).astype(np.int64), springs.max(axis=1).astype(np.int64)
    keys = low * nodes + high
    order = np.argsort(keys, kind="stable")
    twins = keys[order][1:] == keys[order][:-1]
    if twins.any():
        at = int(np.argmax(twins))
        first, second = int(order[at]), int(order[at + 1])
        raise InputError(f"springs {first} and {second} join the same nodes {springs[second].tolist()}")
    return springs


def not_negative(name: str, values: Floats, of: str, *, zero: bool = True) -> Floats:
    """Values that are at least zero (or above zero), or InputError with the first that is not."""
    bad = values < 0.0 if zero else values <= 0.0
    if bad.any():
        at = int(np.argmax(bad))
        raise InputError(f"{name} of {of} {at} is {values[at]:.6g}, expected {'>= 0' if zero else '> 0'}")
    return values


def as_limits(values: ArrayLike | None, springs: int) -> Floats:
    """Check breaking forces: an array (m,), or a number for all (infinite for never); at least 0, not NaN."""
    try:
        limits = np.asarray(np.inf if values is None else values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(f"break_above is not a number or numbers: {error}") from error
    if limits.shape not in {(), (springs,)}:
        raise InputError(f"break_above has shape {limits.shape}, expected a number or ({springs},)")
    bad = ~(limits >= 0.0)
    if bad.any():
        at = int(np.argmax(bad))
        raise InputError(f"break_above of spring {at} is {limits.flat[at]:.6g}, expected a force >= 0")
    return limits


def as_number(name: str, value: object, *, zero: bool = True) -> float:
    """One finite number that is at least zero (or above zero)."""
    number = float(value) if isinstance(value, int | float | np.integer | np.floating) else float("nan")
    if isinstance(value, bool) or not np.isfinite(number) or number < 0.0 or (number == 0.0 and not zero):
        raise InputError(f"{name} is {value!r}, expected a finite number {'>= 0' if zero else '> 0'}")
    return number


def as_mask(name: str, values: ArrayLike | None, nodes: int) -> NDArray[np.bool_]:
    """Boolean mask (n,), from a mask or from node indices; nothing given is nothing marked."""
    mask = np.zeros(nodes, dtype=bool)
    if values is None:
        return mask
    given = np.asarray(values)
    if given.dtype == bool:
        if given.shape != (nodes,):
            raise InputError(f"{name} has shape {given.shape}, expected ({nodes},)")
        return given.copy()
    if given.size == 0:
        return mask
    if given.ndim != 1 or not np.issubdtype(given.dtype, np.integer):
        raise InputError(f"{name} has type {given.dtype} and shape {given.shape}, expected a mask or node indices")
    if given.min() < 0 or given.max() >= nodes:
        raise InputError(f"{name} names nodes {given.min()} to {given.max()}, but the nodes are 0 to {nodes - 1}")
    mask[given] = True
    return mask


def as_box(values: ArrayLike | None, points: Floats, springs: Ints) -> Floats | None:
    """Check the periods (2,) of a network: above 0, and no spring as long as half of one between nearest images."""
    if values is None:
        return None
    try:
        box = np.array(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InputError(f"box is not two numbers: {error}") from error
    if box.shape != (2,) or not (box > 0.0).all():
        raise InputError(f"box is {box.tolist()}, expected two periods > 0")
    arms = points[springs[:, 1]] - points[springs[:, 0]]
    arms -= nearest_periods(arms, box)
    long = (np.abs(arms) >= 0.499 * box).any(axis=1)
    if long.any():
        at = int(np.argmax(long))
        raise InputError(
            f"spring {at} spans {arms[at].tolist()} of a box of {box.tolist()}: it must be shorter than half a period, "
            "or its nearest image is not certain"
        )
    return box
