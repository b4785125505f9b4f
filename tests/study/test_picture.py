"""From a picture file to a study: every format, what is printed and written, and one line for whatever is wrong."""

import sys

import numpy as np
import pytest
import tifffile
from imageio.v3 import imwrite
from PIL import Image
from typer.testing import CliRunner

from vasculo.cli import app
from vasculo.errors import InputError
from vasculo.plexus.image import ImageExtraction
from vasculo.study.outlines import outlines_domain
from vasculo.study.picture import study_of_picture
from vasculo.study.picture_file import read_picture
from vasculo.study.picture_options import pixels_of
from vasculo.study.settings import read_study

DARK = ImageExtraction(vessels="dark")


def call(*words):
    return CliRunner().invoke(app, [str(word) for word in words])


def one_line(result, *parts):
    assert result.exit_code == 2, result.output
    (line,) = result.stderr.strip().splitlines()
    assert line.startswith("vasculo: ")
    for part in parts:
        assert part in line


@pytest.fixture(scope="module")
def grey():
    """Two rows of blocks of tissue between vessels, 8 bit."""
    picture = np.full((60, 90), 20, dtype=np.uint8)
    for row in (6, 34):
        for column in (10, 38, 66):
            picture[row : row + 20, column : column + 18] = 220
    return picture


@pytest.fixture
def blocks(tmp_path, grey):
    imwrite(tmp_path / "blocks.png", grey)
    return tmp_path / "blocks.png"


@pytest.mark.parametrize(
    ("text", "size", "pixels"),
    [
        ("3", None, 3.0),
        (" 1.5 px", None, 1.5),
        (".5px", 0.1, 0.5),
        ("3um", 0.5, 6.0),
        ("3 µm", 2.0, 1.5),
        ("12.566px2", None, 2.0),
        ("314.159um2", 5.0, 2.0),
    ],
)
def test_lengths(text, size, pixels):
    assert pixels_of(text, size) == pytest.approx(pixels, rel=1e-4)


@pytest.mark.parametrize("text", ["", "3mm", "-2px", "px", "3 2", "um2", "nan", "1e3"])
def test_no_lengths(text):
    with pytest.raises(InputError, match="is no length: give pixels, as 3 or 3px, or micrometres"):
        pixels_of(text, 1.0)


def test_micrometres_need_a_pixel_size():
    with pytest.raises(InputError, match=r"'3um' is in micrometres: give the size of a pixel too, with --pixel-size"):
        pixels_of("3um", None)


@pytest.mark.parametrize("name", ["a.png", "a.tif", "a.tiff", "a.TIFF"])
@pytest.mark.parametrize("kind", ["grey", "RGB", "RGBA", "16 bit"])
def test_formats(tmp_path, grey, name, kind):
    opaque = np.full_like(grey, 255)
    picture = {
        "grey": grey,
        "RGB": np.stack([grey] * 3, axis=2),
        "RGBA": np.stack([grey] * 3 + [opaque], axis=2),
        "16 bit": grey.astype(np.uint16) * 257,
    }[kind]
    imwrite(tmp_path / name, picture)
    found, pages = read_picture(tmp_path / name)
    assert np.array_equal(found, picture)
    assert found.dtype == picture.dtype
    assert pages == 1


def test_jpeg(tmp_path, grey):
    imwrite(tmp_path / "a.jpg", grey, quality=95)
    written = study_of_picture(tmp_path / "a.jpg", DARK, tmp_path / "out")
    assert dict(written.rows)["pillars"].startswith("6, ")


def test_palettes_and_grey_with_alpha(tmp_path, grey):
    picture = Image.fromarray(grey)
    picture.convert("P").save(tmp_path / "palette.png")
    picture.convert("LA").save(tmp_path / "alpha.png")
    for name in ("palette.png", "alpha.png"):
        assert np.array_equal(read_picture(tmp_path / name)[0][..., 0], grey)


def test_a_tiff_in_which_zero_is_white_is_read_as_it_is_shown(tmp_path, grey):
    tifffile.imwrite(tmp_path / "a.tif", 255 - grey, photometric="miniswhite")
    assert np.array_equal(read_picture(tmp_path / "a.tif")[0], grey)


def test_pages(tmp_path, grey):
    tifffile.imwrite(tmp_path / "a.tif", np.stack([grey, grey[::-1], 255 - grey]), photometric="minisblack")
    found, pages = read_picture(tmp_path / "a.tif", 3)
    assert np.array_equal(found, 255 - grey)
    assert pages == 3
    with pytest.raises(InputError, match=r"a\.tif has no page 4: it has 3"):
        read_picture(tmp_path / "a.tif", 4)
    with pytest.raises(InputError, match="has no page 0"):
        read_picture(tmp_path / "a.tif", 0)
    written = study_of_picture(tmp_path / "a.tif", DARK, tmp_path / "out", page=2)
    assert written.rows[0] == ("page", "2 of 3")


def test_the_study_runs(blocks, tmp_path):
    out = tmp_path / "made" / "mine.toml"
    result = call("image", blocks, "--vessels", "dark", "--out", out, "--pixel-size", 2.0, "--smoothing", "1.2um")
    assert result.exit_code == 0, result.output
    lines = dict(line.split("  ", 1) for line in result.stdout.splitlines() if "  " in line)
    assert lines["picture"].strip() == "90 x 60 px (180 x 120 um)"
    assert lines["pillars"].strip() == "6, 0 of them cut by the picture's border"
    assert "note: few pillars (6)" in result.stdout
    assert result.stdout.splitlines()[-1] == f"{out} written; try: vasculo run {out}"
    names = {path.name for path in out.parent.iterdir()}
    assert names == {"mine.toml", "mine.outlines.json", "mine.overlay.png"}
    settings = read_study(out)
    assert settings.units.length == 2.0
    assert settings.study.title == "The network of blocks.png"
    assert {"# smoothing = 0.6", "# vessels = dark", "# threshold = otsu"} <= set(out.read_text().splitlines())
    domain = outlines_domain("mine.outlines.json", out.parent)
    assert domain.pillar_areas == pytest.approx(np.full(6, 360.0), rel=0.02)
    few = ["--set", "angiogenesis.steps=1", "--set", "output.figures=false"]
    done = call("run", out, "--out", tmp_path / "run", *few)
    assert done.exit_code == 0, done.output
    assert "pillars 6 to 6" in done.stdout


def test_walls_do_not_slip(tmp_path, grey):
    picture = grey.copy()
    picture[:4] = 220
    imwrite(tmp_path / "a.png", picture)
    written = study_of_picture(tmp_path / "a.png", DARK, tmp_path)
    assert read_study(written.study).angiogenesis.walls == "no-slip"
    assert dict(written.rows)["wall"] == "1"


def test_names(blocks, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert str(study_of_picture(blocks, DARK).study) == "blocks.toml"
    with pytest.raises(InputError, match=r"blocks\.toml exists already: name another file with --out, or give --repl"):
        study_of_picture(blocks, DARK)
    before = (tmp_path / "blocks.outlines.json").read_text()
    study_of_picture(blocks, ImageExtraction(vessels="dark", smoothing=3.0), replace=True)
    assert (tmp_path / "blocks.outlines.json").read_text() != before
    with pytest.raises(InputError, match=r"x\.json is no name of a study: it ends in \.toml, or is a folder"):
        study_of_picture(blocks, DARK, tmp_path / "x.json")


def test_without_matplotlib_there_is_no_overlay(blocks, tmp_path, monkeypatch):
    monkeypatch.delitem(sys.modules, "vasculo.draw.overlay", raising=False)
    monkeypatch.delitem(sys.modules, "vasculo.draw.canvas", raising=False)
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    written = study_of_picture(blocks, DARK, tmp_path / "out")
    assert written.overlay is None
    assert written.notes[-1].startswith("no overlay: pictures need matplotlib")
    assert read_study(written.study).kind == "outlines"


def test_bad_pictures(tmp_path, grey):
    one_line(call("image", tmp_path / "no.png"), "no.png: no such file")
    for name in ("text.png", "text.tif", "text.jpg", "text"):
        (tmp_path / name).write_text("no picture at all")
        one_line(call("image", tmp_path / name, "--out", tmp_path / "out"), f"{name} is no picture that can be read (")
    (tmp_path / "empty.png").write_bytes(b"")
    one_line(call("image", tmp_path / "empty.png", "--out", tmp_path / "out"), "empty.png is no picture")
    imwrite(tmp_path / "flat.png", np.full_like(grey, 7))
    one_line(call("image", tmp_path / "flat.png", "--out", tmp_path / "out"), "all 5400 pixels have the grey value 7")
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("words", "parts"),
    [
        (["--pixel-size", "0"], ["pixel size must be a number of micrometres above 0, got 0"]),
        (["--pixel-size", "nan"], ["pixel size must be a number of micrometres above 0"]),
        (["--smoothing", "1um"], ["'1um' is in micrometres: give the size of a pixel"]),
        (["--smallest", "big"], ["'big' is no length"]),
        (["--threshold", "300"], ["threshold 300 is outside the grey values of the picture, 20 to 220"]),
        (["--threshold", "best"], ["threshold must be a grey value or one of otsu, li, local, got 'best'"]),
        (["--crop", "1,2,3"], ["crop must be four whole numbers"]),
        (["--crop", "a,b"], ["crop 'a,b' must be four whole numbers"]),
        (["--crop", "0,0,100,10"], ["crop 100 x 10 at (0, 0) does not fit"]),
        (["--inlet", "top", "--outlet", "left"], ["outlet left is not opposite inlet top: it must be bottom"]),
        (["--page", "2"], ["blocks.png has no page 2: it has 1"]),
        (["--vessels", "bright"], ["no vessel leads from the inlet to the outlet"]),
        (["--smallest", "30px"], ["no pillars: all 6 islands are smaller than a disk of radius 30"]),
    ],
)
def test_bad_options(blocks, tmp_path, words, parts):
    one_line(call("image", blocks, "--vessels", "dark", "--out", tmp_path / "out", *words), *parts)
    assert not (tmp_path / "out").exists()


def test_without_scikit_image(blocks, monkeypatch):
    monkeypatch.setitem(sys.modules, "skimage.measure", None)
    one_line(call("image", blocks), "pictures are read with scikit-image: pip install 'vasculo[image]' brings it")
