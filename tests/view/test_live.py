"""A run that is shown while it goes: the first and last steps in any case, and never at the run's expense."""

import pytest

from vasculo.pillars.angiogenesis import remodel
from vasculo.pillars.parameters import Angiogenesis
from vasculo.study.rows import growth_row, remodel_row
from vasculo.tissue.lattice import lattice
from vasculo.tissue.parameters import Vasculogenesis
from vasculo.tissue.vasculogenesis import grow_plexus
from vasculo.view.live import OFTEN, SMALL, Live


class Clock:
    """Time that passes only when told."""

    def __init__(self):
        self.now = 0.0

    def __call__(self):
        return self.now


@pytest.fixture
def steps():
    """All checks of a tiny vasculogenesis."""
    seen = []
    grow_plexus(lattice(nodes=400, seed=1), Vasculogenesis(pillar_spacing=0.3), 1, seen.append)
    return seen


@pytest.fixture
def live(units):
    import rerun

    recording = rerun.RecordingStream("test")
    recording.memory_recording()
    clock, told = Clock(), []
    made = Live(recording, units, growth_row, remodel_row, tell=told.append, clock=clock)
    made.told = told
    return made


def test_steps_that_come_too_fast_are_left_out_but_not_the_last(live, steps):
    for step in steps:
        live.growth(step)
    assert live.shown == 1
    assert live.left_out == len(steps) - 1
    live.end()
    assert live.shown == 2


def test_a_step_is_shown_as_often_as_agreed(live, steps):
    for step in steps[:8]:
        live.growth(step)
        live.clock.now += 1.01 * OFTEN
    assert live.shown == 8
    assert live.left_out == 0


def test_a_long_stream_grows_slower(live, steps):
    live.size = lambda: 3 * SMALL
    for step in steps[:9]:
        live.growth(step)
        live.clock.now += 1.01 * OFTEN
    assert live.shown == 2


def test_first_and_last_step_of_the_remodelling_are_shown(live, tissue_run):
    seen = []
    remodel(tissue_run.domain(0), Angiogenesis(steps=2), seen.append)
    for step in seen:
        live.remodel(step)
    assert [step.is_last for step in seen] == [False, False, True]
    assert live.shown == 2
    assert not live.told


def test_a_viewer_that_fails_is_given_up_and_the_run_goes_on(live, steps, monkeypatch):
    def broken(*_):
        raise OSError("no room")

    monkeypatch.setattr(live, "growth_row", broken)
    for step in steps[:3]:
        live.growth(step)
        live.clock.now += 2.0 * OFTEN
    live.end()
    assert live.told == ["the viewer was given up, the run goes on: OSError: no room"]
    assert live.shown == 0
