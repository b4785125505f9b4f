"""Pictures and parameters that cannot be used: one line each, with the numbers."""

import sys

import numpy as np
import pytest
from tests.plexus.pictures import DARK, blocks, read, strips

from vasculo.errors import ComputationError, InputError
from vasculo.plexus.image import ImageExtraction, domain_from_image

GOOD = blocks((20, 20, 20, 20))
WRONG_PICTURES = [
    (np.zeros((30, 30)), {}, "all 900 pixels have the grey value 0: there is nothing to tell apart"),
    (np.zeros((0, 0)), {}, "the picture is 0 x 0 pixels: 8 x 8 is the least"),
    (np.zeros((5, 90)), {}, "the picture is 90 x 5 pixels"),
    (np.zeros((4, 30, 30)), {}, r"a picture has shape \(height, width\), .* not \(4, 30, 30\): take one page"),
    (np.full((30, 30), 1j), {}, "a picture needs real numbers, not complex128"),
    (np.array([["a"]]), {}, "a picture needs real numbers, not <U1"),
    (np.where(GOOD == 0, np.nan, 1.0), {}, "4400 of the 4800 values of the picture are not finite"),
    (GOOD, {"threshold": 1.5}, "threshold 1.5 is outside the grey values of the picture, 0 to 1"),
    (GOOD, {"threshold": -0.1}, "threshold -0.1 is outside the grey values"),
    (GOOD, {"crop": (70, 0, 20, 60)}, r"crop 20 x 60 at \(70, 0\) does not fit into the picture of 80 x 60 pixels"),
    (GOOD, {"smallest_radius": 20.0}, "no pillars: all 1 islands are smaller than a disk of radius 20"),
    (GOOD, {"vessels": "bright"}, "no vessel leads from the inlet to the outlet: of 1 connected parts 0 reach"),
    (strips([1, 0, 1] * 10).T, {}, r"no vessel leads .*: of 10 connected parts 0 reach .* and 0 the outlet"),
    (strips([1] * 20 + [0] * 10 + [1] * 20), {}, "no pillars: all 2 islands belong to the border"),
    (
        blocks((20, 20, 5, 30)),
        {"narrowest": 2.0, "smoothing": 4.0},
        "no pillar is left of 1 islands when passages are 2",
    ),
]


@pytest.mark.parametrize(("picture", "options", "message"), WRONG_PICTURES)
def test_pictures_that_cannot_be_used(picture, options, message):
    with pytest.raises(InputError, match=f"^{message}") as caught:
        domain_from_image(picture, ImageExtraction(**({"smoothing": 0.5} | DARK | options)))
    assert "\n" not in str(caught.value)


def test_all_vessel():
    picture = blocks((20, 20, 20, 20))
    picture[0, 0] = 1.0
    picture[20:40, 20:40] = 0.4
    with pytest.raises(InputError, match="no pillars: all 1 islands are smaller"):
        read(picture, threshold=0.7)
    with pytest.raises(InputError, match="no vessel: all 4800 pixels are tissue: lower the threshold"):
        read(np.where(picture == 1.0, 0.0, 0.5), vessels="dark", threshold=0.0, smoothing=1.0)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"vessels": "grey"}, "vessels must be one of bright, dark, got 'grey'"),
        ({"threshold": "best"}, "threshold must be a grey value or one of otsu, li, local, got 'best'"),
        ({"threshold": True}, "threshold must be a grey value"),
        ({"smoothing": -1.0}, "smoothing must lie from 0 to 100 pixels, got -1.0"),
        ({"narrowest": 0.0}, "narrowest must lie from 0.1 to 10000 pixels"),
        ({"spacing": float("nan")}, "spacing must lie from 0.1"),
        ({"smallest_radius": "3"}, "smallest_radius must lie from 0.5"),
        ({"inlet": "left", "outlet": "top"}, "outlet top is not opposite inlet left: it must be right"),
        ({"inlet": "north"}, "inlet must be one of left, top, right, bottom, got 'north'"),
        ({"border": None}, "border must be one of open, closed, got None"),
        ({"crop": (0, 0, 10)}, "crop must be four whole numbers"),
        ({"crop": (0, -1, 10, 10)}, "crop must be four whole numbers"),
    ],
)
def test_parameters_out_of_range(options, message):
    with pytest.raises(InputError) as caught:
        ImageExtraction(**options)
    assert str(caught.value).startswith(message)


def test_without_scikit_image(monkeypatch):
    monkeypatch.setitem(sys.modules, "skimage.filters", None)
    with pytest.raises(InputError, match=r"scikit-image: pip install 'vasculo\[image\]' brings it"):
        read(GOOD)


def test_outlines_that_cannot_be_kept_apart(monkeypatch):
    from vasculo.plexus import image

    monkeypatch.setattr(image, "GAP_SHARE", 10.0)
    with pytest.raises(
        ComputationError, match="1 of 1 pillars stay too close to the border for a narrowest passage of 2"
    ):
        read(blocks((1, 20, 30, 20)), narrowest=2.0)
