"""Runs side by side: what differs, the same scale and the same time; and pages at three widths, in a browser."""

import re
import shutil
import subprocess

import numpy as np
import pytest
from tests.draw.test_report import read
from typer.testing import CliRunner

import vasculo as vc
from vasculo.cli import app
from vasculo.draw.canvas import new_figure
from vasculo.draw.page import TIMES
from vasculo.draw.report import write_side_by_side
from vasculo.draw.report.comparison import compare
from vasculo.draw.report.flows import Shown, draw_flows

CHROMIUM = shutil.which("chromium") or shutil.which("google-chrome")


@pytest.fixture(scope="module")
def other_run(tmp_path_factory):
    """The same disk in three smaller steps."""
    settings = {
        "domain.width": 6.0,
        "domain.height": 4.0,
        "angiogenesis.steps": 3,
        "angiogenesis.activation": 0.04,
        "output.figures": False,
    }
    return vc.run("disk", tmp_path_factory.mktemp("runs") / "other", settings)


@pytest.fixture(scope="module")
def both_path(disk_run, other_run, tmp_path_factory):
    return write_side_by_side([disk_run, other_run], tmp_path_factory.mktemp("page") / "both.html")


def test_the_settings_that_differ_and_the_numbers_of_both(both_path, disk_run, other_run):
    content, checker = read(both_path)
    asked = checker.part("asked")
    assert re.search(r"angiogenesis. activation .* 0.08 0.04", asked)
    assert re.search(r"angiogenesis. steps .* 2 3", asked)
    assert "domain. width" not in asked
    found = compare([disk_run, other_run])
    one, two = (run.metrics["aspect_ratio"][found.row(run)] for run in (disk_run, other_run))
    assert f"{one:#.3g} {two:#.3g} {TIMES} {two / one:.2f}" in checker.part("numbers")
    assert "<script" not in content
    assert all(source.startswith("data:image/") for source in checker.sources)
    assert all(found["alt"] for tag, found in checker.tags if tag == "img")
    plots = [found["alt"] for tag, found in checker.tags if "svg" in found.get("src", "")]
    assert any(re.match(r"aspect ratio over the time: from \S+ to \S+; from \S+ to \S+", alt) for alt in plots)


def test_runs_are_compared_at_the_time_that_all_have_reached(disk_run, other_run):
    found = compare([disk_run, other_run])
    ends = [run.metrics["time"][-1] for run in (disk_run, other_run)]
    assert found.across == "time"
    assert found.until == min(ends)
    for run in found.runs:
        off = np.abs(run.metrics["time"] - found.until)
        assert off[found.row(run)] == off.min()
    assert [found.step(run, 0.0) for run in found.runs] == [0, 0]


def test_pictures_share_scale_and_colours(disk_run, other_run):
    figure = draw_flows([[Shown(disk_run, 2, "one"), Shown(other_run, 3, "two")]])
    one, two = (axes for axes in figure.axes if axes.get_title(loc="left") in {"one", "two"})
    assert one.get_xlim() == two.get_xlim()
    assert one.get_ylim() == two.get_ylim()
    assert one.collections[0].norm.vmax == two.collections[0].norm.vmax
    assert one.collections[0].norm.gamma == two.collections[0].norm.gamma


def test_a_tissue_that_is_the_same_is_not_drawn_twice(tissue_run, tmp_path, monkeypatch):
    folder = shutil.copytree(tissue_run.folder, tmp_path / "twin", ignore=shutil.ignore_patterns("*.html"))
    monkeypatch.setattr("vasculo.draw.report.beside.draw_flows", lambda _rows: new_figure(1.0, 1.0))
    _, checker = read(write_side_by_side([tissue_run, vc.open_run(folder)], tmp_path / "page.html"))
    assert "No setting that changes a number differs." in checker.text
    assert "The vasculogenesis is the same in all runs" in checker.part("happened")
    assert "The plexuses" not in checker.part("happened")


def test_what_cannot_stand_side_by_side(disk_run, other_run, tissue_run, monkeypatch):
    with pytest.raises(vc.InputError, match="named twice"):
        compare([disk_run, disk_run])
    with pytest.raises(vc.InputError, match="5 runs do not go side by side on a page: name 2 to 4"):
        compare([disk_run, other_run, disk_run, other_run, disk_run])
    keep = tuple(frame for frame in tissue_run.frames if frame.stage == "vasculogenesis")
    monkeypatch.setattr(tissue_run, "frames", keep)
    with pytest.raises(vc.InputError, match=r"no stage in common: .*vasculogenesis.*angiogenesis") as error:
        compare([tissue_run, disk_run])
    assert "\n" not in str(error.value)


def test_the_command(disk_run, other_run, tmp_path, monkeypatch):
    called = []
    monkeypatch.setattr("vasculo.draw.report.write_side_by_side", lambda runs, out: called.append((len(runs), out)))
    target = tmp_path / "page.html"
    result = CliRunner().invoke(app, ["report", str(disk_run.folder), str(other_run.folder), "--out", str(target)])
    assert result.exit_code == 0
    assert called == [(2, target)]
    wrong = CliRunner().invoke(app, ["report", str(disk_run.folder), "--out", str(tmp_path / "none" / "page.html")])
    assert wrong.exit_code == 2
    assert "there is no folder" in wrong.stderr


@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine")
def test_pages_fit_phone_tablet_and_desktop(both_path, tissue_report, tmp_path):
    tell = (
        "<script>addEventListener('load', () => parent.postMessage("
        "[innerWidth, document.documentElement.clientWidth, document.documentElement.scrollWidth].join('/'), '*'))"
        "</script></body>"
    )
    frames = []
    for number, path in enumerate((both_path, tissue_report)):
        copy = tmp_path / f"copy{number}.html"
        copy.write_text(path.read_text().replace("</body>", tell))
        frames += [f'<iframe width="{width}" height="900" src="{copy.name}"></iframe>' for width in (360, 800, 1280)]
    # Chromium makes no window narrower than 500 pixels, but frames.
    whole = tmp_path / "frames.html"
    listen = (
        "<script>addEventListener('message', event => { document.body.append('told ' + event.data + '; ') })</script>"
    )
    whole.write_text(f"<!doctype html>{listen}<style>iframe {{ border: 0 }}</style><body>{''.join(frames)}</body>")
    words = [CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--virtual-time-budget=20000", "--dump-dom"]
    found = subprocess.run([*words, whole.as_uri()], capture_output=True, text=True, timeout=120, check=True).stdout
    told = sorted(tuple(map(int, three)) for three in re.findall(r"told (\d+)/(\d+)/(\d+)", found))
    assert [width for width, _, _ in told] == [360, 360, 800, 800, 1280, 1280]
    assert all(needed <= inside for _, inside, needed in told)
