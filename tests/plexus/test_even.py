import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from vasculo.geometry.outline import resample, segment_lengths, signed_area
from vasculo.plexus.even import CORNER, even_rings
from vasculo.plexus.outlines import ring_nodes


def rounded(seed, radius):
    """Ring of a random star whose corners have a radius."""
    draw = np.random.default_rng(seed)
    angles = np.sort(draw.uniform(0.0, 2.0 * np.pi, 9)) + 1e-2 * np.arange(9)
    radii = draw.uniform(2.0, 6.0, 9)
    star = shapely.Polygon(np.column_stack((radii * np.cos(angles), radii * np.sin(angles)))).buffer(0.0)
    opened = star.buffer(-radius).buffer(2.0 * radius).buffer(-radius)
    largest = max(shapely.get_parts(opened), key=shapely.area, default=shapely.Polygon())
    return ring_nodes(shapely.Polygon(largest.exterior)) if largest.area > 1.0 else ring_nodes(shapely.box(0, 0, 3, 2))


@settings(max_examples=40, deadline=None)
@given(seeds=st.lists(st.integers(0, 2**32 - 1), min_size=1, max_size=4), spacing=st.floats(0.1, 1.5))
def test_against_resample(seeds, spacing):
    rings = [rounded(seed, 0.3) for seed in seeds]
    for ring, even in zip(rings, even_rings(rings, spacing, 16), strict=True):
        plain = resample(ring, spacing, minimum=16, corners=CORNER, keep_area=True)
        if len(even) == len(plain):
            np.testing.assert_allclose(even, plain, atol=1e-9)
        else:  # one of the two crossed itself, and `resample` took more nodes
            assert not shapely.Polygon(even).is_valid


def test_circle_square_and_both_at_once():
    t = 2.0 * np.pi * np.arange(500) / 500
    circle = np.column_stack((5.0 + np.cos(t), np.sin(t)))
    square = np.array([(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)])
    round_one, cornered = even_rings([circle, square], 0.25, 16)
    assert len(round_one) == 25
    assert np.ptp(segment_lengths(round_one)) < 1e-3
    assert signed_area(round_one) == pytest.approx(signed_area(circle), rel=1e-12)
    assert signed_area(cornered) == pytest.approx(4.0, rel=1e-12)
    for corner in square:
        assert np.hypot(*(cornered - corner).T).min() < 1e-12
