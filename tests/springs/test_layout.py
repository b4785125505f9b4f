"""Tables in memory order: each spring in each of its patches, each node with each of its pulls, in the user's order."""

import numpy as np
import pytest

from vasculo.springs.layout import PATCH, SLICE, bring, build_layout, spread, take_back
from vasculo.springs.layout_plain import tables_plain
from vasculo.springs.network import SpringNetwork


def ends_of(layout, patch):
    """Places of both ends of the rows of a patch."""
    start, stop = layout.patch_start[patch : patch + 2]
    halo = layout.halo[layout.halo_start[patch] : layout.halo_start[patch + 1]]
    seen = np.concatenate([PATCH * patch + np.arange(PATCH), halo])
    return seen[layout.first[start:stop]], seen[layout.second[start:stop]]


@pytest.mark.parametrize("nodes", [1, 9, 400, 1024, 2500])
def test_each_spring_is_in_the_patches_of_its_ends(make_irregular, nodes):
    points, springs = make_irregular(nodes, 0) if nodes > 1 else (np.zeros((1, 2)), np.empty((0, 2), np.int32))
    springs = np.random.default_rng(1).permutation(springs)
    layout = build_layout(springs, points)
    assert np.array_equal(np.sort(layout.order), np.arange(len(points)))
    assert layout.places % SLICE == 0
    for patch, (start, stop) in enumerate(zip(layout.patch_start[:-1], layout.patch_start[1:], strict=True)):
        mine = layout.order[patch * PATCH : (patch + 1) * PATCH]
        expected = np.flatnonzero(np.isin(springs, mine).any(axis=1))
        assert np.array_equal(layout.spring[start:stop], expected)
        first, second = ends_of(layout, patch)
        assert np.array_equal(layout.order[first], springs[expected, 0])
        assert np.array_equal(layout.order[second], springs[expected, 1])
        halo = layout.halo[layout.halo_start[patch] : layout.halo_start[patch + 1]]
        assert len(np.unique(halo)) == len(halo)
        assert not np.isin(layout.order[halo], mine).any()
        degrees = np.bincount(springs.ravel(), minlength=len(points))[mine]
        assert np.all(np.diff(degrees) <= 0)


@pytest.mark.parametrize("nodes", [9, 400, 2500])
def test_each_node_has_its_pulls_in_the_order_of_the_springs(make_irregular, nodes):
    points, springs = make_irregular(nodes, 0)
    layout = build_layout(springs, points)
    for place, node in enumerate(layout.order):
        start, stop = layout.slice_start[place // SLICE : place // SLICE + 2]
        base, count = layout.patch_start[place // PATCH], np.diff(layout.patch_start)[place // PATCH]
        pulls = layout.slots[start:stop].reshape(-1, SLICE)[:, place % SLICE]
        pulls = pulls[pulls < 2 * count]
        mine = np.flatnonzero((springs == node).any(axis=1))
        assert np.array_equal(layout.spring[base + pulls % count], mine)
        assert np.array_equal(pulls >= count, springs[mine, 1] == node)


@pytest.mark.parametrize("nodes", [1, 9, 400, 2500])
@pytest.mark.parametrize("around", [False, True])
def test_tables_are_those_of_the_twin(make_irregular, nodes, around):
    points, springs = make_irregular(nodes, 3) if nodes > 1 else (np.zeros((1, 2)), np.empty((0, 2), np.int32))
    rng = np.random.default_rng(4)
    springs = rng.permutation(springs)
    shifts = np.where(rng.random((len(springs), 1)) < 0.1, rng.integers(-1, 2, springs.shape), 0.0) if around else None
    layout = build_layout(springs, points, shifts)
    place = np.argsort(layout.order)
    ends = place[springs]
    seen = ends[:, 1].copy()
    for row in range(len(springs)) if around else []:
        if shifts[row].any():
            image = (layout.image_of == ends[row, 1]) & (layout.image_shift == -shifts[row]).all(axis=1)
            seen[row] = layout.places + np.flatnonzero(image)[0]
    for name, expected in tables_plain(ends, seen, layout.slice_start).items():
        assert np.array_equal(getattr(layout, name), expected), name


def test_patches_are_compact(make_irregular):
    points, springs = make_irregular(10_000, 2)
    layout = build_layout(springs, points)
    assert len(layout.spring) < 1.15 * len(springs)  # computed twice: only what crosses a patch
    assert len(layout.slots) < 1.2 * 2 * len(springs)


def test_a_hub_of_all_nodes_has_wide_numbers():
    # One node joined to 70,000 others: its patch sees more places than 16 bits can number.
    nodes = 70_001
    springs = np.column_stack([np.zeros(nodes - 1, np.int32), np.arange(1, nodes, dtype=np.int32)])
    points = np.random.default_rng(0).random((nodes, 2))
    assert build_layout(springs, points).first.dtype == np.uint32
    network = SpringNetwork(points, springs, 0.0, pinned=np.arange(1, nodes))
    network.advance(1e-6, 1)
    np.testing.assert_allclose(network.velocities[0], 1e-6 * (points[1:] - points[0]).sum(axis=0), rtol=1e-9)
    assert build_layout(springs[:5], points[:6]).first.dtype == np.uint16


def test_images_stand_where_they_are_seen():
    points = np.array([[0.1, 0.5], [0.5, 0.5], [0.9, 0.5]])
    springs = np.array([[0, 1], [1, 2], [2, 0]], np.int32)
    layout = build_layout(springs, points, np.array([[0.0, 0.0], [0.0, 0.0], [-1.0, 0.0]]))
    assert layout.order[layout.image_of].tolist() == [0]
    assert layout.image_shift.tolist() == [[1.0, 0.0]]
    assert layout.halo.tolist() == [layout.places]
    assert ends_of(layout, 0)[1].tolist()[2] == layout.places
    x, y = np.full(layout.places + 1, 9.0), np.full(layout.places + 1, 9.0)
    bring(points, layout.order, layout.image_of, layout.image_shift, x, y)
    assert abs(x[layout.places] - 1.1) < 1e-15
    assert y[layout.places] == 0.5
    assert not x[3 : layout.places].any()
    back = np.zeros_like(points)
    take_back(x, y, layout.order, back)
    assert np.array_equal(back, points)


def test_values_of_springs_come_to_their_rows():
    rows = np.empty(4)
    spread(np.array([5.0, 6.0]), np.array([2, 0, 1, 2], np.int32), np.array([0, -1, 1], np.int32), -7.0, rows)
    assert rows.tolist() == [6.0, 5.0, -7.0, 6.0]
