"""What the report says about the remodelling."""

import re

import numpy as np
import pytest

from vasculo.draw.page import TIMES
from vasculo.draw.remodelling import branch_parts, remodelling_parts, step_times
from vasculo.pillars.events import Event


def words(parts):
    return re.sub(r"\s+", " ", re.sub(r"<[^>]*>", " ", " ".join(parts)))


def test_measures_stand_at_three_steps_with_what_they_mean(disk_run):
    text = words(remodelling_parts(disk_run))
    assert "step 0 step 1 step 2 change" in text
    for name in ("aspect_ratio", "local_angle", "permeability", "shear_variation", "triangles"):
        assert name in text
    rows = disk_run.metrics["stage"] == "angiogenesis"
    first, _, last = disk_run.metrics["permeability"][rows]
    assert f"{TIMES} {last / first:.2f}" in text
    assert "Events: none" in text
    assert "closed itself off" not in text


def test_lengths_and_shear_have_units(tissue_run):
    text = words(remodelling_parts(tissue_run))
    row = tissue_run.frame("angiogenesis").index
    assert f"{tissue_run.metrics['mean_gap'][row] * 1000.0:.3g} µm" in text
    assert f"{tissue_run.metrics['mean_wall_shear'][row] * 500.0:.3g} dyn/cm²" in text


def test_a_plexus_that_closed_itself_off_is_told(disk_run, monkeypatch):
    rows = disk_run.metrics["stage"] == "angiogenesis"
    ratio = disk_run.metrics["shear_ratio"].copy()
    ratio[rows] = (3.0, 21.5, 34.0)
    monkeypatch.setitem(disk_run.metrics, "shear_ratio", ratio)
    text = words(remodelling_parts(disk_run))
    assert "The plexus closed itself off: at step 1" in text
    assert "34 times" in text
    monkeypatch.setitem(disk_run.settings["angiogenesis"], "closure_ratio", 40.0)
    assert "closed itself off:" not in words(remodelling_parts(disk_run))


def test_events_are_counted_and_those_that_are_no_merger_listed(disk_run, monkeypatch):
    events = (
        Event(1, 0.1, "merge", (1.0, 1.0), ((0,), (1,)), 0.0),
        Event(1, 0.1, "merge", (2.0, 1.0), ((2,), (3,)), 60.0),
        Event(2, 0.2, "vanish", (3.0, 0.5), (tuple(range(8)),)),
        Event(2, 0.2, "border", (np.nan, np.nan), ((9,),)),
    )
    monkeypatch.setitem(disk_run.__dict__, "events", events)
    text = words(remodelling_parts(disk_run))
    assert "merge 2 two pillars became one" in text
    assert "vanish 1 a pillar vanished" in text
    assert "Mergers: 2, with a mean cos 2φ against x of 0.25" in text
    assert "2 vanish 3, 0.5 0, 1, 2, 3, 4, 5 and 2 more" in text
    assert "nan" not in text
    assert "split" not in text


def test_the_times_of_the_parts_add_up_to_the_stage(disk_run):
    stage = next(fact for fact in disk_run.facts("stages") if fact["name"] == "angiogenesis")
    numbers = [float(value) for value in re.findall(r"(\d+\.\d\d) ", words(step_times(disk_run)))]
    assert len(numbers) == 5
    assert sum(numbers[:4]) == pytest.approx(stage["seconds"], abs=0.03)
    assert numbers[4] == pytest.approx(stage["seconds"], abs=0.006)


def test_records_without_times_have_no_table_of_them(disk_run, monkeypatch):
    monkeypatch.delitem(disk_run.metrics, "seconds_flow")
    assert step_times(disk_run) == []


def test_a_branch_says_where_it_comes_from(disk_run, monkeypatch):
    facts = {
        "branch": [
            {"run": "0123456789ab", "folder": "chains", "step": 40, "changes": [["angiogenesis.activation", 0.08, 0.0]]}
        ],
        "extended": [{"step": 60, "changes": [["angiogenesis.steps", 60, 80]]}],
    }
    monkeypatch.setattr(disk_run, "facts", lambda name: facts.get(name, {}))
    one, two = branch_parts(disk_run)
    assert "Branch of run chains (0123456789ab) behind step 40: angiogenesis.activation 0.08 → 0." in words([one])
    assert "Continued behind step 60: angiogenesis.steps 60 → 80." in words([two])
    monkeypatch.setattr(disk_run, "facts", lambda _name: {})
    assert branch_parts(disk_run) == []
