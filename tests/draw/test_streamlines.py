"""Streamlines: the stream function from recorded velocities, against flows whose own is known."""

import numpy as np
import pytest

import vasculo as vc
from vasculo.draw.canvas import new_figure
from vasculo.draw.streamlines import draw_streamlines, stream_values
from vasculo.flow.read.stream import stream_function
from vasculo.store.read import FlowFields


def fields(mesh, velocity):
    nothing = np.empty(0)
    edges = np.empty((0, 2), dtype=np.int32)
    return FlowFields(mesh, velocity, nothing, nothing, edges, edges[:, 0], nothing)


@pytest.fixture(scope="module")
def solved():
    angle = np.linspace(0.0, 2.0 * np.pi, 40, endpoint=False)
    disk = np.stack((3.0 + 0.6 * np.cos(angle), 1.7 + 0.6 * np.sin(angle)), axis=1)
    mesh = vc.generate_mesh(vc.Domain.rectangle(6.0, 4.0, [disk]), edge_length=0.25)
    sides = {"left": vc.Pressure(1.0), "right": vc.Pressure(0.0), "bottom": vc.Slip(), "top": vc.Slip()}
    return vc.solve_stokes(mesh, sides)


@pytest.mark.parametrize("angle", [0.0, 0.7, 2.5])
def test_a_uniform_flow_has_a_linear_stream_function(angle):
    mesh = vc.generate_mesh(vc.Domain.rectangle(3.0, 2.0), edge_length=0.4)
    u, v = np.cos(angle), np.sin(angle)
    psi = stream_values(fields(mesh, np.tile((u, v), (len(mesh.triangles), 1))))
    wanted = u * mesh.points[:, 1] - v * mesh.points[:, 0]
    np.testing.assert_allclose(psi - psi[0], wanted - wanted[0], atol=1e-12)


def test_it_comes_near_the_exact_one_of_a_solved_flow(solved):
    exact = stream_function(solved)
    psi = stream_values(fields(solved.mesh, solved.velocity))
    difference = (psi - exact) - np.mean(psi - exact)
    assert np.abs(difference).max() < 0.02 * np.ptp(exact)
    mesh = solved.mesh
    wall = np.unique(mesh.boundary_edges[mesh.boundary_tags == 0])
    assert np.ptp(psi[wall]) == 0.0


def test_the_same_flow_passes_between_each_two_lines(solved):
    axes = new_figure(3, 2).subplots()
    lines = draw_streamlines(axes, fields(solved.mesh, solved.velocity), 8)
    psi = stream_values(fields(solved.mesh, solved.velocity))
    assert len(lines.levels) == 8
    np.testing.assert_allclose(np.diff(lines.levels), np.ptp(psi) / 8)


def test_fluid_at_rest_has_no_lines(solved):
    axes = new_figure(3, 2).subplots()
    assert draw_streamlines(axes, fields(solved.mesh, np.zeros_like(solved.velocity)), 8) is None
