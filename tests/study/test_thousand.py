"""The built-in study of a thousand pillars, and the controls: what they ask for, and what they show when made small."""

import numpy as np
import pytest

from vasculo import measure
from vasculo.pillars.angiogenesis import remodel
from vasculo.study.builtin import builtin_path
from vasculo.study.drawn import drawn_domain
from vasculo.study.forecast import forecast
from vasculo.study.run import run
from vasculo.study.settings import read_study

MOST_MEMORY = 5_000.0  # MB


def remodelled(name, **overrides):
    """First and last step of a study that is drawn, and everything that happened."""
    settings = read_study(builtin_path(name), {f"angiogenesis.{key}": value for key, value in overrides.items()})
    steps = []
    remodel(drawn_domain(settings), settings.angiogenesis, steps.append)
    return steps[0], steps[-1], [event.kind for step in steps for event in step.events]


def order(step):
    return measure.order(step.domain)


def flow_gain(first, last):
    return measure.permeability(last.domain, last.flow) / measure.permeability(first.domain, first.flow)


def test_a_thousand_pillars_are_foreseen():
    settings = read_study(builtin_path("thousand"))
    assert settings.stages == ("vasculogenesis", "extraction", "angiogenesis")
    assert settings.angiogenesis.steps >= 40
    lines = dict(forecast(settings))
    assert float(lines["expected pillars"].split()[1].rstrip(",")) > 1000
    assert float(lines["expected memory"].split()[1]) < MOST_MEMORY


@pytest.mark.slow
def test_a_thousand_made_small(tmp_path):
    changes = {"tissue.nodes": 3_000, "angiogenesis.steps": 12, "output.figures": False}
    found = run("thousand", tmp_path / "run", changes).metrics
    rows = found["stage"] == "angiogenesis"
    pillars, alignment, permeability = (found[name][rows] for name in ("pillars", "alignment", "permeability"))
    assert list(found["step"][rows]) == list(range(0, 13, 2))
    assert pillars[0] > 50
    assert pillars[-1] < 0.9 * pillars[0]
    assert alignment[-1] > alignment[0] + 0.2
    assert permeability[-1] > 1.4 * permeability[0]


def test_rolled_pillars_neither_align_nor_merge():
    first, last, kinds = remodelled("rolled", steps=6)
    assert "merge" not in kinds
    assert abs(order(last) - order(first)) < 0.3
    assert flow_gain(first, last) < 1.0


def test_with_the_rule_turned_round_pillars_grow_across_the_flow():
    first, last, _ = remodelled("flipped", steps=6)
    assert order(last) < order(first) - 0.2
    assert flow_gain(first, last) < 0.7


def test_elastic_filaments_stop_half_way():
    settings = read_study(builtin_path("elastic"))
    ratios = []
    remodel(
        drawn_domain(settings),
        settings.angiogenesis,
        lambda step: ratios.append(float(measure.pillars(step.domain).aspect_ratio[0])),
    )
    assert 1.4 < ratios[20] < 1.75
    assert ratios[40] == pytest.approx(ratios[20], abs=0.05)
    assert np.ptp(ratios[30:]) < 0.05
