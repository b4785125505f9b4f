"""States of the remodelling in the record: all that a run needs to go on from any recorded step to the same numbers.

What a frame holds already, the outlines and where they come from, is not stored twice.
"""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING, Any

import numpy as np

from vasculo.pillars.state import RemodelState

if TYPE_CHECKING:
    from collections.abc import Mapping

    from numpy.typing import NDArray

    Arrays = dict[str, NDArray[Any]]

SCALARS = tuple(field.name for field in fields(RemodelState) if field.type in {"int", "float"})
"""Fields that are single numbers; a frame holds them in one array, in this order."""


def state_rows(state: RemodelState, frame: Mapping[str, NDArray[Any]]) -> Arrays:
    """Bring a state into arrays that a frame can hold; those that follow from the frame are left empty.

    Parameters
    ----------
    state : RemodelState
        The state.
    frame : mapping of str to array
        Outlines of the same step, as `vasculo.store.frames.outlines` makes them.
    """
    arrays, known = state.arrays(), _known(frame)
    rows = {"scalars": np.array([arrays.pop(name) for name in SCALARS], dtype=np.float64)}
    for name, array in arrays.items():
        like = arrays["points"] if name == "reference" else known.get(name)
        rows[name] = array[:0] if like is not None and np.array_equal(array, like) else array
    return rows


def state_of(
    rows: Mapping[str, NDArray[Any]], scalars: tuple[str, ...], frame: Mapping[str, NDArray[Any]]
) -> RemodelState:
    """Rebuild a state from what `state_rows` gave.

    Parameters
    ----------
    rows, frame : mapping of str to array
        What was stored of the step.
    scalars : tuple of str
        Names of the single numbers.

    Raises
    ------
    InputError
        When an array is missing: the record is of another version.
    """
    arrays = dict(rows)
    arrays |= dict(zip(scalars, arrays.pop("scalars"), strict=True))
    for name, like in _known(frame).items():
        arrays[name] = arrays[name] if len(arrays[name]) else like
    arrays["reference"] = arrays["reference"] if len(arrays["reference"]) else arrays["points"].copy()
    return RemodelState.from_arrays(arrays)


def _known(frame: Mapping[str, NDArray[Any]]) -> Arrays:
    """Arrays of a state that follow from the outlines."""
    return {
        "points": frame["points"],
        "starts": _starts(frame["sizes"]),
        "members": frame["members"],
        "member_starts": _starts(frame["member_sizes"]),
    }


def _starts(sizes: NDArray[Any]) -> NDArray[np.int32]:
    return np.concatenate([[0], np.cumsum(sizes)]).astype(np.int32)
