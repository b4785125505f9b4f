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
