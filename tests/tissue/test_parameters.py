"""Parameters of vasculogenesis: ranges and presets."""

import dataclasses

import numpy as np
import pytest

from vasculo.errors import InputError
from vasculo.tissue.vasculogenesis import PRESETS, Vasculogenesis


def test_the_default_is_medium():
    assert Vasculogenesis() == Vasculogenesis.preset("medium")
    assert Vasculogenesis().growth_rate == 0.0009
    assert not Vasculogenesis().self_stopping


def test_presets():
    assert list(PRESETS) == ["fine", "medium", "coarse", "paper", "uniform", "selfstop", "selfstop_fine"]
    assert Vasculogenesis.preset("paper").tether == 0.0
    assert {name for name, preset in PRESETS.items() if preset.self_stopping} == {"selfstop", "selfstop_fine"}
    sizes = [PRESETS[name].growth_rate for name in ("fine", "medium", "coarse")]
    assert sizes == sorted(sizes, reverse=True)


def test_an_unknown_preset_names_the_nearest():
    with pytest.raises(InputError, match="no preset 'medum' of vasculogenesis: did you mean 'medium'"):
        Vasculogenesis.preset("medum")
    with pytest.raises(InputError, match="one of fine, medium, coarse, paper, uniform, selfstop, selfstop_fine"):
        Vasculogenesis.preset("xyz")


WORDS = ["threshold_kind", "threshold_law"]
OPTIONAL = ["growth_time", "pillar_spacing", "time_step"]
NUMBERS = [field.name for field in dataclasses.fields(Vasculogenesis) if field.name not in WORDS]


@pytest.mark.parametrize("field", NUMBERS)
@pytest.mark.parametrize("value", [-1.0, np.nan, np.inf, None, "1", True])
def test_every_field_refuses_nonsense(field, value):
    if value is None and field in OPTIONAL:
        assert getattr(Vasculogenesis(), field) is None
        return
    with pytest.raises(InputError, match=f"^{field} is .*expected a number in "):
        Vasculogenesis(**{field: value})


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"growth_rate": 0.0}, r"growth_rate is 0.0, expected a number in \[1e-06, 1e\+06\]"),
        ({"stop_void_fraction": 1.1}, r"stop_void_fraction is 1.1, expected a number in \(0, 1\]"),
        ({"time_step": 0}, "time_step is 0, expected"),
        ({"threshold_law": "gauss"}, "threshold_law is 'gauss', expected one of normal, weibull"),
        ({"threshold_kind": 1}, "threshold_kind is 1, expected one of strain, force"),
        ({"threshold_correlation": 0.5}, r"threshold_correlation is 0.5, expected 0 or a number in \[1, 1000\]"),
        ({"growth_time": 100.0, "pillar_spacing": 0.1}, "growth_time 100 and pillar_spacing 0.1 both decide"),
        ({"pillar_spacing": 0.1, "stop_void_fraction": 1.0}, "pillar_spacing 0.1 needs rupture that ends at a void"),
        ({"final_rest_factor": 0.5}, "final_rest_factor 0.5 is above growth_limit 0.4"),
    ],
)
def test_ranges(change, message):
    with pytest.raises(InputError, match=message):
        Vasculogenesis(**change)


def test_frozen():
    with pytest.raises(dataclasses.FrozenInstanceError):
        Vasculogenesis().tether = 1.0


@pytest.mark.parametrize("field", ["damping", "tightening_damping", "tether", "hold", "quiet_time", "settling_time"])
def test_upper_ends(field):
    assert getattr(Vasculogenesis(**{field: 1e6}), field) == 1e6
    with pytest.raises(InputError, match=rf"^{field} is 1e\+300, expected a number in [\[(]0, 1e\+06\]$"):
        Vasculogenesis(**{field: 1e300})


@pytest.mark.parametrize("field", ["growth_rate", "time_step"])
def test_lower_ends(field):
    assert getattr(Vasculogenesis(**{field: 1e-6}), field) == 1e-6
    with pytest.raises(InputError, match=rf"^{field} is 1e-07, expected a number in \[1e-06, 1e\+06\]$"):
        Vasculogenesis(**{field: 1e-7})
