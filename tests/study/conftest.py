"""Tiny runs, made once, and what tells whether two of them are the same."""

import hashlib

import h5py
import numpy as np
import pytest

from vasculo.study.run import run
from vasculo.study.watch import Silence

TINY_TISSUE = {
    "tissue.nodes": 900,
    "vasculogenesis.preset": "fine",
    "angiogenesis.steps": 2,
    "output.growth_every": 30,
    "output.figures": False,
}
TINY_DISK = {
    "domain.width": 6.0,
    "domain.height": 4.0,
    "angiogenesis.steps": 3,
    "output.figures": False,
}
TINY_PLEXUS = {
    "domain.pillars": 6,
    "domain.channel": 0.35,
    "domain.pad": 0.5,
    "study.seed": 0,
    "angiogenesis.steps": 6,
    "angiogenesis.membrane_spacing": 0.3,
    "angiogenesis.activation": 0.16,
    "output.figures": False,
}


class StopAt(Silence):
    """Presses Ctrl-C when a stage reaches a step, and keeps what it was told."""

    def __init__(self, stage="", step=0):
        self.wanted = stage, step
        self.stage = ""
        self.notes = []

    def begin(self, stage, _):
        self.stage = stage

    def note(self, text):
        self.notes.append(text)

    def advance(self, done, _total, _text):
        if self.stage == self.wanted[0] and done >= self.wanted[1]:
            raise KeyboardInterrupt


def checksums(path):
    """A checksum of every array in a record, by name; wall times and words are left out."""
    found = {}

    def note(name, item):
        words = name.startswith("run/") and item.dtype == object
        if isinstance(item, h5py.Dataset) and not words and not name.startswith("run/metrics/seconds"):
            found[name] = hashlib.sha256(np.ascontiguousarray(item[()]).tobytes()).hexdigest()

    with h5py.File(path) as file:
        file.visititems(lambda name, item: note(name, item) if isinstance(item, h5py.Dataset) else None)
    return found


@pytest.fixture(scope="session")
def stop_at():
    """Progress that presses Ctrl-C at a step of a stage."""
    return StopAt


@pytest.fixture(scope="session")
def same_arrays():
    """Check that two runs recorded the same bits, in every array but the wall times."""

    def check(one, two):
        mine, theirs = checksums(one.path), checksums(two.path)
        assert len(mine) > 60
        assert [name for name in mine | theirs if mine.get(name) != theirs.get(name)] == []

    return check


@pytest.fixture(scope="session")
def tiny_plexus():
    """Settings of a study of six pillars that merge within six steps."""
    return dict(TINY_PLEXUS)


@pytest.fixture(scope="session")
def plexus_run(tmp_path_factory):
    """Six pillars, six steps, without figures."""
    return run("chains", tmp_path_factory.mktemp("runs") / "plexus", TINY_PLEXUS)


@pytest.fixture(scope="session")
def tiny_tissue():
    """Settings of a study that goes through all stages in seconds."""
    return dict(TINY_TISSUE)


@pytest.fixture(scope="session")
def tiny_disk():
    """Settings of a study of one disk that takes a second."""
    return dict(TINY_DISK)


@pytest.fixture(scope="session")
def tissue_run(tmp_path_factory):
    """All stages on a tiny tissue, without figures."""
    return run("small", tmp_path_factory.mktemp("runs") / "tissue", TINY_TISSUE)


@pytest.fixture(scope="session")
def disk_run(tmp_path_factory):
    """A disk, three steps, without figures."""
    return run("disk", tmp_path_factory.mktemp("runs") / "disk", TINY_DISK)
