import numpy as np
import pytest

from vasculo import measure
from vasculo.errors import InputError
from vasculo.springs.network import SpringNetwork


def grid_with_holes(holes, triangles=True):
    """Unit grid 30 x 20 with a diagonal in each square; springs inside the given boxes are gone."""
    x, y = np.meshgrid(np.arange(31.0), np.arange(21.0))
    points = np.stack([x.ravel(), y.ravel()], axis=1)
    corner = (np.arange(30)[None, :] + 31 * np.arange(20)[:, None]).ravel()
    corners = [
        np.stack([corner, corner + 1, corner + 32], axis=1),
        np.stack([corner, corner + 32, corner + 31], axis=1),
    ]
    faces = np.concatenate(corners)
    edges = np.unique(np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)
    middle = points[edges].mean(axis=1)
    gone = np.zeros(len(edges), dtype=bool)
    for x0, y0, x1, y1 in holes:
        gone |= (middle > (x0, y0)).all(axis=1) & (middle < (x1, y1)).all(axis=1)
    network = SpringNetwork(points, edges[~gone], triangles=faces if triangles else None)
    return network, float(np.mean(~gone)), float(np.hypot(*(points[edges[:, 0]] - points[edges[:, 1]]).T).mean())


def test_exact_numbers():
    network, left, unit = grid_with_holes([(2, 2, 8, 8), (10, 2, 20, 14)])
    numbers = measure.plexus(network)
    assert numbers.springs_left == pytest.approx(left)
    assert numbers.voids == 2
    np.testing.assert_allclose(np.sort(numbers.areas), [36.0 / 0.5, 120.0 / 0.5])
    assert numbers.void_fraction == pytest.approx(156.0 / 600.0)
    assert numbers.spacing == pytest.approx(np.sqrt(300.0) / unit)
    weighted = (36.0**2 + 120.0**2) / 156.0
    assert numbers.mean_diameter == pytest.approx(2.0 * np.sqrt(weighted / np.pi) / unit)
    assert numbers.median_area == pytest.approx(78.0 / 0.5)
    assert numbers.variation == pytest.approx(42.0 / 78.0)
    assert (numbers.components, numbers.dangling_fraction) == (1, 0.0)


def test_without_triangles():
    numbers = measure.plexus(grid_with_holes([(2, 2, 8, 8), (10, 2, 20, 14)], triangles=False)[0])
    assert numbers.springs_left is None
    assert numbers.voids == 2
    assert numbers.void_fraction == pytest.approx(156.0 / 600.0)


def test_a_whole_tissue_has_no_voids():
    numbers = measure.plexus(grid_with_holes([])[0])
    assert numbers.springs_left == 1.0
    assert numbers.voids == len(numbers.areas) == 0
    assert numbers.void_fraction == numbers.spacing == numbers.mean_diameter == numbers.variation == 0.0


def test_no_springs():
    with pytest.raises(InputError, match="everything is broken"):
        measure.plexus(SpringNetwork([(0, 0), (1, 0)], np.empty((0, 2), dtype=int)))
