"""Fingerprints of arrays: whether somebody changed one by hand, without keeping a copy of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numba import njit

if TYPE_CHECKING:
    from numpy.typing import NDArray

LANES = 4
"""Numbers that are mixed side by side."""

_FACTOR = np.uint64(0x9E3779B97F4A7C15)  # odd, of no pattern: 2^64 over the golden ratio


def fingerprint(array: object) -> tuple[object, ...]:
    """Type, shape and a 64-bit digest of the bytes of an array; equal for equal arrays, and else all but never.

    Anything but a contiguous array has the empty fingerprint, which equals nothing that `SpringNetwork` remembers.
    """
    if not isinstance(array, np.ndarray) or not array.flags.c_contiguous:
        return ()
    flat = array.reshape(-1).view(np.uint8)
    words = flat[: flat.size // 8 * 8].view(np.uint64)
    rest = int.from_bytes(flat[words.nbytes :].tobytes(), "little")
    return array.dtype.str, array.shape, int(digest(words)), rest


@njit(cache=True, error_model="numpy")
def digest(words):  # type: ignore[no-untyped-def]
    """Mix uint64 words (k,) into one; four lanes, so that the multiplications overlap."""
    one, two, three, four = np.uint64(1), np.uint64(2), np.uint64(3), np.uint64(4)
    whole = words.size // LANES * LANES
    for k in range(0, whole, LANES):
        one = (one ^ words[k]) * _FACTOR
        two = (two ^ words[k + 1]) * _FACTOR
        three = (three ^ words[k + 2]) * _FACTOR
        four = (four ^ words[k + 3]) * _FACTOR
        one ^= one >> np.uint64(29)
        two ^= two >> np.uint64(29)
        three ^= three >> np.uint64(29)
        four ^= four >> np.uint64(29)
    for k in range(whole, words.size):
        one = (one ^ words[k]) * _FACTOR
        one ^= one >> np.uint64(29)
    for lane in (two, three, four):
        one = (one ^ lane) * _FACTOR
        one ^= one >> np.uint64(29)
    return one


def digest_plain(words: NDArray[np.uint64]) -> int:
    """Plain twin of `digest`."""
    factor, mask = int(_FACTOR), 2**64 - 1

    def mix(lane: int, word: int) -> int:
        lane = ((lane ^ word) * factor) & mask
        return lane ^ (lane >> 29)

    lanes = [1, 2, 3, 4]
    whole = len(words) // LANES * LANES
    for k, word in enumerate(words[:whole].tolist()):
        lanes[k % LANES] = mix(lanes[k % LANES], word)
    for word in words[whole:].tolist():
        lanes[0] = mix(lanes[0], word)
    for lane in lanes[1:]:
        lanes[0] = mix(lanes[0], lane)
    return lanes[0]
