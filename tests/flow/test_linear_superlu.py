"""Factors by SciPy: the order of elimination, how much it fills, and what the factor solves."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import sparse
from scipy.spatial import Delaunay
from tests.flow.meshes import rectangle

from vasculo.errors import ComputationError
from vasculo.flow.linear.dissection import dissect_plain, elimination_order
from vasculo.flow.linear.fill import count_fill, count_fill_plain
from vasculo.flow.linear.memory import TooLargeError
from vasculo.flow.linear.superlu import ScipyFactor


def graph(points):
    """Edges of the Delaunay triangles, both ways, by rows."""
    start, columns = Delaunay(points).vertex_neighbor_vertices
    return start.astype(np.int32), columns.astype(np.int32)


def lattice(side):
    points = np.stack(np.meshgrid(np.arange(side), np.arange(side)), axis=-1).reshape(-1, 2).astype(float)
    return points, *graph(points + 0.01 * np.random.default_rng(0).normal(size=points.shape))


@settings(max_examples=25)
@given(st.integers(5, 90), st.integers(0, 2**32 - 1))
def test_order_and_fill_match_the_plain_twins(nodes, seed):
    points = np.random.default_rng(seed).uniform(size=(nodes, 2))
    start, columns = graph(points)
    order = elimination_order(points, start, columns)
    np.testing.assert_array_equal(order, dissect_plain(points, start, columns))
    np.testing.assert_array_equal(np.sort(order), np.arange(nodes))
    assert count_fill(order, start, columns) == count_fill_plain(order, start, columns)


def test_points_in_one_place_are_ordered_too():
    start, columns = graph(np.random.default_rng(1).uniform(size=(60, 2)))
    order = elimination_order(np.zeros((60, 2)), start, columns)
    np.testing.assert_array_equal(np.sort(order), np.arange(60))


def test_dissection_fills_less_than_rows_do_and_grows_slowly():
    per_node = []
    for side in (20, 40, 80):
        points, start, columns = lattice(side)
        order = elimination_order(points, start, columns)
        per_node.append(count_fill(order, start, columns) / side**2)
    rows = count_fill(np.arange(6400, dtype=np.int32), start, columns) / 6400
    assert per_node[-1] < 0.4 * rows
    assert np.diff(per_node).max() < 1.5 * np.diff(per_node).min() + 2.0  # as the logarithm, not as the root


def matrix_on(mesh):
    """Blocks on cells and their neighbours, dominant on the diagonal."""
    rng = np.random.default_rng(2)
    cells = len(mesh.triangles)
    pairs = mesh.faces[1]
    pairs = pairs[pairs[:, 1] >= 0]
    i, j = np.concatenate([pairs, pairs[:, ::-1], np.arange(cells)[:, None].repeat(2, axis=1)]).T
    full = sparse.coo_array((np.ones(len(i)), (i, j)), shape=(cells, cells)).tocsr()
    data = rng.normal(size=(full.nnz, 3, 3)) + 8.0 * np.eye(3) * (np.repeat(
        np.arange(cells), np.diff(full.indptr)) == full.indices)[:, None, None]  # fmt: skip
    return sparse.bsr_array((data.astype(np.float32), full.indices, full.indptr), shape=(3 * cells, 3 * cells))


def test_it_solves_in_single_precision_and_tells_its_size():
    mesh = rectangle(2.0, 1.0, 10)
    matrix = matrix_on(mesh)
    wanted = np.random.default_rng(5).normal(size=matrix.shape[0])
    with ScipyFactor(matrix, mesh.centroids) as factor:
        found = factor.solve(matrix.astype(np.float64) @ wanted)
        assert factor.needed > factor.bytes > matrix.data.nbytes
    assert 1e-9 < np.abs(found - wanted).max() < 1e-4


def test_too_large_a_factor_is_refused_before_it_is_made():
    mesh = rectangle(1.0, 1.0, 10)
    with pytest.raises(TooLargeError, match=r"SuperLU on 600 unknowns needs .* GB of memory and 1e-06 GB are free"):
        ScipyFactor(matrix_on(mesh), mesh.centroids, 1000.0)


def test_a_singular_matrix_is_refused():
    mesh = rectangle(1.0, 1.0, 6)
    matrix = matrix_on(mesh)
    matrix.data[matrix.indptr[7] : matrix.indptr[8]] = 0.0
    with pytest.raises(ComputationError, match="unknowns is singular"):
        ScipyFactor(matrix, mesh.centroids)
