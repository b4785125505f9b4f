"""What the record holds of a remodelling beyond its pictures: states to go on from, events, lineage."""

import csv
import dataclasses
import io

import h5py
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from vasculo.errors import InputError
from vasculo.pillars.events import Event
from vasculo.pillars.state import RemodelState
from vasculo.store.events import COLUMNS, event_rows, events_of, events_text
from vasculo.store.frames import outlines
from vasculo.store.read import open_run
from vasculo.store.record import Record
from vasculo.store.states import SCALARS, state_of, state_rows


def assert_same_state(one, two):
    for field in dataclasses.fields(RemodelState):
        mine, theirs = getattr(one, field.name), getattr(two, field.name)
        np.testing.assert_array_equal(mine, theirs, err_msg=field.name)
        assert type(mine) is type(theirs), field.name
        if isinstance(mine, np.ndarray):
            assert mine.dtype == theirs.dtype, field.name


def test_every_state_comes_back(folder, steps):
    run = open_run(folder)
    for number, step in enumerate(steps):
        assert_same_state(run.state(number), step.state)
    assert_same_state(run.state(), steps[-1].state)


def test_outlines_are_not_stored_twice(steps):
    plain, remembering = steps[0], steps[1]
    rows = state_rows(plain.state, outlines(plain))
    for name in ("points", "starts", "members", "member_starts", "reference"):
        assert len(rows[name]) == 0, name
    rows = state_rows(remembering.state, outlines(remembering))
    assert len(rows["points"]) == 0
    assert len(rows["reference"]) == len(remembering.state.points)


def test_outlines_that_differ_are_stored(steps):
    state = dataclasses.replace(steps[0].state, points=steps[0].state.points + 1e-9)
    frame = outlines(steps[0])
    assert_same_state(state_of(state_rows(state, frame), SCALARS, frame), state)


def test_events_and_lineage(folder, steps):
    run = open_run(folder)
    every = [event for step in steps for event in step.events]
    assert len(every) == 4
    assert [event.kind for event in run.events] == [event.kind for event in every]
    for mine, theirs in zip(run.events, every, strict=True):
        np.testing.assert_equal(dataclasses.astuple(mine), dataclasses.astuple(theirs))
    assert [event.kind for event in run.pillars(2).events] == ["merge", "border"]
    assert run.lineage(1) == ((0, 2), (1,))


def test_events_as_a_table(folder):
    rows = list(csv.DictReader(io.StringIO(events_text(open_run(folder).events))))
    assert tuple(rows[0]) == COLUMNS
    assert [row["step"] for row in rows] == ["1", "2", "2", "3"]
    assert rows[1] == {
        "step": "2",
        "time": "0.2",
        "kind": "merge",
        "x": "1.0",
        "y": "1.0",
        "angle": "20.0",
        "pillars": "0 2",
    }
    assert rows[2]["pillars"] == "0+2"
    assert rows[2]["angle"] == ""


finite = st.floats(allow_nan=False, allow_infinity=False)
pillar = st.lists(st.integers(0, 2**31 - 1), min_size=1, max_size=4).map(tuple)
event = st.builds(
    Event,
    step=st.integers(0, 10**6),
    time=finite,
    kind=st.sampled_from(["merge", "border", "vanish", "split", "closure", "rest"]),
    place=st.tuples(finite, finite),
    pillars=st.lists(pillar, max_size=3).map(tuple),
    angle=finite,
)


@settings(deadline=None, max_examples=50)
@given(st.lists(event, max_size=6))
def test_any_events_come_back(events):
    assert events_of(event_rows(events)) == tuple(events)


@pytest.fixture
def old(folder):
    """The record as version 0.1 of the format had it: mergers by their angles only, no states."""
    with h5py.File(folder / "run.vtkhdf", "r+") as file:
        run = file["run"]
        angles = run["events/angle"][:]
        kinds = run["events/kind"][:]
        steps, ends = run["events/step"][:], run["pillars/ends/sizes"]
        run["pillars/merge_angles"] = angles[kinds == b"merge"]
        run["pillars/ends/merge_angles"] = [np.count_nonzero(steps[kinds == b"merge"] <= k) for k in range(len(ends))]
        del run["events"], run["states"], run.attrs["id"]
        run.attrs["format"] = 1
    return folder


def test_an_older_record_opens_with_its_mergers(old, steps):
    run = open_run(old)
    assert run.id == ""
    assert [(event.kind, event.step, event.angle, event.pillars) for event in run.events] == [
        ("merge", k, 10.0 * k, ()) for k in (1, 2, 3)
    ]
    assert all(np.isnan(event.place).all() for event in run.events)
    assert run.lineage() == steps[-1].lineage
    with pytest.raises(InputError, match="holds no states to go on from"):
        run.state()


def test_an_older_record_is_not_continued(old):
    with pytest.raises(InputError, match="record format 1, which can be read but not continued"):
        Record.reopen(old / "run.vtkhdf", 7)
    record = Record.amend(old / "run.vtkhdf")  # the report may be written anew
    record.set_facts("stages", [])
    record.close()
    assert len(open_run(old).events) == 3


def test_a_copy_becomes_a_run_of_its_own(folder):
    before = open_run(folder)
    assert len(before.id) == 12
    record = Record.reopen(folder / "run.vtkhdf", 5)
    record.set_settings('[study]\ntitle = "other"\n', new=True)
    record.close()
    after = open_run(folder)
    assert after.id != before.id
    assert after.settings["study"] == {"title": "other"}
    assert (after.steps(), len(after.events)) == ([0, 1], 1)
