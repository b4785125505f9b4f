"""A tiny run of all stages, and the viewer's own checks raised as errors."""

import pytest

from vasculo.store.units import Units
from vasculo.study.run import run

rerun = pytest.importorskip("rerun")


@pytest.fixture(autouse=True)
def _strict():
    before = rerun.strict_mode()
    rerun.set_strict_mode(True)
    yield
    rerun.set_strict_mode(before)


@pytest.fixture(scope="session")
def tissue_run(tmp_path_factory):
    """All stages on a tiny tissue, with units, without figures."""
    settings = {
        "tissue.nodes": 900,
        "vasculogenesis.preset": "fine",
        "angiogenesis.steps": 2,
        "output.growth_every": 10,
        "output.figures": False,
        "units.length": 1000.0,
    }
    return run("small", tmp_path_factory.mktemp("runs") / "tissue", settings)


@pytest.fixture
def units():
    return Units(length=1000.0)
