"""Sweeps on workers: one killed in the middle, one stopped and gone on with, a scheduler elsewhere."""

import fcntl
import os
import signal
import socket
import threading
import time

import numpy as np
import pytest

from vasculo.errors import ComputationError, InputError
from vasculo.springs.threads import get_threads, set_threads
from vasculo.study.sweep import cluster as cluster_module
from vasculo.study.sweep.home import LOCK
from vasculo.study.sweep.results import open_sweep
from vasculo.study.sweep.sweep import Stopped, sweep
from vasculo.study.watch import Silence


class Told(Silence):
    """Keeps what it was told; presses Ctrl-C when so many runs are done."""

    def __init__(self, stop_at=None):
        self.notes, self.stop_at = [], stop_at

    def note(self, text):
        self.notes.append(text)

    def advance(self, done, _total, _text):
        if done == self.stop_at:
            raise KeyboardInterrupt


@pytest.fixture
def _threads():
    """The number of threads of this process, brought back at the end."""
    before = get_threads()
    yield
    set_threads(before)


def same_tables(one, two):
    """Compare all columns but the wall times; return how many there are."""
    names = [name for name in one if name != "seconds"]
    assert names == [name for name in two if name != "seconds"]
    for name in names:
        np.testing.assert_array_equal(one[name], two[name], err_msg=name)
    return len(names)


class Killer(threading.Thread):
    """Kills the process that works on a run as soon as the run has recorded its first step."""

    def __init__(self, folder):
        super().__init__(daemon=True)
        self.folder, self.killed = folder, None

    def run(self):
        end = time.monotonic() + 120.0
        while self.killed is None and time.monotonic() < end:
            table = self.folder / "metrics.csv"
            if table.is_file() and table.read_text().count("\n") >= 2 and (holder := self.holder()):
                os.kill(holder, signal.SIGKILL)
                self.killed = holder
            time.sleep(0.005)

    def holder(self):
        """Process that holds the folder; None when none does."""
        with (self.folder / LOCK).open() as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_SH | fcntl.LOCK_NB)
            except BlockingIOError:
                return int(lock.read().strip() or 0) or None  # empty while it is being written
        return None


@pytest.mark.slow
def test_a_killed_worker_and_a_stop_change_nothing_in_the_table(heights, done_here, tmp_path, monkeypatch):
    out = tmp_path / "sweep"
    told = Told(stop_at=1)
    with socket.create_server(("127.0.0.1", 0)) as taken:
        monkeypatch.setattr(cluster_module, "DASHBOARD", taken.getsockname()[1])
        with pytest.raises(Stopped, match=rf"go on with: vasculo sweep --resume --out {out}"):
            sweep(heights, out, workers=2, progress=told)
        links = [note.split()[-1] for note in told.notes if "dashboard: http://127.0.0.1:" in note]
        assert len(links) == 1
        assert f":{taken.getsockname()[1]}/" not in links[0]
    half = open_sweep(out)
    assert 1 <= (half.table["status"] == "complete").sum() < 4
    assert not (out / "stop").exists()

    last = half.table["run"][half.table["status"] == "waiting"][-1]
    killer = Killer(out / "runs" / str(last))
    killer.start()
    found = sweep(None, out, workers=2, resume=True)
    killer.join()
    assert killer.killed not in {None, os.getpid()}
    log = (out / "runs" / last / "log.txt").read_text()
    assert "goes on behind step" in log
    assert found.complete
    assert not found.failures
    assert same_tables(found.table, done_here.table) > 25
    assert same_tables(open_sweep(out).table, done_here.table) > 25
    page = (out / "sweep.html").read_text()
    assert page.count('href="runs/') == 4
    assert (out / "diagram.png").stat().st_size > 5_000


@pytest.mark.slow
@pytest.mark.usefixtures("_threads")
def test_at_a_scheduler(heights, done_here, tmp_path):
    from distributed import LocalCluster

    heights["sweep"]["seeds"] = 1
    with LocalCluster(n_workers=1, threads_per_worker=1, processes=False, dashboard_address=None) as cluster:
        address = cluster.scheduler_address
        found = sweep(heights, tmp_path / "sweep", scheduler=address)
        assert found.complete
        heights["sweep"]["seeds"] = 2
        grown = sweep(heights, tmp_path / "sweep", scheduler=address, resume=True)
    assert grown.complete
    assert grown.table["run"].tolist() == ["0001", "0002", "0003", "0004"]
    assert grown.table["seed"].tolist() == [0, 0, 1, 1]
    order = [0, 2, 1, 3]
    np.testing.assert_array_equal(grown.table["aspect_ratio"][order], done_here.table["aspect_ratio"])


@pytest.mark.slow
@pytest.mark.usefixtures("_threads")
def test_workers_that_do_several_tasks_at_once_are_refused(heights, tmp_path):
    from distributed import LocalCluster

    with (
        LocalCluster(n_workers=1, threads_per_worker=2, processes=False, dashboard_address=None) as cluster,
        pytest.raises(InputError, match="does 2 tasks at once: start it with --nthreads 1"),
    ):
        sweep(heights, tmp_path / "sweep", scheduler=cluster.scheduler_address)


def test_a_scheduler_that_is_away_is_told(heights, tmp_path, monkeypatch):
    monkeypatch.setattr(cluster_module, "ANSWER", 0.5)
    with pytest.raises(InputError, match=r"scheduler tcp://127\.0\.0\.1:9 does not answer within 0\.5 s"):
        sweep(heights, tmp_path / "sweep", scheduler="tcp://127.0.0.1:9")
    with pytest.raises(InputError, match="'no address' is no address, as tcp://host:8786"):
        sweep(heights, tmp_path / "other", scheduler="no address")


@pytest.mark.parametrize("workers", [0, -1, True, 1.5])
def test_workers_must_be_a_number(heights, tmp_path, workers):
    with pytest.raises(InputError, match="is not a whole number from 1 up"):
        sweep(heights, tmp_path / "sweep", workers=workers)
    assert not (tmp_path / "sweep").exists()


def test_workers_or_a_scheduler_not_both(heights, tmp_path):
    with pytest.raises(InputError, match="give one of them"):
        sweep(heights, tmp_path / "sweep", workers=2, scheduler="tcp://127.0.0.1:9")


def test_going_on_needs_the_same_sweep(heights, done_here, tmp_path):
    with pytest.raises(InputError, match=r"holds no sweep: there is no plan\.json"):
        sweep(None, tmp_path, resume=True)
    with pytest.raises(InputError, match="say which sweep to go on with"):
        sweep(None, None, resume=True)
    heights["settings"]["angiogenesis.steps"] = 4
    with pytest.raises(InputError, match=r"was begun with \[settings\] angiogenesis\.steps = 3, "):
        sweep(heights, done_here.folder, resume=True)
    heights["settings"]["angiogenesis.steps"] = 3
    heights["vary"] = {"domain.radius": [0.5]}
    with pytest.raises(InputError, match=r"begun over domain\.height, not over domain\.radius"):
        sweep(heights, done_here.folder, resume=True)
    heights["sweep"]["study"] = "chains"
    heights["vary"] = {"domain.height": [5.0]}
    heights["settings"] = {}
    with pytest.raises(InputError, match=r"was begun with another chains\.toml"):
        sweep(heights, done_here.folder, resume=True)


def test_a_scheduler_that_goes_away_is_told(done_here):
    from types import SimpleNamespace

    from vasculo.study.sweep.sweep import _outcome_of as outcome_of

    lost = SimpleNamespace(status="cancelled")
    with pytest.raises(ComputationError, match="the scheduler went away; what was done is kept"):
        outcome_of(done_here.plan.runs[0], lost, done_here.folder)


def test_a_worker_that_is_killed_again_and_again_is_a_failure(done_here):
    from types import SimpleNamespace

    from distributed.scheduler import KilledWorker

    from vasculo.study.sweep.sweep import _outcome_of as outcome_of

    error = KilledWorker("key", None, 3)
    outcome = outcome_of(done_here.plan.runs[0], SimpleNamespace(status="error", exception=lambda: error), None)
    assert outcome.status == "failed"
    assert outcome.line == "its worker was killed 4 times, most likely it ran out of memory"
