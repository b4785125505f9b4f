"""A disk that fails under HDF5: an error that can be caught, no crash, and the last flush still readable."""

import os
import signal
import subprocess
import sys
import textwrap

import pytest

from vasculo.store.guarded import GuardedFile, uninterrupted
from vasculo.store.read import open_run

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
    from vasculo.store.record import Record

    record = Record.reopen(folder / "run.vtkhdf", 7)
    monkeypatch.setattr("shutil.disk_usage", lambda _: type("usage", (), {"free": 1000})())
    with pytest.raises(OSError, match="No space left") as caught:
        record.add_springs({"step": 1, "time": 0.0}, *fab.tissue_frame(0))
    assert caught.value.errno == 28
    record.close()
    assert len(open_run(folder).frames) == 7
