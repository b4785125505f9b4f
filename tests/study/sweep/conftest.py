"""A small sweep of a disk: four runs of two steps each."""

import pytest

from vasculo.study.sweep.sweep import _begin as begin
from vasculo.study.sweep.work import work

HEIGHTS = {
    "sweep": {"study": "disk", "title": "Heights", "seeds": 2},
    "settings": {"angiogenesis.steps": 3, "domain.width": 6.0, "units.length": 30.0},
    "vary": {"domain.height": [4.0, 5.0]},
}


@pytest.fixture
def heights():
    """The sweep as a mapping, to be changed at will."""
    return {name: dict(table) for name, table in HEIGHTS.items()}


@pytest.fixture(scope="session")
def done_here(tmp_path_factory):
    """The sweep, done in this process."""
    found = begin(HEIGHTS, tmp_path_factory.mktemp("sweeps") / "heights")
    for run in found.plan.runs:
        outcome = work(found.folder, run.name, found.plan.overrides(run), found.names)
        assert outcome.status == "complete", outcome.line
        found.outcomes[run.name] = outcome
    found.write_tables()
    return found
