"""Branches: a run goes on under other settings in a folder of its own, and the old one stays as it is."""

import hashlib
import tomllib

import numpy as np
import pytest

import vasculo as vc
from vasculo.errors import ComputationError, InputError
from vasculo.study import branch as branch_module
from vasculo.study.run import Interrupted, run

OFF = {"angiogenesis.activation": 0.0}


def contents(folder):
    """Every file of a folder with its content and time."""
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return {path: (hashlib.sha256(path.read_bytes()).hexdigest(), path.stat().st_mtime_ns) for path in files}


def ways(run_):
    """Steps of the branches in the study of a run, and what held before each."""
    return [(entry["step"], entry["before"]) for entry in run_.settings["branch"]]


@pytest.fixture(scope="module")
def knocked_out(plexus_run, tmp_path_factory):
    """The plexus without activation from step 3 on."""
    return run(branch=plexus_run.folder, step=3, settings=OFF, out=tmp_path_factory.mktemp("branch") / "off")


def test_what_was_computed_is_kept_and_the_rest_is_other(plexus_run, knocked_out):
    assert knocked_out.complete
    assert knocked_out.steps() == plexus_run.steps()
    for name, values in knocked_out.metrics.items():
        np.testing.assert_array_equal(values[:4], plexus_run.metrics[name][:4], err_msg=name)
    assert (knocked_out.metrics["aspect_ratio"][4:] != plexus_run.metrics["aspect_ratio"][4:]).all()
    assert [event.step for event in knocked_out.events] == [e.step for e in plexus_run.events if e.step <= 3]
    assert np.ptp(knocked_out.metrics["time"][3:]) == 0.0


def test_the_old_folder_stays_as_it_is(plexus_run, tmp_path):
    before = contents(plexus_run.folder)
    run(branch=plexus_run.folder, step=5, settings=OFF, out=tmp_path / "off")
    assert contents(plexus_run.folder) == before


def test_the_record_and_the_study_say_so(plexus_run, knocked_out):
    changes = [["angiogenesis.activation", 0.16, 0.0]]
    folder = plexus_run.folder.name
    assert knocked_out.facts("branch") == [{"run": plexus_run.id, "folder": folder, "step": 3, "changes": changes}]
    assert knocked_out.id != plexus_run.id
    study = tomllib.loads((knocked_out.folder / "study.toml").read_text())
    assert study == knocked_out.settings
    assert study["angiogenesis"]["activation"] == 0.0
    assert study["branch"] == [{"step": 3, "before": {"activation": 0.16}, "run": f"{folder} {plexus_run.id}"}]
    log = (knocked_out.folder / "log.txt").read_text()
    assert f"branch of {plexus_run.folder} behind step 3, into {knocked_out.folder}: " in log
    assert "angiogenesis.activation = 0.0 instead of 0.16" in log
    assert plexus_run.facts("branch") == {}


def test_its_study_alone_gives_the_same_numbers(knocked_out, tmp_path, same_arrays):
    again = run(knocked_out.folder / "study.toml", tmp_path / "again")
    same_arrays(again, knocked_out)
    assert again.facts("branch") == {}


def test_a_branch_that_is_stopped_goes_on(plexus_run, knocked_out, tmp_path, stop_at, same_arrays):
    with pytest.raises(Interrupted, match=rf"--resume --out {tmp_path / 'off'}"):
        run(branch=plexus_run.folder, step=3, settings=OFF, out=tmp_path / "off", progress=stop_at("angiogenesis", 4))
    same_arrays(run(out=tmp_path / "off", resume=True), knocked_out)
    with pytest.raises(Interrupted):  # and its study, stopped before the branch and behind it
        run(knocked_out.folder, tmp_path / "anew", progress=stop_at("angiogenesis", 2))
    with pytest.raises(Interrupted):
        run(out=tmp_path / "anew", resume=True, progress=stop_at("angiogenesis", 5))
    same_arrays(run(out=tmp_path / "anew", resume=True), knocked_out)


def test_without_changes_it_repeats_the_run(plexus_run, tmp_path, same_arrays):
    for step in (0, 4):
        same_arrays(run(branch=plexus_run.folder, step=step, out=tmp_path / str(step)), plexus_run)


def test_a_branch_of_a_branch(plexus_run, knocked_out, tmp_path, same_arrays):
    wanted = {"angiogenesis.activation": -0.16, "angiogenesis.steps": 7}
    late = run(branch=knocked_out.folder, step=5, settings=wanted, out=tmp_path / "late")
    assert ways(late) == [(3, {"activation": 0.16}), (5, {"activation": 0.0})]
    assert [origin["folder"] for origin in late.facts("branch")] == [plexus_run.folder.name, knocked_out.folder.name]
    same_arrays(run(late.folder / "study.toml", tmp_path / "again"), late)
    early = run(branch=knocked_out.folder, step=1, settings={"angiogenesis.activation": 0.1}, out=tmp_path / "early")
    assert ways(early) == [(1, {"activation": 0.16})]
    back = run(branch=knocked_out.folder, step=3, settings={"angiogenesis.activation": 0.16}, out=tmp_path / "back")
    assert ways(back) == [(3, {})]
    same_arrays(back, plexus_run)


def test_what_remembers_can_be_switched_on_and_off(plexus_run, tmp_path):
    variants = (
        {"angiogenesis.matrix": "elastic", "angiogenesis.filament_memory": 0.5},
        {"angiogenesis.matrix": "plastic", "angiogenesis.filament_memory": 0.0},
        {"angiogenesis.matrix": "elastic", "angiogenesis.sensing": "rolled"},
    )
    parent = plexus_run.folder
    for number, settings in enumerate(variants):
        steps = 7 + number
        done = run(branch=parent, settings=settings | {"angiogenesis.steps": steps}, out=tmp_path / str(number))
        assert done.steps()[-1] == steps
        parent = done.folder


def test_values_on_resume_branch_beside_the_run(tiny_disk, tmp_path, stop_at):
    with pytest.raises(Interrupted):
        run("disk", tmp_path / "disk", tiny_disk, progress=stop_at("angiogenesis", 2))
    before, told = contents(tmp_path / "disk"), stop_at()
    done = run(out=tmp_path / "disk", resume=True, settings=OFF, progress=told)
    assert done.folder == tmp_path / "disk-branch"
    assert contents(tmp_path / "disk") == before
    assert told.notes[0].startswith(f"branch of {tmp_path / 'disk'} behind step 2, into {tmp_path / 'disk-branch'}: ")
    again = run(out=tmp_path / "disk", resume=True, step=1, settings=OFF)
    assert again.folder == tmp_path / "disk-branch-2"
    assert again.facts("branch")[0]["step"] == 1


def test_before_the_first_step(tiny_tissue, tissue_run, tmp_path, stop_at):
    with pytest.raises(Interrupted):
        run("small", tmp_path / "run", tiny_tissue, progress=stop_at("angiogenesis", 0))
    with pytest.raises(InputError, match="step 1 was not recorded, the nearest are 0"):
        run(branch=tmp_path / "run", step=1, settings=OFF)
    grown = run("small", tmp_path / "grown", tiny_tissue | {"study.until": "extraction"})
    with pytest.raises(InputError, match=r"step 1 was not recorded, no step of the angiogenesis was"):
        run(branch=grown.folder, step=1, settings=OFF)
    done = run(branch=grown.folder, settings=OFF, out=tmp_path / "off")
    assert done.facts("branch")[0]["step"] == -1
    assert "branch" not in done.settings
    assert len(done.frames) == len([frame for frame in tissue_run.frames if frame.stage == "vasculogenesis"])


def test_from_a_state_in_python(plexus_run):
    steps = []
    keys = vc.Angiogenesis(**plexus_run.settings["angiogenesis"])
    vc.remodel(plexus_run.domain(0), keys, watch=steps.append, start=plexus_run.state(4))
    assert [step.step for step in steps] == [5, 6]
    np.testing.assert_array_equal(steps[-1].state.points, plexus_run.state().points)


def test_what_cannot_be_branched(plexus_run, tmp_path):
    folder = plexus_run.folder
    for settings, message in (
        ({"domain.channel": 0.5}, r"settings: domain.channel = 0.5 would change what was computed with 0.35"),
        ({"study.seed": 4}, r"study.seed = 4 would change"),
        (OFF, r"at step 6 has come to its end by angiogenesis.steps = 6: raise that with --set, or branch from an"),
        ({"angiogenesis.strain_limit": 0.1, "angiogenesis.steps": 9}, r"by angiogenesis.strain_limit = 0.1, or rest,"),
        ({"angiogenesis.actvation": 0.1}, "unknown key angiogenesis.actvation, did you mean"),
    ):
        with pytest.raises(InputError, match=message):
            run(branch=folder, settings=settings, out=tmp_path / "new")
    with pytest.raises(InputError, match=r"step 17 was not recorded, the nearest are 5 and 6"):
        run(branch=folder, step=17, out=tmp_path / "new")
    with pytest.raises(InputError, match="takes its study from there"):
        run("disk", branch=folder, out=tmp_path / "new")
    with pytest.raises(InputError, match="goes with a branch"):
        run("disk", step=3, out=tmp_path / "new")
    with pytest.raises(InputError, match=r"cannot be continued: there is no study\.toml"):
        run(branch=tmp_path, out=tmp_path / "new")
    with pytest.raises(InputError, match="holds a run already"):
        run(branch=folder, step=3, settings=OFF, out=folder)
    assert not (tmp_path / "new").exists()


def test_a_branch_that_cannot_be_written_leaves_nothing(plexus_run, tmp_path, monkeypatch):
    def full(*_):
        raise OSError(28, "No space left on device", "run.vtkhdf")

    monkeypatch.setattr(branch_module.shutil, "copyfile", full)
    with pytest.raises(ComputationError, match=r"run.vtkhdf cannot be written: No space left .*; nothing was begun"):
        run(branch=plexus_run.folder, step=3, settings=OFF, out=tmp_path / "new")
    assert not (tmp_path / "new").exists()


def test_a_study_may_change_its_settings_on_the_way(tmp_path):
    study = tmp_path / "study.toml"
    text = (
        '[domain]\nkind = "disk"\nwidth = 6.0\nheight = 4.0\n[angiogenesis]\nsteps = 3\nactivation = 0.0\n'
        "[output]\nfigures = false\n[[branch]]\nstep = 2\nbefore = {activation = 0.08}\n"
    )
    study.write_text(text)
    done = run(study, tmp_path / "run")
    time = done.metrics["time"]
    assert time[2] > time[1] > 0.0
    assert time[3] == time[2]
    for wrong, message in (
        (("step = 2", "step = 4"), r"steps of \[\[branch\]\] must rise and end by angiogenesis.steps: they are 4, 3"),
        (("step = 2", "step = -1"), r"branch.step = -1 is not a whole number from 0 up"),
        (("step = 2\n", ""), r"branch.step is missing"),
        (("activation = 0.08}", "activatoin = 0.08}"), r"branch.before has activatoin: name keys of \[angiogenesis\]"),
        (("activation = 0.08}", "activation = 8.0}"), r"\[\[branch\]\] step = 2: angiogenesis.activation = 8.0 is not"),
        (("[[branch]]", "[branch]"), r"must be written as \[\[branch\]\]"),
    ):
        study.write_text(text.replace(*wrong))
        with pytest.raises(InputError, match=message):
            run(study, tmp_path / "other")
