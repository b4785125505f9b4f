"""Connected parts, by hand and by the percolation of the triangular lattice."""

import numpy as np
import pytest

from vasculo.springs.parts import connected_parts, largest_part


def test_parts_by_hand():
    springs = np.array([[4, 5], [5, 6], [1, 2], [0, 1]])
    parts = connected_parts(springs, 8)
    assert len(np.unique(parts)) == 4
    assert parts[0] == parts[1] == parts[2]
    assert parts[4] == parts[5] == parts[6]
    assert np.flatnonzero(largest_part(springs, 8)).tolist() == [0, 1, 2]
    assert np.flatnonzero(largest_part(springs[[0, 1, 2]], 8)).tolist() == [4, 5, 6]
    assert connected_parts(np.empty((0, 2), int), 3).tolist() == [0, 1, 2]


def spans(size, share, rng):
    """Whether the springs that a share of a triangular lattice keeps join its left side to its right side."""
    index = np.arange(size * size).reshape(size, size)
    pairs = [(index[:, :-1], index[:, 1:]), (index[:-1], index[1:]), (index[:-1, 1:], index[1:, :-1])]
    springs = np.concatenate([np.column_stack([a.ravel(), b.ravel()]) for a, b in pairs])
    parts = connected_parts(springs[rng.random(len(springs)) < share], size * size)
    return bool(np.intersect1d(parts[index[:, 0]], parts[index[:, -1]]).size)


@pytest.mark.slow
def test_bonds_of_the_triangular_lattice_percolate_at_the_exact_share():
    # p_c = 2 sin(pi / 18) = 0.347296. On a rhombus the chance to span at p_c is 1/2 at every size, by duality with the
    # honeycomb and the star-triangle relation, so the shares at which half of the draws span cross at p_c.
    rng = np.random.default_rng(0)
    exact = 2.0 * np.sin(np.pi / 18.0)
    shares = np.linspace(exact - 0.03, exact + 0.03, 7)
    halves = []
    for size in (32, 128):
        often = [np.mean([spans(size, share, rng) for _ in range(150)]) for share in shares]
        halves.append(float(np.interp(0.5, np.maximum.accumulate(often), shares)))
    assert abs(halves[0] - exact) < 0.01, halves
    assert abs(halves[1] - exact) < 0.003, halves
