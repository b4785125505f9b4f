import math
from dataclasses import replace

import pytest

from vasculo.errors import InputError
from vasculo.pillars.parameters import Angiogenesis


def test_defaults_are_those_of_the_active_cell():
    p = Angiogenesis()
    assert (p.steps, p.activation, p.filament_ratio, p.cells) == (40, 0.08, 10.0, "active")
    assert not p.is_hanging


def test_hanging_is_the_control():
    p = Angiogenesis.hanging(steps=12)
    assert p.is_hanging
    assert (p.steps, p.traction) == (12, 0.005)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"steps": -1}, "steps = -1"),
        ({"steps": 2.5}, "whole number"),
        ({"activation": 0.5}, "activation = 0.5 is not a number from -0.2 to 0.2"),
        ({"activation": math.nan}, "activation = nan"),
        ({"viscosity": 0.0}, "viscosity = 0.0"),
        ({"pressure_drop": 0.0}, "drives no flow"),
        ({"walls": "sticky"}, "not one of slip, no-slip"),
        ({"cells": "dead"}, "not one of active, hanging"),
        ({"cells": "hanging"}, "traction > 0"),
        ({"merge_gap": 0.35}, "above twice step_cap, 0.48"),
        ({"merge_gap": 2.0, "closing": 0.5}, "at least 1"),
        ({"filament_ratio": "stiff"}, "filament_ratio = 'stiff'"),
    ],
)
def test_bad_values_are_named_with_a_way_out(change, words):
    with pytest.raises(InputError, match=words) as caught:
        replace(Angiogenesis(), **change)
    assert "\n" not in str(caught.value)
