"""Meshes of one and two triangles, where full fits are impossible: the fallbacks, and what stays exact."""

import numpy as np
import pytest

from vasculo.errors import InputError
from vasculo.flow.boundary import Pressure, Slip, Velocity
from vasculo.flow.stokes import solve_stokes
from vasculo.mesh.triangulation import Triangulation

POINTS = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
NAMES = ("bottom", "left", "right", "top")
TWO = Triangulation(POINTS, [[0, 1, 2], [0, 2, 3]], [[0, 1], [1, 2], [2, 3], [3, 0]], [-1, -3, -4, -2], NAMES)
ONE = Triangulation(POINTS[:3], [[0, 1, 2]], [[0, 1], [1, 2], [2, 0]], [-1, -3, -2], NAMES)


def test_two_triangles_carry_poiseuille_flow():
    flow = solve_stokes(TWO, {"left": Pressure(1.0), "right": Pressure(0.0)})
    np.testing.assert_allclose(flow.velocity, [[1.0 / 9.0, 0.0]] * 2, atol=1e-12)
    np.testing.assert_allclose(flow.pressure, [1.0 / 3.0, 2.0 / 3.0], rtol=1e-12)
    assert flow.flow_rate("right") == pytest.approx(1.0 / 12.0, rel=1e-12)
    assert flow.report["level_3"] == 5


def test_one_triangle_balances_mass():
    flow = solve_stokes(ONE, {"left": Pressure(1.0), "right": Pressure(0.0)})
    assert flow.flow_rate("right") == pytest.approx(-flow.flow_rate("left"), rel=1e-12)
    assert flow.flow_rate("right") > 0.0
    assert flow.report["two_point_outflows"] == 2
    assert flow.report["two_point_pressures"] == 3
    assert np.isfinite(flow.wall_shear).all()


def test_shear_fits_shrink_on_mirror_lines():
    sides = {"left": Slip(), "right": Slip(), "top": Pressure(0.0), "bottom": Velocity(0.0, 1.0)}
    flow = solve_stokes(TWO, sides)
    np.testing.assert_allclose(flow.velocity, [[0.0, 1.0]] * 2, atol=1e-12)
    assert flow.report["linear_fits"] == 2


def test_differences_of_two_cells_are_the_last_resort():
    flow = solve_stokes(TWO, dict.fromkeys(NAMES, Slip()), force=[[1.0, 0.0], [0.0, 1.0]])
    assert flow.report["two_point_fits"] == 1
    assert flow.report["two_point_pressures"] == 5
    assert flow.mass_imbalance < 1e-12
    assert np.abs(flow.velocity).max() > 1e-3


def test_what_no_wall_holds_back_is_refused():
    with pytest.raises(InputError, match="no wall holds back"):
        solve_stokes(TWO, {"left": Pressure(1.0), "right": Pressure(0.0), "top": Slip(), "bottom": Slip()})
