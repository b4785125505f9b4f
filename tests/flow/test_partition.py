"""Parts of the cell graph: every cell in one, connected, not too large, cut where few faces lie, always the same."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import sparse
from scipy.spatial import Delaunay
from tests.flow.meshes import cylinder_in_square, fan, rectangle, scattered

from vasculo.errors import InputError
from vasculo.flow.boundary import Periodic
from vasculo.flow.faces import build_faces
from vasculo.flow.linear.partition import END, mark_ends, mirror_entries, partition
from vasculo.flow.linear.partition_cut import cut_between
from vasculo.flow.linear.partition_plain import beyond_cut, distances, ends_plain, partition_plain


def graph(pairs, cells, seed=None):
    """Symmetric pattern by sorted rows; with a seed the cells are numbered at random."""
    pairs = np.asarray(pairs).reshape(-1, 2)
    if seed is not None:
        pairs = np.random.default_rng(seed).permutation(cells)[pairs]
    made = sparse.csr_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(cells, cells))
    made = sparse.csr_array(made + made.T)
    made.sort_indices()
    return made


def cell_graph(mesh, conditions=None, seed=None):
    faces = build_faces(mesh, conditions or {})
    return graph(faces.cells[: faces.inner], len(mesh.triangles), seed)


def random_graph(number, seed):
    """Cells of a Delaunay triangulation of random points, some taken out, so that there are tips, holes and islands."""
    rng = np.random.default_rng(seed)
    made = Delaunay(rng.uniform(size=(number, 2)))
    kept = np.flatnonzero(rng.uniform(size=len(made.simplices)) < 0.8)
    name = np.full(len(made.simplices) + 1, -1)
    name[kept] = np.arange(len(kept))
    pairs = np.column_stack([np.repeat(np.arange(len(kept)), 3), name[made.neighbors[kept]].ravel()])
    return graph(pairs[(pairs[:, 1] > pairs[:, 0])], len(kept), seed)


def pieces(made, part):
    """Number of connected pieces when the faces between parts are cut."""
    row = np.repeat(np.arange(len(part)), np.diff(made.indptr))
    same = part[row] == part[made.indices]
    left = sparse.csr_array((np.ones(same.sum()), (row[same], made.indices[same])), shape=made.shape)
    return sparse.csgraph.connected_components(left, directed=False)[0]


@settings(max_examples=40, deadline=None)
@given(st.integers(5, 150), st.integers(0, 10**6), st.integers(1, 60))
def test_any_graph(number, seed, most):
    made = random_graph(number, seed)
    part = partition(made.indptr, made.indices, most)
    sizes = np.bincount(part)
    assert sizes.sum() == made.shape[0]
    assert 1 <= sizes.min() <= sizes.max() <= most
    assert pieces(made, part) == len(sizes)
    lowest = np.unique(part, return_index=True)[1]
    assert (np.diff(lowest) > 0).all()
    np.testing.assert_array_equal(part, partition_plain(made.indptr, made.indices, most))


@pytest.mark.parametrize("most", [40, 200, 1000])
@pytest.mark.parametrize("seed", range(3))
def test_no_part_of_a_mesh_is_small(most, seed):
    made = cell_graph(scattered(28, seed=seed), seed=seed)
    sizes = np.bincount(partition(made.indptr, made.indices, most))
    assert len(sizes) <= 3 * made.shape[0] / most + 1
    assert sizes.min() > 0.3 * most


def test_the_same_parts_again():
    made = cell_graph(scattered(25, seed=4))
    one, two = (partition(made.indptr, made.indices, 90) for _ in range(2))
    np.testing.assert_array_equal(one, two)


def test_a_small_graph_is_one_part():
    made = cell_graph(fan(2))
    assert not partition(made.indptr, made.indices, made.shape[0]).any()
    assert partition(made.indptr, made.indices, made.shape[0] - 1).max() == 1


def test_islands_are_parts_of_their_own():
    made = graph([[0, 2], [2, 4], [1, 3]], 6)
    np.testing.assert_array_equal(partition(made.indptr, made.indices, 10), [0, 1, 0, 1, 0, 2])


def test_the_cell_itself_may_be_in_its_row():
    made = cell_graph(scattered(12))
    own = sparse.csr_array(made + sparse.eye_array(made.shape[0]))
    own.sort_indices()
    wanted = partition(made.indptr, made.indices, 50)
    np.testing.assert_array_equal(partition(own.indptr.astype(np.int32), own.indices, 50), wanted)


def test_a_dumbbell_is_cut_at_its_neck():
    # Two squares of 10 x 10 cells, joined by a row of three.
    place = {(i, j): 10 * i + j for i in range(10) for j in range(10)}
    place |= {(i + 13, j): 100 + 10 * i + j for i in range(10) for j in range(10)}
    place |= {(i, 4): 190 + i for i in range(10, 13)}
    pairs = [(c, place[near]) for (i, j), c in place.items() for near in ((i + 1, j), (i, j + 1)) if near in place]
    made = graph(pairs, 203)
    part = partition(made.indptr, made.indices, 120)
    row = np.repeat(np.arange(203), np.diff(made.indptr))
    assert part.max() == 1
    assert np.count_nonzero(part[row] != part[made.indices]) == 2


def test_periodic_seams_are_faces_like_others():
    mesh = rectangle(4.0, 0.25, across=2, jitter=0.0)
    ring = cell_graph(mesh, {"left": Periodic("right", 1.0)})
    part = partition(ring.indptr, ring.indices, round((1.0 - END) * ring.shape[0]))
    assert np.bincount(part).min() > 0.34 * ring.shape[0]
    assert pieces(ring, part) == 2


@pytest.mark.parametrize("seed", range(4))
def test_ends_and_cut_match_their_twins(seed):
    made = cell_graph(cylinder_in_square(0.3, 24, seed=seed), seed=seed)
    near = [made.indices[a:b].tolist() for a, b in zip(made.indptr, made.indptr[1:], strict=False)]
    cells = made.shape[0]
    away = distances(near, set(range(cells)), 0)
    line = list(away)
    beyond = distances(near, set(range(cells)), line[-1])
    side = np.zeros(cells, dtype=np.int8)
    lengths = [np.array([found[c] for c in range(cells)], dtype=np.int32) for found in (away, beyond)]
    piece = np.array(line, dtype=np.int32)
    mark_ends(piece, *lengths, side)
    first, last = ends_plain(line, away, beyond)
    assert (set(np.flatnonzero(side == 1)), set(np.flatnonzero(side == 2))) == (first, last)
    assert len(first) == len(last) == int(END * cells)
    for end in (first, last):
        assert len(distances(near, end, next(iter(end)))) == len(end)

    back = mirror_entries(made.indptr, made.indices)
    row = np.repeat(np.arange(cells), np.diff(made.indptr))
    np.testing.assert_array_equal(made.indices[back], row)
    np.testing.assert_array_equal(row[back], made.indices)
    level, flow = np.full(cells, -1, dtype=np.int32), np.zeros(len(back), dtype=np.int8)
    part, place = np.zeros(cells, dtype=np.int32), np.empty(cells, dtype=np.int32)
    number = cut_between(made.indptr, made.indices, back, part, piece, side, flow, level, place)
    beyond = level >= 0
    assert set(np.flatnonzero(beyond)) == beyond_cut(near, line, first, last)
    assert np.count_nonzero(beyond[row] & ~beyond[made.indices]) == number
    assert not flow.any()


def test_no_cells_a_part_is_refused():
    made = cell_graph(fan(1))
    with pytest.raises(InputError, match="0 cells a part") as caught:
        partition(made.indptr, made.indices, 0)
    assert "\n" not in str(caught.value)
