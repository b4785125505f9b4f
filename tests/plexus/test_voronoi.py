import numpy as np
import pytest

from vasculo.errors import InputError
from vasculo.geometry.neighbours import pillar_gaps
from vasculo.geometry.outline import segment_lengths
from vasculo.plexus.voronoi import disk_domain, voronoi_plexus


@pytest.mark.parametrize("seed", range(6))
def test_box_channels_and_fraction(seed):
    domain = voronoi_plexus(16, width=16.0, height=9.0, channel=0.6, seed=seed)
    assert domain.bounds == (0.0, 0.0, 16.0, 9.0)
    assert domain.side_names == ("bottom", "left", "right", "top")
    assert 14 <= len(domain.pillars) <= 16
    assert 0.42 < 1.0 - domain.area / 144.0 < 0.52
    assert pillar_gaps(domain.pillars).min() == pytest.approx(0.6, rel=0.01)
    nodes = np.concatenate(domain.pillars)
    assert nodes[:, 1].min() == pytest.approx(0.3, abs=0.01)
    assert nodes[:, 1].max() == pytest.approx(8.7, abs=0.01)
    assert nodes[:, 0].min() == pytest.approx(1.8, abs=0.01)
    ratios = [edges.max() / edges.min() for edges in map(segment_lengths, domain.pillars)]
    assert max(ratios) < 1.1


def test_mean_radius_is_the_unit():
    for pillars, channel in ((16, 0.6), (64, 0.58), (3, 0.3)):
        assert voronoi_plexus(pillars, channel=channel, seed=4).mean_radius == pytest.approx(1.0, abs=6e-3)


def test_seed_decides():
    one, two, three = voronoi_plexus(seed=1), voronoi_plexus(seed=1), voronoi_plexus(seed=2)
    for first, second in zip(one.pillars, two.pillars, strict=True):
        np.testing.assert_array_equal(first, second)
    assert one.area != three.area


def test_disk():
    domain = disk_domain()
    assert domain.bounds == (0.0, 0.0, 12.0, 8.0)
    np.testing.assert_allclose(np.hypot(*(domain.pillars[0] - (6.0, 4.0)).T), 1.0)
    assert domain.pillar_areas[0] == pytest.approx(17.5 * np.sin(2.0 * np.pi / 35.0))


def test_bad_input():
    with pytest.raises(InputError, match="both width and height"):
        voronoi_plexus(16, width=16.0)
    with pytest.raises(InputError, match="channel must be positive"):
        voronoi_plexus(channel=-0.1)
    with pytest.raises(InputError, match="channel must be at most 3"):
        voronoi_plexus(channel=50.0)
    with pytest.raises(InputError, match="no room"):
        voronoi_plexus(16, width=3.0, height=9.0)
    with pytest.raises(InputError, match="no pillar is left"):
        voronoi_plexus(400, width=16.0, height=9.0)
    with pytest.raises(InputError, match="at least 1 pillar"):
        voronoi_plexus(0)
    with pytest.raises(InputError, match="radius 5"):
        disk_domain(radius=5.0)


@pytest.mark.parametrize(
    ("draw", "change", "message"),
    [
        (
            voronoi_plexus,
            {"pillars": 10**26},
            f"pillars = {10**26} must be a whole number: at least 1 pillar, at most 100000",
        ),
        (voronoi_plexus, {"pillars": 16.0}, "pillars = 16.0 must be a whole number"),
        (voronoi_plexus, {"pillars": True}, "pillars = True must be a whole number"),
        (voronoi_plexus, {"pad": 1e300}, "pad must lie from 0 to 100 mean pillar radii, got 1e+300"),
        (voronoi_plexus, {"pad": np.nan}, "pad must lie from 0 to 100"),
        (voronoi_plexus, {"width": np.nan, "height": 9.0}, "width must be positive and finite, got nan"),
        (voronoi_plexus, {"width": 0.0, "height": 9.0}, "width must be positive and finite, got 0.0"),
        (voronoi_plexus, {"width": 16.0, "height": 1e300}, "height must be at most 1e+06, got 1e+300"),
        (voronoi_plexus, {"spacing": 1e-9}, "spacing must be at least 0.001"),
        (disk_domain, {"width": np.nan}, "width must be positive and finite, got nan"),
        (disk_domain, {"height": "8"}, "height must be positive and finite, got '8'"),
        (disk_domain, {"radius": 0}, "radius must be positive and finite, got 0"),
        (disk_domain, {"width": 1e300}, "width must be at most 1e+06, got 1e+300"),
        (disk_domain, {"nodes": 7}, "nodes must be a whole number from 8 to 100000, got 7"),
        (disk_domain, {"nodes": 8.5}, "nodes must be a whole number from 8 to 100000, got 8.5"),
    ],
)
def test_the_key_and_its_range_are_named(draw, change, message):
    with pytest.raises(InputError) as caught:
        draw(**change)
    assert str(caught.value).startswith(message)
