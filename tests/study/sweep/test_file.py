"""The sweep file: how points come about, and what is said about one that cannot be used."""

import math

import pytest

from vasculo.errors import InputError
from vasculo.study.sweep.file import read_sweep
from vasculo.study.sweep.plan import look, make_plan
from vasculo.study.sweep.points import MOST_RUNS, Span, grid, latin
from vasculo.study.sweep.sweep import plan_sweep
from vasculo.study.sweep.template import write_template

DISK = {"study": "disk"}
HEIGHTS = {"domain.height": [4.0, 6.0]}


def file(**tables):
    return read_sweep({"sweep": DISK} | tables)


def test_a_grid_has_every_combination():
    found = file(vary={"domain.height": [4.0, 6.0], "angiogenesis.steps": {"from": 2, "to": 8, "steps": 3}})
    assert found.points == [{"domain.height": h, "angiogenesis.steps": s} for h in (4.0, 6.0) for s in (2, 5, 8)]


def test_a_logarithmic_interval_has_equal_ratios():
    assert Span(0.1, 10.0, "log", 5).values() == [0.1, 0.316227766017, 1.0, 3.16227766017, 10.0]


def test_whole_numbers_that_fall_together_are_taken_once():
    assert Span(1, 3, "linear", 9, whole=True).values() == [1, 2, 3]


def test_keys_may_be_quoted_or_nested():
    quoted = read_sweep({"sweep": DISK, "settings": {"angiogenesis.steps": 3}, "vary": HEIGHTS})
    nested = read_sweep(
        {"sweep": DISK, "settings": {"angiogenesis": {"steps": 3}}, "vary": {"domain": {"height": [4.0, 6.0]}}}
    )
    assert quoted.points == nested.points
    assert quoted.fixed == nested.fixed == {"angiogenesis.steps": 3}


def test_a_latin_hypercube_has_one_point_in_each_part():
    axes = {"a": Span(0.0, 8.0), "b": Span(1.0, 256.0, "log"), "c": ["one", "two"]}
    points = latin(axes, 8, seed=3)
    assert sorted(int(point["a"]) for point in points) == list(range(8))
    assert sorted(int(math.log2(point["b"])) for point in points) == list(range(8))
    assert sorted(point["c"] for point in points) == ["one"] * 4 + ["two"] * 4
    assert points == latin(axes, 8, seed=3) != latin(axes, 8, seed=4)


def test_runs_are_the_points_with_their_seeds():
    plan, path = make_plan(read_sweep({"sweep": DISK | {"seeds": [3, 7]}, "vary": HEIGHTS}))
    assert [(run.name, run.point, run.seed) for run in plan.runs] == [
        ("0001", 1, 3), ("0002", 1, 7), ("0003", 2, 3), ("0004", 2, 7),
    ]  # fmt: skip
    overrides = plan.overrides(plan.runs[1])
    assert overrides["study.seed"] == 7
    assert overrides["output.figures"] is False
    assert overrides["study.title"] == "Sweep of disk: domain.height = 4.0, seed 7"
    assert look(plan, path, "sweep").first.domain["height"] == 4.0


def test_points_of_a_list_take_what_they_leave_out_from_the_study():
    found = read_sweep({"sweep": DISK | {"method": "list"}, "point": [{"domain.height": 4.0}, {"domain.radius": 0.5}]})
    plan, _ = make_plan(found)
    assert plan.runs[0].settings == {"domain.height": 4.0, "domain.radius": 1.0}
    assert plan.runs[1].settings == {"domain.height": 8.0, "domain.radius": 0.5}


def test_a_plan_grows_and_keeps_the_names_of_its_runs():
    old, _ = make_plan(read_sweep({"sweep": DISK, "vary": {"domain.height": [4.0, 6.0]}}))
    new, _ = make_plan(read_sweep({"sweep": DISK | {"seeds": 2}, "vary": {"domain.height": [3.0, 4.0, 6.0]}}))
    grown = old.grown(new)
    assert grown.runs[:2] == old.runs
    assert [(run.name, run.point, run.seed, run.settings["domain.height"]) for run in grown.runs[2:]] == [
        ("0003", 3, 0, 3.0), ("0004", 3, 1, 3.0), ("0005", 1, 1, 4.0), ("0006", 2, 1, 6.0),
    ]  # fmt: skip
    assert grown.grown(new) == grown


def test_the_template_is_a_sweep_that_can_be_run(tmp_path):
    write_template(tmp_path / "sweep.toml")
    found = plan_sweep(tmp_path / "sweep.toml")
    assert len(found.plan.runs) == 18
    assert {number.name for number in found.shown} <= set(found.names)
    with pytest.raises(InputError, match="exists already"):
        write_template(tmp_path / "sweep.toml")


BAD = [
    ({"vary": HEIGHTS}, r"no section \[sweep\]"),
    ({"sweep": {}, "vary": HEIGHTS}, r"sweep\.study is missing: it must be a text"),
    ({"sweep": DISK, "varied": HEIGHTS}, r"unknown section \[varied\], did you mean \[vary\]\?"),
    ({"sweep": DISK | {"seed": 3}, "vary": HEIGHTS}, r"unknown key sweep\.seed, did you mean sweep\.seeds\?"),
    ({"sweep": DISK | {"seeds": 0}, "vary": HEIGHTS}, r"seeds = 0 is not a whole number from 1 up"),
    ({"sweep": DISK | {"seeds": [1, 1]}, "vary": HEIGHTS}, r"seeds = \[1, 1\] has a seed twice"),
    ({"sweep": DISK | {"seeds": [-1]}, "vary": HEIGHTS}, r"from 0 to 4294967295"),
    (
        {"sweep": DISK | {"method": "random"}, "vary": HEIGHTS},
        r"method = 'random' must be one of 'grid', 'list', 'latin'",
    ),
    ({"sweep": DISK | {"points": 3}, "vary": HEIGHTS}, r"points goes with method = 'latin'"),
    ({"sweep": DISK | {"method": "latin"}, "vary": HEIGHTS}, r"points goes with method = 'latin'"),
    ({"sweep": DISK}, r"\[vary\] names no setting"),
    ({"sweep": DISK, "vary": {"domain.height": []}}, r"vary\.domain\.height = \[\] holds no value"),
    ({"sweep": DISK, "vary": {"domain.height": 3.0}}, r"must be a list of values or \{from"),
    ({"sweep": DISK, "vary": {"domain.height": {"from": 6.0, "to": 4.0, "steps": 3}}}, r"from = 6\.0 and to = 4\.0"),
    (
        {"sweep": DISK, "vary": {"domain.height": {"from": 4.0, "to": 6.0}}},
        r"steps = None must be a whole number from 2",
    ),
    ({"sweep": DISK, "vary": {"domain.height": {"from": 0, "to": 6, "scale": "log", "steps": 3}}}, r"above 0 on a log"),
    ({"sweep": DISK, "vary": {"domain.height": {"from": 4.0, "to": 6.0, "step": 3}}}, r"has step: it takes from, to"),
    ({"sweep": DISK, "vary": {"height": [4.0]}}, r"'height' names no key: give section\.key"),
    ({"sweep": DISK, "vary": {"study.seed": [1, 2]}}, r"study\.seed is given as sweep\.seeds"),
    ({"sweep": DISK, "vary": {"output.figures": [True]}}, r"output\.figures changes no number"),
    ({"sweep": DISK, "settings": {"domain.height": 5.0}, "vary": HEIGHTS}, r"in \[settings\] and is varied"),
    (
        {"sweep": DISK, "vary": {"domain.height": [4.0, 5.0, 4.0]}},
        r"points 1 and 3 are the same \(domain\.height = 4\.0\)",
    ),
    ({"sweep": DISK | {"method": "list"}, "vary": HEIGHTS}, r"\[vary\] has no use with method = 'list'"),
    ({"sweep": DISK | {"method": "list"}}, r"there is no point: give \[\[point\]\]"),
    ({"sweep": DISK, "vary": HEIGHTS, "point": [HEIGHTS]}, r"\[\[point\]\] goes with method = 'list'"),
    ({"sweep": DISK | {"seeds": 60_000}, "vary": HEIGHTS}, r"2 points of 60,000 seeds are 120,000 runs, above 100,000"),
    (
        {"sweep": DISK, "vary": {"domain.height": {"from": 4, "to": 6, "steps": 200_000}}},
        r"200,000 points .* above 100,000",
    ),
]


@pytest.mark.parametrize(("tables", "line"), BAD)
def test_what_cannot_be_read_is_told_in_one_line(tables, line):
    with pytest.raises(InputError, match=line) as caught:
        read_sweep(tables)
    assert "\n" not in str(caught.value)


TYPO = {"measure": {"numbers": ["alignement"]}, "vary": HEIGHTS}
NO_COLOUR = {"measure": {"numbers": "order"}, "diagram": {"colour": "pillars"}, "vary": HEIGHTS}
BAD_POINTS = [
    (
        {"vary": {"domain.hight": [4.0]}},
        r"point 1 \(domain\.hight = 4\.0\): unknown key .* did you mean domain\.height",
    ),
    ({"vary": {"domain.height": [4.0, -1.0]}}, r"point 2 \(domain\.height = -1\.0\): "),
    (TYPO, r"measure\.numbers: no number is called 'alignement', did you mean 'alignment'"),
    ({"vary": HEIGHTS, "measure": {"numbers": 3}}, r"measure\.numbers = 3 must be the name of a number"),
    (NO_COLOUR, r"diagram\.colour: no number is called 'pillars'"),
    ({"vary": HEIGHTS, "diagram": {"x": "domain.radius"}}, r"diagram\.x = 'domain\.radius' is not varied"),
    ({"sweep": {"study": "dsk"}, "vary": HEIGHTS}, r"dsk: no such file and no built-in study, did you mean 'disk'"),
]


@pytest.mark.parametrize(("tables", "line"), BAD_POINTS)
def test_a_point_that_cannot_be_run_is_told_before_anything_runs(tables, line):
    with pytest.raises(InputError, match=line) as caught:
        plan_sweep({"sweep": DISK} | tables)
    assert "\n" not in str(caught.value)


def test_a_file_that_is_no_toml_is_told_with_its_place(tmp_path):
    path = tmp_path / "bad.toml"
    path.write_text("[sweep\n")
    with pytest.raises(InputError, match=r"bad\.toml: not TOML at line 1"):
        read_sweep(path)
    with pytest.raises(InputError, match="cannot be read: No such file"):
        read_sweep(tmp_path / "none.toml")


def test_a_study_beside_the_sweep_is_found(tmp_path):
    (tmp_path / "mine.toml").write_text('[domain]\nkind = "disk"\n')
    (tmp_path / "sweep.toml").write_text('[sweep]\nstudy = "mine.toml"\n[vary]\ndomain.height = [4.0, 6.0]\n')
    found = plan_sweep(tmp_path / "sweep.toml")
    assert found.settings.kind == "disk"
    assert len(found.plan.runs) == 2


def test_a_grid_too_large_is_refused_before_it_is_made():
    with pytest.raises(InputError, match=f"above {MOST_RUNS:,}"):
        grid({name: list(range(1_000)) for name in "abc"})
