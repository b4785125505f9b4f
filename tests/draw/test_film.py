"""Films: the right pictures in the right number, one size, plays everywhere, told how far it is."""

import re
import subprocess

import numpy as np
import pytest

from vasculo.draw import film as module
from vasculo.draw.film import WHAT_FILMS, draw_film, film, schedule
from vasculo.errors import InputError


def frames(path):
    """Frames of a film, (n, h, w, 3) uint8, and what ffmpeg says of it."""
    from imageio_ffmpeg import get_ffmpeg_exe

    told = subprocess.run([get_ffmpeg_exe(), "-i", path], capture_output=True, text=True, check=False).stderr
    wide, high = (int(side) for side in re.search(r", (\d+)x(\d+)", told).groups())
    plain = [get_ffmpeg_exe(), "-v", "error", "-i", path, "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    data = subprocess.run(plain, capture_output=True, check=True).stdout
    return np.frombuffer(data, dtype=np.uint8).reshape(-1, high, wide, 3), told


@pytest.mark.parametrize("counts", [[41], [45, 41], [3], [1], [500, 200]])
@pytest.mark.parametrize("seconds", [2.0, 6.0, 10.0])
def test_a_film_is_as_long_as_it_should_be(counts, seconds):
    shown, pace = schedule(counts, seconds)
    assert 4.0 <= pace <= 12.0
    assert len(shown) / pace == pytest.approx(seconds, rel=0.12)
    assert shown[0] == (0, 0)
    assert shown[-1] == (len(counts) - 1, counts[-1] - 1)
    assert shown == sorted(shown)


def test_few_steps_are_all_shown_and_the_ends_are_held():
    shown, pace = schedule([5], 10.0)
    assert sorted(set(shown)) == [(0, k) for k in range(5)]
    assert shown.count((0, 4)) > shown.count((0, 2)) >= 1
    assert shown.count((0, 0)) / pace > 1.0
    shown, pace = schedule([30], 10.0, rate=15.0)
    assert pace == 15.0
    assert {shown.count((0, k)) for k in range(1, 29)} == {1}


def test_many_steps_are_thinned_evenly():
    shown, pace = schedule([2000], 6.0)
    steps = np.unique([step for _, step in shown])
    assert pace == 12.0
    assert len(steps) < 90
    assert np.ptp(np.diff(steps)) <= 1


def test_the_film_plays_everywhere(tissue_run):
    told = []
    path = draw_film(tissue_run, width=201, seconds=2.0, tell=lambda *words: told.append(words))
    assert path == tissue_run.folder / "figures" / "story.mp4"
    shown, told_of_it = frames(path)
    assert "Video: h264" in told_of_it
    assert "yuv420p" in told_of_it
    assert shown.shape[2] in {200, 202}
    assert shown.shape[1] % 2 == 0
    stages = [len(tissue_run.steps(stage)) for stage in ("vasculogenesis", "angiogenesis")]
    expected, pace = schedule(stages, 2.0)
    assert len(shown) == len(expected)
    assert float(re.search(r"([\d.]+) fps", told_of_it)[1]) == pytest.approx(pace, rel=0.01)
    assert len(told) == len(set(expected))
    assert told[0][2] == "vasculogenesis step 0"
    assert told[-1][2] == "angiogenesis step 1"
    # it moves, ends with the flow (dark), and the last picture is held
    assert np.abs(shown[0].astype(int) - shown[len(shown) // 2]).mean() > 2.0
    assert shown[-1].mean() < shown[0].mean() - 20.0
    assert np.abs(shown[-1].astype(int) - shown[-2]).mean() < 1.0


def test_what_stands_still_does_not_flicker(disk_run, monkeypatch):
    made = []
    monkeypatch.setattr("imageio_ffmpeg.write_frames", lambda *_, **__: _Sink(made))
    with pytest.raises(FileNotFoundError):
        film(disk_run, "flow", 320, 2.0)
    made = [np.asarray(picture) for picture in made if picture is not None]
    strip = {picture[-40:].tobytes() for picture in made}
    assert len(strip) == 1
    assert len({picture.tobytes() for picture in made}) == len(disk_run.steps())


class _Sink:
    def __init__(self, made):
        self.send, self.close = made.append, lambda: None


def test_one_scale_for_all_steps(disk_run, monkeypatch):
    views = []
    monkeypatch.setattr(
        module, "paint", lambda *words, keep=module.paint, **more: (views.append(words[1]), keep(*words, **more))[1]
    )
    film(disk_run, "shear", 200, 1.0)
    assert len(views) == len(disk_run.steps())
    assert len({(view.top, view.box) for view in views}) == 1


@pytest.mark.parametrize("what", WHAT_FILMS[1:])
def test_every_kind_can_be_filmed(tissue_run, what):
    assert film(tissue_run, what, 160, 1.0)[4:8] == b"ftyp"


def test_an_animated_gif(disk_run):
    path = draw_film(disk_run, "flow", width=200, seconds=1.0, kind="gif")
    data = path.read_bytes()
    assert path.name == "flow.gif"
    assert data.startswith(b"GIF89a")
    assert b"NETSCAPE2.0" in data  # it repeats
    assert len(data) < 200_000


def test_what_cannot_be_filmed_is_said(disk_run, monkeypatch):
    with pytest.raises(InputError, match="width = 100 of a film is not from 160 to 3840"):
        film(disk_run, "flow", 100)
    with pytest.raises(InputError, match=r"seconds = 0\.2 of a film is not from 1 to 120"):
        film(disk_run, "flow", seconds=0.2)
    with pytest.raises(InputError, match="no recorded step of vasculogenesis"):
        film(disk_run, "springs")
    monkeypatch.setitem(__import__("sys").modules, "imageio_ffmpeg", None)
    with pytest.raises(InputError, match=r"films need imageio-ffmpeg: pip install 'vasculo\[draw\]'"):
        film(disk_run, "flow")
