"""Records that were damaged from outside: one line with the file and a way out, and nothing left open."""

import subprocess
import sys

import h5py
import pytest

from vasculo.errors import ComputationError, InputError
from vasculo.store.read import open_run
from vasculo.store.record import Record
from vasculo.study import run as study_run


def spoil(path, name):
    """Overwrite the stored bytes of one dataset."""
    with h5py.File(path) as file:
        data = file[name]
        if data.chunks:
            places = [data.id.get_chunk_info(i) for i in range(data.id.get_num_chunks())]
            spans = [(place.byte_offset, place.size) for place in places]
        else:
            spans = [(data.id.get_offset(), data.id.get_storage_size())]
    with path.open("rb+") as file:
        for start, size in spans:
            file.seek(start)
            file.write(b"\xa5" * size)


@pytest.mark.parametrize("way", ["Record.reopen(path, 3)", "Record.amend(path)"])
@pytest.mark.parametrize("what", ["empty", "no run", "no table", "no file of this kind"])
def test_a_record_without_its_groups(tmp_path, way, what):
    path = tmp_path / "run.vtkhdf"
    if what == "empty":
        path.touch()
    elif what == "no file of this kind":
        path.write_text("words\n" * 500)
    else:
        with h5py.File(path, "w") as file:
            file.create_group("VTKHDF")
            if what == "no table":
                file.create_group("run/pillars")
    before = path.read_bytes()
    code = (
        "import sys\nfrom pathlib import Path\nfrom vasculo.store.record import Record\n"
        f"path = Path(sys.argv[1])\ntry:\n    {way}\nexcept Exception as error:\n    print(type(error).__name__, error)"
    )
    done = subprocess.run([sys.executable, "-c", code, str(path)], capture_output=True, text=True, check=False)
    assert done.stderr == ""
    assert done.stdout.startswith(f"InputError {path} cannot be c")
    assert done.stdout.endswith("start the run anew\n")
    assert path.read_bytes() == before


def test_a_refused_record_is_not_kept_locked(tmp_path):
    path = tmp_path / "run.vtkhdf"
    path.touch()
    for _ in range(2):
        with pytest.raises(InputError, match="cannot be changed"):
            Record.amend(path)


def test_a_damaged_step(folder):
    path = folder / "run.vtkhdf"
    spoil(path, "VTKHDF/CellData/force")
    run = open_run(folder)
    with pytest.raises(InputError, match=rf"{path} is damaged at vasculogenesis step 20 \(.*\): .*anew"):
        run.network()
    with pytest.raises(InputError, match="is damaged at angiogenesis step 1 "):
        run.flow(1)


def test_damaged_outlines(folder):
    spoil(folder / "run.vtkhdf", "run/pillars/points")
    with pytest.raises(InputError, match="is damaged at angiogenesis step 3 "):
        open_run(folder).pillars()


def test_a_damaged_fact(folder, monkeypatch):
    run = open_run(folder)
    path = folder / "run.vtkhdf"
    with h5py.File(path, "r+") as file:
        del file["run/stages"]
        file["run/stages"] = "[1, 2"
    with pytest.raises(InputError, match="is damaged in its stages"):
        run.facts("stages")

    def broken(*_):
        raise OSError("Can't synchronously read data (wrong B-tree signature)")

    monkeypatch.setattr(h5py, "File", broken)
    for read in (lambda: run.facts("stages"), run.domain):
        with pytest.raises(InputError, match=r"is damaged in its \w+ \(Can't synchronously read data .*anew"):
            read()


def test_a_record_that_became_busy(folder, monkeypatch):
    run = open_run(folder)

    def busy(*_):
        raise BlockingIOError(11, "Resource temporarily unavailable")

    monkeypatch.setattr(h5py, "File", busy)
    with pytest.raises(InputError, match="wait for its end"):
        run.flow()


@pytest.mark.parametrize(
    ("error", "message"),
    [
        (
            OSError("Can't synchronously read data (filter failed)"),
            r"run.vtkhdf is damaged \(Can't .*start the run anew",
        ),
        (OSError("encoder error -2 when writing image file"), r"cannot be written: encoder error.*--resume"),
        (OSError(28, "No space left on device"), r"cannot be written: No space.*--resume"),
    ],
)
def test_a_read_that_fails_in_a_run_is_no_full_disk(tmp_path, monkeypatch, error, message):
    def fail(*_):
        raise error

    monkeypatch.setattr(study_run, "_compute", fail)
    with pytest.raises(ComputationError, match=message):
        study_run.run("disk", tmp_path / "out")


def test_a_failed_write_is_told_rather_than_what_came_of_it(folder, monkeypatch, fab):
    record = Record.reopen(folder / "run.vtkhdf", 7)

    def torn(*_):
        record._guard.failure = OSError(28, "No space left on device")
        raise OSError("Can't synchronously read data")

    monkeypatch.setattr(record._grid, "append", torn)
    with pytest.raises(OSError, match="No space left") as caught:
        record.add_springs({"step": 1, "time": 0.0}, *fab.tissue_frame(0))
    assert caught.value.errno == 28
    with pytest.raises(OSError, match="No space left"):
        record.close()
    assert len(open_run(folder).frames) == 7
