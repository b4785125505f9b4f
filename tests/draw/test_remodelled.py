"""Pictures of the remodelling: frames on one scale, chains and their colours, shares of the shear, mergers."""

from itertools import pairwise

import numpy as np
import pytest
from matplotlib.colors import to_hex

from vasculo.draw.canvas import new_figure
from vasculo.draw.chains import chain_classes, draw_lineage
from vasculo.draw.curves import draw_curves
from vasculo.draw.figures import pictures
from vasculo.draw.frames import columns_of, draw_frames
from vasculo.draw.pillars import pen
from vasculo.draw.rose import draw_mergers
from vasculo.draw.scale import flow_arrow, length_unit, nice_length, scale_bar
from vasculo.draw.shares import draw_shares, membrane
from vasculo.draw.single import picture
from vasculo.draw.views import paint, view_of
from vasculo.geometry.outline import perimeter
from vasculo.pillars.events import Event
from vasculo.store.read import Pillars


def merger(step, angle):
    return Event(step, 0.1 * step, "merge", (1.0, 2.0), ((0,), (1,)), angle)


def square(side, x=0.0):
    return np.array([[x, 0.0], [x + side, 0.0], [x + side, side], [x, side]])


class Chained:
    """A run of two recorded steps: five squares, of which three and two become chains."""

    def __init__(self, run):
        self.run, self.settings, self.units, self.domain = run, run.settings, run.units, run.domain
        self.events = tuple(merger(1, angle) for angle in (3.0, 0.0, 90.0))

    def steps(self):
        return [0, 1]

    def mesh(self, _step):
        return self.run.mesh(0)

    def pillars(self, step=None):
        rows = ([square(0.5, x) for x in range(5)], tuple((k,) for k in range(5)))
        if step == 1:
            rows = ([square(2.0), square(2.0, 3.0)], ((0, 1, 4), (2, 3)))
        nothing = [np.zeros(4) for _ in rows[0]]
        return Pillars(rows[0], rows[1], nothing, nothing, self.events if step == 1 else ())


def test_frames_have_one_scale_and_what_they_need_below(tissue_run):
    figure = draw_frames(tissue_run)
    shown = [axes for axes in figure.axes if axes.get_title(loc="left").startswith("step")]
    assert [axes.get_title(loc="left").split(" ")[1] for axes in shown] == ["0", "1"]
    tops = {axes.collections[0].norm.vmax for axes in shown}
    assert len(tops) == 1
    (below,) = [axes for axes in figure.axes if axes.texts]
    assert below.texts[0].get_text().endswith("µm")
    assert below.texts[-1].get_text() == "flow"
    (bar,) = below.child_axes
    assert bar.get_title(loc="left") == "speed over its mean at step 0"


@pytest.mark.parametrize(("ratio", "columns"), [(1.0, 3), (1.5, 2), (5.0, 1)])
def test_columns_follow_the_shape_of_the_domain_and_the_width(ratio, columns):
    box = (0.0, 0.0, ratio, 1.0)
    assert columns_of(box, 6, 7.0) == columns
    assert columns_of(box, 6, 3.3) == min(columns, 2)
    assert columns_of(box, 1, 7.0) == columns_of(box, 6, 1.0) == 1


def test_the_scale_bar_has_the_length_it_says():
    assert nice_length(7.3) == 5.0
    assert nice_length(20.0) == 20.0
    axes = new_figure(3, 2).subplots()
    scale_bar(axes, (0.0, 0.0, 60.0, 40.0), (1.5, "R"))
    ends = axes.lines[0].get_xdata()
    assert axes.texts[0].get_text() == "5 R"
    assert ends[1] - ends[0] == pytest.approx(5 * 1.5)


def test_the_unit_of_lengths(disk_run, tissue_run):
    assert tissue_run.settings["units"]["length"] == 1000.0
    assert length_unit(tissue_run) == (pytest.approx(1e-3), "µm")
    radius, name = length_unit(disk_run)
    assert name == "R₀"
    assert radius == pytest.approx(1.0, rel=0.01)


@pytest.mark.parametrize(("inlet", "way"), [("left", (1, 0)), ("right", (-1, 0)), ("bottom", (0, 1)), ("top", (0, -1))])
def test_the_arrow_shows_the_way_in(disk_run, monkeypatch, inlet, way):
    monkeypatch.setitem(disk_run.settings["angiogenesis"], "inlet", inlet)
    axes = new_figure(3, 2).subplots()
    flow_arrow(axes, disk_run, (0.5, 0.5))
    tail = np.array(axes.texts[0].xyann)
    assert np.sign(-tail).astype(int).tolist() == list(way)


@pytest.mark.parametrize("largest", [1, 2, 4, 5, 700])
def test_every_chain_has_a_class(largest):
    classes = chain_classes(largest)
    assert classes[0][:2] == (1, "1")
    last = classes[-1][1].split(" to ")
    assert int(last[-1]) == largest
    for (_, name, _), (begins, _, _) in pairwise(classes):
        assert int(name.split(" to ")[-1]) + 1 == begins


def test_corridors_are_drawn_for_any_step(tissue_run):
    assert picture(tissue_run, "chains").axes[0].get_title(loc="left").startswith("step 1")
    axes = new_figure(3, 3).subplots()
    paint(tissue_run, view_of(tissue_run, "chains"), axes, 0)
    assert f"{len(tissue_run.pillars(0).outlines)} pillars" in axes.get_title(loc="left")


def test_pillars_have_the_colour_of_their_chain(disk_run):
    figure = draw_lineage(Chained(disk_run))
    first, last = (axes.collections[0].get_facecolor() for axes in figure.axes[:2])
    first, last = [to_hex(c) for c in first], [to_hex(c) for c in last]
    assert first == [last[0], last[0], last[1], last[1], last[0]]
    assert last[0] != last[1]
    assert [text.get_text() for text in figure.axes[2].get_legend().get_texts()] == ["A: 3", "B: 2", "single"]
    letters = [[text.get_text() for text in axes.texts] for axes in figure.axes[:2]]
    assert letters == [["A", "A", "B", "B", "A"], ["A", "B"]]


def test_the_rose_counts_every_merger_on_both_sides(disk_run):
    figure = draw_mergers(Chained(disk_run))
    rose, over = figure.axes
    heights = np.array([bar.get_height() for bar in rose.patches])
    assert heights.sum() == 2 * 3
    assert heights[0] == heights[12] == 2
    assert heights[6] == heights[18] == 1
    assert [bar.get_height() for bar in over.patches] == [0, 3]


def test_shares_add_up_to_the_whole_membrane(tissue_run):
    pillars = tissue_run.pillars()
    length, shear, activation = membrane(pillars)
    assert length.sum() == pytest.approx(sum(perimeter(outline) for outline in pillars.outlines))
    assert shear @ length / length.sum() == pytest.approx(1.0)
    assert len(activation) == len(length)
    for axes in draw_shares(tissue_run).axes:
        for stairs in axes.patches:
            assert stairs.get_data().values.sum() == pytest.approx(100.0)


def test_outlines_get_thinner_with_their_number():
    assert pen(1) == pen(100) == 1.0
    assert 0.25 <= pen(1000) < pen(300) < 1.0


def test_numbers_that_a_run_has_not_are_left_out_of_the_curves(disk_run, monkeypatch):
    whole = len([axes for axes in draw_curves(disk_run, "angiogenesis").axes if axes.get_visible()])
    for name in ("local_angle", "permeability"):
        assert np.isfinite(disk_run.metrics[name]).any()
        monkeypatch.delitem(disk_run.metrics, name)
    left = draw_curves(disk_run, "angiogenesis")
    assert len([axes for axes in left.axes if axes.get_visible()]) == whole - 2


def test_what_stays_the_same_is_left_out_of_the_curves(disk_run, tissue_run):
    titles = [
        [axes.get_title(loc="left") for axes in draw_curves(run, "angiogenesis").axes] for run in (disk_run, tissue_run)
    ]
    assert "fastest to slowest shear" not in titles[0]
    assert {"fastest to slowest shear", "distances, µm", "angle to the local flow, degrees"} <= set(titles[1])


def test_mergers_bring_their_pictures(tissue_run, monkeypatch):
    names = {picture.name for picture in pictures(tissue_run)}
    monkeypatch.setitem(tissue_run.__dict__, "events", (merger(1, 10.0),))
    assert {picture.name for picture in pictures(tissue_run)} - names == {"lineage", "mergers"}
