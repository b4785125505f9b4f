"""The report: one page that needs nothing else, with every number of the run it talks about."""

import base64
import re
from html.parser import HTMLParser

from vasculo.draw.canvas import png
from vasculo.draw.figures import pictures
from vasculo.draw.page import cards, folded, page, picture, table
from vasculo.draw.report import write_report
from vasculo.store.table import COLUMNS

VOID = {"meta", "img", "br"}


class Checker(HTMLParser):
    """Collects links and images, and checks that tags close in order."""

    def __init__(self):
        super().__init__()
        self.open, self.sources, self.text = [], [], []

    def handle_starttag(self, tag, attrs):
        if tag not in VOID:
            self.open.append(tag)
        self.sources += [value for name, value in attrs if name in {"src", "href", "srcset", "data"}]

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text.append(data)


def read(path):
    checker = Checker()
    content = path.read_text(encoding="utf-8")
    checker.feed(content)
    assert checker.open == []
    return content, checker


def test_one_self_contained_page(tissue_run):
    content, checker = read(write_report(tissue_run))
    assert len(checker.sources) == len(pictures(tissue_run))
    for source in checker.sources:
        assert source.startswith("data:image/png;base64,")
        assert base64.b64decode(source.partition(",")[2]).startswith(b"\x89PNG")
    words = re.sub(r'src="data:[^"]*"', "", content)
    assert not re.search(r"(https?:)?//[a-z]", words)
    assert "@import" not in words
    assert "url(" not in words
    assert 'name="viewport"' in content


def test_it_describes_the_plexus(tissue_run):
    _, checker = read(write_report(tissue_run))
    text = " ".join(checker.text)
    facts = {entry["name"]: entry["value"] for entry in tissue_run.facts("plexus")}
    assert f"{facts['voids']} voids on {facts['void_fraction']:.0%} of the tissue" in text
    assert f"{facts['cords']} cords {facts['cord_length']:.1f} long and {facts['cord_width']:.1f} wide" in text
    assert all(name in text for name in facts)


def test_it_holds_the_numbers(tissue_run):
    _, checker = read(write_report(tissue_run))
    text = " ".join(checker.text)
    run = tissue_run
    assert f"{len(run.network().springs):,}" in text
    assert f"{len(run.pillars(0).outlines)} → {len(run.pillars().outlines)}" in text
    for stage in run.facts("stages"):
        assert stage["name"] in text
        assert stage["result"] in text
    for name in COLUMNS:
        assert name in text
    for section in run.settings:
        assert section in text
    for fact in ("fluid_fraction", "dangling_springs", "tubule_width_l0"):
        assert fact in text
    assert "A Computational Model of Micro-vascular Growth" in text
    assert "µm" in text
    assert "dyn/cm²" in text
    assert "peak memory" in text
    assert "did not come to its end" not in text


def test_figures_in_the_folder_are_used_as_they_are(disk_run):
    figure = pictures(disk_run)[0]
    folder = disk_run.folder / "figures"
    folder.mkdir(exist_ok=True)
    mine = png(figure.draw(disk_run)) + b"mine"
    (folder / f"{figure.name}.png").write_bytes(mine)
    content, _ = read(write_report(disk_run))
    assert base64.b64encode(mine).decode() in content
    (folder / f"{figure.name}.png").unlink()
    content, _ = read(write_report(disk_run))
    assert base64.b64encode(mine).decode() not in content


def test_a_run_without_end_says_so(disk_run, monkeypatch):
    monkeypatch.setattr(disk_run, "complete", False)
    _, checker = read(write_report(disk_run))
    assert "did not come to its end" in " ".join(checker.text)


def test_text_is_escaped():
    parts = [table(("<x1>",), [("<x2>",)]), cards([("<x3>", "&")]), picture(b"x", '"q"', "<x4>"), folded("<x5>", "")]
    joined = page("<x6>", parts)
    for raw in ("<x1>", "<x2>", "<x3>", "<x4>", "<x5>", "<x6>"):
        assert raw.replace("<", "&lt;").replace(">", "&gt;") in joined
        assert raw not in joined
    assert "&quot;q&quot;" in joined
