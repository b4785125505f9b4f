"""Fingerprints: equal for equal arrays, different for any change."""

import numpy as np
import pytest

from vasculo.springs.fingerprint import digest, digest_plain, fingerprint


@pytest.mark.parametrize("size", [0, 1, 3, 4, 5, 8, 1001])
def test_kernel_and_twin(size):
    words = np.random.default_rng(size).integers(0, 2**64, size, dtype=np.uint64)
    assert int(digest(words)) == digest_plain(words)


@pytest.mark.parametrize("dtype", [np.float64, np.int32, np.bool_, np.uint8])
def test_any_change_shows(dtype):
    array = np.random.default_rng(0).integers(0, 2, (37, 3)).astype(dtype)
    before = fingerprint(array)
    assert fingerprint(array.copy()) == before
    seen = {before}
    for at in range(array.size):
        array.flat[at] = 1 - array.flat[at] if dtype != np.bool_ else not array.flat[at]
        seen.add(fingerprint(array))
        array.flat[at] = 1 - array.flat[at] if dtype != np.bool_ else not array.flat[at]
    assert len(seen) == array.size + 1
    assert fingerprint(array) == before
    assert fingerprint(array.reshape(3, 37)) != before
    assert fingerprint(array.view(np.int8) if dtype == np.uint8 else array.astype(np.float32)) != before


def test_swapped_and_shifted_values_show():
    rng = np.random.default_rng(1)
    array = rng.random(64)
    seen = {fingerprint(array), fingerprint(array[::-1].copy()), fingerprint(np.roll(array, 4)), fingerprint(-array)}
    for _ in range(200):
        swapped = array.copy()
        i, j = rng.choice(64, 2, replace=False)
        swapped[[i, j]] = swapped[[j, i]]
        assert fingerprint(swapped) != fingerprint(array)
    assert len(seen) == 4
    assert fingerprint(np.zeros(3)) != fingerprint(np.zeros(4))


def test_what_is_no_contiguous_array_equals_nothing_remembered():
    assert fingerprint([1.0, 2.0]) == fingerprint(np.zeros((4, 4))[:, ::2]) == ()
