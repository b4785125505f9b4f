"""The report of a run: one page that needs nothing else and no script, with every number of the run it talks about."""

import base64
import io
import re
import shutil
from html.parser import HTMLParser
from itertools import pairwise

import h5py
import pytest
from PIL import Image, ImageChops

import vasculo as vc
from vasculo.draw.canvas import png
from vasculo.draw.figures import pictures
from vasculo.draw.page import Markup, cards, folded, page, picture, table
from vasculo.draw.report import write_report
from vasculo.draw.report.asked import asked
from vasculo.draw.report.happened import figures
from vasculo.draw.report.media import moving, small
from vasculo.draw.report.numbers import numbers
from vasculo.draw.report.repeat import repeat
from vasculo.draw.report.sure import sure
from vasculo.draw.report.write import summary_of

VOID = {"meta", "img", "br", "wbr", "source"}
PARTS = ("asked", "happened", "numbers", "sure", "repeat")


class Checker(HTMLParser):
    """Collects what a page loads and says, and checks that tags close in order."""

    def __init__(self):
        super().__init__()
        self.open, self.tags, self.sources, self.links, self.names, self.words = [], [], [], [], [], []

    def handle_starttag(self, tag, attrs):
        found = dict(attrs)
        self.tags.append((tag, found))
        if tag not in VOID:
            self.open.append(tag)
        self.sources += [found[name] for name in ("src", "srcset", "data", "poster") if name in found]
        self.links += [found["href"]] if "href" in found else []
        self.names += [found["id"]] if "id" in found else []

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        if self.open and self.open[-1] != "style":
            self.words.append(data)

    @property
    def text(self):
        return re.sub(r"\s+", " ", " ".join(self.words))

    def part(self, name):
        """Words of one part of the page."""
        number = PARTS.index(name) + 1
        return self.text.partition(f"{number} · ")[2].partition(f"{number + 1} · ")[0]


def read(path):
    checker = Checker()
    content = path.read_text(encoding="utf-8")
    checker.feed(content)
    assert checker.open == []
    return content, checker


@pytest.fixture(scope="module")
def tissue_page(tissue_report):
    return read(tissue_report)


@pytest.fixture(scope="module")
def disk_page(disk_run, disk_report):
    assert disk_report == disk_run.folder / "report.html"
    return read(disk_report)


@pytest.mark.parametrize("name", ["tissue_page", "disk_page"])
def test_the_page_needs_nothing_but_itself(name, request):
    content, checker = request.getfixturevalue(name)
    assert not {tag for tag, _ in checker.tags} & {"script", "link", "iframe", "object", "embed"}
    assert not [key for _, found in checker.tags for key in found if key.startswith("on")]
    assert all(source.startswith(("data:image/", "data:video/mp4;base64,")) for source in checker.sources)
    assert all(link.startswith("#") and link[1:] in checker.names for link in checker.links)
    plain = re.sub(r'(src|poster)="data:[^"]*"', "", content)
    assert not re.search(r"(https?:)?//[a-z]", plain)
    assert "@import" not in plain
    assert "url(" not in plain
    assert 'name="viewport"' in content
    assert len(content) < 3e6


@pytest.mark.parametrize("name", ["tissue_page", "disk_page"])
def test_it_can_be_read_without_eyes(name, request):
    _, checker = request.getfixturevalue(name)
    images = [found for tag, found in checker.tags if tag == "img"]
    assert images
    assert all(found["alt"].strip(" .") for found in images)
    assert all("scope" in found for tag, found in checker.tags if tag == "th")
    levels = [int(tag[1]) for tag, _ in checker.tags if re.fullmatch(r"h[1-6]", tag)]
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert all(after - before <= 1 for before, after in pairwise(levels))
    assert [name for name in checker.names if name in PARTS] == list(PARTS)


def test_the_film_plays_without_a_script_and_prints_as_a_picture(disk_page):
    _, checker = disk_page
    (video,) = [found for tag, found in checker.tags if tag == "video"]
    assert {"controls", "muted", "loop", "playsinline"} <= video.keys()
    (source,) = [found for tag, found in checker.tags if tag == "source"]
    film = base64.b64decode(source["src"].partition(",")[2])
    assert film[4:8] == b"ftyp"
    (still,) = [found for tag, found in checker.tags if found.get("class") == "still"]
    assert still["src"] == video["poster"]


def test_without_ffmpeg_the_page_says_so(disk_run, monkeypatch):
    def film(*_args, **_options):
        raise vc.InputError("films need imageio-ffmpeg")

    monkeypatch.setattr("vasculo.draw.report.media.film", film)
    found = moving(disk_run, "flow", "The film", "what is seen")
    assert "No film: films need imageio-ffmpeg" in found
    assert "<video" not in found


def test_every_figure_is_there(tissue_page, tissue_run):
    _, checker = tissue_page
    for entry in pictures(tissue_run):
        if not entry.name.startswith("curves"):
            assert entry.title in checker.part("happened")
    for column in ("permeability", "aspect_ratio"):
        assert column.replace("_", " ") in checker.part("happened")


def test_only_settings_that_differ_are_listed(disk_page, disk_run):
    _, checker = disk_page
    asked = checker.part("asked").partition("All settings")[0]
    for key, value in (("domain. width", "6"), ("domain. height", "4"), ("angiogenesis. steps", "2")):
        assert re.search(rf"{key} .* {value} ", asked)
    assert "40" in asked  # the default of angiogenesis.steps
    assert "angiogenesis. viscosity" not in asked
    assert "output. figures" in asked
    defaults = disk_run.facts("defaults")
    differ = [
        (section, key)
        for section, keys in disk_run.settings.items()
        for key, value in keys.items()
        if value != defaults.get(f"{section}.{key}") and (section, key) != ("study", "title")
    ]
    assert f"{len(differ)} settings of" in asked
    for section, key in differ:
        assert f"{section}. {key}" in asked


def test_the_numbers_have_units_and_definitions(tissue_page, tissue_run):
    _, checker = tissue_page
    text, run = checker.part("numbers"), tissue_run
    row = run.frame("angiogenesis").index
    gap, shear = run.metrics["mean_gap"][row], run.metrics["mean_wall_shear"][row]
    assert f"{gap * 1000.0:#.3g} {gap:#.3g}" in text  # micrometres, and model lengths below
    assert f"{shear * 500.0:#.3g}" in text
    assert "mean gap µm (small: model length) mean distance from a pillar to its nearest neighbour" in text
    facts = {entry["name"]: entry["value"] for entry in run.facts("plexus")}
    assert f"{facts['voids']} voids on {facts['void_fraction']:.0%} of the tissue" in text
    for entry in (*run.facts("plexus"), *run.facts("extraction")):
        assert entry["name"].replace("_", " ") in text


def test_the_summary_is_made_from_the_numbers(tissue_page, tissue_run):
    _, checker = tissue_page
    head = checker.text.partition("1 · ")[0]
    springs = tissue_run.metrics["springs"]
    assert "A tissue of 900 nodes" in head
    assert f"of its {int(springs[0]):,} springs" in head
    assert f"{len(tissue_run.pillars(0).outlines)} → {len(tissue_run.pillars().outlines)}" in head


def test_it_says_how_to_repeat(tissue_page, tissue_run):
    _, checker = tissue_page
    text = checker.part("repeat")
    assert "vasculo run tissue/study.toml" in text
    assert "vasculo run --branch tissue --step" in text
    assert re.sub(r"\s+", " ", tissue_run.settings_text).strip() in text
    for stage in tissue_run.facts("stages"):
        assert stage["name"] in text
        assert stage["result"] in text
    assert f"numpy {tissue_run.facts('machine')['numpy']}" in text
    assert "A Computational Model of Micro-vascular Growth" in text


def test_figures_in_the_folder_are_used(disk_run, monkeypatch):
    first, *_, last = (entry for entry in pictures(disk_run) if not entry.name.startswith("curves"))
    monkeypatch.setattr("vasculo.draw.report.happened.pictures", lambda _run: [first])
    mine, folder = png(last.draw(disk_run)), disk_run.folder / "figures"
    folder.mkdir(exist_ok=True)
    (folder / f"{first.name}.png").write_bytes(mine)
    shown = base64.b64encode(small(mine)[0]).decode()
    assert shown in "".join(figures(disk_run))
    (folder / f"{first.name}.png").unlink()
    assert shown not in "".join(figures(disk_run))


def test_a_picture_gets_smaller_and_stays_the_picture(disk_run):
    content = png(pictures(disk_run)[0].draw(disk_run))
    found, kind, ratio = small(content)
    assert kind == "webp"
    assert len(found) < 0.5 * len(content)
    one, two = (Image.open(io.BytesIO(data)).convert("L") for data in (content, found))
    assert one.size == two.size
    assert ratio == one.width / one.height
    histogram = ImageChops.difference(one, two).histogram()
    assert sum(k * n for k, n in enumerate(histogram)) / sum(histogram) < 2.0  # grey levels, of 255


def words(*parts):
    return re.sub(r"\s+", " ", re.sub(r"<[^>]*>", " ", " ".join(parts)))


def test_a_run_without_end_says_so(disk_run, monkeypatch):
    monkeypatch.setattr(disk_run, "complete", False)
    assert "did not come to its end" in words(summary_of(disk_run))
    assert "vasculo run --resume --out disk" in words(repeat(disk_run))
    assert "stopped after 3 recorded steps" in words(sure(disk_run))


def test_a_run_that_stopped_before_the_remodelling(tissue_run, monkeypatch, tmp_path):
    monkeypatch.setattr(tissue_run, "frames", tissue_run.frames[:2])
    monkeypatch.setattr(tissue_run, "complete", False)
    monkeypatch.setattr(tissue_run, "metrics", {name: found[:2] for name, found in tissue_run.metrics.items()})
    monkeypatch.setattr("vasculo.draw.report.happened.pictures", lambda _run: [])
    _, checker = read(write_report(tissue_run, tmp_path / "page.html"))
    assert "tissue at rest" in checker.part("sure")
    assert "mass balance" not in checker.part("sure")
    assert "pillars became" not in checker.text


def test_records_of_earlier_versions_leave_parts_out_and_say_so(disk_run, tmp_path):
    folder = shutil.copytree(disk_run.folder, tmp_path / "old")
    (folder / "metrics.csv").unlink()
    with h5py.File(folder / "run.vtkhdf", "r+") as file:
        for name in ("defaults", "machine", "stages", "meanings", "states", "metrics/corridors", "metrics/shear_ratio"):
            del file[f"run/{name}"]
    run = vc.open_run(folder)
    assert "does not hold the defaults of its version, so all settings are listed" in words(asked(run))
    missing = re.search(r"Without a value in this run: ([a-z_, ]*)\.", words(numbers(run)))
    assert {"corridors", "shear_ratio"} <= set(missing[1].split(", "))
    assert "flow through the whole plexus" not in words(sure(run))
    assert "does not say on what machine" in words(repeat(run))
    assert "No stage has come to its end." in words(repeat(run))


def test_text_is_escaped():
    parts = [table(("<x1>",), [("<x2>",)]), cards([("<x3>", "&")]), picture(b"x", '"q"', "<x4>"), folded("<x5>", "")]
    joined = page("<x6>", parts)
    for raw in ("<x1>", "<x2>", "<x3>", "<x4>", "<x5>", "<x6>"):
        assert raw.replace("<", "&lt;").replace(">", "&gt;") in joined
        assert raw not in joined
    assert "&quot;q&quot;" in joined
    assert "<b>kept</b>" in table(("a",), [(Markup("<b>kept</b>"),)])
