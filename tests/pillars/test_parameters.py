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
        ({"activation": 0.7}, "activation = 0.7 is not a number from -0.6 to 0.6"),
        ({"activation": math.nan}, "activation = nan"),
        ({"viscosity": 0.0}, "viscosity = 0.0"),
        ({"pressure_drop": 0.0}, "drives no flow"),
        ({"walls": "sticky"}, "not one of slip, no-slip"),
        ({"cells": "dead"}, "not one of active, hanging"),
        ({"cells": "hanging"}, "traction > 0"),
        ({"step_cap": 2.5}, "step_cap = 2.5 is not a number from 0.01 to 2"),
        ({"merge_gap": 2.0, "closing": 0.5}, "at least 1"),
        ({"response": "liner"}, "response = 'liner' is not one of linear, logarithm, sign"),
        ({"sensing": "global"}, "sensing = 'global' is not one of local, rolled"),
        ({"matrix": "soft"}, "not one of auto, plastic, elastic, none"),
        ({"matrix": "none", "traction": 0.01}, "traction = 0.01: set it to 0"),
        ({"traction_part": "half"}, "not one of friction, full"),
        ({"filament_memory": 1.5}, "filament_memory = 1.5 is not a number from 0 to 1"),
        ({"smoothing": 1.5}, "smoothing = 1.5 is not a whole number"),
        ({"inlet": "right"}, "inlet = 'right' is the outlet too"),
        ({"filament_ratio": "stiff"}, "filament_ratio = 'stiff'"),
    ],
)
def test_bad_values_are_named_with_a_way_out(change, words):
    with pytest.raises(InputError, match=words) as caught:
        replace(Angiogenesis(), **change)
    assert "\n" not in str(caught.value)


def test_the_matrix_remembers_around_hanging_cells_or_where_it_is_told_to():
    assert not Angiogenesis().remembers_matrix
    assert Angiogenesis(matrix="elastic").remembers_matrix
    assert Angiogenesis.hanging().remembers_matrix
    assert not Angiogenesis.hanging(matrix="plastic").remembers_matrix
