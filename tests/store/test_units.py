"""Physical units: factors worked out by hand, and the viscosity that a run computes with."""

import pytest

from vasculo.errors import InputError
from vasculo.store.read import open_run
from vasculo.store.units import DIMENSIONS, Units
from vasculo.study.run import run

WHOLE = Units(length=1000.0, shear=20.0, viscosity=4.0)


@pytest.mark.parametrize(
    ("dimension", "factor", "name"),
    [
        ("", 1.0, ""),
        ("length", 1e3, "µm"),
        ("area", 1e6, "µm²"),
        ("density", 1e-6, "1/µm²"),
        ("pressure", 20.0, "dyn/cm²"),
        # 2 Pa times 1e-3 m over 4e-3 Pa s are 0.5 m/s
        ("velocity", 5e5, "µm/s"),
        ("flow rate", 5e8, "µm²/s"),
        ("resistance", 4e-8, "dyn s/(cm² µm²)"),
        ("angle", 1.0, "degrees"),
    ],
)
def test_factors_by_hand(dimension, factor, name):
    assert WHOLE.factor(dimension) == pytest.approx(factor, rel=1e-12)
    assert WHOLE.name(dimension) == name


def test_without_names_all_stays_in_model_units():
    none = Units()
    assert {none.factor(dimension) for dimension in DIMENSIONS} == {1.0}
    assert none.name("velocity") == "model velocity"
    assert [dimension for dimension in DIMENSIONS if none.known(dimension)] == ["", "angle", "seconds"]


def test_a_velocity_needs_all_three():
    assert not Units(length=1.0, shear=1.0).known("velocity")
    assert Units(length=1.0, shear=1.0).known("pressure")


@pytest.mark.parametrize("value", [0.0, -1.0, float("inf"), float("nan")])
def test_a_unit_is_above_zero(value):
    with pytest.raises(InputError, match="shear = "):
        Units(shear=value)


def test_speeds_of_a_thicker_model_fluid_are_told_right(tmp_path):
    """At twice the model viscosity a flow is half as fast in model units, and as fast in micrometres a second."""
    told = []
    for viscosity in (1.0, 2.0):
        settings = {
            "angiogenesis.steps": 0,
            "angiogenesis.viscosity": viscosity,
            "output.figures": False,
            "units.length": 100.0,
            "units.shear": 5.0,
            "units.viscosity": 4.0,
        }
        found = open_run(run("disk", tmp_path / str(viscosity), settings).folder)
        told.append(abs(found.flow().velocity).max() * found.units.factor("velocity"))
    assert told[1] == pytest.approx(told[0], rel=1e-9)
