"""A disk that fails under HDF5: an error that can be caught, no crash, and the last flush still readable."""

import os
import signal
import struct
import subprocess
import sys
import textwrap

import pytest

from vasculo.errors import InputError
from vasculo.store.guarded import GuardedFile, mend, undo_path, uninterrupted
from vasculo.store.read import open_run
from vasculo.store.record import Record

SCRIPT = """
    import resource, sys
    from pathlib import Path
    sys.path.insert(0, {here!r})
    from conftest import STUDY, fill
    from vasculo.store.record import Record
    record = Record.create(Path({path!r}), STUDY, "0")
    fill(record, growth=2, remodelling=0)
    size = Path({path!r}).stat().st_size
    resource.setrlimit(resource.RLIMIT_FSIZE, (size + 3000, size + 3000))
    try:
        fill(record, growth=40, remodelling=0)
    except OSError as error:
        print("caught", error.errno, error.filename)
    try:
        record.close()
    except OSError as error:
        print("closed", error.errno)
"""


def test_a_failing_disk_is_an_error_and_no_crash(tmp_path):
    path = tmp_path / "run.vtkhdf"
    code = textwrap.dedent(SCRIPT.format(here=os.path.dirname(__file__), path=str(path)))  # noqa: PTH120
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == ["caught", "27", str(path), "closed", "27"]
    assert done.stderr == ""


@pytest.mark.parametrize("room", [0, 3000, 40_000])
def test_a_failing_disk_leaves_the_last_flush(tmp_path, room):
    """HDF5 writes over chunks and metadata before it comes to the write that fails."""
    path = tmp_path / "run.vtkhdf"
    script = SCRIPT.replace("size + 3000, size + 3000", f"size + {room}, size + {room}")
    code = textwrap.dedent(script.format(here=os.path.dirname(__file__), path=str(path)))  # noqa: PTH120
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "caught 27" in done.stdout
    run = open_run(path)
    assert len(run.frames) >= 2
    for frame in run.frames:
        assert len(run.network(frame.step).points)
    Record.reopen(path, len(run.frames)).close()


KILLED = """
    import os, signal, sys
    from pathlib import Path
    sys.path.insert(0, {here!r})
    from conftest import STUDY, fill
    from vasculo.store.guarded import GuardedFile
    from vasculo.store.record import Record
    record = Record.create(Path({path!r}), STUDY, "0")
    fill(record, growth=2, remodelling=1)
    real, left = GuardedFile.write, [{count}]
    def write(self, data):
        left[0] -= 1
        if left[0] < 0:
            self._keep(self.tell(), self.tell() + len(data))
            self._file.write(bytes(len(data) // 2))  # half of it, and wrong
            os.kill(os.getpid(), signal.SIGKILL)
        return real(self, data)
    GuardedFile.write = write
    fill(record, growth=0, remodelling=40)
"""


@pytest.mark.parametrize("count", [0, 3, 20, 60])
def test_a_killed_process_leaves_the_last_flush(tmp_path, count):
    path = tmp_path / "run.vtkhdf"
    code = textwrap.dedent(KILLED.format(here=os.path.dirname(__file__), path=str(path), count=count))  # noqa: PTH120
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == -signal.SIGKILL, done.stderr
    run = open_run(path)
    assert len(run.frames) >= 3
    assert not undo_path(path).exists()
    for step in run.steps():
        assert len(run.flow(step).pressure)
        assert len(run.state(step).points)
    Record.reopen(path, len(run.frames)).close()


def test_pieces_that_were_cut_short_are_not_put_back(tmp_path):
    path = tmp_path / "f"
    path.write_bytes(b"01xx45yy+++")
    piece = struct.Struct("<qq").pack
    undo_path(path).write_bytes(piece(8, 0) + piece(2, 2) + b"23" + piece(6, 2) + b"6")
    mend(path)
    assert path.read_bytes() == b"012345yy"
    assert not undo_path(path).exists()
    mend(path)
    assert path.read_bytes() == b"012345yy"


def test_a_file_that_grows_keeps_no_undo(tmp_path):
    path = tmp_path / "f"
    file = GuardedFile(path, "x")
    file.write(b"0123")
    file.check()
    file.write(b"4567")
    assert undo_path(path).read_bytes() == b""
    with pytest.raises(InputError, match="being written by another run"):
        mend(path)
    file.seek(0)
    file.write(b"ab")
    assert undo_path(path).read_bytes().endswith(b"01")
    file.check()
    assert undo_path(path).read_bytes() == b""
    file.close()
    assert [item.name for item in tmp_path.iterdir()] == ["f"]
    assert path.read_bytes() == b"ab234567"


def test_what_was_written_over_comes_back(tmp_path):
    path = tmp_path / "f"
    file = GuardedFile(path, "x")
    file.write(b"0123456789")
    file.check()
    file.seek(2)
    file.write(b"abc")
    file.truncate(4)
    file.seek(3)
    file.write(b"defghijklmn")
    file.failure = OSError(28, "No space left on device")
    with pytest.raises(OSError, match="No space"):
        file.check()
    assert path.read_bytes() == b"0123456789"
    file.close()


def test_a_close_without_check_brings_back_too(tmp_path):
    path = tmp_path / "f"
    file = GuardedFile(path, "x")
    file.write(b"0123456789")
    file.check()
    file.seek(0)
    file.write(b"abc")
    file.check()
    file.seek(8)
    file.write(b"defg")
    file.failure = OSError(28, "No space left on device")
    file.close()
    assert path.read_bytes() == b"abc3456789"


def test_the_first_failure_stays(tmp_path, monkeypatch):
    file = GuardedFile(tmp_path / "f", "x")
    file.write(b"abc")
    file.check()

    class Broken:
        def __init__(self, inner):
            self.inner = inner

        def __getattr__(self, name):
            return getattr(self.inner, name)

        def write(self, _):
            raise OSError(28, "No space left on device")

    monkeypatch.setattr(file, "_file", Broken(file._file))
    assert file.write(b"defg") == 4
    assert file.write(b"more") == 4
    buffer = bytearray(b"zzzz")
    file.seek(2)
    assert file.readinto(buffer) == 4
    assert bytes(buffer) == b"c\0\0\0"
    with pytest.raises(OSError, match="No space") as caught:
        file.check()
    assert caught.value.filename == str(tmp_path / "f")
    file.close()
    assert (tmp_path / "f").read_bytes() == b"abc"


def test_ctrl_c_waits():
    seen = []

    def work():
        with uninterrupted():
            signal.raise_signal(signal.SIGINT)
            seen.append("block done")
        seen.append("never")

    with pytest.raises(KeyboardInterrupt):
        work()
    assert seen == ["block done"]


def test_a_full_disk_is_noticed_before_anything_is_torn(folder, monkeypatch, fab):
    record = Record.reopen(folder / "run.vtkhdf", 7)
    monkeypatch.setattr("shutil.disk_usage", lambda _: type("usage", (), {"free": 1000})())
    with pytest.raises(OSError, match="No space left") as caught:
        record.add_springs({"step": 1, "time": 0.0}, *fab.tissue_frame(0))
    assert caught.value.errno == 28
    record.close()
    assert len(open_run(folder).frames) == 7
