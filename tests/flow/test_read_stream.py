"""The stream function: conservative, constant on walls, refused where it has no single value."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.flow.exact import AT_REST
from tests.flow.meshes import annulus, cylinder_in_square, rectangle

from vasculo.errors import InputError
from vasculo.flow.boundary import Periodic, Pressure, Slip, Velocity
from vasculo.flow.read.stream import add_up, add_up_plain, edge_fluxes, stream_function
from vasculo.flow.stokes import solve_stokes
from vasculo.mesh.triangulation import Triangulation


def missed(flow, psi):
    ends, flux = edge_fluxes(flow)
    return np.abs(psi[ends[:, 1]] - psi[ends[:, 0]] - flux).max()


def test_poiseuille_flow():
    mesh = rectangle(2.0, 1.0, 8, seed=1)
    flow = solve_stokes(mesh, {"left": Pressure(24.0), "right": Pressure(0.0)})
    psi = stream_function(flow)
    y = mesh.points[:, 1]
    np.testing.assert_allclose(psi, 3.0 * y**2 - 2.0 * y**3, atol=1e-13)
    assert np.ptp(psi[y == 0.0]) == 0.0
    assert np.ptp(psi[y == 1.0]) == 0.0
    assert missed(flow, psi) < 1e-14


def test_walls_and_pillars_are_streamlines():
    mesh = cylinder_in_square(0.1, 32)
    flow = solve_stokes(mesh, {"left": Pressure(1.0), "right": Pressure(0.0), "top": Slip()}, viscosity=0.1)
    psi = stream_function(flow)
    assert missed(flow, psi) < 1e-12 * np.ptp(psi)
    for name in ("top", "bottom", "pillars"):
        on = np.unique(mesh.boundary_edges[mesh.edge_of(name)])
        assert np.ptp(psi[on]) == 0.0
    y = mesh.points[:, 1]
    assert psi[y == 0.0][0] == 0.0
    assert psi[y == 1.0][0] == pytest.approx(flow.flow_rate("right"), rel=1e-12)
    pillar = psi[np.unique(mesh.boundary_edges[mesh.edge_of("pillars")])][0]
    assert 0.0 < pillar < flow.flow_rate("right")


def test_the_second_order_of_a_driven_swirl():
    worst = []
    for across in (8, 16, 32):
        mesh = rectangle(1.0, 1.0, across, seed=3)
        psi = stream_function(solve_stokes(mesh, {}, force=AT_REST.force(mesh)))
        x, y = mesh.points.T
        exact = np.sin(np.pi * x) ** 2 * np.sin(np.pi * y) ** 2 / np.pi
        worst.append(np.sqrt(np.mean((psi - exact) ** 2)))
    assert np.log2(worst[0] / worst[2]) / 2.0 > 1.8


def test_seams_are_cuts():
    mesh = cylinder_in_square(0.2, 32)
    flow = solve_stokes(mesh, {"left": Periodic("right", 1.0), "bottom": Periodic("top", 0.4)})
    psi = stream_function(flow)
    assert missed(flow, psi) < 1e-12 * np.ptp(psi)
    x, y = mesh.points.T
    for at, along, passing in ((x, y, flow.flow_rate("top")), (y, x, flow.flow_rate("right"))):
        low, high = (np.flatnonzero(np.abs(at - side) < 1e-9) for side in (0.0, 1.0))
        jump = psi[high[np.argsort(along[high])]] - psi[low[np.argsort(along[low])]]
        sign = -1.0 if at is x else 1.0
        np.testing.assert_allclose(jump, sign * passing, atol=1e-12 * np.ptp(psi))


def test_parts_of_the_fluid_each_have_their_own():
    one, two = rectangle(1.0, 1.0, 5, seed=0), rectangle(1.0, 1.0, 5, seed=1)
    count = len(one.points)
    mesh = Triangulation(
        np.concatenate([one.points, two.points + np.array([0.0, 2.0])]),
        np.concatenate([one.triangles, two.triangles + count]),
        np.concatenate([one.boundary_edges, two.boundary_edges + count]),
        np.concatenate([one.boundary_tags, two.boundary_tags]), one.side_names,
    )  # fmt: skip
    flow = solve_stokes(mesh, {"left": Pressure(12.0), "right": Pressure(0.0)})
    psi = stream_function(flow)
    half = 0.5 * flow.flow_rate("right")
    assert [np.ptp(psi[:count]), np.ptp(psi[count:])] == pytest.approx([half, half], rel=1e-12)
    assert missed(flow, psi) < 1e-13


def test_a_pillar_that_gives_out_fluid_is_refused():
    mesh = annulus()
    flow = solve_stokes(mesh, {"pillars": Velocity(lambda x, y: (x, y)), "rim": Pressure(0.0)})
    with pytest.raises(InputError, match=r"pillar 0 gives out 1\.5"):
        stream_function(flow)


@settings(deadline=None, max_examples=25)
@given(st.integers(0, 10_000), st.integers(2, 12), st.integers(1, 3))
def test_kernel_and_twin(seed, nodes, parts):
    rng = np.random.default_rng(seed)
    total = nodes * parts
    ends = np.concatenate([rng.integers(0, nodes, (3 * nodes, 2)) + nodes * p for p in range(parts)])
    ends = np.concatenate([ends, np.column_stack([np.arange(total - 1), np.arange(1, total)])])
    ends = ends[(ends[:, 0] != ends[:, 1]) & (ends[:, 0] // nodes == ends[:, 1] // nodes)].astype(np.int32)
    values = rng.normal(size=total)
    flux = values[ends[:, 1]] - values[ends[:, 0]]
    roots = rng.permutation(total)
    found = add_up(ends, flux, roots, total)
    np.testing.assert_allclose(found, add_up_plain(ends, flux, roots, total), atol=1e-12)
