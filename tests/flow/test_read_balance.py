"""The balance of all forces to round-off, and of power and dissipation to second order."""

import numpy as np
import pytest
from tests.flow.exact import ANNULUS, AT_REST
from tests.flow.meshes import annulus, cylinder_in_square, rectangle

from vasculo.errors import InputError
from vasculo.flow.boundary import Periodic, Pressure, Slip, Velocity
from vasculo.flow.read.energy import dissipation, power
from vasculo.flow.read.forces import drag, force_balance, force_on
from vasculo.flow.stokes import solve_stokes

SWIRL = Velocity(lambda x, y: (ANNULUS.u(x, y), ANNULUS.v(x, y)))
INLET = Velocity(lambda _, y: 6.0 * y * (1.0 - y), 0.0)

CASES = {
    "openings": lambda: (cylinder_in_square(0.1, 32), {"left": Pressure(5.0), "right": Pressure(2.0), "top": Slip()}),
    "inlet": lambda: (cylinder_in_square(0.1, 32), {"left": INLET, "right": Pressure(1.0)}),
    "seams": lambda: (cylinder_in_square(0.1, 32), {"left": Periodic("right", 1.0), "bottom": Periodic("top", -0.4)}),
    "swirl": lambda: (annulus(), {"pillars": SWIRL, "rim": SWIRL}),
}


@pytest.mark.parametrize("case", CASES)
def test_all_forces_balance(case):
    mesh, conditions = CASES[case]()
    force = np.random.default_rng(0).normal(size=(len(mesh.triangles), 2))
    flow = solve_stokes(mesh, conditions, viscosity=2.0, force=force)
    forces = force_balance(flow)
    assert set(forces) == {"pillars", "body force", *mesh.side_names}
    size = max(np.abs(part).max() for part in forces.values())
    np.testing.assert_allclose(sum(forces.values()), 0.0, atol=1e-12 * size)
    np.testing.assert_allclose(forces["pillars"], drag(flow).sum(axis=0), atol=1e-12 * size)


def test_the_force_through_openings_is_their_pressure():
    mesh = rectangle(2.0, 1.0, 8)
    flow = solve_stokes(mesh, {"left": Pressure(5.0), "right": Pressure(2.0)})
    np.testing.assert_allclose(force_on(flow, "left"), [-5.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(force_on(flow, "right"), [2.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(force_on(flow, "top") + force_on(flow, "bottom"), [3.0, 0.0], atol=1e-12)
    with pytest.raises(InputError, match="no side"):
        force_on(flow, "lid")


def test_power_of_poiseuille_flow():
    mesh = rectangle(2.0, 1.0, 8)
    by_pressure = power(solve_stokes(mesh, {"left": Pressure(24.0), "right": Pressure(0.0)}))
    assert by_pressure == pytest.approx((24.0, 0.0, 0.0), abs=1e-11)
    by_force = power(solve_stokes(mesh, {"left": Periodic("right")}, force=(12.0, 0.0)))
    # The body force meets the velocity at the centroids, the seam the exact flux.
    assert by_force == pytest.approx((0.0, 0.0, 24.0), rel=0.02, abs=1e-12)
    assert power(solve_stokes(mesh, {"left": Periodic("right", 24.0)})).total == pytest.approx(24.0, rel=1e-12)
    inlet = power(solve_stokes(mesh, {"left": INLET, "right": Pressure(0.0)}))
    assert inlet.moving == pytest.approx(24.0, rel=1e-11)
    assert inlet.total == pytest.approx(24.0, rel=1e-11)


def test_power_of_the_turning_cylinder():
    # Torque times rate of turning, the rate being 2.
    flow = solve_stokes(annulus(16, 120), {"pillars": SWIRL, "rim": SWIRL})
    assert power(flow).moving == pytest.approx(2.0 * ANNULUS.torque, rel=1e-3)
    assert power(flow).total == power(flow).moving


def square(k):
    mesh = rectangle(1.0, 1.0, 8 * k, seed=2)
    return solve_stokes(mesh, {}, force=AT_REST.body_force)


def array(k):
    mesh = cylinder_in_square(0.1, 32, 5) if k == 1 else cylinder_in_square(0.1, 32 * k)
    return solve_stokes(mesh, {"left": Periodic("right", 1.0), "bottom": Periodic("top")}, viscosity=3.0)


def swirl(k):
    return solve_stokes(annulus(4 * k, 30 * k), {"pillars": SWIRL, "rim": SWIRL})


@pytest.mark.parametrize(("make", "bound"), [(square, 1.6e-2), (array, 1.4e-2), (swirl, 4.5e-2)])
def test_dissipation_is_the_power_to_second_order(make, bound):
    for k in (1, 2, 4):
        flow = make(k)
        lost = dissipation(flow)
        assert (lost >= 0.0).all()
        assert lost @ flow.mesh.areas == pytest.approx(power(flow).total, rel=bound / k**2)
