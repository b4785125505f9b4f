"""Forces on nodes, pillars and their moments: conservative to round-off, exact for the turning cylinder."""

import numpy as np
import pytest
import shapely
from tests.flow.exact import ANNULUS
from tests.flow.meshes import annulus, cylinder_in_square, rectangle

from vasculo.errors import InputError
from vasculo.flow.boundary import Periodic, Pressure, Slip, Velocity
from vasculo.flow.read.forces import drag, node_force, node_shear, torque, wall_force
from vasculo.flow.stokes import solve_stokes
from vasculo.geometry.domain import Domain
from vasculo.mesh.generate import generate_mesh

SWIRL = Velocity(lambda x, y: (ANNULUS.u(x, y), ANNULUS.v(x, y)))


@pytest.fixture(scope="module")
def array():
    mesh = cylinder_in_square(0.1, 48, exact_area=False)
    return solve_stokes(mesh, {"left": Periodic("right", 1.0), "bottom": Periodic("top", 0.3)}, force=(0.2, -0.1))


@pytest.mark.parametrize("part", ["full", "viscous", "pressure"])
def test_node_forces_keep_force_and_moment(array, part):
    mesh = array.mesh
    force, at = wall_force(array, part), mesh.points[array.wall_edges].mean(axis=1)
    nodes = node_force(array, part)
    np.testing.assert_allclose(nodes.sum(axis=0), force.sum(axis=0), atol=1e-14)
    for centre in ((0.0, 0.0), (0.5, 0.5), (-30.0, 7.0)):
        arm, far = mesh.points - centre, at - centre
        moments = arm[:, 0] * nodes[:, 1] - arm[:, 1] * nodes[:, 0], far[:, 0] * force[:, 1] - far[:, 1] * force[:, 0]
        assert moments[0].sum() == pytest.approx(moments[1].sum(), abs=1e-12)
        assert torque(array, centre, part)[0] == pytest.approx(moments[1].sum(), abs=1e-12)
    on_wall = np.zeros(len(mesh.points), dtype=bool)
    on_wall[array.wall_edges] = True
    assert not nodes[~on_wall].any()


def test_the_parts_of_the_drag(array):
    np.testing.assert_allclose(drag(array, "viscous") + drag(array, "pressure"), drag(array), atol=1e-15)
    # Pressure drops on the whole cell, and the body force on its fluid.
    fluid = array.mesh.areas.sum()
    np.testing.assert_allclose(drag(array)[0], np.array([1.0, 0.3]) + np.array([0.2, -0.1]) * fluid, atol=1e-12)


def test_friction_carries_its_known_share():
    # Multipole series: 0.4494 of the drag at a solid fraction of 0.1.
    mesh = cylinder_in_square(0.1, 96, exact_area=False)
    flow = solve_stokes(mesh, {"left": Periodic("right", 1.0), "bottom": Periodic("top")})
    assert drag(flow, "viscous")[0, 0] / drag(flow)[0, 0] == pytest.approx(0.4494, rel=4e-3)


def test_torque_of_the_turning_cylinder():
    # 4 pi viscosity a b^2 V / (b^2 - a^2), walls as polygons with the exact velocity on them.
    missed = []
    for k in (1, 2, 4):
        flow = solve_stokes(annulus(5 * k, 32 * k), {"pillars": SWIRL, "rim": SWIRL}, viscosity=3.0)
        missed.append(torque(flow)[0] / (-3.0 * ANNULUS.torque) - 1.0)
        assert abs(torque(flow, part="pressure")[0]) < 5e-3 * abs(torque(flow)[0])
    assert abs(missed[2]) < 5e-4
    assert np.log2(abs(missed[0] / missed[2])) / 2.0 > 1.8


def test_the_centre_is_the_centroid_wherever_the_pillar_lies():
    mesh = cylinder_in_square(0.1, 24)
    flow = solve_stokes(mesh, {"left": Pressure(1.0), "right": Pressure(0.0), "top": Slip()})
    assert torque(flow)[0] == pytest.approx(torque(flow, (0.5, 0.5))[0], abs=1e-12)
    assert torque(flow)[0] == pytest.approx(torque(flow, [(0.5, 0.5)])[0], abs=1e-12)
    assert abs(torque(flow)[0]) > 1e-3


def test_node_shear_of_a_channel():
    mesh = rectangle(2.0, 1.0, 8)
    flow = solve_stokes(mesh, {"left": Pressure(1.0), "right": Pressure(0.0)})
    shear = node_shear(flow)
    y = mesh.points[:, 1]
    np.testing.assert_allclose(np.abs(shear[(y == 0.0) | (y == 1.0)]), 0.25, rtol=1e-12)
    assert np.isnan(shear[(y > 0.0) & (y < 1.0)]).all()


def test_pillars_that_are_no_walls_feel_nothing():
    flow = solve_stokes(cylinder_in_square(0.1, 24), {"left": Pressure(1.0), "pillars": Slip()})
    assert drag(flow).shape == (1, 2)
    assert not drag(flow).any()
    assert torque(flow).tolist() == [0.0]


def test_faults(array):
    with pytest.raises(InputError, match="'friction'"):
        drag(array, "friction")
    with pytest.raises(InputError, match=r"centre has shape \(3,\)"):
        torque(array, (0.0, 0.0, 0.0))
    with pytest.raises(InputError, match="centre"):
        torque(array, (np.nan, 0.0))


def test_the_centroid_of_an_uneven_pillar():
    # Half a disk: the mean of its nodes is not its centroid.
    angle = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 24)
    half = np.column_stack([1.0 + 0.3 * np.cos(angle), 0.45 + 0.3 * np.sin(angle)])
    mesh = generate_mesh(Domain.rectangle(2.0, 1.0, [half]), 0.08, 0.04)
    flow = solve_stokes(mesh, {"left": Pressure(1.0), "right": Pressure(0.0)})
    centre = shapely.Polygon(half).centroid.coords[0]
    assert torque(flow)[0] == pytest.approx(torque(flow, centre)[0], rel=1e-9)
    assert torque(flow)[0] != pytest.approx(torque(flow, half.mean(axis=0))[0], rel=2e-2)
