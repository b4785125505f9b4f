"""The classical form with linear gradients: what it reaches, and what the quadratic fits gain."""

import numpy as np
import pytest
from tests.flow.exact import AT_REST, errors
from tests.flow.meshes import rectangle

from vasculo.errors import InputError
from vasculo.flow.boundary import Pressure
from vasculo.flow.stokes import solve_stokes


def test_linear_gradients_are_second_order_in_velocity_and_first_in_pressure_and_shear():
    rows = {1: [], 2: []}
    for order, row in rows.items():
        for across in (12, 24, 48):
            mesh = rectangle(1.0, 1.0, across, seed=1)
            row.append(errors(mesh, solve_stokes(mesh, {}, force=AT_REST.body_force, order=order), AT_REST))
    slope = np.log2(np.array(rows[1])[:-1] / np.array(rows[1])[1:])
    assert (slope[:, 0] > 1.9).all(), slope
    assert ((slope[:, [1, 3]] > 0.9) & (slope[:, [1, 3]] < 1.6)).all(), slope
    gain = np.array(rows[1][-1]) / np.array(rows[2][-1])
    assert gain[0] > 3.0, gain
    assert (gain[[1, 3]] > 6.0).all(), gain


def test_linear_gradients_are_not_exact_for_poiseuille_but_balance_mass():
    mesh = rectangle(3.0, 1.0, 12, seed=1)
    flow = solve_stokes(mesh, {"left": Pressure(1.0), "right": Pressure(0.0)}, order=1)
    assert 1e-4 < abs(36.0 * flow.flow_rate("right") - 1.0) < 0.02
    assert flow.mass_imbalance < 1e-12


def test_only_two_orders_are_there():
    with pytest.raises(InputError, match=r"order is 3: give 1 .* or 2"):
        solve_stokes(rectangle(1.0, 1.0, 3), {}, order=3)
