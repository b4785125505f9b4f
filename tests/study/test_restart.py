"""A run that is stopped and goes on leaves the same bits as one in one go, whatever its cells remember."""

import os
import signal
import subprocess
import sys
import time

import pytest

from vasculo.errors import InputError
from vasculo.store.read import open_run
from vasculo.study.run import Interrupted, run

VARIANTS = {
    "plain": {},
    "memory": {"angiogenesis.matrix": "elastic", "angiogenesis.filament_memory": 0.5},
    "rolled": {"angiogenesis.sensing": "rolled", "angiogenesis.roll_seed": 3, "angiogenesis.erosion": 0.1},
    "hanging": {"angiogenesis.cells": "hanging", "angiogenesis.traction": 0.02, "angiogenesis.steps": 3},
}
"""What is remembered from step to step: nothing, filaments and matrix, the random numbers, the matrix alone."""


@pytest.mark.parametrize("name", VARIANTS)
def test_stopped_and_resumed(plexus_run, tiny_plexus, tmp_path, stop_at, same_arrays, name):
    settings = tiny_plexus | VARIANTS[name]
    whole = run("chains", tmp_path / "whole", settings) if VARIANTS[name] else plexus_run
    events = [event.step for event in whole.events]
    cut = events[0] if events else 1
    assert name == "hanging" or max(events) > cut  # something happens on both sides
    for step in (cut, cut + 1) if name == "plain" else (cut,):
        with pytest.raises(Interrupted):
            run("chains", tmp_path / "half", settings, progress=stop_at("angiogenesis", step))
        half = open_run(tmp_path / "half")
        assert half.steps() == list(range(step + 1))
        done = run(out=tmp_path / "half", resume=True)
        same_arrays(done, whole)
        assert done.events == whole.events or name == "rolled"  # NaN is not itself
        for path in done.folder.iterdir():
            path.unlink()


def test_states_between_recorded_steps_are_made_again(tiny_plexus, tmp_path, stop_at, same_arrays):
    settings = tiny_plexus | {"output.step_every": 4}
    whole = run("chains", tmp_path / "whole", settings)
    assert whole.steps() == [0, 4, 6]
    with pytest.raises(Interrupted):
        run("chains", tmp_path / "half", settings, progress=stop_at("angiogenesis", 3))
    assert open_run(tmp_path / "half").steps() == [0]
    same_arrays(run(out=tmp_path / "half", resume=True), whole)


@pytest.mark.slow
def test_a_killed_run_goes_on(plexus_run, tiny_plexus, tmp_path, same_arrays):
    """SIGTERM ends a run like Ctrl-C; SIGKILL may come at any moment, as often as it likes."""
    folder = tmp_path / "run"
    script = (
        "import sys\nfrom vasculo.study.run import run\n"
        f"folder = {str(folder)!r}\n"
        f"run('chains', folder, {tiny_plexus!r}) if sys.argv[1] == 'new' else run(out=folder, resume=True)"
    )
    for number, blow in enumerate((signal.SIGKILL, signal.SIGKILL, signal.SIGTERM)):
        word = "resume" if number else "new"
        process = subprocess.Popen([sys.executable, "-c", script, word], stderr=subprocess.PIPE, text=True)
        rows = number + 2  # a header and a row more each time
        deadline = time.monotonic() + 120
        table = folder / "metrics.csv"
        while time.monotonic() < deadline and process.poll() is None:
            if table.exists() and table.read_text().count("\n") > rows:
                break
            time.sleep(0.002)
        process.send_signal(blow)
        _, errors = process.communicate(timeout=120)
        if blow == signal.SIGTERM and process.returncode:
            assert "Interrupted" in errors
    same_arrays(run(out=folder, resume=True), plexus_run)
    assert not list(folder.glob(".*"))


def test_more_steps_in_place(plexus_run, tiny_plexus, tmp_path, same_arrays):
    short = run("chains", tmp_path / "run", tiny_plexus | {"angiogenesis.steps": 2})
    note = "angiogenesis.steps = 6 instead of 2"
    longer = run(out=short.folder, resume=True, settings={"angiogenesis.steps": 6, "study.title": "Longer"})
    same_arrays(longer, plexus_run)
    assert longer.id == short.id
    assert longer.settings["study"]["title"] == "Longer"
    assert longer.settings["angiogenesis"]["steps"] == 6
    assert longer.facts("extended") == [
        {
            "step": 2,
            "changes": [["study.title", short.settings["study"]["title"], "Longer"], ["angiogenesis.steps", 2, 6]],
        }
    ]
    assert note in (short.folder / "log.txt").read_text()
    assert [stage["name"] for stage in longer.facts("stages")] == ["domain", "angiogenesis"]
    with pytest.raises(InputError, match=r"has come to step 6, behind angiogenesis.steps = 3: give 6 or more"):
        run(out=short.folder, resume=True, settings={"angiogenesis.steps": 3})
    same_arrays(run(out=short.folder, resume=True), plexus_run)
    same_arrays(run(short.folder, tmp_path / "again"), plexus_run)


def test_a_run_that_came_to_its_end_early_stays_there(tiny_plexus, tmp_path, same_arrays):
    whole = run("chains", tmp_path / "whole", tiny_plexus | {"angiogenesis.strain_limit": 0.12})
    last = whole.steps()[-1]
    assert 0 < last < 6
    same_arrays(run(out=whole.folder, resume=True), open_run(whole.folder))
    assert open_run(whole.folder).steps()[-1] == last


def test_a_tissue_that_was_not_finished_begins_again(tissue_run, tiny_tissue, tmp_path, stop_at, same_arrays):
    with pytest.raises(Interrupted):
        run("small", tmp_path / "half", tiny_tissue, progress=stop_at("vasculogenesis", 1))
    same_arrays(run(out=tmp_path / "half", resume=True), tissue_run)


def test_a_checkpoint_of_before_is_refused(tiny_disk, tmp_path):
    import h5py

    done = run("disk", tmp_path / "run", tiny_disk)
    with h5py.File(done.folder / "checkpoint.h5", "r+") as file:
        file.attrs["format"] = 1
    with pytest.raises(InputError, match=r"checkpoint format 1, this version reads 2: .* start it anew") as caught:
        run(out=done.folder, resume=True)
    assert os.linesep not in str(caught.value)
