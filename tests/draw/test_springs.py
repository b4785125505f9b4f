"""Springs of large and of periodic tissues: an image when there are many, the same look, both sides of the seam."""

import numpy as np
import pytest
from matplotlib.collections import LineCollection

from vasculo.draw import crowd
from vasculo.draw import springs as module
from vasculo.draw.canvas import RESOLUTION, new_figure
from vasculo.draw.crowd import Crowd
from vasculo.draw.growth import part_share
from vasculo.draw.seam import images
from vasculo.draw.springs import draw_springs, sharpness, whole_tissue, zoom
from vasculo.store.read import Springs


def tissue(side, holes=((0.3, 0.35, 0.18), (0.7, 0.65, 0.15)), box=None):
    """A triangular lattice with holes whose rims pull hard; periodic when it has a box."""
    column, row = np.meshgrid(np.arange(side), np.arange(side))
    points = np.stack([(column + 0.5 * (row % 2)).ravel() / side, (row + 0.25).ravel() / side], axis=1)
    index = (column + side * row).ravel()
    ahead = np.where(row % 2, column + 1, column).ravel()
    up = side * ((row.ravel() + 1) % side)
    pairs = np.concatenate(
        [
            np.stack([index, (column.ravel() + 1) % side + side * row.ravel()], axis=1),
            np.stack([index, ahead % side + up], axis=1),
            np.stack([index, (ahead - 1) % side + up], axis=1),
        ]
    )
    if box is None:
        pairs = pairs[np.abs(points[pairs[:, 0]] - points[pairs[:, 1]]).max(axis=1) < 0.5]
    away = np.min([np.hypot(*(points - (x, y)).T) - r for x, y, r in holes], axis=0)
    pairs = pairs[(away[pairs] > 0.0).all(axis=1)]
    forces = np.where(away[pairs].max(axis=1) < max(2.0 / side, 0.015), 1.0, 0.1)  # in more than 2 % of the springs
    return Springs(points, np.zeros_like(points), pairs.astype(np.int32), forces, box)


def shot(springs, box, widen=1.0, size=(4.0, 4.0)):
    """Brightness of a picture of the region alone, from top to bottom."""
    figure = new_figure(*size, 160)
    figure.set_layout_engine("none")
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    draw_springs(axes, springs, box, widen=widen)
    axes.axis("off")
    figure.canvas.draw()
    return np.asarray(figure.canvas.buffer_rgba())[:, :, 0] / 255.0


def test_many_springs_are_an_image_and_few_are_lines(monkeypatch):
    few = tissue(20)
    monkeypatch.setattr(module, "CROWD", len(few.springs))
    axes = new_figure(2, 2).subplots()
    draw_springs(axes, few, whole_tissue())
    assert [type(artist) for artist in axes.collections] == [LineCollection]
    monkeypatch.setattr(module, "CROWD", len(few.springs) - 1)
    axes = new_figure(2, 2).subplots()
    draw_springs(axes, few, whole_tissue())
    assert [type(artist) for artist in axes.artists] == [Crowd]
    assert len(axes.collections) == 0
    draw_springs(axes, few, (0.0, 0.0, 0.5, 0.5))  # what counts is what is in view
    assert len(axes.collections) == 1


@pytest.mark.parametrize("box", [(-0.005, -0.005, 1.005, 1.005), (0.1, 0.2, 0.4, 0.5)])
def test_lines_and_image_look_alike(monkeypatch, box):
    state = tissue(60)
    lines = shot(state, box)
    monkeypatch.setattr(module, "CROWD", 0)
    image = shot(state, box)
    assert image.mean() == pytest.approx(lines.mean(), abs=0.004)
    assert np.abs(image - lines).mean() < 0.02


def test_a_large_tissue_has_dark_cords_and_white_voids():
    state = tissue(260)
    assert len(state.springs) > module.CROWD
    picture = shot(state, whole_tissue(), zoom(len(state.springs)))
    high, wide = picture.shape
    x, y = np.meshgrid((np.arange(wide) + 0.5) / wide, 1.0 - (np.arange(high) + 0.5) / high)
    away = np.hypot(x - 0.3, y - 0.35) - 0.18
    assert (picture[away < -0.01] == 1.0).all()
    assert picture[np.abs(away - 0.004) < 0.002].mean() < 0.45
    rest = picture[
        (away > 0.05) & (np.hypot(x - 0.7, y - 0.65) > 0.2) & (np.abs(x - 0.5) < 0.4) & (np.abs(y - 0.5) < 0.4)
    ]
    assert 0.6 < rest.mean() < 0.95


def test_the_image_is_made_once_a_picture_and_is_the_same_each_time(monkeypatch):
    monkeypatch.setattr(module, "CROWD", 0)
    made = []
    monkeypatch.setattr(crowd, "raster", lambda *given, keep=crowd.raster: made.append(1) or keep(*given))
    figure = new_figure(2, 2)
    draw_springs(figure.subplots(), tissue(20), whole_tissue())
    figure.canvas.draw()
    first = np.array(figure.canvas.buffer_rgba())
    figure.canvas.draw()
    assert made == [1]
    np.testing.assert_array_equal(first, figure.canvas.buffer_rgba())
    figure.set_size_inches(3, 3)
    figure.canvas.draw()
    assert made == [1, 1]
    figure.axes[0].artists[0].set_visible(False)
    figure.canvas.draw()
    assert made == [1, 1]


@pytest.mark.parametrize("kind", ["svg", "pdf"])
def test_vector_graphics_take_the_image_too(tmp_path, monkeypatch, kind):
    monkeypatch.setattr(module, "CROWD", 0)
    figure = new_figure(2, 2)
    draw_springs(figure.subplots(), tissue(20), whole_tissue())
    figure.savefig(tmp_path / f"a.{kind}")
    assert b"mage" in (tmp_path / f"a.{kind}").read_bytes()


def test_widths_and_sharpness_follow_the_number_of_springs():
    assert zoom(35_000) == 1.0
    assert zoom(3_000_000) == pytest.approx(0.168, abs=0.001)
    assert zoom(0) == zoom(1) == 2.5
    assert sharpness(35_000) == sharpness(100_000) == RESOLUTION
    assert RESOLUTION < sharpness(300_000) < sharpness(600_000) < sharpness(3_000_000) == sharpness(10**8) == 290


def test_a_fragment_shows_as_many_nodes_of_any_large_tissue():
    assert part_share(900) == part_share(3_000) == 0.6
    for nodes in (12_000, 100_000, 1_000_000):
        assert nodes * part_share(nodes) ** 2 == pytest.approx(4000)


def test_springs_across_the_seam_are_placed_on_both_sides():
    points = np.array([[0.95, 0.5], [0.05, 0.5], [0.5, 1.9], [0.5, 0.1], [0.9, 1.95], [-0.9, 2.05]])
    pairs = np.array([[0, 1], [1, 0], [2, 3], [4, 5], [0, 2], [1, 3]], dtype=np.int32)
    ends, origin = images(points, pairs, (1.0, 2.0))
    found = sorted((int(k), *np.round(end.ravel(), 6).tolist()) for k, end in zip(origin, ends, strict=True))
    assert found == [
        (0, -0.05, 0.5, 0.05, 0.5),
        (0, 0.95, 0.5, 1.05, 0.5),
        (1, 0.05, 0.5, -0.05, 0.5),
        (1, 1.05, 0.5, 0.95, 0.5),
        (2, 0.5, -0.1, 0.5, 0.1),
        (2, 0.5, 1.9, 0.5, 2.1),
        (3, -0.1, -0.05, 0.1, 0.05),
        (3, -0.1, 1.95, 0.1, 2.05),
        (3, 0.9, -0.05, 1.1, 0.05),
        (3, 0.9, 1.95, 1.1, 2.05),
        (4, 0.95, 0.5, 0.5, -0.1),
        (4, 0.95, 2.5, 0.5, 1.9),
        (5, 0.05, 0.5, 0.5, 0.1),
    ]


@pytest.mark.parametrize("crowded", [False, True])
def test_a_periodic_tissue_looks_the_same_wherever_its_seam_is(monkeypatch, crowded):
    monkeypatch.setattr(module, "CROWD", 0 if crowded else 10**9)
    state = tissue(40, box=(1.0, 1.0))
    box = whole_tissue(state.box)
    assert box == (0.0, 0.0, 1.0, 1.0)
    moved = Springs(state.points + np.array([3.25, -7.5]), state.velocities, state.springs, state.forces, state.box)
    one, two = shot(state, box), shot(moved, box)
    assert one.shape == (640, 640)
    other = np.abs(np.roll(one, (-320, 160), axis=(0, 1)) - two) > 0.02
    assert np.count_nonzero(other) < 100  # crossings of equal springs, one or the other on top
    unwrapped = Springs(state.points, state.velocities, state.springs, state.forces)
    assert np.abs(shot(unwrapped, box) - one).mean() > 0.01  # lines across the whole tissue


@pytest.mark.parametrize("crowded", [False, True])
def test_a_periodic_tissue_is_cut_off_at_its_box_and_at_the_panel(monkeypatch, crowded):
    monkeypatch.setattr(module, "CROWD", 0 if crowded else 10**9)
    state = tissue(40, box=(1.0, 1.0))
    picture = shot(state, (-0.5, -0.5, 1.5, 1.5))
    assert (picture[:158] == 1.0).all()
    assert (picture[:, 482:] == 1.0).all()
    assert picture[165:475, 165:475].mean() < 0.9
    axes = new_figure(2, 2).subplots()
    draw_springs(axes, state, (0.5, 0.5, 1.5, 1.5))
    clip = (axes.artists or axes.collections)[0].get_clip_box()
    np.testing.assert_allclose(clip.extents, axes.transData.transform([(0.5, 0.5), (1.0, 1.0)]).ravel())
    draw_springs(axes, state, (2.0, 2.0, 3.0, 3.0))
