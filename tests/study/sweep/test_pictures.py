"""The page of a sweep: what it shows, and where its links lead."""

import copy
import re
from dataclasses import replace
from html.parser import HTMLParser

import pytest

from vasculo.study.sweep.pictures import illustrate
from vasculo.study.sweep.sweep import _begin as begin
from vasculo.study.sweep.work import Outcome


class Page(HTMLParser):
    """Links, pictures and open elements of a page."""

    def __init__(self, text):
        super().__init__()
        self.links, self.images, self.open, self.seen = [], [], [], set()
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.seen.add(tag)
        values = dict(attrs)
        self.links += [values["href"]] if tag == "a" else []
        self.images += [values] if tag == "img" else []
        if tag not in {"meta", "img", "br"}:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag


@pytest.fixture
def sweep(done_here):
    """The sweep that was done, to be changed at will."""
    found = copy.copy(done_here)
    found.outcomes = dict(done_here.outcomes)
    return found


def test_the_page_links_every_run_and_needs_nothing_else(sweep):
    text = illustrate(sweep).read_text()
    page = Page(text)
    assert page.open == []
    assert "script" not in page.seen
    assert [link for link in page.links if link.startswith("runs/")] == [f"runs/000{n}/" for n in (1, 2, 3, 4)]
    assert all((sweep.folder / link).is_dir() for link in page.links if not link.startswith("#"))
    assert len(page.images) == 2
    assert all(image["alt"] and image["src"].startswith("data:image/") for image in page.images)
    assert not re.search(r"""(src|href)=["']https?:""", text)
    assert "4 of 4" in text
    assert "height" in text
    assert "failed" not in text


def test_failures_and_what_is_missing_are_told(sweep):
    sweep.outcomes["0002"] = Outcome("0002", "failed", "the flow <did> not converge")
    del sweep.outcomes["0004"]
    text = illustrate(sweep).read_text()
    assert Page(text).open == []
    assert "1 of 4 runs are not done yet; 1 of 4 runs failed, see below." in text
    assert "the flow &lt;did&gt; not converge" in text
    assert f"vasculo sweep --resume --out {sweep.folder}" in text


def test_a_sweep_without_a_complete_run_has_a_page(sweep):
    sweep.outcomes = {"0001": Outcome("0001", "failed", "no")}
    text = illustrate(sweep).read_text()
    assert "0 of 4" in text
    assert "<img" not in text


def test_numbers_are_told_in_the_units_of_the_study(sweep):
    numbers = [number for number in sweep.numbers if number.name == "permeability"]
    sweep.shown = numbers
    text = illustrate(sweep).read_text()
    assert "permeability, µm²" in text
    value = 900.0 * sweep.table["permeability"][0]
    assert f"{value:.4g}" in text


def test_a_third_setting_has_a_picture_a_number(heights, tmp_path):
    heights["vary"] = {"domain.height": [4.0, 5.0], "domain.radius": [0.5, 1.0], "angiogenesis.activation": [0.1, 0.15]}
    heights["sweep"]["seeds"] = 1
    found = begin(heights, tmp_path / "sweep")
    for number, run in enumerate(found.plan.runs):
        found.outcomes[run.name] = Outcome(run.name, "complete", "", 1.0, dict.fromkeys(found.names, float(number)))
    found.shown = found.shown[:2]
    found.file = replace(found.file, diagram=replace(found.file.diagram, gallery=False))
    illustrate(found)
    assert {path.name for path in found.folder.glob("diagram*")} == {f"diagram-{each.name}.png" for each in found.shown}
