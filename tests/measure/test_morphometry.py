"""The table of a plexus: exact patterns, pictures of known domains, scale and rotation; the distance of two tables."""

import numpy as np
import pytest
import shapely
from scipy.spatial import Voronoi
from scipy.stats.qmc import Halton

import vasculo as vc
from vasculo.geometry.neighbours import as_polygons
from vasculo.measure.distance import DISTRIBUTIONS, SCALES
from vasculo.measure.morphometry import pooled


def grid(kind, across, gap=0.2):
    """Squares or hexagons in their lattices of spacing 1 between centres, `gap` apart."""
    i, j = (axis.ravel().astype(float) for axis in np.meshgrid(np.arange(across), np.arange(across)))
    if kind == "squares":
        centres, corners = np.column_stack((i, j)), 4
    else:
        centres, corners = np.column_stack((i + 0.5 * (j % 2), j * np.sqrt(0.75))), 6
    angles = 2.0 * np.pi * (np.arange(corners) + 0.5) / corners
    around = 0.5 * (1.0 - gap) / np.cos(np.pi / corners) * np.column_stack((np.cos(angles), np.sin(angles)))
    box = np.array([(-1, -1), (across + 1, -1), (across + 1, across + 1), (-1, across + 1)], dtype=float)
    return vc.Domain(box, [centre + around for centre in centres], {})


def cells(seed, count=150, shrink=0.012, factor=1.0, turn=0.0):
    """Cells of a Voronoi diagram of random points in a disk, each shrunk, scaled and turned about the origin."""
    rng = np.random.default_rng(seed)
    points = rng.uniform(-0.7, 0.7, (2 * count, 2))
    diagram = Voronoi(points)
    regions = [diagram.regions[region] for region in diagram.point_region]
    rings = [diagram.vertices[region] for region in regions if region and -1 not in region]
    inside = shapely.Point(0.0, 0.0).buffer(0.62)
    shapes = [shapely.Polygon(ring).buffer(-shrink, join_style="mitre") for ring in rings]
    shapes = [shape for shape in shapes if not shape.is_empty and inside.contains(shape)]
    across = factor * np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    outlines = [shapely.get_coordinates(shape.exterior)[:-1] @ across for shape in shapes]
    corners = factor * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], dtype=float)
    return vc.Domain(corners, outlines, {})


def test_squares():
    table = vc.measure.morphometry(grid("squares", 12), window=(2.3, 2.3, 8.7, 8.7))
    assert table.roundness == pytest.approx(np.pi / 4)
    assert (table.solidity, table.elongation, table.neighbours) == pytest.approx((1.0, 1.0, 4.0))
    assert table.degree == pytest.approx(4.0, abs=0.1)  # at the edge of the window pieces meet in threes
    assert table.area_variation == pytest.approx(0.0, abs=1e-9)
    assert table.areas.mean == pytest.approx(1.0)
    assert table.spacing == pytest.approx(1.0, rel=0.08)  # one place of the window; right in the mean over places
    assert table.segment * table.spacing == pytest.approx(1.0, rel=0.02)
    assert table.widths.quantile(0.5) * table.spacing == pytest.approx(0.2, rel=0.01)
    assert table.regularity * table.spacing == pytest.approx(2.0)
    assert table.vessel_fraction == pytest.approx(0.36, abs=0.04)


def test_hexagons():
    table = vc.measure.morphometry(grid("hexagons", 14))
    spacing = np.sqrt(np.sqrt(0.75))
    assert table.roundness == pytest.approx(np.pi / (2.0 * np.sqrt(3.0)))
    assert (table.degree, table.three_way, table.neighbours) == (3.0, 1.0, 6.0)
    assert table.spacing == pytest.approx(spacing, rel=0.04)
    assert table.segment * table.spacing == pytest.approx(1.0 / np.sqrt(3.0), rel=0.01)
    assert table.widths.quantile(0.5) * table.spacing == pytest.approx(0.2, rel=0.01)
    assert table.regularity * table.spacing == pytest.approx(2.0)
    assert table.junctions == pytest.approx(2.0, rel=0.1)


def test_ellipses_that_lie_alike_are_ordered():
    angles = 2.0 * np.pi * np.arange(40) / 40
    ellipse = np.column_stack((0.4 * np.cos(angles), 0.2 * np.sin(angles)))
    along = np.array([np.cos(0.5), np.sin(0.5)])
    turned = ellipse @ np.array([along, [-along[1], along[0]]])
    centres = np.column_stack([axis.ravel() for axis in np.meshgrid(np.arange(9.0), np.arange(9.0))])
    domain = vc.Domain([(-1, -1), (9, -1), (9, 9), (-1, 9)], [centre + turned for centre in centres], {})
    table = vc.measure.morphometry(domain)
    assert table.order == pytest.approx(1.0)
    assert table.elongation == pytest.approx(2.0)
    assert table.roundness == pytest.approx(0.84, abs=0.005)  # of an ellipse with axes 2 : 1 (Ramanujan)


def test_scale_changes_the_scale_alone():
    one, two = vc.measure.morphometry(cells(1)), vc.measure.morphometry(cells(1, factor=37.0))
    rows, others = one.rows(), two.rows()
    assert others.pop("spacing") == pytest.approx(37.0 * rows.pop("spacing"))
    assert others == pytest.approx(rows)
    assert vc.measure.distance(one, two).value == pytest.approx(0.0, abs=1e-6)


def test_a_quarter_turn_changes_nothing():
    one = vc.measure.morphometry(cells(1)).rows()
    two = vc.measure.morphometry(cells(1, turn=0.5 * np.pi)).rows()
    assert two == pytest.approx(one, rel=1e-6)


def test_any_turn_changes_what_lies_in_the_window_only():
    """The window stays upright, so that other islands lie in it: no more apart than two parts of one pattern."""
    one = vc.measure.morphometry(cells(1, 400), window=(-0.4, -0.4, 0.4, 0.4))
    two = vc.measure.morphometry(cells(1, 400, turn=0.6), window=(-0.4, -0.4, 0.4, 0.4))
    assert vc.measure.distance(one, two).value < 1.0


def test_weights_take_back_the_preference_for_small_islands():
    """Large disks are cut more often; in the mean over places of the window their share comes out right."""
    around = 2.0 * np.pi * np.arange(24) / 24
    disk = np.column_stack((np.cos(around), np.sin(around)))
    places = [(i, j) for i in range(9) for j in range(9)]
    disks = [np.array((i, j)) + (0.65 if (i + j) % 2 else 0.25) * disk for i, j in places]
    domain = vc.Domain([(-1, -1), (9, -1), (9, 9), (-1, 9)], disks, {})
    offsets = 2.0 * Halton(2, scramble=False).random(36)
    windows = [(x + 1.1, y + 1.1, x + 5.3, y + 5.3) for x, y in offsets]
    tables = [vc.measure.morphometry(domain, window=window) for window in windows]
    density = np.array([table.spacing**-2 for table in tables])
    large = [table.areas.weights[table.areas.values > 1.0].sum() for table in tables]
    plain = [np.count_nonzero(table.areas.values > 1.0) for table in tables]
    assert density.mean() == pytest.approx(1.0, rel=0.03)
    assert np.mean(large * density) / density.mean() == pytest.approx(0.5, abs=0.015)
    assert np.sum(plain) / np.sum([table.whole for table in tables]) < 0.47


def test_pooled_tables_have_the_means_and_all_values():
    tables = [vc.measure.morphometry(cells(seed)) for seed in (1, 2)]
    both = pooled(tables)
    assert both.islands == pytest.approx(sum(table.islands for table in tables))
    assert both.roundness == pytest.approx(np.mean([table.roundness for table in tables]))
    assert len(both.areas.values) == sum(len(table.areas.values) for table in tables)
    assert both.areas.weights.sum() == pytest.approx(1.0)
    assert (np.diff(both.areas.values) >= 0.0).all()


def test_a_painted_domain_has_the_table_of_the_domain():
    pytest.importorskip("skimage")
    domain = vc.extract_domain(vc.grow_plexus(vc.lattice(3_000, 1), vc.Vasculogenesis(), 1))
    size, window = 700, (0.12, 0.12, 0.88, 0.88)
    places = (np.arange(size) + 0.5) / size * 0.76 + 0.12
    tissue = shapely.contains_xy(shapely.union_all(as_polygons(domain.pillars)), *np.meshgrid(places, places[::-1]))
    found = vc.domain_from_image(tissue, vc.ImageExtraction(vessels="dark", narrowest=1.0, smoothing=0.7))
    one, two = vc.measure.morphometry(domain, window=window), vc.measure.morphometry(found)
    rows, painted = one.rows(), two.rows()
    assert painted["whole"] == rows["whole"]
    assert painted["spacing"] / size * 0.76 == pytest.approx(rows["spacing"], rel=0.01)
    for name in (
        "vessel_fraction",
        "roundness",
        "solidity",
        "elongation",
        "order",
        "width",
        "segment",
        "area_variation",
    ):
        assert painted[name] == pytest.approx(rows[name], rel=0.03, abs=0.005), name
    assert vc.measure.distance(one, two).value < 0.25


def test_a_network_and_its_domain_have_one_table():
    plexus = vc.grow_plexus(vc.lattice(2_000, 2), vc.Vasculogenesis.preset("fine"), 2)
    assert vc.measure.morphometry(plexus).rows() == vc.measure.morphometry(vc.extract_domain(plexus)).rows()


def test_distance_is_symmetric_and_its_shares_add_up():
    one, two = (vc.measure.morphometry(cells(seed, shrink=shrink)) for seed, shrink in ((1, 0.012), (2, 0.02)))
    there, back = vc.measure.distance(one, two), vc.measure.distance(two, one)
    assert there.value == pytest.approx(back.value)
    assert there.value > 0.5
    assert sum(there.shares.values()) == pytest.approx(1.0)
    assert set(there.differences) == set(SCALES)
    for name in SCALES:
        sign = 1.0 if name in DISTRIBUTIONS else -1.0
        assert there.differences[name] == pytest.approx(sign * back.differences[name])
    assert there.differences["vessel_fraction"] > 0.0
    assert max(there.shares, key=there.shares.get) in {"vessel_fraction", "widths"}


def test_weights_choose_the_terms():
    one, two = (vc.measure.morphometry(cells(seed)) for seed in (1, 2))
    only = vc.measure.distance(one, two, dict.fromkeys(set(SCALES) - {"degree"}, 0.0))
    assert only.value == pytest.approx(abs(two.degree - one.degree) / SCALES["degree"])
    assert float(only) == only.value


@pytest.mark.parametrize(
    ("weights", "words"),
    [({"colour": 1.0}, "no term"), ({"degree": -1.0}, "degree is -1"), (dict.fromkeys(SCALES, 0.0), "all 11 weights")],
)
def test_wrong_weights(weights, words):
    table = vc.measure.morphometry(cells(1))
    with pytest.raises(vc.InputError, match=words):
        vc.measure.distance(table, table, weights)


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: vc.measure.morphometry(3), "not int"),
        (lambda: vc.measure.morphometry(grid("squares", 2)), "at least 5 islands, there are 4"),
        (lambda: vc.measure.morphometry(grid("squares", 6), window=(0, 0, 2.0, 2.0)), "at least 5 whole"),
        (lambda: vc.measure.morphometry(grid("squares", 6), window=(0, 0, 99, 1)), "no part of the domain"),
        (lambda: vc.measure.morphometry(grid("squares", 6), smallest=0.7), "share of the mean area"),
    ],
)
def test_what_cannot_be_measured(call, words):
    with pytest.raises(vc.InputError, match=words):
        call()
