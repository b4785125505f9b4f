"""Runs end to end, tiny: what lies in the folder, repetition, interruption, failure."""

import csv
import tomllib

import numpy as np
import pytest

from vasculo import measure
from vasculo.errors import ComputationError, InputError
from vasculo.store.checkpoint import Checkpoint
from vasculo.store.read import open_run
from vasculo.study import job as job_module
from vasculo.study.folder import Log, free_folder, new_folder, old_folder
from vasculo.study.invariants import MASS_LIMIT
from vasculo.study.run import Interrupted, run
from vasculo.study.watch import Silence

FILES = {"study.toml", "run.vtkhdf", "metrics.csv", "checkpoint.h5", "log.txt"}


def numbers(run_):
    """All columns but the wall times."""
    return {name: values for name, values in run_.metrics.items() if name != "stage" and not name.startswith("seconds")}


def assert_same(one, two):
    assert [(f.stage, f.step, f.time) for f in one.frames] == [(f.stage, f.step, f.time) for f in two.frames]
    for name, values in numbers(one).items():
        np.testing.assert_array_equal(values, numbers(two)[name], err_msg=name)
    for mine, theirs in zip(one.pillars().outlines, two.pillars().outlines, strict=True):
        np.testing.assert_array_equal(mine, theirs)
    np.testing.assert_array_equal(one.flow().pressure, two.flow().pressure)


class StopAt(Silence):
    """Presses Ctrl-C when a stage reaches a step."""

    def __init__(self, stage, step):
        self.wanted = stage, step
        self.stage = ""

    def begin(self, stage, _):
        self.stage = stage

    def advance(self, done, _total, _text):
        if self.stage == self.wanted[0] and done >= self.wanted[1]:
            raise KeyboardInterrupt


def test_a_run_of_all_stages(tissue_run):
    assert tissue_run.complete
    assert {path.name for path in tissue_run.folder.iterdir()} == FILES
    settings = tomllib.loads((tissue_run.folder / "study.toml").read_text())
    assert settings == tissue_run.settings
    assert settings["tissue"]["nodes"] == 900
    stages = tissue_run.facts("stages")
    assert [stage["name"] for stage in stages] == ["vasculogenesis", "extraction", "angiogenesis"]
    assert all(stage["seconds"] >= 0 and stage["peak_mb"] > 0 for stage in stages)
    assert {entry["name"] for entry in tissue_run.facts("extraction")} > {"voids", "pillars", "fluid_fraction"}
    assert tissue_run.steps() == [0, 1, 2]
    assert "complete" in (tissue_run.folder / "log.txt").read_text()


def test_the_morphology_of_the_plexus_is_kept(tissue_run):
    facts = {entry["name"]: entry["value"] for entry in tissue_run.facts("plexus")}
    plexus = Checkpoint.load(tissue_run.folder / "checkpoint.h5").plexus
    found = measure.plexus(plexus)
    assert {"voids", "spacing", "cord_length", "cord_width", "mean_degree", "connectivity"} < set(facts)
    assert all(value == getattr(found, name) for name, value in facts.items())
    assert all(entry["meaning"] for entry in tissue_run.facts("plexus"))
    assert tissue_run.facts("tissue") == {}


def test_a_plexus_that_cannot_be_measured_does_not_cost_the_run(tmp_path, monkeypatch):
    def refuse(_):
        raise InputError("the void of face 3 reaches around the periodic box")

    monkeypatch.setattr(job_module.measure, "plexus", refuse)
    settings = {"tissue.nodes": 900, "output.figures": False, "vasculogenesis.preset": "fine"}
    done = run("plexus", tmp_path / "run", settings)
    assert done.complete
    assert done.facts("plexus") == {}
    assert "plexus: not measured: the void of face 3" in (done.folder / "log.txt").read_text()


def test_a_periodic_tissue_is_kept_with_its_box(tmp_path):
    settings = {"tissue.nodes": 900, "tissue.boundary": "periodic", "study.until": "vasculogenesis"}
    done = run("plexus", tmp_path / "run", settings | {"output.figures": False, "vasculogenesis.preset": "fine"})
    assert done.period == done.network().box == (1.0, 1.0)
    plexus = Checkpoint.load(done.folder / "checkpoint.h5").plexus
    assert plexus.box.tolist() == [1.0, 1.0]
    np.testing.assert_array_equal(done.network().forces, plexus.tensions())


def test_the_table_says_what_the_record_says(tissue_run):
    with (tissue_run.folder / "metrics.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["stage"] for row in rows] == [frame.stage for frame in tissue_run.frames]
    for row, frame in zip(rows, tissue_run.frames, strict=True):
        assert int(row["step"]) == frame.step
        assert float(row["time"]) == frame.time
        if frame.stage == "vasculogenesis":
            state = tissue_run.network(frame.step)
            assert int(row["springs"]) == len(state.springs)
            assert row["permeability"] == row["merges"] == ""
        else:
            assert int(row["pillars"]) == len(tissue_run.pillars(frame.step).outlines)
            assert int(row["triangles"]) == len(tissue_run.mesh(frame.step).triangles)
            assert float(row["mass_imbalance"]) < MASS_LIMIT
            assert row["springs"] == ""


def test_springs_only_break_and_the_last_one_is_recorded(tissue_run):
    rows = tissue_run.metrics["stage"] == "vasculogenesis"
    springs = tissue_run.metrics["springs"][rows]
    assert (np.diff(springs) <= 0).all()
    assert springs[-1] < springs[0]
    steps = tissue_run.metrics["step"][rows]
    assert (np.diff(steps) > 0).all()


def test_the_wall_shear_in_the_record_gives_the_mean_in_the_table(disk_run):
    flow = disk_run.flow(2)
    ends = flow.mesh.points[flow.wall_edges]
    lengths = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
    on_pillars = flow.wall_pillar >= 0
    mean = np.average(np.abs(flow.wall_shear[on_pillars]), weights=lengths[on_pillars])
    row = disk_run.frame("angiogenesis", 2).index
    assert mean == pytest.approx(disk_run.metrics["mean_wall_shear"][row], rel=1e-12)


def test_the_same_numbers_again_from_its_own_study_file(disk_run, tmp_path):
    assert_same(run(disk_run.folder / "study.toml", tmp_path / "again"), disk_run)


def test_the_same_numbers_again_for_a_tissue(tissue_run, tmp_path):
    assert_same(run(tissue_run.folder, tmp_path / "again"), tissue_run)


@pytest.mark.parametrize("step", [0, 2])
def test_interrupted_and_resumed_gives_the_same_numbers(disk_run, tiny_disk, tmp_path, step):
    with pytest.raises(Interrupted, match=r"go on with: vasculo run --resume --out .*half") as caught:
        run("disk", tmp_path / "half", tiny_disk, progress=StopAt("angiogenesis", step))
    assert caught.value.folder == tmp_path / "half"
    half = open_run(tmp_path / "half")
    assert not half.complete
    assert half.steps() == list(range(step + 1))
    assert_same(run(out=tmp_path / "half", resume=True), disk_run)
    assert "goes on behind step" in (tmp_path / "half/log.txt").read_text()


@pytest.mark.parametrize("stage", ["vasculogenesis", "angiogenesis"])
def test_finished_stages_are_not_done_again(tissue_run, tiny_tissue, tmp_path, monkeypatch, stage):
    with pytest.raises(Interrupted):
        run("small", tmp_path / "half", tiny_tissue, progress=StopAt(stage, 1))
    if stage == "angiogenesis":
        monkeypatch.setattr(job_module, "grow_plexus", None)
        monkeypatch.setattr(job_module, "extract", None)
    assert_same(run("small", tmp_path / "half", tiny_tissue, resume=True), tissue_run)


def test_resuming_a_complete_run_changes_nothing(tiny_disk, tmp_path):
    before = run("disk", tmp_path / "run", tiny_disk)
    assert_same(run(out=tmp_path / "run", resume=True), before)
    assert open_run(tmp_path / "run").complete


def test_steps_left_out_of_the_record(disk_run, tiny_disk, tmp_path):
    sparse = run("disk", tmp_path / "run", tiny_disk | {"output.step_every": 2})
    assert sparse.steps() == [0, 2, 3]
    for mine, theirs in zip(sparse.pillars().outlines, disk_run.pillars().outlines, strict=True):
        np.testing.assert_array_equal(mine, theirs)


def test_a_folder_in_use_is_refused(disk_run, tiny_disk):
    with pytest.raises(InputError, match="holds a run already: name another folder with --out, or go on with --resume"):
        run("disk", disk_run.folder, tiny_disk)


def test_resume_refuses_another_study(disk_run, tmp_path):
    with pytest.raises(InputError, match=r"was begun with domain.width = 6.0, not 12.0: resume without"):
        run("disk", disk_run.folder, resume=True)
    with pytest.raises(InputError, match="holds no run to go on with"):
        run(out=tmp_path, resume=True)


def test_resume_needs_its_files(tiny_disk, tmp_path):
    folder = tmp_path / "half"
    with pytest.raises(Interrupted):
        run("disk", folder, tiny_disk, progress=StopAt("angiogenesis", 1))
    study = (folder / "study.toml").read_text()
    (folder / "study.toml").write_text(study.replace("steps = 3", "steps = 4"))
    with pytest.raises(InputError, match=r"was changed since the run began: change it back"):
        run(out=folder, resume=True)
    (folder / "study.toml").write_text(study)
    (folder / "run.vtkhdf").unlink()
    with pytest.raises(InputError, match=r"there is no run\.vtkhdf"):
        run(out=folder, resume=True)


def test_a_failed_step_keeps_the_steps_before(tiny_disk, tmp_path, monkeypatch):
    real = job_module.remodel

    def failing(domain, parameters, watch, **more):
        def stop(step):
            watch(step)
            if step.step == 1:
                raise ComputationError("remodelling step 2: the flow did not converge (residual 3)")

        return real(domain, parameters, stop, **more)

    monkeypatch.setattr(job_module, "remodel", failing)
    with pytest.raises(ComputationError, match=r"residual 3\); what was done is kept in .*run") as caught:
        run("disk", tmp_path / "run", tiny_disk)
    assert "\n" not in str(caught.value)
    kept = open_run(tmp_path / "run")
    assert not kept.complete
    assert kept.steps() == [0, 1]
    assert "stopped: ComputationError" in (tmp_path / "run/log.txt").read_text()


def test_a_study_that_cannot_begin_leaves_nothing_behind(tiny_disk, tmp_path, monkeypatch):
    def refuse(*_, **__):
        raise InputError("the passages cannot be meshed")

    monkeypatch.setattr(job_module, "remodel", refuse)
    with pytest.raises(InputError, match="cannot be meshed"):
        run("disk", tmp_path / "run", tiny_disk)
    assert not (tmp_path / "run").exists()
    (tmp_path / "kept").mkdir()
    (tmp_path / "kept/mine.txt").write_text("mine")
    with pytest.raises(InputError):
        run("disk", tmp_path / "kept", tiny_disk)
    assert [path.name for path in (tmp_path / "kept").iterdir()] == ["mine.txt"]


def test_a_full_disk_ends_in_one_line_and_can_be_resumed(disk_run, tiny_disk, tmp_path, monkeypatch):
    class Usage:
        free = 10**12

    monkeypatch.setattr("shutil.disk_usage", lambda _: Usage)

    class Fill(Silence):
        def advance(self, done, _total, _text):
            if done == 1:
                Usage.free = 1000

    with pytest.raises(ComputationError, match=r"run.vtkhdf cannot be written: No space left on device") as caught:
        run("disk", tmp_path / "full", tiny_disk, progress=Fill())
    assert "--resume" in str(caught.value)
    assert "\n" not in str(caught.value)
    assert open_run(tmp_path / "full").steps() == [0, 1]
    Usage.free = 10**12
    assert_same(run(out=tmp_path / "full", resume=True), disk_run)


def test_folders(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    first = new_folder("disk", None)
    assert str(first) == "runs/disk"
    (first / "study.toml").write_text("")
    assert str(free_folder("disk")) == "runs/disk-2"
    with pytest.raises(InputError, match="no run of chains under runs"):
        old_folder("chains", None)
    (new_folder("disk", None) / "study.toml").write_text("")
    assert str(old_folder("disk", None)) == "runs/disk-2"
    assert old_folder("chains", "runs/disk") == first
    with pytest.raises(InputError, match=r"holds a study\.toml that the run would replace"):
        new_folder("disk", "runs/disk")
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="cannot be made"):
        new_folder("disk", tmp_path / "file")


def test_the_log_goes_on(tmp_path):
    for text in ("one", "two"):
        with Log(tmp_path) as log:
            log.line(text)
    lines = (tmp_path / "log.txt").read_text().splitlines()
    assert [line.split("  ")[1] for line in lines] == ["one", "two"]
