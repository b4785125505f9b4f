"""Networks that several tests use."""

import numpy as np
import pytest
from scipy.spatial import Delaunay, cKDTree

from vasculo.springs.network import SpringNetwork


def triangular(rows, columns):
    """Points and springs of a regular triangular lattice with spacing 1, bonds along x, rows shifted by a half."""
    points = [(column + 0.5 * (row % 2), row * np.sqrt(0.75)) for row in range(rows) for column in range(columns)]
    return joined(np.array(points), 1.1)


def joined(points, reach):
    """Points, and springs between all that are closer than reach."""
    pairs = cKDTree(points).query_pairs(reach, output_type="ndarray")
    return points, pairs[np.lexsort(pairs.T[::-1])].astype(np.int32)


def irregular(nodes, seed):
    """Points and springs of a random Delaunay mesh, about one unit apart."""
    side = int(np.sqrt(nodes))
    grid = np.stack(np.meshgrid(np.arange(side), np.arange(side)), axis=-1).reshape(-1, 2).astype(float)
    points = grid + np.random.default_rng(seed).uniform(-0.3, 0.3, grid.shape)
    corners = Delaunay(points).simplices
    pairs = np.concatenate([corners[:, (0, 1)], corners[:, (1, 2)], corners[:, (2, 0)]])
    return points, np.unique(np.sort(pairs, axis=1), axis=0).astype(np.int32)


@pytest.fixture
def make_triangular():
    return triangular


@pytest.fixture
def join():
    return joined


@pytest.fixture
def make_irregular():
    return irregular


@pytest.fixture
def moving(make_irregular):
    """A free irregular network in motion, with uneven stiffness and masses."""
    points, springs = make_irregular(100, 3)
    rng = np.random.default_rng(4)
    network = SpringNetwork(
        points, springs, stiffness=rng.uniform(0.5, 2.0, len(springs)), masses=rng.uniform(0.5, 2.0, len(points))
    )
    network.velocities = rng.normal(0.0, 0.3, points.shape)
    return network
