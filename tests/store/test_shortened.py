"""Records that were cut short, and records and tables of earlier and later versions."""

import fcntl
import gzip
import os
import shutil
import struct
from pathlib import Path

import h5py
import numpy as np
import pytest
from typer.testing import CliRunner

from vasculo.cli import app
from vasculo.errors import InputError
from vasculo.store.guarded import undo_path
from vasculo.store.read import open_run
from vasculo.store.shortened import ShortenedFile, whole_length
from vasculo.store.table import COLUMNS, from_csv

DATA = Path(__file__).parent / "data"


@pytest.fixture
def with_files(folder, fab):
    """The fabricated record with its table and its study beside it, and what it gives when it is whole."""
    run = open_run(folder)
    lines = [",".join(COLUMNS[:4])]
    lines += [
        f"{stage},{int(step)},{time!r},{'' if np.isnan(count) else int(count)}"
        for stage, step, time, count in zip(*(run.metrics[name] for name in COLUMNS[:4]), strict=True)
    ]
    (folder / "metrics.csv").write_text("\n".join(lines) + "\n")
    (folder / "study.toml").write_text(fab.STUDY)
    return folder, run


def cut(folder, size):
    """Cut the record; return what it holds then."""
    path = folder / "run.vtkhdf"
    os.truncate(path, size)
    return path.read_bytes()


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9, 0.99, 1.0])
def test_what_is_whole_opens(with_files, share):
    folder, whole = with_files
    length = whole.path.stat().st_size
    assert whole_length(whole.path) == length
    there = min(int(share * length), length - 1)
    kept = cut(folder, there)
    try:
        run = open_run(folder)
    except InputError as error:
        line = str(error)
        assert f"cut short: {there:,} of its {length:,} bytes are there, and no step is whole" in line
        assert "the numbers of all steps are in metrics.csv; the settings are in study.toml" in line
        assert line.endswith(f"`vasculo run {folder / 'study.toml'}` runs it again")
        assert "\n" not in line
        assert share < 0.99, "nearly all of the record is there, and nothing of it opens"
    else:
        assert not run.complete
        assert run.settings == whole.settings
        assert f"{len(run.frames)} of 7 recorded steps are whole" in run.caveat
        assert 0 < len(run.frames) <= 7
        np.testing.assert_array_equal(run.metrics["step"], whole.metrics["step"])
        np.testing.assert_array_equal(run.metrics["time"], whole.metrics["time"])
        for step in run.steps("vasculogenesis"):
            np.testing.assert_array_equal(run.network(step).forces, whole.network(step).forces)
        for step in run.steps():
            np.testing.assert_array_equal(run.flow(step).pressure, whole.flow(step).pressure)
            for mine, theirs in zip(run.domain(step).pillars, whole.domain(step).pillars, strict=True):
                np.testing.assert_array_equal(mine, theirs)
    assert (folder / "run.vtkhdf").read_bytes() == kept, "a cut file is never changed"


def test_a_step_in_the_midst_is_named_by_its_number_when_those_before_it_are_lost(with_files):
    folder, whole = with_files
    cut(folder, whole.path.stat().st_size - 1)
    run = open_run(folder)
    run.frames = tuple(frame for frame in run.frames if frame.step != 1)
    last = run.steps()[-1]
    np.testing.assert_array_equal(run.pillars(last).node_shear[0], whole.pillars(last).node_shear[0])


def test_a_table_that_is_cut_too_is_no_help_and_no_harm(with_files):
    folder, whole = with_files
    table = folder / "metrics.csv"
    table.write_text(table.read_text()[:-12])
    cut(folder, int(0.97 * whole.path.stat().st_size))
    assert len(open_run(folder).frames) > 0


def test_a_cut_record_is_told_by_measure_and_is_not_continued(with_files):
    folder, whole = with_files
    kept = cut(folder, whole.path.stat().st_size - 1)
    told = CliRunner().invoke(app, ["measure", str(folder)])
    assert told.exit_code == 0
    assert "recorded steps are whole" in " ".join(told.output.split())
    again = CliRunner().invoke(app, ["run", "--resume", "--out", str(folder)])
    assert again.exit_code == 2
    assert len(again.stderr.strip().splitlines()) == 1
    assert whole.path.read_bytes() == kept


def test_what_a_killed_process_left_does_not_fill_a_gap_with_zeros(with_files):
    folder, whole = with_files
    length = whole.path.stat().st_size
    kept = cut(folder, length - 1)
    piece = struct.pack("<qq", 0, 48) + kept[:48]
    left = struct.pack("<qq", length, 0) + piece
    undo_path(whole.path).write_bytes(left)
    assert 0 < len(open_run(folder).frames) <= 7
    assert whole.path.read_bytes() == kept
    assert undo_path(whole.path).read_bytes() == left


def test_a_cut_record_that_is_being_written(with_files):
    folder, whole = with_files
    cut(folder, whole.path.stat().st_size - 1)
    with whole.path.open("rb+") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        with pytest.raises(InputError, match="being written by a run that goes on: wait for its end"):
            open_run(folder)


def test_a_file_that_says_it_is_longer(tmp_path):
    path = tmp_path / "a"
    path.write_bytes(b"abcdef")
    assert whole_length(path) == 0
    with ShortenedFile(path, 10) as file:
        assert file.readable()
        assert file.seekable()
        assert file.seek(0, 2) == 10
        file.seek(2)
        assert file.read(4) == b"cdef"
        assert file.tell() == 6
        with pytest.raises(OSError, match="bytes 6 to 8 are missing"):
            file.read(2)


@pytest.fixture
def old(tmp_path):
    """A run of four pillars that merge, made by the version that wrote record format 1."""
    with gzip.open(DATA / "format-1.vtkhdf.gz") as packed, (tmp_path / "run.vtkhdf").open("wb") as file:
        shutil.copyfileobj(packed, file)
    shutil.copy(DATA / "format-1.csv", tmp_path / "metrics.csv")
    return tmp_path


def test_a_run_of_format_1(old):
    run = open_run(old)
    with h5py.File(run.path) as file:
        assert file["run"].attrs["format"] == 1
    assert run.complete
    assert run.caveat == ""
    assert run.steps() == [0, 2, 4]
    assert [len(run.pillars(step).outlines) for step in run.steps()] == [4, 1, 1]
    assert len(run.events) == 3
    assert {event.kind for event in run.events} == {"merge"}
    assert run.flow().wall_shear.size > 20
    stages, table = from_csv(old / "metrics.csv")
    assert stages == list(run.metrics["stage"])
    for name in COLUMNS[1:]:
        np.testing.assert_array_equal(run.metrics[name], table[name])
    assert np.isnan(run.metrics["corridors"]).all(), "a column that this version did not have yet"


@pytest.mark.parametrize("command", [["measure"], ["draw"], ["draw", "--what", "shear"], ["report"]])
def test_commands_read_a_run_of_format_1(old, command):
    done = CliRunner().invoke(app, [command[0], str(old), *command[1:]], catch_exceptions=False)
    assert done.exit_code == 0, done.output
    if command[0] == "report":
        assert "Sixteen pillars" in (old / "report.html").read_text()


def test_a_run_of_format_1_is_not_continued(old):
    done = CliRunner().invoke(app, ["run", "--resume", "--out", str(old)])
    assert done.exit_code == 2
    assert len(done.stderr.strip().splitlines()) == 1


def test_a_run_of_a_later_version(old):
    with h5py.File(old / "run.vtkhdf", "r+") as file:
        file["run"].attrs.update({"format": 7, "version": "3.2"})
    with pytest.raises(InputError, match=r"record format 7, made by vasculo 3.2; vasculo .* reads formats 1 and 2: "):
        open_run(old)


def test_a_table_with_the_columns_of_an_earlier_version(tmp_path):
    path = tmp_path / "t.csv"
    path.write_text("stage,step,time,pillars\nangiogenesis,0,0.5,\nangiogenesis,3,1.5,12\n")
    stages, table = from_csv(path)
    assert stages == ["angiogenesis", "angiogenesis"]
    assert table["pillars"][1] == 12
    assert np.isnan(table["pillars"][0])
    assert np.isnan(table["order"]).all()
    assert set(table) == set(COLUMNS[1:])
    path.write_text("stage,step,time,wheels\nangiogenesis,0,0.5,4\n")
    with pytest.raises(InputError, match="no table of a run"):
        from_csv(path)
