import numpy as np
import pytest

import vasculo as vc
from vasculo import measure
from vasculo.errors import InputError
from vasculo.plexus.survey import survey
from vasculo.plexus.voids import void_fraction
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
    assert (numbers.components, numbers.connectivity, numbers.dangling_fraction, numbers.dead_ends) == (1, 1.0, 0.0, 0)
    assert numbers.roundness == pytest.approx(0.5 * (np.pi / 4.0 + 4.0 * np.pi * 120.0 / 44.0**2))
    assert (numbers.cords, numbers.border_cords, numbers.junctions, numbers.loops) == (0, 1, 0, 0)
    assert numbers.neighbours.tolist() == [1, 1]
    assert numbers.cord_length == numbers.cord_length_variation == numbers.mean_degree == 0.0


def test_a_grid_of_square_holes():
    holes = [(5 * i + 1, 5 * j + 1, 5 * i + 5, 5 * j + 5) for i in range(6) for j in range(4)]
    network, _, unit = grid_with_holes(holes)
    numbers = measure.plexus(network)
    assert (numbers.voids, numbers.cords, numbers.border_cords, numbers.junctions) == (24, 22, 16, 15)
    np.testing.assert_array_equal(numbers.junction_degrees, 4)
    np.testing.assert_allclose(numbers.cord_lengths, 5.0 / unit)
    np.testing.assert_allclose(numbers.cord_widths, 1.0 / unit)
    assert numbers.cord_width == pytest.approx(1.0 / unit)
    assert (numbers.mean_degree, numbers.three_way, numbers.loops) == (4.0, 0.0, 8)
    assert numbers.inner_neighbours == 4.0
    assert numbers.mean_neighbours == pytest.approx((8 * 4 + 12 * 3 + 4 * 2) / 24)


def test_dead_ends_and_islands():
    network, _, _ = grid_with_holes([(2, 2, 8, 8), (10, 2, 20, 14)])
    node = {(x, y): x + 31 * y for x in range(31) for y in range(21)}
    hanging = [
        (node[10, 5], node[11, 5]),
        (node[11, 5], node[12, 5]),
        (node[12, 5], node[12, 6]),
        (node[12, 5], node[12, 4]),
    ]
    island = [(node[5, 5], node[5, 6])]
    more = np.concatenate([network.springs, hanging, island])
    numbers = measure.plexus(SpringNetwork(network.points, more, triangles=network.triangles))
    assert (numbers.dead_ends, numbers.components, numbers.voids) == (2, 2, 2)
    assert numbers.dangling_fraction == pytest.approx(4.0 / len(more))
    used = len(np.unique(more))
    assert numbers.connectivity == pytest.approx((used - 2) / used)


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


PITCH = 4  # rows of holes; the lattice has 2 PITCH rows and 3 PITCH columns a cell


def periodic_honeycomb(across=1, up=1, radius=3.0, drift=(0.0, 0.0), mirror=False):
    """Triangular lattice on a torus with hexagonal holes; cords are PITCH long and sqrt(3) (PITCH - radius) wide."""
    columns, rows = 3 * PITCH * across, 2 * PITCH * up
    i, j = (part.ravel() for part in np.meshgrid(np.arange(columns), np.arange(rows)))
    points = np.stack([i + 0.5 * (j % 2), 0.5 * np.sqrt(3.0) * j], axis=1)
    box = np.array([columns, 0.5 * np.sqrt(3.0) * rows])

    def node(column, row):
        return column % columns + columns * (row % rows)

    here, right = node(i, j), node(i + 1, j)
    above, left_above, below = node(i + j % 2, j + 1), node(i + j % 2 - 1, j + 1), node(i + j % 2, j - 1)
    triangles = np.concatenate([np.stack([here, right, above], axis=1), np.stack([here, below, right], axis=1)])
    edges = np.concatenate([np.stack([here, there], axis=1) for there in (right, above, left_above)])
    arms = points[edges[:, 1]] - points[edges[:, 0]]
    middle = points[edges[:, 0]] + 0.5 * (arms - box * np.round(arms / box))
    gone = np.zeros(len(edges), dtype=bool)
    for x in range(across):
        for y in range(up):
            for half in (0.0, 0.5):
                away = middle - (3.0 * PITCH * (x + half), np.sqrt(3.0) * PITCH * (y + half))
                away = np.abs(away - box * np.round(away / box))
                gone |= np.maximum(away[:, 1], 0.5 * (away @ (np.sqrt(3.0), 1.0))) < 0.5 * np.sqrt(3.0) * radius - 1e-6
    if mirror:
        points = points * (-1.0, 1.0)
    network = SpringNetwork(points, edges[~gone], triangles=triangles, box=box)
    network.points += drift
    return network


@pytest.mark.parametrize("cells", [(1, 1), (2, 1), (2, 3)])
@pytest.mark.parametrize("drift", [(0.0, 0.0), (137.2, -54.9)])
@pytest.mark.parametrize("mirror", [False, True])
def test_a_periodic_honeycomb_is_its_unit_cell(cells, drift, mirror):
    network = periodic_honeycomb(*cells, drift=drift, mirror=mirror)
    with np.errstate(all="raise", under="ignore"):
        numbers = measure.plexus(network)
    count = 2 * cells[0] * cells[1]
    assert (numbers.voids, numbers.cords, numbers.junctions, numbers.border_cords) == (count, 3 * count, 2 * count, 0)
    np.testing.assert_allclose(numbers.areas, 54.0)
    assert numbers.void_fraction == pytest.approx(9.0 / 16.0)
    assert mirror or void_fraction(network) == (pytest.approx(9.0 / 16.0), count)  # it takes triangles as they are
    assert numbers.spacing == pytest.approx(np.sqrt(24.0 * np.sqrt(3.0)))
    np.testing.assert_allclose(numbers.cord_lengths, 4.0)
    np.testing.assert_allclose(numbers.cord_widths, np.sqrt(3.0))
    np.testing.assert_array_equal(numbers.junction_degrees, 3)
    np.testing.assert_array_equal(numbers.neighbours, 6)
    assert (numbers.loops, numbers.components, numbers.dangling_fraction) == (count + 1, 1, 0.0)
    assert numbers.roundness == pytest.approx(np.pi / (2.0 * np.sqrt(3.0)))


def test_a_periodic_network_stretched_over_its_seams():
    """Nodes moved by a wave that fits the box: areas are those of the moved outlines, and still fill the box."""
    network = periodic_honeycomb(2, 2)
    network.points += 0.3 * np.sin(2.0 * np.pi * network.reference[:, ::-1] / network.box[::-1])
    found = survey(network)
    assert found.area == pytest.approx(network.box.prod())
    for void in found.voids:
        x, y = (void.outline - void.outline[0]).T
        assert 0.5 * (x @ np.roll(y, -1) - np.roll(x, -1) @ y) == pytest.approx(void.area)
        assert np.ptp(void.outline, axis=0).max() < 7.5
    numbers = measure.plexus(network)
    assert numbers.junctions - numbers.cords + numbers.voids == 0


def test_periodic_in_x_only():
    whole, cut = periodic_honeycomb(2, 2), periodic_honeycomb(2, 2)
    network = SpringNetwork(
        whole.points, whole.springs[np.abs(np.diff(whole.points[whole.springs][:, :, 1], axis=1)[:, 0]) < 2.0],
        triangles=whole.triangles[np.ptp(whole.points[whole.triangles][:, :, 1], axis=1) < 2.0],
        box=(cut.box[0], np.inf),
    )  # fmt: skip
    numbers = measure.plexus(network)
    assert numbers.voids == 2 * 3 + 4  # three rows of whole holes, and halves at both sides
    assert numbers.border_cords > 0
    assert numbers.loops - 1 == np.sum(~numbers.graph.at_border)


def test_what_a_periodic_network_cannot_give():
    network = periodic_honeycomb()
    with pytest.raises(InputError, match=r"periodic plexus \(box \[12.0, 6.9"):
        vc.extract_domain(network)
    with pytest.raises(InputError, match="96 nodes without triangles"):
        measure.plexus(SpringNetwork(network.points, network.springs, box=network.box))


@pytest.mark.parametrize("wave", [0.0, 1.5, -1.5])
def test_a_void_that_reaches_around(wave):
    network = periodic_honeycomb(2, 2, radius=1.0)
    x, y = network.points[network.springs].mean(axis=1).T
    x -= wave * np.sin(2.0 * np.pi * y / network.box[1])
    network.remove_springs((x > 4.0) & (x < 9.0))
    assert void_fraction(network)[1] == 1
    with pytest.raises(InputError, match=r"reaches around the periodic box, \[0, 1\] times in x and y"):
        measure.plexus(network)


@pytest.fixture(scope="module")
def medium():
    return vc.grow_plexus(vc.lattice(nodes=12_000, seed=0), vc.Vasculogenesis.preset("medium"), seed=0)


def test_a_grown_plexus(medium):
    numbers = measure.plexus(medium)
    assert numbers.cord_length == pytest.approx(5.5, abs=0.5)
    assert numbers.cord_width == pytest.approx(1.5, abs=0.2)
    assert 0.45 < numbers.cord_length_variation < 0.65
    assert numbers.cord_lengths.min() > 0.25
    assert 3.05 < numbers.mean_degree < 3.3
    assert 0.8 < numbers.three_way < 0.95
    assert numbers.mean_neighbours == pytest.approx(4.9, abs=0.3)
    assert numbers.roundness == pytest.approx(0.885, abs=0.03)
    assert numbers.connectivity > 0.99
    assert numbers.loops == np.sum(~numbers.graph.at_border)
    assert numbers.junction_degrees.sum() == 2 * numbers.cords + np.sum(numbers.graph.ends[~numbers.graph.inner] >= 0)


def test_a_turned_and_scaled_plexus_has_the_same_numbers(medium):
    turn = np.array([[np.cos(0.4), np.sin(0.4)], [-np.sin(0.4), np.cos(0.4)]])
    moved = SpringNetwork(37.0 * medium.reference @ turn, medium.springs, triangles=medium.triangles)
    moved.points[:] = 37.0 * medium.points @ turn
    one, two = measure.plexus(medium), measure.plexus(moved)
    for name in ("cord_length", "cord_width", "mean_degree", "roundness", "spacing", "mean_neighbours"):
        assert getattr(two, name) == pytest.approx(getattr(one, name), rel=1e-3)
    assert (one.cords, one.junctions, one.border_cords) == (two.cords, two.junctions, two.border_cords)
