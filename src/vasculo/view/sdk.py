"""Rerun, the viewer that everything here speaks to: an extra, with its usage statistics off."""

from __future__ import annotations

import os
from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np

from vasculo.errors import missing_extra

try:
    import rerun
    from rerun import blueprint
except ImportError:
    raise missing_extra("viewers", "rerun-sdk", "view") from None

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray

__all__ = ["blueprint", "bytes_of", "rerun", "without_statistics"]


@contextmanager
def without_statistics() -> Iterator[None]:
    """Start programs of rerun that keep no usage statistics and send none.

    They do so wherever the variable `CI` is set; the settings of the user stay as they are.
    """
    before = os.environ.get("CI")
    os.environ["CI"] = "true"
    try:
        yield
    finally:
        if before is None:
            del os.environ["CI"]
        else:
            os.environ["CI"] = before


def bytes_of(colour: str) -> NDArray[np.uint8]:
    """Return a colour written as #rrggbb as three bytes; (3,) uint8.

    Examples
    --------
    >>> bytes_of("#ff8000").tolist()
    [255, 128, 0]
    """
    return np.frombuffer(bytes.fromhex(colour[1:]), dtype=np.uint8)
