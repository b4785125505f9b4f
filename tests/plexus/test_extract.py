import numpy as np
import pytest
import shapely

from vasculo.errors import InputError
from vasculo.geometry.outline import segment_lengths, signed_area
from vasculo.plexus.extract import extract, extract_domain
from vasculo.plexus.parameters import Extraction
from vasculo.springs.network import SpringNetwork

NARROW = Extraction(lumen_width=0.75)


def assert_sound(found):
    domain, report = found.domain, found.report
    polygons = [shapely.Polygon(pillar) for pillar in domain.pillars]
    assert all(polygon.is_valid for polygon in polygons)
    assert all(signed_area(pillar) > 0.0 for pillar in domain.pillars)
    for i, one in enumerate(polygons):
        for two in polygons[i + 1 :]:
            assert one.distance(two) > 0.8 * found.tubule_width
    for pillar in domain.pillars:
        edges = segment_lengths(pillar)
        assert edges.max() / edges.min() < 1.3
        assert len(pillar) >= 16
    x0, y0, x1, y1 = domain.bounds
    assert sum(p.area for p in polygons) + domain.area == pytest.approx((x1 - x0) * (y1 - y0), rel=1e-12)
    assert report.pillars == len(domain.pillars) == len(found.void_of_pillar) == len(found.lineage)
    dropped = report.dropped_small + report.dropped_vanished + report.dropped_nested
    assert report.voids == len(found.voids) == report.pillars + report.merged + dropped
    assert report.wall_gap_l0 * found.length_unit > 0.8 * 0.5 * found.tubule_width
    for index, pillar in zip(found.void_of_pillar, polygons, strict=True):
        assert shapely.Polygon(found.voids[index].outline).buffer(0).buffer(1e-9).intersects(pillar)


@pytest.mark.parametrize("kind", ["lumen_width", "minimum_width"])
def test_every_degenerate_case_at_once(zoo, kind):
    found = extract(zoo(), Extraction(**{kind: 0.75}))
    report = found.report
    assert_sound(found)
    assert report.voids == 10  # nine holes and the ring that hangs in one of them
    assert report.dropped_nested == 1
    assert report.pillars == 9
    assert report.fragments == 1
    assert report.fragment_springs == 4
    assert report.dangling_springs == 3 + 2
    assert report.second_loops == 1
    assert report.one_spring_cords >= 1
    assert report.frame_voids == 1
    assert report.folded_triangles > 0
    assert report.folded_voids == 1
    assert report.coincident_nodes == 4
    assert report.short_springs == 2
    assert report.crossings == 0
    assert report.narrowest_before_l0 == 0.0
    assert report.widened_passages >= 1
    assert report.notes


def test_without_triangles_the_same_pillars(zoo):
    width = 0.75
    with_triangles = extract(zoo(), Extraction(lumen_width=width))
    plain = zoo(triangles=False)
    ratio = with_triangles.length_unit / extract(plain, NARROW).length_unit  # L0 is the mean of the living springs
    without = extract(plain, Extraction(lumen_width=width * ratio, smallest_radius=0.6 * ratio, spacing=0.6 * ratio))
    assert_sound(without)
    assert without.report.pillars == with_triangles.report.pillars
    for one in with_triangles.domain.pillars:
        nearest = min(
            shapely.hausdorff_distance(shapely.Polygon(one), shapely.Polygon(p)) for p in without.domain.pillars
        )
        assert nearest < 0.1


def test_lineage_holds_the_void(zoo):
    found = extract(zoo(), NARROW)
    assert [group[0] for group in found.lineage] == found.void_of_pillar.tolist()
    for index, pillar in zip(found.void_of_pillar, found.domain.pillars, strict=True):
        void = found.voids[index]
        assert void.nodes[0] == void.nodes.min()
        assert 0.0 < signed_area(pillar) < signed_area(void.outline)
        np.testing.assert_array_equal(void.outline, zoo().points[void.nodes])


def test_exact_area_of_a_square_pillar(carver):
    network = carver(20, 16, [[(5, 5), (15, 5), (15, 11), (5, 11)]])
    found = extract(network, NARROW)
    unit, width = found.length_unit, found.tubule_width
    assert width == pytest.approx(0.75 * unit)
    polygon = shapely.Polygon(found.domain.pillars[0])
    assert polygon.area == pytest.approx((10 - width) * (6 - width) - (4 - np.pi) * (0.3 * unit) ** 2, rel=2e-4)
    # chords cut the rounded corners, so all sides stand a little farther out to keep the area
    sides = np.array(polygon.bounds) - (5 + width / 2, 5 + width / 2, 15 - width / 2, 11 - width / 2)
    assert np.abs(sides) == pytest.approx(np.full(4, np.abs(sides[0])), abs=1e-9)
    assert (sides * (-1, -1, 1, 1) > 0.0).all()
    assert np.abs(sides).max() < 0.012 * unit
    pad = np.sqrt(polygon.area / np.pi)
    assert found.domain.bounds == pytest.approx((-pad, 0.0, 20.0 + pad, 16.0))
    assert found.domain.side_names == ("bottom", "left", "right", "top")
    left = found.domain.sides.index("left")
    assert found.domain.outer[left][0] == pytest.approx(-pad)
    assert found.report.notes[0].startswith("only 1 pillars")


def test_fluid_fraction_is_met_and_clipped(carver):
    holes = [[(x, y), (x + 8, y), (x + 8, y + 8), (x, y + 8)] for x in (1, 10, 19) for y in (1, 10)]
    network = carver(28, 19, holes)
    met = extract(network, Extraction(fluid_fraction=0.42))
    assert met.report.width_from == "fluid fraction"
    assert met.report.fluid_fraction == pytest.approx(0.42, abs=2e-3)
    low = extract(network, Extraction(fluid_fraction=0.05)).report
    assert low.width_from == "lower limit"
    assert low.tubule_width >= 0.16 * low.mean_radius
    high = extract(network, Extraction(fluid_fraction=0.9)).report
    assert (high.width_from, high.tubule_width_l0) == ("upper limit", pytest.approx(1.25))


def test_cords_of_one_spring_never_merge(carver):
    holes = [[(x, 1), (x + 6, 1), (x + 6, 8), (x, 8)] for x in (1, 7, 13, 19)]
    keep = [[(x, y) for y in range(1, 9)] for x in (7, 13, 19)]
    found = extract(carver(26, 9, holes, keep), NARROW)
    assert_sound(found)
    assert found.report.pillars == 4
    assert found.report.one_spring_cords == 3
    # the shapes are 0.75 apart; even outlines of the same area stand a little farther out
    assert 0.95 * 0.75 < found.report.narrowest_after_l0 < 0.75


@pytest.mark.parametrize("triangles", [True, False])
def test_numbering_of_the_nodes_does_not_matter(zoo, triangles):
    network = zoo(triangles)
    order = np.random.default_rng(5).permutation(len(network.points))
    place = np.argsort(order)
    springs = place[network.springs][::-1, ::-1]
    corners = None if network.triangles is None else np.roll(place[network.triangles], 1, axis=1)
    other = SpringNetwork(network.reference[order], springs, triangles=corners)
    other.points[:] = network.points[order]
    one, two = extract(network, NARROW), extract(other, NARROW)
    rows, others = one.report.rows(), two.report.rows()
    assert {name: value for name, value in rows.items() if isinstance(value, int)} == {
        name: value for name, value in others.items() if isinstance(value, int)
    }
    shapes = [shapely.Polygon(pillar) for pillar in two.domain.pillars]
    for pillar in one.domain.pillars:
        assert min(shapely.hausdorff_distance(shapely.Polygon(pillar), shape) for shape in shapes) < 1e-9


def test_moved_scaled_and_mirrored_networks(zoo):
    plain = extract(zoo(), NARROW).domain
    moved = zoo()
    for array in (moved.points, moved.reference):
        array[:] = 0.01 * array * [-1.0, 1.0] + [3.0, -7.0]
    mirrored = extract(moved, NARROW).domain
    assert len(mirrored.pillars) == len(plain.pillars)
    for one, two in zip(plain.pillars, mirrored.pillars, strict=True):
        image = shapely.Polygon(0.01 * one * [-1.0, 1.0] + [3.0, -7.0])
        # other nodes on the same curve: chords differ by the sagitta of a corner of radius 0.3 at a spacing of 0.6
        assert shapely.hausdorff_distance(image, shapely.Polygon(two)) < 0.6**2 / (8.0 * 0.3) * 0.01
        assert shapely.Polygon(two).area == pytest.approx(image.area, rel=1e-6)


def test_same_input_same_bits(zoo):
    one, two = extract(zoo()), extract(zoo())
    assert one.report == two.report
    for first, second in zip(one.domain.pillars, two.domain.pillars, strict=True):
        np.testing.assert_array_equal(first, second)


def test_outline_that_crosses_itself(carver):
    # the two sides of a neck change places: a figure eight, whose larger lobe stays
    hole = [(2, 2), (14, 2), (14, 8), (2, 8)]
    move = {(x, 2): (x, 5.4) for x in (9, 10)} | {(x, 8): (x, 4.6) for x in (9, 10)}
    found = extract(carver(16, 10, [hole], move=move), NARROW)
    assert_sound(found)
    assert found.report.invalid_outlines == 1
    assert found.report.pillars == 1
    assert found.domain.pillars[0][:, 0].max() < 9.5


def test_budget_widens_then_merges_then_refuses(carver):
    holes = [[(x, y), (x + 6, y), (x + 6, y + 6), (x, y + 6)] for x in range(1, 43, 7) for y in range(1, 29, 7)]
    network = carver(43, 29, holes)
    free = extract(network, Extraction(lumen_width=0.3))
    count, triangles = free.report.pillars, free.report.predicted_triangles
    wider = extract(network, Extraction(lumen_width=0.3, triangle_budget=int(0.8 * triangles)))
    assert wider.report.width_from == "budget"
    assert wider.report.merged == 0
    assert wider.report.predicted_triangles <= 0.8 * triangles
    limit = extract(network, Extraction(lumen_width=1.25))
    merged = extract(network, Extraction(lumen_width=0.3, triangle_budget=int(0.98 * limit.report.predicted_triangles)))
    assert_sound(merged)
    assert 1 <= merged.report.merged <= 0.15 * count
    assert merged.report.tubule_width_l0 == pytest.approx(1.25)
    assert sorted(void for group in merged.lineage for void in group) == list(range(count))
    with pytest.raises(InputError, match="raise triangle_budget"):
        extract(network, Extraction(triangle_budget=100))


def test_a_budget_that_leaves_no_pillar(carver):
    network = carver(12, 10, [[(5, 5), (8, 5), (8, 7), (5, 7)]])
    assert extract(network, Extraction(lumen_width=0.3)).report.pillars == 1
    with pytest.raises(InputError, match="budget of 2 triangles cannot be met: no pillar is left"):
        extract(network, Extraction(lumen_width=0.3, triangle_budget=2))


def test_widths_exclude_each_other():
    with pytest.raises(InputError) as caught:
        Extraction(fluid_fraction=0.4, minimum_width=1.0)
    assert str(caught.value) == (
        "fluid_fraction = 0.4 and minimum_width = 1.0 exclude each other: "
        "give one of fluid_fraction, lumen_width, minimum_width"
    )
    with pytest.raises(InputError, match=r"lumen_width = 0\.7 and minimum_width = 1 exclude each other"):
        Extraction(lumen_width=0.7, minimum_width=1)


def test_what_was_asked_for_is_reported(carver):
    network = carver(20, 16, [[(5, 5), (15, 5), (15, 11), (5, 11)]])
    for name, words in (("lumen_width", "lumen width"), ("minimum_width", "minimum width")):
        found = extract(network, Extraction(**{name: 0.8}))
        assert found.report.width_from == words
        assert found.report.tubule_width_l0 == found.report.first_width_l0 == pytest.approx(0.8)
        assert found.report.refined_passages == found.report.passages == 0
        assert found.passages.bodies.tolist() == [[0, -1], [0, -2], [0, -3], [0, -4]]
    square = extract(network, Extraction(minimum_width=0.8)).domain.pillars[0]
    assert signed_area(square) > 0.98 * 60.0  # nothing is narrow: only the corners are rounded


def test_nothing_broken(carver):
    with pytest.raises(InputError, match="no void: the largest face covers 1 mean initial"):
        extract(carver(10, 10, []))


def test_everything_broken(carver):
    with pytest.raises(InputError, match="everything is broken: one void covers 100 %"):
        extract(carver(10, 10, [[(-1, -1), (11, -1), (11, 11), (-1, 11)]], [[(x, 0) for x in range(11)]]))
    network = SpringNetwork([(0, 0), (1, 0), (0, 1)], np.empty((0, 2), dtype=int), triangles=[(0, 1, 2)])
    with pytest.raises(InputError, match="everything is broken: none of the springs between 3 nodes"):
        extract_domain(network)


def test_no_pillar_left(carver):
    network = carver(20, 16, [[(5, 5), (9, 5), (9, 8), (5, 8)]])
    with pytest.raises(InputError, match="no pillar: all 1 voids vanish"):
        extract(network, Extraction(lumen_width=3.0))


def test_open_chain_has_no_void():
    with pytest.raises(InputError, match="enclose nothing"):
        extract(SpringNetwork([(0, 0), (1, 0), (2, 1)], [(0, 1), (1, 2)]))


def test_not_finite(carver):
    network = carver(20, 16, [[(5, 5), (9, 5), (9, 8), (5, 8)]])
    network.points[7, 1] = np.nan
    with pytest.raises(InputError, match="node 7 of 357 is not finite"):
        extract(network)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("lumen_width", 0.0),
        ("minimum_width", -1.0),
        ("fluid_fraction", 1.0),
        ("strip", -1.0),
        ("spacing", float("nan")),
        ("smallest_radius", float("inf")),
        ("triangle_budget", 0),
        ("rays", 2),
    ],
)
def test_parameters_are_checked(name, value):
    with pytest.raises(InputError, match=name):
        Extraction(**{name: value})


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("spacing", 1e-4, "spacing must lie from 0.05 to 10, got 0.0001"),
        ("spacing", 11, "spacing must lie from 0.05 to 10, got 11"),
        ("spacing", "a", "spacing must lie from 0.05 to 10, got 'a'"),
        ("strip", 1e18, "strip must lie from 0.05 to 100, got 1e+18"),
        ("strip", None, "strip must lie from 0.05 to 100, got None"),
        ("smallest_radius", 101.0, "smallest_radius must lie between 0 and 100, got 101.0"),
        ("lumen_width", 1e300, "lumen_width must lie between 0 and 100, got 1e+300"),
        ("minimum_width", "1", "minimum_width must lie between 0 and 100, got '1'"),
        ("edge_length", 0.0, "edge_length must lie from 0.02 to 10, got 0.0"),
        ("fluid_fraction", True, "fluid_fraction must lie between 0 and 1, got True"),
        ("rays", 5000, "rays must be a whole number from 3 to 4096, got 5000"),
        ("rays", 64.0, "rays must be a whole number from 3 to 4096, got 64.0"),
        ("triangles_across", True, "triangles_across must be a whole number from 1 to 20, got True"),
        ("triangles_across", 21, "triangles_across must be a whole number from 1 to 20, got 21"),
        ("triangle_budget", 1e5, "triangle_budget must be a whole number from 1 up, got 100000.0"),
    ],
)
def test_ranges_are_printed(name, value, message):
    with pytest.raises(InputError) as caught:
        Extraction(**{name: value})
    assert str(caught.value) == message


def test_ends_of_the_ranges_are_allowed():
    for name, values in (("spacing", (0.05, 10)), ("strip", (0.05, 100)), ("rays", (3, np.int64(4096)))):
        for value in values:
            assert getattr(Extraction(**{name: value}), name) == value
