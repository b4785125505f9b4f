"""Watchers of the user: what they see, what they write, how they end a run, and how their faults are told."""

import csv
import re
import shutil
from pathlib import Path

import numpy as np
import pytest

import vasculo as vc
from vasculo.errors import ComputationError, InputError
from vasculo.store.read import open_run
from vasculo.study.laws import forget_laws
from vasculo.study.run import Interrupted, run
from vasculo.study.settings import read_study
from vasculo.study.watch_table import WATCH_TABLE, UserWatchers
from vasculo.study.watchers import registered, stages_of

EXAMPLES = Path(__file__).parents[2] / "examples"
FILE = """import vasculo as vc


@vc.watcher("remodel")
def area(step):
    return {"area": step.domain.pillar_areas.sum(), "nodes": len(step.domain.pillars[0])}


@vc.watcher("remodel")
def odd(step):
    if step.step % 2:
        return {"odd": float("nan") if step.step == 3 else 1}
"""
STUDY = """[study]
uses = "my_watcher.py"

[domain]
kind = "disk"
width = 6.0
height = 4.0

[angiogenesis]
steps = 4

[output]
figures = false
step_every = 2
"""


@pytest.fixture(autouse=True)
def clean():
    yield
    forget_laws()


@pytest.fixture
def study(tmp_path):
    folder = tmp_path / "studies"
    folder.mkdir()
    (folder / "my_watcher.py").write_text(FILE)
    (folder / "disk.toml").write_text(STUDY)
    return folder / "disk.toml"


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The study of these tests, run once."""
    folder = tmp_path_factory.mktemp("watched")
    (folder / "my_watcher.py").write_text(FILE)
    (folder / "disk.toml").write_text(STUDY)
    return run(folder / "disk.toml", folder / "whole")


def rows(folder):
    with (folder / WATCH_TABLE).open(newline="") as file:
        return list(csv.DictReader(file))


def steps(folder):
    return [int(row["step"]) for row in rows(folder)]


class Looker:
    """A watcher that keeps what it sees."""

    def __init__(self):
        self.seen, self.ended = [], 0

    def growth(self, step):
        self.seen.append(("growth", step.step))

    def remodel(self, step):
        self.seen.append(("remodel", step.step))

    def end(self):
        self.ended += 1


def test_what_they_return_becomes_a_table(whole):
    done = whole
    table = rows(done.folder)
    assert list(table[0]) == ["stage", "step", "time", "area", "nodes", "odd"]
    assert steps(done.folder) == [0, 1, 2, 3, 4]  # every step, also those that are not recorded
    assert done.steps() == [0, 2, 4]
    assert [row["odd"] for row in table] == ["", "1", "", "", ""]
    recorded = {int(row["step"]): row for row in table if int(row["step"]) in done.steps()}
    for step, row in recorded.items():
        assert float(row["area"]) == done.domain(step).pillar_areas.sum()
        assert float(row["time"]) == done.metrics["time"][done.steps().index(step)]
        assert row["nodes"] == str(len(done.domain(step).pillars[0]))
    assert (done.folder / "my_watcher.py").read_text() == FILE


def test_a_run_that_goes_on_has_each_step_once(study, whole, tmp_path, stop_at, same_arrays):
    with pytest.raises(Interrupted):
        run(study, tmp_path / "half", progress=stop_at("angiogenesis", 3))
    assert steps(tmp_path / "half") == [0, 1, 2, 3]  # step 3 was seen, and not recorded
    again = run(out=tmp_path / "half", resume=True)
    same_arrays(again, whole)
    assert (again.folder / WATCH_TABLE).read_text() == (whole.folder / WATCH_TABLE).read_text()
    longer = run(out=again.folder, resume=True, settings={"angiogenesis.steps": 5})
    assert steps(longer.folder) == [0, 1, 2, 3, 4, 5]


def test_a_branch_takes_the_rows_before_it_along(whole, tmp_path):
    off = run(branch=whole.folder, step=2, settings={"angiogenesis.activation": 0.0}, out=tmp_path / "off")
    assert steps(off.folder) == [0, 1, 2, 3, 4]
    mine, theirs = rows(off.folder), rows(whole.folder)
    assert mine[:3] == theirs[:3]
    assert mine[4]["area"] != theirs[4]["area"]


def test_a_run_of_a_finished_run_begins_its_table_anew(whole, tmp_path):
    again = run(whole.folder, tmp_path / "again")
    assert rows(again.folder) == rows(whole.folder)


def test_a_watcher_ends_the_angiogenesis(study, tmp_path):
    stop = '        raise vc.StopRun("seen enough")\n'
    (study.parent / "my_watcher.py").write_text(
        FILE.replace("    if step.step % 2:\n", "    if step.step == 3:\n" + stop)
    )
    done = run(study, tmp_path / "run")
    assert done.complete
    assert done.steps() == [0, 2, 3]  # the last step is recorded, whatever the interval
    assert done.facts("stages")[-1]["result"].endswith("steps 3, ended by a watcher: seen enough")
    assert steps(done.folder) == [0, 1, 2, 3]  # the other watcher's row of that step is there
    longer = run(out=done.folder, resume=True, settings={"angiogenesis.steps": 5})
    assert longer.steps() == [0, 2, 3, 4, 5]


def test_objects_and_functions_in_python(tiny_disk, tmp_path):
    looker = Looker()

    @vc.watcher("remodel")
    def count(step):
        return {"pillars": len(step.domain.pillars)}

    done = run("disk", tmp_path / "run", tiny_disk, watchers=[count, looker])
    assert looker.seen == [("remodel", step) for step in range(4)]
    assert looker.ended == 1
    assert [row["pillars"] for row in rows(done.folder)] == ["1"] * 4
    assert stages_of(count) == ("remodel",)
    plain = run("disk", tmp_path / "plain", tiny_disk)
    assert not (plain.folder / WATCH_TABLE).exists()  # a watcher of the session is used where it is given


def test_the_end_is_told_when_a_run_fails(tiny_disk, tmp_path):
    looker, failing = Looker(), Looker()
    failing.remodel = lambda step: 1 / (2 - step.step)
    with pytest.raises(ZeroDivisionError):
        run("disk", tmp_path / "run", tiny_disk, watchers=[failing, looker])
    assert looker.seen == [("remodel", 0), ("remodel", 1)]
    assert looker.ended == 1


def test_growth_is_watched_at_every_look(tmp_path, tiny_tissue):
    looker = Looker()
    settings = tiny_tissue | {
        "study.until": "vasculogenesis",
        "study.uses": str(EXAMPLES / "watchers" / "my_watcher.py"),
    }
    done = run("small", tmp_path / "run", settings, watchers=[looker])
    table = rows(done.folder)
    assert {row["stage"] for row in table} == {"vasculogenesis"}
    assert [("growth", int(row["step"])) for row in table] == looker.seen
    assert set(done.steps("vasculogenesis")) < {step for _, step in looker.seen}
    net = done.network(done.steps("vasculogenesis")[-1])
    lengths = np.hypot(*(net.points[net.springs[:, 1]] - net.points[net.springs[:, 0]]).T)
    strains = lengths / (lengths - net.forces) - 1.0  # the stiffness is 1
    assert float(table[-1]["largest_strain"]) == pytest.approx(strains.max(), rel=1e-9)


@pytest.mark.parametrize(
    ("body", "message"),
    [
        (
            "return {'x': 1 / (2 - step.step)}",
            "failed at step 2 of the angiogenesis: my_watcher.py, line 6: ZeroDivisionError: di",
        ),
        ("return [1]", r"at step 0 of the angiogenesis returned \[1\]: return a dict of numbers, or nothing"),
        ("return {'a': 'b'}", "returned a = 'b', which is no number"),
        ("return {'step': 1}", "returned 'step', a column that is taken: choose another name"),
        ("return {'odd': 1}", "returned 'odd', a column that is taken"),
        ("return step.nothing", "line 6: AttributeError: 'RemodelStep' object has no attribute 'nothing'"),
        ("raise vc.InputError('no: 3')", "line 6: no: 3"),
    ],
)
def test_faults_while_a_run_goes(study, tmp_path, body, message):
    text = FILE.replace('return {"area": step.domain.pillar_areas.sum(), "nodes": len(step.domain.pillars[0])}', body)
    (study.parent / "my_watcher.py").write_text(text)
    with pytest.raises(ComputationError, match=message) as caught:
        run(study, tmp_path / "run", {"output.step_every": 1})
    assert str(caught.value).startswith("watcher '")
    assert str(caught.value).endswith(f"; what was done is kept in {tmp_path / 'run'}")
    assert "\n" not in str(caught.value)
    kept = open_run(tmp_path / "run")
    assert not kept.complete
    assert len(kept.steps()) == int(re.search(r"step (\d)", str(caught.value))[1])  # those before the fault


def test_growth_cannot_be_ended(tmp_path, tiny_tissue):
    @vc.watcher("growth")
    def impatient(_step):
        raise vc.StopRun("now")

    with pytest.raises(
        ComputationError, match="watcher 'impatient' raised StopRun at step 0 of the vasculogenesis: only"
    ):
        run("small", tmp_path / "run", tiny_tissue, watchers=[impatient])


def test_a_fixed_file_goes_on_in_a_branch_without_a_gap(study, tmp_path):
    (study.parent / "my_watcher.py").write_text(FILE.replace("step.step % 2", "step.step % (step.step - 3)"))
    with pytest.raises(ComputationError, match="at step 3 of the angiogenesis"):
        run(study, tmp_path / "run")
    assert open_run(tmp_path / "run").steps() == [0, 2]
    (study.parent / "my_watcher.py").write_text(FILE)
    settings = {"study.uses": str(study.parent / "my_watcher.py")}
    done = run(branch=tmp_path / "run", settings=settings, out=tmp_path / "fixed")
    assert steps(done.folder) == [0, 1, 2, 3, 4]
    assert [row["area"] for row in rows(done.folder)][3] != ""


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (FILE.replace('"remodel"', '"flow"', 1), r"line 4: watcher\('flow'\) must be one of 'growth', 'remodel'"),
        (FILE.replace("area(step)", "area(step, more)"), r"line 4: watcher area\(step, more\) must take one argument"),
        (FILE.replace("area(step)", "area()"), r"watcher area\(\) must take one argument, the step"),
    ],
)
def test_faults_of_the_file(study, text, message):
    before = registered()
    (study.parent / "my_watcher.py").write_text(text)
    with pytest.raises(InputError, match=message):
        read_study(study)
    assert registered() == before


def test_what_is_no_watcher(tiny_disk, tmp_path):
    with pytest.raises(
        InputError, match=r"watcher '<lambda>' is not one: write @vasculo\.watcher\(\"remodel\"\) above"
    ):
        run("disk", tmp_path / "run", tiny_disk, watchers=[lambda _: None])
    assert not (tmp_path / "run").exists()


def test_a_table_that_was_changed(tmp_path):
    (tmp_path / WATCH_TABLE).write_text("a,b\n1,2\n")
    with pytest.raises(ComputationError, match=r"watch\.csv is no table of watchers any more: take it away"):
        UserWatchers((), tmp_path / WATCH_TABLE, {})


@pytest.mark.parametrize(
    ("study", "steps_done", "words"),
    [("laws/disk.toml", 2, "steps 2"), ("watchers/disk.toml", 12, "ended by a watcher: aspect ratio 1.5")],
)
def test_the_examples_run(study, steps_done, words, tmp_path):
    folder = tmp_path / "examples"
    shutil.copytree(EXAMPLES / Path(study).parent, folder)
    settings = {"domain.width": 6.0, "domain.height": 4.0, "angiogenesis.steps": steps_done, "output.figures": False}
    done = run(folder / Path(study).name, tmp_path / "run", settings)
    assert words in done.facts("stages")[-1]["result"]
    if "watchers" in study:
        assert {"peak_speed", "mean_aspect_ratio"} <= set(rows(done.folder)[0])
        assert float(rows(done.folder)[-2]["mean_aspect_ratio"]) < 1.5
    else:
        assert done.settings["angiogenesis"]["response"] == "saturating"
        assert np.abs(np.concatenate(done.pillars(0).activation)).max() < 1.0


def test_the_example_of_a_tissue_can_be_used():
    settings = read_study(EXAMPLES / "watchers" / "tissue.toml")
    assert settings.stages == ("vasculogenesis",)
    assert [stage for stage, _ in settings.watchers] == ["growth", "remodel", "remodel"]
