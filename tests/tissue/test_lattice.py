"""The initial tissue."""

import numpy as np
import pytest

from vasculo.errors import InputError
from vasculo.plexus.voids import triangle_areas
from vasculo.tissue.lattice import lattice


def angles(network):
    """Angles of all triangles (t, 3) in degrees."""
    corners = network.points[network.triangles]
    forward = np.roll(corners, -1, axis=1) - corners
    back = np.roll(corners, 1, axis=1) - corners
    cross = forward[..., 0] * back[..., 1] - forward[..., 1] * back[..., 0]
    return np.degrees(np.arctan2(cross, np.sum(forward * back, axis=2)))


def test_the_paper_size():
    tissue = lattice(seed=1)
    assert tissue.points.shape == (12_000, 2)
    assert abs(len(tissue.springs) - 35_600) < 100
    assert abs(1.0 / tissue.lengths().mean() - 98.1) < 1.0
    assert abs(tissue.lengths().std() / tissue.lengths().mean() - 0.24) < 0.01
    assert np.bincount(tissue.springs.ravel()).max() <= 11


@pytest.mark.parametrize(("nodes", "seed"), [(25, 0), (26, 5), (60, 3), (200, 59), (1_500, 2), (4_000, 0)])
def test_the_mesh_fills_the_square(nodes, seed):
    tissue = lattice(nodes, seed)
    assert len(tissue.points) == nodes
    corners = angles(tissue)
    assert corners.min() > 10.0  # counter-clockwise and no slivers, at the frame neither
    corner = tissue.points[tissue.triangles]
    a, b = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    assert abs(0.5 * np.sum(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) - 1.0) < 1e-12
    # Euler: a triangulated square has 3 n - 3 - b edges and 2 n - 2 - b triangles, b nodes on its boundary.
    frame = int(tissue.pinned.sum())
    assert len(tissue.springs) == 3 * nodes - 3 - frame
    assert len(tissue.triangles) == 2 * nodes - 2 - frame
    sides = np.sort(np.concatenate([tissue.triangles[:, (k, (k + 1) % 3)] for k in range(3)]), axis=1)
    assert np.array_equal(np.unique(sides, axis=0), tissue.springs)


def test_the_frame_is_pinned_and_evenly_spaced():
    tissue = lattice(1_000, 4)
    on_edge = ((tissue.points == 0.0) | (tissue.points == 1.0)).any(axis=1)
    assert np.array_equal(on_edge, tissue.pinned)
    bottom = np.sort(tissue.points[tissue.points[:, 1] == 0.0, 0])
    assert bottom[0] == 0.0
    assert bottom[-1] == 1.0
    np.testing.assert_allclose(np.diff(bottom), 1.0 / (len(bottom) - 1), rtol=1e-12)
    for turned in (tissue.points[:, ::-1], 1.0 - tissue.points):
        np.testing.assert_allclose(np.sort(turned[turned[:, 1] == 0.0, 0]), bottom, atol=1e-15)


def test_the_tissue_is_at_rest():
    tissue = lattice(500, 0)
    assert not tissue.tensions().any()
    assert tissue.damping == tissue.tether == 0.0
    assert np.all(tissue.masses == 1.0)
    assert np.all(tissue.stiffness == 1.0)
    tissue.advance(0.2, 100, break_above=0.0)
    assert np.array_equal(tissue.points, tissue.reference)
    assert len(tissue.springs) == len(lattice(500, 0).springs)


def test_neighbours_have_near_numbers():
    tissue = lattice(4_000, 0)
    assert np.abs(np.diff(tissue.springs, axis=1)).max() < 8 * np.sqrt(4_000)


def test_the_seed_decides():
    first, again, other = lattice(300, 7), lattice(300, 7), lattice(300, 8)
    assert np.array_equal(first.points, again.points)
    assert np.array_equal(first.springs, again.springs)
    assert not np.array_equal(first.points, other.points)


def test_small_tissues_of_many_seeds():
    for nodes in (25, 40, 90):
        assert min(angles(lattice(nodes, seed)).min() for seed in range(40)) > 8.0


@pytest.mark.parametrize(
    ("nodes", "seed", "message"),
    [
        (24, 0, "a tissue of 24 nodes cannot be made: at least 25 are needed"),
        (0, 0, "a tissue of 0 nodes"),
        (-5, 0, "a tissue of -5 nodes"),
        (100.5, 0, "a tissue of 100.5 nodes"),
        (100, -1, "seed is -1"),
        (100, 0.5, "seed is 0.5, expected a whole number >= 0"),
        (100, None, "seed is None"),
        (63, 0, "a tissue of 63 nodes that is periodic cannot be made: at least 64 are needed"),
    ],
)
def test_bad_input(nodes, seed, message):
    with pytest.raises(InputError, match=message):
        lattice(nodes, seed, boundary="periodic" if "periodic" in message else "pinned")


@pytest.mark.parametrize("nodes", [25.0, "a", True, None])
def test_nodes_are_a_whole_number(nodes):
    with pytest.raises(InputError, match="a whole number from 25 up"):
        lattice(nodes)


@pytest.mark.parametrize("nodes", [5_000_001, 10**9, 10**26])
def test_too_many_nodes(nodes):
    with pytest.raises(InputError, match=f"a tissue of {nodes} nodes cannot be made: at most 5000000 are possible"):
        lattice(nodes)


KINDS = ["relaxed", "jittered", "poisson"]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("nodes", [64, 65, 301, 2_000])
def test_a_torus_is_filled_once(kind, nodes):
    tissue = lattice(nodes, 1, kind=kind, boundary="periodic")
    assert tissue.points.shape == (nodes, 2)
    assert np.all((tissue.points >= 0.0) & (tissue.points < 1.0))
    # Euler on a torus: V - E + F = 0, and every edge has two of the three sides of every triangle.
    assert (len(tissue.springs), len(tissue.triangles)) == (3 * nodes, 2 * nodes)
    assert not tissue.pinned.any()
    assert tissue.box.tolist() == [1.0, 1.0]
    areas = triangle_areas(tissue.triangles, tissue.points, tissue.reference, tissue.box)
    assert areas.min() > 0.0
    assert abs(areas.sum() - 1.0) < 1e-12
    assert tissue.lengths().max() < 3.0 / np.sqrt(nodes)
    uses = np.unique(np.sort(tissue.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1), axis=0)
    assert np.array_equal(uses, tissue.springs)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("nodes", [25, 26, 60, 1_500])
def test_every_kind_fills_the_square(kind, nodes):
    tissue = lattice(nodes, 3, kind=kind)
    frame = int(tissue.pinned.sum())
    assert (len(tissue.springs), len(tissue.triangles)) == (3 * nodes - 3 - frame, 2 * nodes - 2 - frame)
    assert angles(tissue).min() > 8.0


def test_a_free_tissue_is_the_pinned_one_not_pinned():
    pinned, free = lattice(300, 2), lattice(300, 2, boundary="free")
    assert np.array_equal(pinned.points, free.points)
    assert not free.pinned.any()


def test_without_jitter_the_lattice_is_regular():
    tissue = lattice(30 * 26, 0, kind="jittered", jitter=0.0, boundary="periodic")
    lengths = tissue.lengths()
    assert lengths.std() / lengths.mean() < 0.01
    assert np.all(np.bincount(tissue.springs.ravel()) == 6)
    spreads = []
    for jitter in (0.0, 0.1, 0.3, 0.5):
        lengths = lattice(2_000, 0, kind="jittered", jitter=jitter).lengths()
        spreads.append(lengths.std() / lengths.mean())
    assert spreads == sorted(spreads)
    assert spreads[-1] > 0.2


def test_poisson_disks_keep_their_distance():
    tissue = lattice(2_000, 5, kind="poisson", boundary="periodic")
    assert tissue.lengths().min() > np.sqrt(0.64 / 2_000)
    frame = lattice(2_000, 5, kind="poisson")
    inner = ~frame.pinned[frame.springs].all(axis=1)
    assert frame.lengths()[inner].min() > 0.999 * np.sqrt(0.64 / 2_000)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"kind": "hexagonal"}, "kind is 'hexagonal', expected one of relaxed, jittered, poisson"),
        ({"boundary": "open"}, "boundary is 'open', expected one of pinned, free, periodic"),
        ({"jitter": 0.6}, "jitter is 0.6, expected a number from 0 to 0.5 lattice spacings"),
        ({"jitter": -0.1}, "jitter is -0.1"),
        ({"jitter": None}, "jitter is None"),
    ],
)
def test_bad_options(options, message):
    with pytest.raises(InputError, match=message):
        lattice(100, **options)
