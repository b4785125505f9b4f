"""One run as a worker does it: begun, gone on with, found complete, failed, stopped."""

import fcntl
import shutil

import h5py
import numpy as np
import pytest

from vasculo.errors import ComputationError, InputError
from vasculo.store.read import open_run
from vasculo.study.sweep import work as work_module
from vasculo.study.sweep.file import to_toml
from vasculo.study.sweep.home import LOCK, STOP, claimed
from vasculo.study.sweep.numbers import read_numbers
from vasculo.study.sweep.results import open_sweep
from vasculo.study.sweep.sweep import _begin as begin
from vasculo.study.sweep.work import found_complete, work

LAWS = """import vasculo as vc


@vc.cell_response("half")
def half(shear, mean, position):
    return 0.5 * (shear / mean - 1.0)
"""


@pytest.fixture
def sweep(heights, tmp_path):
    """A sweep in its folder, with nothing done; the plan and its first run."""
    found = begin(heights, tmp_path / "sweep")
    return found, found.plan.runs[0]


def do(found, run):
    return work(found.folder, run.name, found.plan.overrides(run), found.names)


def same(one, two):
    assert one.keys() == two.keys()
    np.testing.assert_array_equal(list(one.values()), list(two.values()))


def test_a_run_has_its_own_folder_settings_and_numbers(done_here):
    run = done_here.plan.runs[2]
    there = done_here.run(run.name)
    assert there.complete
    assert there.settings["domain"]["height"] == 5.0
    assert there.settings["study"]["title"] == "Heights: domain.height = 5.0, seed 0"
    assert not (there.folder / "figures").exists()
    numbers = done_here.outcomes[run.name].numbers
    assert numbers["aspect_ratio"] == there.metrics["aspect_ratio"][-1]
    assert numbers["permeability.gain"] == there.metrics["permeability"][-1] / there.metrics["permeability"][0]
    assert done_here.outcomes[run.name].seconds == sum(stage["seconds"] for stage in there.facts("stages"))


def test_a_complete_run_is_left_as_it_is(done_here):
    run = done_here.plan.runs[0]
    log = (done_here.folder / "runs" / run.name / "log.txt").read_text()
    again = do(done_here, run)
    assert again.status == "complete"
    same(again.numbers, done_here.outcomes[run.name].numbers)
    overrides = done_here.plan.overrides(run)
    same(found_complete(done_here.folder, run.name, overrides, done_here.names).numbers, again.numbers)
    assert found_complete(done_here.folder, run.name, overrides | {"output.figures": True}, done_here.names) is None
    assert (done_here.folder / "runs" / run.name / "log.txt").read_text() == log


def test_a_run_that_was_stopped_goes_on_to_the_same_numbers(sweep, done_here, monkeypatch):
    found, run = sweep
    monkeypatch.setattr(work_module, "_LOOKS", 0.0)
    advance = work_module._Pulse.advance

    def stop_behind_the_first_step(self, done, total, text):
        if done >= 1:
            (found.folder / STOP).touch()
        advance(self, done, total, text)

    with monkeypatch.context() as patch:
        patch.setattr(work_module._Pulse, "advance", stop_behind_the_first_step)
        assert do(found, run).status == "stopped"
    assert open_run(found.folder / "runs" / run.name).steps() == [0, 1]
    assert found_complete(found.folder, run.name, found.plan.overrides(run), found.names) is None
    (found.folder / STOP).unlink()
    outcome = do(found, run)
    assert outcome.status == "complete"
    same(outcome.numbers, done_here.outcomes[run.name].numbers)
    assert "goes on behind step 1" in (found.folder / "runs" / run.name / "log.txt").read_text()


@pytest.mark.parametrize("cut", ["checkpoint.h5", "run.vtkhdf", "torn"])
def test_a_run_that_was_cut_off_too_early_begins_anew(sweep, done_here, cut):
    found, run = sweep
    folder = found.folder / "runs" / run.name
    shutil.copytree(done_here.folder / "runs" / run.name, folder)
    with h5py.File(folder / "run.vtkhdf", "r+") as file:
        file["run"].attrs["complete"] = False
    if cut == "torn":
        (folder / "run.vtkhdf").write_bytes((folder / "run.vtkhdf").read_bytes()[:1_000])
    else:
        (folder / cut).unlink()
    outcome = do(found, run)
    assert outcome.status == "complete", outcome.line
    same(outcome.numbers, done_here.outcomes[run.name].numbers)


def test_a_run_that_fails_says_why_in_one_line(sweep, monkeypatch):
    found, run = sweep

    def fail(*_args, **_kwargs):
        raise ComputationError("the flow did not\nconverge")

    monkeypatch.setattr(work_module, "execute", fail)
    outcome = do(found, run)
    assert (outcome.status, outcome.line) == ("failed", "the flow did not converge")

    def trip(*_args, **_kwargs):
        raise ZeroDivisionError("division by zero")

    monkeypatch.setattr(work_module, "execute", trip)
    assert do(found, run).line.startswith("ZeroDivisionError: division by zero (test_work.py, line ")


def test_a_worker_without_the_folder_says_so(sweep, tmp_path):
    found, run = sweep
    outcome = work(tmp_path / "elsewhere", run.name, found.plan.overrides(run), found.names)
    assert outcome.status == "failed"
    assert "does not see" in outcome.line
    assert "shared file system" in outcome.line


def test_two_workers_never_share_a_folder(sweep, monkeypatch):
    found, run = sweep
    folder = found.folder / "runs" / run.name
    folder.mkdir()
    monkeypatch.setattr(work_module, "_PATIENCE", 0.0)
    with (folder / LOCK).open("w") as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        assert "still worked in by another process" in do(found, run).line
    with claimed(folder, "free again"):
        pass


def test_a_record_that_another_program_writes_is_left_alone(sweep, done_here):
    found, run = sweep
    folder = found.folder / "runs" / run.name
    shutil.copytree(done_here.folder / "runs" / run.name, folder)
    with h5py.File(folder / "run.vtkhdf", "r+") as file:
        file["run"].attrs["complete"] = False
    with (folder / "run.vtkhdf").open("rb") as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        assert "being written by a run outside the sweep" in do(found, run).line
    assert open_run(folder).steps() == [0, 1, 2, 3]


def test_numbers_that_a_run_has_not_are_empty(done_here):
    found = read_numbers(done_here.run("0001"), ["springs", "plexus.spacing", "aspect_ratio.start", "aspect_ratio"])
    assert np.isnan(found["springs"])
    assert np.isnan(found["plexus.spacing"])
    assert found["aspect_ratio.start"] < found["aspect_ratio"]


def test_another_sweep_in_the_same_folder_is_refused(sweep, heights):
    found, _ = sweep
    with pytest.raises(
        InputError, match="holds a sweep already: name another folder with --out, or go on with --resume"
    ):
        begin(heights, found.folder)


def test_laws_that_the_sweep_file_names_travel_with_it(heights, tmp_path):
    (tmp_path / "my_laws.py").write_text(LAWS)
    heights["settings"] |= {"study.uses": "my_laws.py", "angiogenesis.response": "half"}
    (tmp_path / "sweep.toml").write_text(to_toml(heights))
    found = begin(tmp_path / "sweep.toml", tmp_path / "out")
    (tmp_path / "my_laws.py").unlink()
    run = found.plan.runs[0]
    outcome = do(found, run)
    assert outcome.status == "complete", outcome.line
    assert found.run(run.name).settings["angiogenesis"]["response"] == "half"
    assert open_sweep(tmp_path / "out").settings.laws == tmp_path / "out" / "my_laws.py"
