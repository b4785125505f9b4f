"""Two tiny runs to draw."""

import pytest

from vasculo.draw.report import write_report
from vasculo.study.run import run


@pytest.fixture(scope="session")
def disk_run(tmp_path_factory):
    """A disk, two steps."""
    settings = {"domain.width": 6.0, "domain.height": 4.0, "angiogenesis.steps": 2, "output.figures": False}
    return run("disk", tmp_path_factory.mktemp("runs") / "disk", settings)


@pytest.fixture(scope="session")
def tissue_run(tmp_path_factory):
    """All stages on a tiny tissue, with units."""
    settings = {
        "tissue.nodes": 900,
        "vasculogenesis.preset": "fine",
        "angiogenesis.steps": 1,
        "output.growth_every": 30,
        "output.figures": False,
        "units.length": 1000.0,
        "units.shear": 500.0,
    }
    return run("small", tmp_path_factory.mktemp("runs") / "tissue", settings)


@pytest.fixture(scope="session")
def disk_report(disk_run):
    """The report of the disk, in its folder."""
    return write_report(disk_run)


@pytest.fixture(scope="session")
def tissue_report(tissue_run):
    """The report of the tissue, in its folder."""
    return write_report(tissue_run)
