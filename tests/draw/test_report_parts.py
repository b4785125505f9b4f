"""What the parts of a report say: events in words, checks with their thresholds, numbers, times, branches."""

import re

import numpy as np
import pytest

from vasculo.draw.page import MINUS, TIMES
from vasculo.draw.report.asked import branch_parts
from vasculo.draw.report.checks import checks
from vasculo.draw.report.events import event_lines, events_parts
from vasculo.draw.report.repeat import step_times
from vasculo.draw.report.summary import sentence
from vasculo.draw.report.words import cell, change, number
from vasculo.mesh.quality import triangle_quality
from vasculo.pillars.events import Event
from vasculo.springs.network import SpringNetwork
from vasculo.store.units import Units


def words(parts):
    return re.sub(r"\s+", " ", re.sub(r"<[^>]*>", " ", " ".join(parts)))


def named(run):
    return {check.name: check for check in checks(run)}


def test_numbers_have_three_digits():
    told = [number(value) for value in (0.0, 29.0, 1.6, 0.85, -0.0321, 12345.6, 4.66e-5, float("nan"))]
    assert told == ["0", "29", "1.60", "0.850", f"{MINUS}0.0321", "12,346", f"4.66 {TIMES} 10⁻⁵", ""]


def test_physical_and_model_numbers_stand_together():
    assert cell(0.02, "length", Units(length=1000.0)) == "20<small>0.0200</small>"
    assert cell(0.02, "length", Units()) == "0.0200"
    assert change(0.02, 0.03, "mean_gap", Units()) == f"{TIMES} 1.50"
    assert change(0.02, 0.03, "corridor_run", Units(length=1000.0)) == "+10.0"
    assert change(3.0, 3.0, "pillars", Units()) == "="
    assert change(np.nan, 3.0, "pillars", Units()) == ""


def test_events_are_told_in_words_with_times(disk_run, monkeypatch):
    events = (
        Event(1, 0.1, "merge", (1.0, 1.0), ((0,), (1,)), 0.0),
        Event(1, 0.1, "merge", (2.0, 1.0), ((2,), (3,)), 60.0),
        Event(2, 0.2, "vanish", (3.0, 0.5), (tuple(range(8)),)),
        Event(2, 0.2, "border", (np.nan, np.nan), ((9,),)),
        Event(3, 0.3, "closure", (0.5, 0.5)),
    )
    assert event_lines(events) == [
        "step 1, time 0.100: 2 times two pillars became one: 0 and 1 at (1, 1); 2 and 3 at (2, 1)",
        "step 2, time 0.200: a pillar vanished: 0+1+2+3+4+5 and 2 more at (3, 0.5)",
        "step 2, time 0.200: a pillar joined a closed side: 9",
        "step 3, time 0.300: the plexus began to close itself off: the shear ratio passed its limit",
    ]
    monkeypatch.setitem(disk_run.__dict__, "events", events)
    text = words(events_parts(disk_run))
    assert "5 events: 2 times two pillars became one, a pillar joined a closed side, a pillar vanished" in text
    assert "mean cos 2φ of 0.25" in text
    monkeypatch.setitem(disk_run.__dict__, "events", ())
    assert "Events: none." in words(events_parts(disk_run))


def test_long_lists_of_events_are_folded(disk_run, monkeypatch):
    events = tuple(Event(k, 0.1 * k, "vanish", (1.0, 1.0), ((k,),)) for k in range(300))
    monkeypatch.setitem(disk_run.__dict__, "events", events)
    found = "".join(events_parts(disk_run))
    assert "Step by step, the first 200 of 300 lines" in found
    assert found.count("<li>") == 200


def test_a_sound_run_passes_its_checks(disk_run):
    found = named(disk_run)
    assert all(check.good for check in found.values())
    rows = disk_run.metrics["stage"] == "angiogenesis"
    assert f"{disk_run.metrics['mass_imbalance'][rows].max():.1e}" in found["mass balance of the flow"].found
    lowest = min(
        triangle_quality(mesh.points, mesh.triangles).min()
        for mesh in (disk_run.mesh(step) for step in disk_run.steps())
    )
    assert f"lowest {lowest:.2f}," in found["shape of the triangles"].found
    assert "3 of 3 recorded steps looked at" in found["shape of the triangles"].found


def test_the_time_step_is_held_against_the_stability_limit(tissue_run, monkeypatch):
    first = tissue_run.network(0)
    keys = tissue_run.settings["vasculogenesis"]
    network = SpringNetwork(first.points, first.springs, tether=keys["tether"])
    limits = []
    for name in ("damping", "tightening_damping"):
        network.damping = keys[name]
        limits.append(network.safe_limit())
    check = named(tissue_run)["time step of the tissue"]
    assert f"of the limit {min(limits):.3g}" in check.found
    assert check.good
    monkeypatch.setitem(tissue_run.metrics, "time", 10.0 * tissue_run.metrics["time"])
    assert not named(tissue_run)["time step of the tissue"].good


def test_triangles_across_the_narrowest_passage(tissue_run, monkeypatch):
    check = named(tissue_run)["triangles across the narrowest passage"]
    rows = float(check.found.partition(" ")[0])
    asked = tissue_run.settings["angiogenesis"]["flow_across"]
    assert 0.6 * asked < rows < 2.0 * asked
    monkeypatch.setitem(tissue_run.settings["angiogenesis"], "flow_across", 10)
    assert not named(tissue_run)["triangles across the narrowest passage"].good


@pytest.mark.parametrize(
    ("column", "value", "name"),
    [
        ("mass_imbalance", 1e-7, "mass balance of the flow"),
        ("residual", 0.05, "cells at rest"),
        ("shear_ratio", 34.0, "flow through the whole plexus"),
    ],
)
def test_what_is_past_its_threshold_is_to_be_looked_at(disk_run, monkeypatch, column, value, name):
    spoilt = disk_run.metrics[column].copy()
    spoilt[-1] = value
    monkeypatch.setitem(disk_run.metrics, column, spoilt)
    found = named(disk_run)
    assert [check.name for check in found.values() if not check.good] == [name]


def test_trouble_in_the_log_is_told(disk_run, tmp_path, monkeypatch):
    (tmp_path / "log.txt").write_text(
        "2026-01-01 00:00:00  stopped: Interrupted: by hand\n2026-01-01 00:00:01  complete\n"
    )
    monkeypatch.setattr(disk_run, "folder", tmp_path)
    check = named(disk_run)["warnings in the log"]
    assert not check.good
    assert check.found == "stopped: Interrupted: by hand"


def test_one_pillar_has_its_own_sentence(disk_run):
    ratio = disk_run.metrics["aspect_ratio"]
    assert sentence(disk_run).startswith(
        f"In 2 remodelling steps one pillar in the flow went from aspect ratio {ratio[0]:.2f} to {ratio[-1]:.2f}"
    )


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
