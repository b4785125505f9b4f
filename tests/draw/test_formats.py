"""Files for papers: text stays text, what is dense is an image inside, no date, the width that was asked for."""

import re

import numpy as np
import pytest

from vasculo.draw.canvas import FORMATS, WIDTH, new_figure, render, save
from vasculo.draw.embedded import lighter
from vasculo.draw.figures import pictures
from vasculo.draw.single import draw_one, picture
from vasculo.draw.views import WHATS


@pytest.mark.parametrize("kind", FORMATS)
def test_the_same_bytes_whenever_it_is_made(disk_run, kind):
    one, two = (render(picture(disk_run, "flow"), kind) for _ in range(2))
    assert one == two
    assert b"20" + b"26-" not in one
    for word in (b"CreationDate", b"dc:date", b"ModDate"):
        assert word not in one


def test_text_stays_text(disk_run):
    svg = render(picture(disk_run, "flow"), "svg").decode()
    assert re.search(r">step 2 · 1 pillar</text>", svg)
    assert "sans-serif" in svg
    assert svg.count("<image") >= 1
    pdf = render(picture(disk_run, "flow"), "pdf")
    assert b"/FontFile2" in pdf  # an embedded TrueType font
    assert b"/Type3" not in pdf
    assert pdf.count(b"/Subtype /Image") >= 1


@pytest.mark.parametrize("what", WHATS)
def test_files_for_papers_stay_small(tissue_run, what):
    files = draw_one(tissue_run, what, formats=("svg", "pdf"), width=85.0 / 25.4)
    for file in files:
        assert 5_000 < file.stat().st_size < 1_000_000
    points = [float(size) for size in re.findall(r'(?:width|height)="([0-9.]+)pt"', files[0].read_text()[:2000])]
    assert points[0] == pytest.approx(85.0 / 25.4 * 72.0, rel=0.01)


@pytest.mark.parametrize("width", [85.0 / 25.4, WIDTH])
def test_no_text_leaves_a_picture_or_lies_over_another(tissue_run, disk_run, width):
    for run in (tissue_run, disk_run):
        for wanted in pictures(run):
            figure = wanted.draw(run, width)
            assert figure.get_figwidth() == pytest.approx(width, rel=0.01)
            figure.canvas.draw()
            titles = [axes.get_title(loc="left") for axes in figure.axes if axes.get_visible()]
            assert all(titles) or any(axes.get_legend() or axes.texts for axes in figure.axes), wanted.name
            placed = boxes(figure)
            for text, box in placed:
                inside = box.x0 >= -1 and box.y0 >= -1 and box.x1 <= figure.bbox.width + 1
                assert inside, (wanted.name, text, box.extents, figure.bbox.extents)
            for k, (text, box) in enumerate(placed):
                for other, beside in placed[:k]:
                    assert not overlap(box, beside), (wanted.name, text, other)


def boxes(figure):
    """Captions and labels of a figure, with their boxes in pixels; letters on pillars lie inside these."""
    renderer = figure.canvas.get_renderer()
    found = []
    for axes in figure.axes:
        if axes.get_visible():
            found.append(axes._left_title)
            found += [text for text in axes.texts if len(text.get_text()) > 1]
            found += [child._left_title for child in axes.child_axes]
            found += axes.get_legend().get_texts() if axes.get_legend() else []
    return [(text.get_text(), text.get_window_extent(renderer)) for text in found if text.get_text()]


def overlap(one, two):
    wide = min(one.x1, two.x1) - max(one.x0, two.x0)
    high = min(one.y1, two.y1) - max(one.y0, two.y0)
    return wide > 1.0 and high > 3.0


def test_images_inside_svg_get_smaller_and_look_the_same():
    figure = new_figure(2.0, 2.0)
    axes = figure.subplots()
    x, y = np.meshgrid(np.linspace(0.0, 1.0, 200), np.linspace(0.0, 1.0, 200))
    axes.imshow(np.stack((x, y, 0.5 * x + 0.5 * y), axis=2))
    plain = _svg(figure)
    packed = lighter(plain)
    assert packed != plain
    assert lighter(packed) == packed
    before, after = (_images(data) for data in (plain, packed))
    assert len(before) == len(after) == 1
    assert np.abs(before[0].astype(int) - after[0]).max() <= 2


def test_grey_images_lose_nothing():
    figure = new_figure(2.0, 2.0)
    figure.subplots().imshow(np.random.default_rng(1).random((50, 50)), cmap="gray")
    plain = _svg(figure)
    packed = lighter(plain)
    assert len(packed) < 0.8 * len(plain)
    np.testing.assert_array_equal(_images(plain)[0], _images(packed)[0])


def _svg(figure):
    from io import BytesIO

    data = BytesIO()
    figure.savefig(data, format="svg")
    return data.getvalue()


def _images(svg):
    import base64
    from io import BytesIO

    from PIL import Image

    found = re.findall(rb"data:image/png;base64,([A-Za-z0-9+/=\s]+)", svg)
    return [np.asarray(Image.open(BytesIO(base64.b64decode(data))).convert("RGBA")) for data in found]


def test_the_name_of_the_file_gives_the_format(tmp_path):
    figure = new_figure(1.0, 1.0)
    for kind, start in (("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")):
        assert save(figure, tmp_path / f"a.{kind}").read_bytes().startswith(start)
    small, large = (len(save(figure, tmp_path / "b.png", dpi).read_bytes()) for dpi in (50, 400))
    assert small < large
