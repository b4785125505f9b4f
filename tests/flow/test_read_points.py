"""Points are found in their triangles, and velocity and pressure interpolated there."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.flow.exact import ANNULUS
from tests.flow.meshes import annulus, cylinder_in_square, rectangle

from vasculo.errors import InputError
from vasculo.flow.boundary import Periodic, Pressure, Velocity
from vasculo.flow.read.locate import Locator, find_triangles_plain
from vasculo.flow.read.points import pressure_at, velocity_at
from vasculo.flow.stokes import solve_stokes
from vasculo.springs.threads import get_threads, set_threads

MESHES = (rectangle(1.7, 1.0, 7, seed=3), annulus(3, 17), cylinder_in_square(0.2, 24), annulus(2, 8, inner=0.01))


@settings(deadline=None, max_examples=30)
@given(st.integers(0, 10_000), st.sampled_from(MESHES))
def test_kernel_and_twin(seed, mesh):
    rng = np.random.default_rng(seed)
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    nodes = mesh.points[rng.integers(0, len(mesh.points), 5)]
    points = np.concatenate([rng.uniform(low - 0.1, high + 0.1, (60, 2)), nodes])
    found, shares = Locator(mesh).find(points)
    plain, others = find_triangles_plain(points, mesh.points, mesh.triangles)
    np.testing.assert_array_equal(found < 0, plain < 0)
    np.testing.assert_array_equal(found[:60], plain[:60])
    np.testing.assert_allclose(shares[:60], others[:60], atol=1e-12)
    inside = found >= 0
    back = np.einsum("kc,kcd->kd", shares[inside], mesh.points[mesh.triangles[found[inside]]])
    np.testing.assert_allclose(back, points[inside], atol=1e-12)


def test_nodes_and_edges_lie_inside():
    for mesh in MESHES:
        middles = mesh.points[mesh.faces.ends].mean(axis=1)
        found, shares = Locator(mesh).find(np.concatenate([mesh.points, middles]))
        assert (found >= 0).all()
        assert shares.min() >= 0.0
        np.testing.assert_allclose(shares.sum(axis=1), 1.0, atol=1e-15)


def test_linear_flow_and_pressure():
    def shear(x, y):
        return 2.0 * y - 1.0, 0.5 * x

    mesh = annulus(4, 24)
    flow = solve_stokes(mesh, {"pillars": Velocity(shear), "rim": Velocity(shear)})
    points = np.random.default_rng(0).uniform(-1.0, 1.0, (500, 2))
    found = velocity_at(flow, points)
    inside = ~np.isnan(found[:, 0])
    radius = np.hypot(*points.T)
    assert inside[(radius > 0.5) & (radius < 0.99)].all()
    assert not inside[(radius < 0.49) | (radius > 1.0)].any()
    np.testing.assert_allclose(found[inside], np.column_stack(shear(*points[inside].T)), atol=1e-11)

    mesh = rectangle(2.0, 1.0, 8, seed=1)
    for sides in ({"left": Pressure(5.0), "right": Pressure(1.0)}, {"left": Periodic("right", 4.0)}):
        flow = solve_stokes(mesh, sides)
        points = np.array([[0.3, 0.2], [1.9, 0.99], [2.1, 0.5]])
        found = pressure_at(flow, points) - pressure_at(flow, [[0.0, 0.5]])
        np.testing.assert_allclose(found, [-0.6, -3.8, np.nan], atol=1e-11)


def test_second_order_and_rest_at_the_walls():
    swirl = Velocity(lambda x, y: (ANNULUS.u(x, y), ANNULUS.v(x, y)))
    points = np.random.default_rng(1).uniform(-0.7, 0.7, (1000, 2))
    points = points[np.hypot(*points.T) > 0.52]
    worst = []
    for k in (1, 2, 4):
        flow = solve_stokes(annulus(4 * k, 30 * k), {"pillars": swirl})
        found = velocity_at(flow, points)
        worst.append(np.sqrt(np.mean((found[:, 0] - ANNULUS.u(*points.T)) ** 2)))
        rim = flow.mesh.points[flow.wall_edges[flow.wall_pillar < 0]].mean(axis=1)
        np.testing.assert_allclose(velocity_at(flow, rim), 0.0, atol=1e-15)
    assert np.log2(worst[0] / worst[2]) / 2.0 > 1.8


def test_threads_change_no_bit():
    points = np.random.default_rng(0).uniform(-1.0, 1.0, (20_000, 2))
    locator = Locator(annulus(8, 60))
    before = get_threads()
    try:
        set_threads(1)
        one = locator.find(points)
        set_threads(2)
        two = locator.find(points)
    finally:
        set_threads(before)
    np.testing.assert_array_equal(two[0], one[0])
    np.testing.assert_array_equal(two[1], one[1])


def test_faults():
    locator = Locator(MESHES[0])
    with pytest.raises(InputError, match=r"shape \(2,\)"):
        locator.find([0.0, 1.0])
    with pytest.raises(InputError, match="1 of 2 points"):
        locator.find([[0.0, 1.0], [np.inf, 0.0]])
