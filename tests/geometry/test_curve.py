"""Hilbert's curve: near in the plane is near in the order."""

import numpy as np

from vasculo.geometry.curve import curve_order, curve_places, curve_places_plain, sort_keys


def test_hilberts_curve():
    grid = np.stack(np.divmod(np.arange(32 * 32), 32), axis=1).astype(np.float64)
    steps = np.abs(np.diff(grid[curve_order(grid)], axis=0)).sum(axis=1)
    assert (steps == 1.0).all()
    points = np.random.default_rng(0).normal(size=(300, 2))
    places = curve_places(points)
    assert np.array_equal(places, curve_places_plain(points))
    assert np.array_equal(sort_keys(places), np.argsort(places, kind="stable"))
    keys = np.random.default_rng(1).integers(0, 2**48, 1000) >> np.random.default_rng(2).integers(0, 48, 1000)
    assert np.array_equal(sort_keys(keys), np.argsort(keys, kind="stable"))
    assert curve_order(np.ones((4, 2))).tolist() == [0, 1, 2, 3]
    assert curve_order(np.empty((0, 2))).tolist() == []
