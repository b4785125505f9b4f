"""Pictures become domains: to a fraction of a pixel, whatever the kind of picture, with a clear rule at the border."""

import numpy as np
import pytest
import shapely
from hypothesis import HealthCheck, given, reject, settings
from hypothesis import strategies as st
from scipy.ndimage import gaussian_filter
from tests.plexus.pictures import DARK, blocks, painted, read

from vasculo.errors import InputError
from vasculo.geometry.domain import Domain
from vasculo.geometry.neighbours import as_polygons
from vasculo.geometry.outline import segment_lengths
from vasculo.mesh.generate import generate_mesh
from vasculo.plexus.image import SIDES, ImageExtraction, domain_from_image
from vasculo.plexus.voronoi import voronoi_plexus


def polygons_of(found):
    return as_polygons(found.domain.pillars)


def nearest(shape, others):
    return min(others, key=lambda other: other.centroid.distance(shape.centroid))


RADIUS, GAP, PITCH = 12.0, 6.0, 30.0


@pytest.fixture(scope="module")
def hexagonal():
    """Disks on a hexagonal lattice off the pixels' own, and their picture."""
    places = [
        (PITCH * (i + 0.6 + 0.5 * (j % 2)), PITCH * (np.sqrt(0.75) * j + 0.7)) for i in range(4) for j in range(4)
    ]
    disks = [shapely.Point(*place).buffer(RADIUS, quad_segs=90) for place in places]
    return disks, painted(disks, 140, 118)


@pytest.mark.parametrize("smoothing", [0.0, 0.5, 1.0])
def test_disks_are_found_to_a_fraction_of_a_pixel(hexagonal, smoothing):
    disks, picture = hexagonal
    found = domain_from_image(picture, ImageExtraction(**DARK, smoothing=smoothing, spacing=1.0))
    assert len(found.domain.pillars) == len(disks) == 16
    for polygon in polygons_of(found):
        disk = nearest(polygon, disks)
        assert polygon.area == pytest.approx(np.pi * RADIUS**2, rel=0.01)
        assert polygon.centroid.distance(disk.centroid) < 0.05
        assert shapely.hausdorff_distance(polygon, disk, 0.2) < 0.2
    assert found.report.narrowest_gap == pytest.approx(GAP, abs=0.2)
    assert found.report.mean_radius == pytest.approx(RADIUS, rel=0.005)
    assert (found.report.widened, found.report.cut, found.report.walls) == (0, 0, 0)
    solid = 16 * np.pi * RADIUS**2 / picture.size
    assert found.report.fluid_fraction == pytest.approx(1.0 - solid, abs=0.005)


@pytest.mark.parametrize("smoothing", [1.0, 2.0, 3.0])
def test_the_blur_does_not_shrink_what_is_round(smoothing):
    disk = shapely.Point(40.2, 39.7).buffer(RADIUS, quad_segs=90)
    found = domain_from_image(painted([disk], 80, 80), ImageExtraction(**DARK, smoothing=smoothing, spacing=1.0))
    lost = RADIUS - found.report.mean_radius
    assert abs(lost) < 0.2 * smoothing**2 / (2.0 * RADIUS) + 0.03  # a Gaussian alone takes s^2/(2 R)


KINDS = {
    "bytes": lambda grey: np.rint(255 * grey).astype(np.uint8),
    "16 bit": lambda grey: np.rint(40_000 * grey + 100).astype(np.uint16),
    "signed": lambda grey: np.rint(1000 * grey - 500).astype(np.int16),
    "single": lambda grey: (1e6 * grey).astype(np.float32),
    "RGB": lambda grey: np.rint(255 * np.stack([grey] * 3, axis=2)).astype(np.uint8),
    "RGBA": lambda grey: np.rint(255 * np.stack([grey] * 3 + [np.ones_like(grey)], axis=2)).astype(np.uint8),
    "red": lambda grey: np.rint(255 * np.stack([grey, 0 * grey, 0 * grey], axis=2)).astype(np.uint8),
    "transparent vessels": lambda grey: np.stack([0 * grey] * 3 + [grey], axis=2),
}


@pytest.mark.parametrize("kind", KINDS)
def test_any_kind_of_picture_gives_the_same_domain(hexagonal, kind):
    _, picture = hexagonal
    wanted = domain_from_image(picture, ImageExtraction(**DARK))
    vessels = "bright" if kind == "transparent vessels" else "dark"
    found = domain_from_image(KINDS[kind](picture), ImageExtraction(vessels=vessels))
    for one, two in zip(found.domain.pillars, wanted.domain.pillars, strict=True):
        assert shapely.hausdorff_distance(shapely.Polygon(one), shapely.Polygon(two)) < 0.02


def test_an_inverted_picture_with_the_other_side_vessel(hexagonal):
    _, picture = hexagonal
    one = domain_from_image(picture, ImageExtraction(**DARK))
    two = domain_from_image(1.0 - picture, ImageExtraction(vessels="bright"))
    assert np.allclose(np.concatenate(one.domain.pillars), np.concatenate(two.domain.pillars), atol=0.01)


def test_a_mask_is_cut_half_way_whatever_the_method(hexagonal):
    _, picture = hexagonal
    for threshold in ("otsu", "li"):
        found = domain_from_image(np.where(picture > 0.5, 200, 40), ImageExtraction(**DARK, threshold=threshold))
        assert found.report.threshold == 120.0
        assert found.report.mean_radius == pytest.approx(RADIUS, rel=0.01)


@pytest.mark.parametrize("threshold", [0.5, "otsu", "li"])
def test_thresholds(hexagonal, threshold):
    noise = np.random.default_rng(0).normal(0.0, 0.1, hexagonal[1].shape)
    found = domain_from_image(hexagonal[1] + noise, ImageExtraction(**DARK, threshold=threshold))
    assert len(found.domain.pillars) == 16
    assert found.report.mean_radius == pytest.approx(RADIUS, rel=0.03)
    assert 0.3 < found.report.threshold < 0.6


def test_a_local_threshold_sees_through_uneven_light(hexagonal):
    disks, picture = hexagonal
    shaded = picture - 0.9 * np.cos(np.linspace(0.0, np.pi, picture.shape[1]))
    with pytest.raises(InputError, match="no vessel leads"):
        domain_from_image(shaded, ImageExtraction(**DARK))
    found = domain_from_image(shaded, ImageExtraction(**DARK, threshold="local", window=51, smallest_radius=6.0))
    assert len(found.domain.pillars) == len(disks)
    assert np.isnan(found.report.threshold)


def test_a_domain_that_is_painted_comes_back():
    scale = 14.0
    drawn = voronoi_plexus(16, seed=3)
    outlines = [shapely.Polygon(scale * pillar) for pillar in drawn.pillars]
    width, height = (int(np.ceil(scale * extent)) for extent in drawn.bounds[2:])
    for fine, within in ((8, 0.002), (1, 0.02)):  # a mask of whole pixels has no better areas itself
        found = domain_from_image(painted(outlines, width, height, fine), ImageExtraction(**DARK))
        assert len(found.domain.pillars) == len(outlines)
        for polygon in polygons_of(found):
            source = nearest(polygon, outlines)
            assert polygon.area == pytest.approx(source.area, rel=within)
            assert shapely.hausdorff_distance(polygon, source, 0.2) < 1.0
        assert found.domain.pillar_areas.sum() == pytest.approx(sum(o.area for o in outlines), rel=0.01)


@pytest.fixture(scope="module")
def lopsided():
    """A picture without any symmetry: blobs of several sizes, some cut by the border."""
    noise = np.random.default_rng(4).standard_normal((90, 130))
    return np.abs(gaussian_filter(noise, 4.0))


@pytest.mark.parametrize("quarters", range(4))
def test_the_inlet_turns_the_picture(lopsided, quarters):
    upright = domain_from_image(lopsided, ImageExtraction(**DARK))
    turned = np.rot90(lopsided, -quarters)
    found = domain_from_image(turned, ImageExtraction(**DARK, inlet=SIDES[quarters]))
    assert found.domain.side_names == upright.domain.side_names
    assert np.allclose(np.concatenate(found.domain.pillars), np.concatenate(upright.domain.pillars), atol=1e-6)
    assert np.array_equal(np.rot90(found.mask, quarters), upright.mask)
    assert found.mask.shape == turned.shape
    for pillar in found.domain.pillars:
        x, y = shapely.Polygon(found.in_picture(pillar)).representative_point().coords[0]
        assert not found.mask[int(y), int(x)]


def test_islands_cut_beside_the_flow_are_pillars_or_wall():
    picture = blocks((0, 20, 15, 30), (25, 30, 12, 20), (50, 15, 10, 40))
    opened, closed = read(picture), read(picture, border="closed")
    assert (opened.report.pillars, opened.report.cut, opened.report.walls) == (3, 2, 0)
    assert opened.domain.side_names == ("bottom", "left", "right", "top")
    assert opened.report.narrowest_wall_gap == pytest.approx(0.5 * opened.report.narrowest, rel=0.1)
    assert (closed.report.pillars, closed.report.cut, closed.report.walls) == (1, 0, 2)
    assert "wall" in closed.domain.side_names
    solid = 15 * 30 + 12 * 20 + 10 * 40
    assert closed.report.fluid_fraction == pytest.approx(1.0 - solid / picture.size, abs=0.01)
    assert list(opened.cut) == [bool(abs(pillar[:, 1].mean() - 30.0) > 10.0) for pillar in opened.domain.pillars]


def test_a_border_of_tissue_from_inlet_to_outlet_is_wall():
    picture = blocks((0, 0, 12, 80), (25, 30, 12, 20))
    found = read(picture)
    assert (found.report.pillars, found.report.walls) == (1, 1)
    wall = np.array(found.domain.sides) == "wall"
    lengths = segment_lengths(found.domain.outer)[wall]
    assert lengths.sum() == pytest.approx(80 + 2 * 12, abs=1.0)
    assert lengths.min() > 0.5 * found.report.spacing
    x0, y0, x1, y1 = found.domain.bounds
    assert (y0, y1) == (0.0, 60.0)
    assert x1 - x0 == pytest.approx(80 + 2.0 * found.report.mean_radius)


def test_islands_cut_at_inlet_and_outlet_end_at_the_strip():
    found = read(blocks((20, 0, 20, 25), (20, 60, 20, 20)))
    assert (found.report.pillars, found.report.cut) == (2, 2)
    ends = sorted((pillar[:, 0].min(), pillar[:, 0].max()) for pillar in found.domain.pillars)
    assert ends[0][0] == pytest.approx(0.0, abs=0.3)
    assert ends[1][1] == pytest.approx(80.0, abs=0.3)
    assert found.domain.bounds[0] == pytest.approx(-found.report.mean_radius, rel=1e-9)


def test_an_island_from_inlet_to_outlet_between_two_vessels_is_a_pillar():
    found = read(blocks((25, 0, 10, 80)))
    assert (found.report.pillars, found.report.walls) == (1, 0)
    assert found.domain.pillar_areas[0] == pytest.approx(800.0, rel=0.01)


def test_a_vessel_over_corners_of_pixels_is_one_vessel():
    picture = np.ones((40, 40))
    steps = np.arange(40)
    picture[steps, steps] = 0.0
    picture[:3] = picture[-3:] = 0.0
    picture[:, :3] = picture[:, -3:] = 0.0
    found = read(picture, smoothing=0.0)
    assert found.report.pillars == 2
    assert found.report.narrowest_gap >= 0.8 * found.report.narrowest > 0.0


def test_isolated_vessels_are_filled_and_small_islands_dropped():
    picture = blocks((20, 20, 25, 40), (5, 10, 2, 2))
    picture[30:35, 35:41] = 0.0
    found = read(picture)
    assert (found.report.islands, found.report.pillars, found.report.small) == (2, 1, 1)
    assert (found.report.lost_parts, found.report.lost_area) == (1, 30)
    assert found.lost.sum() == 30
    assert found.lost[32, 38]
    assert not found.mask[32, 38]
    assert found.domain.pillar_areas[0] == pytest.approx(1000.0, rel=0.01)


@pytest.mark.parametrize(("wide", "kept"), [(2, False), (10, True)])
def test_dead_ends_narrower_than_the_narrowest_passage_are_filled(wide, kept):
    picture = blocks((10, 20, 40, 40))
    picture[30 : 30 + wide, 20:45] = 0.0
    found = read(picture, narrowest=4.0, spacing=1.0)
    assert found.report.pillars == 1
    assert found.domain.pillar_areas[0] == pytest.approx(1600.0 - (25 * wide if kept else 0), rel=0.01)


def test_narrow_passages_are_widened():
    picture = blocks((20, 10, 20, 29), (20, 40, 20, 30))
    found = read(picture, narrowest=4.0)
    assert found.report.widened == 1
    assert found.report.narrowest_gap == pytest.approx(4.0, rel=0.2)
    loose = read(picture, narrowest=0.8, spacing=1.0)
    assert loose.report.widened == 0
    assert loose.report.narrowest_gap == pytest.approx(1.0, abs=0.15)


def test_a_part_of_the_picture(lopsided):
    part = domain_from_image(lopsided, ImageExtraction(**DARK, crop=(20, 10, 90, 60)))
    same = domain_from_image(lopsided[10:70, 20:110], ImageExtraction(**DARK))
    assert np.array_equal(np.concatenate(part.domain.pillars), np.concatenate(same.domain.pillars))
    assert (part.report.width, part.report.height) == (90, 60)


def test_what_should_be_looked_at():
    report = read(blocks((5, 20, 50, 20))).report
    assert report.tallest == pytest.approx(50 / 60, abs=0.01)
    few, tall = report.notes
    assert few == "few pillars (1): numbers of the network mean little"
    assert tall.startswith("a pillar takes 8")


def test_a_flow_mesh_fits(hexagonal, lopsided):
    for picture in (hexagonal[1], lopsided):
        found = domain_from_image(picture, ImageExtraction(**DARK, border="closed"))
        unit = found.report.mean_radius
        mesh = generate_mesh(found.domain, 0.7 * unit, 0.3 * unit, across=2)
        assert mesh.areas.sum() == pytest.approx(found.domain.area, rel=1e-10)
        assert mesh.quality().min() > 0.3


@settings(deadline=None, max_examples=40, suppress_health_check=[HealthCheck.filter_too_much])
@given(
    seed=st.integers(0, 2**32 - 1),
    shape=st.tuples(st.integers(20, 90), st.integers(20, 90)),
    grain=st.floats(1.0, 5.0),
    options=st.fixed_dictionaries(
        {
            "vessels": st.sampled_from(["bright", "dark"]),
            "inlet": st.sampled_from(SIDES),
            "border": st.sampled_from(["open", "closed"]),
            "smoothing": st.sampled_from([0.0, 0.5, 1.0, 2.0]),
            "narrowest": st.sampled_from([None, 1.0, 3.0]),
        }
    ),
)
def test_whatever_the_picture_the_domain_is_sound(seed, shape, grain, options):
    picture = np.abs(gaussian_filter(np.random.default_rng(seed).standard_normal(shape), grain))
    try:
        found = domain_from_image(picture, ImageExtraction(**options))
    except InputError:
        reject()
    report, polygons = found.report, polygons_of(found)
    assert shapely.is_valid(polygons).all()
    assert report.narrowest_gap >= 0.8 * report.narrowest * (1.0 - 1e-9)
    assert report.narrowest_wall_gap >= 0.4 * report.narrowest * (1.0 - 1e-9)
    for pillar in found.domain.pillars:
        lengths = segment_lengths(pillar)
        assert lengths.max() <= 1.31 * lengths.min()
        assert len(pillar) >= 16
    width, height = found.mask.shape[::-1] if options["inlet"] in {"left", "right"} else found.mask.shape
    x0, y0, x1, y1 = found.domain.bounds
    assert (y0, y1) == (0.0, height)
    assert x0 == pytest.approx(width - x1)
    assert report.fluid_fraction == pytest.approx(report.vessel_fraction, abs=0.25)
    assert isinstance(found.domain, Domain)


def test_mirrored_pictures_give_mirrored_pillars(lopsided):
    one = domain_from_image(lopsided, ImageExtraction(**DARK))
    two = domain_from_image(lopsided[::-1], ImageExtraction(**DARK))
    assert np.sort(one.domain.pillar_areas) == pytest.approx(np.sort(two.domain.pillar_areas), rel=5e-3)
