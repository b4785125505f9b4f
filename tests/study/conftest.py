"""Tiny runs, made once."""

import pytest

from vasculo.study.run import run

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
