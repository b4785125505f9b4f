"""Colour scales keep their order in grey print and for colour-blind eyes."""

import numpy as np
import pytest
from matplotlib.colors import LinearSegmentedColormap
from tests.draw.eyes import EYES, apart, lab

from vasculo.draw import canvas
from vasculo.draw.canvas import CHAIN, CHAINS, ERROR, PILLAR, PRESSURE, SHEAR, SPEED
from vasculo.draw.chains import OTHER, SINGLE
from vasculo.draw.network import GROUND, PALE
from vasculo.draw.overlay import CUT, LOST, WALL, WHOLE

SCALES = {"speed": SPEED, "chain": CHAIN, "shear": SHEAR, "pressure": PRESSURE, "error": ERROR}


def tones(scale, count=65):
    return scale(np.linspace(0.0, 1.0, count))[:, :3]


def test_every_scale_is_looked_at():
    made = [value for value in vars(canvas).values() if isinstance(value, LinearSegmentedColormap)]
    assert sorted(scale.name for scale in made) == sorted(SCALES)


def test_grey_and_blindness_are_right():
    grey = lab([(k, k, k) for k in (0.0, 0.5, 1.0)])
    np.testing.assert_allclose(grey, [[0, 0, 0], [53.389, 0, 0], [100, 0, 0]], atol=0.02)
    np.testing.assert_allclose(lab(["red"])[0], [53.24, 80.09, 67.20], atol=0.02)
    assert apart(["#d62728", "#6a8a2f"], "deutan") < 0.5 * apart(["#d62728", "#6a8a2f"])


@pytest.mark.parametrize("name", SCALES)
@pytest.mark.parametrize("eye", EYES)
def test_lightness_goes_one_way(name, eye):
    lightness = lab(tones(SCALES[name]), eye)[:, 0]
    steps = np.diff(lightness)
    assert (steps > 0.0).all() or (steps < 0.0).all()
    assert abs(lightness[-1] - lightness[0]) > 50.0


@pytest.mark.parametrize("name", SCALES)
@pytest.mark.parametrize("eye", EYES)
def test_an_eighth_of_a_scale_is_seen(name, eye):
    seen = lab(tones(SCALES[name], 9), eye)
    steps = np.linalg.norm(np.diff(seen, axis=0), axis=1)
    assert steps.min() > 6.0  # a distance of 2.3 is just noticed
    assert steps.max() < 5.0 * steps.min()


def test_in_grey_print_high_and_low_shear_are_not_alike():
    low, middle, high = lab(tones(SHEAR, 3))[:, 0]
    assert low - middle > 25.0
    assert middle - high > 25.0


def test_the_flow_is_never_as_light_as_a_pillar():
    assert lab(tones(SPEED))[:, 0].max() < lab([PILLAR])[0, 0]


def test_the_lines_of_the_network_show_on_their_ground():
    lightness = lab(tones(ERROR))[:, 0]
    assert lightness.min() > lab([GROUND])[0, 0] + 20.0
    below, at, above = lab(tones(ERROR, 3))[:, 0]
    assert min(at - below, above - at) > 15.0
    assert lab([PALE])[0, 0] > at


@pytest.mark.parametrize("eye", EYES)
def test_chains_are_told_apart(eye):
    assert apart(CHAINS, eye) > 25.0
    assert apart([*CHAINS, OTHER], eye) > 25.0
    assert apart([OTHER, SINGLE], eye) > 10.0


@pytest.mark.parametrize("eye", EYES)
def test_outlines_over_a_picture_are_told_apart(eye):
    assert apart([WHOLE, CUT, WALL, LOST], eye) > 25.0
