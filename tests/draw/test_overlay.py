"""The overlay shows the outlines where they are in the picture, and a scale bar of a round length."""

import numpy as np
import pytest
from imageio.v3 import imread
from matplotlib.colors import to_rgb

from vasculo.draw.overlay import CUT, LOST, WALL, WHOLE, draw_overlay, nice_length
from vasculo.plexus.image import SIDES, ImageExtraction, domain_from_image


def picture():
    """A block in the lower left corner's quarter, tissue along the right side, and a vessel that leads nowhere."""
    grey = np.zeros((60, 80), dtype=np.uint8)
    grey[35:50, 10:30] = 200
    grey[:, 66:] = 200
    grey[20:30, 71:76] = 0
    return grey


def coloured(file, colour, close=0.1):
    """Pixels of a file that have nearly a colour; (n, 2) row and column as shares of the size."""
    shown = imread(file)[..., :3] / 255.0
    places = np.argwhere(np.abs(shown - to_rgb(colour)).max(axis=2) < close)
    return places / shown.shape[:2]


def test_every_kind_of_outline_is_where_it_belongs(tmp_path):
    found = domain_from_image(picture(), ImageExtraction(vessels="dark", inlet="top"))
    file = draw_overlay(picture(), found, None, tmp_path / "overlay.png")
    row, column = coloured(file, WHOLE)[:, 0], coloured(file, WHOLE)[:, 1]
    assert len(row) > 100
    inside = row < 0.9  # the key stands below
    assert row[inside].mean() > 0.5
    assert column[inside].mean() < 0.45
    assert np.median(coloured(file, WALL)[:, 1]) > 0.7
    assert len(coloured(file, LOST)) > 50
    assert len(coloured(file, CUT, 0.02)) == 0


@pytest.mark.parametrize("inlet", SIDES)
def test_colour_pictures_and_every_inlet(tmp_path, inlet):
    grey = np.zeros((40, 60))
    grey[10:30, 20:40] = 1.0
    found = domain_from_image(grey, ImageExtraction(vessels="dark", inlet=inlet))
    colours = np.stack([grey, 0.5 * grey, grey, np.ones_like(grey)], axis=2)
    with_bar = imread(draw_overlay(colours, found, 0.5, tmp_path / "one.png"))
    without = imread(draw_overlay(colours, found, None, tmp_path / "two.png"))
    # the bar is the one long dark row of the lower part
    rows = [
        (image[2 * len(image) // 3 :, :, :3] < 0.25 * image.max()).all(axis=2).sum(axis=1).max()
        for image in (with_bar, without)
    ]
    assert rows[0] > 60 > 2 * rows[1]


@pytest.mark.parametrize(("wanted", "length"), [(1.0, 1.0), (1.99, 1.0), (37.0, 20.0), (50.0, 50.0), (0.07, 0.05)])
def test_round_lengths(wanted, length):
    assert nice_length(wanted) == pytest.approx(length)
