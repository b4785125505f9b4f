"""Periodic sides in both directions, on square and skew cells; several inlets and outlets; single pillars."""

import numpy as np
import pytest
from tests.flow.lattice_cell import lattice_cell
from tests.flow.meshes import rectangle

from vasculo.flow.boundary import Periodic, Pressure, Slip, Velocity, Wall
from vasculo.flow.stokes import solve_stokes
from vasculo.geometry.domain import Domain
from vasculo.mesh.generate import generate_mesh

SQUARE = ((1.0, 0.0), (0.0, 1.0))
HEXAGONAL = ((1.0, 0.0), (0.5, np.sqrt(0.75)))


def mean_velocity(mesh, first, second, drops):
    """Mean over the whole cell, pillar included."""
    sides = {"left": Periodic("right", drops[0]), "bottom": Periodic("top", drops[1])}
    flow = solve_stokes(mesh, sides)
    return mesh.areas @ flow.velocity / abs(first[0] * second[1] - first[1] * second[0]), flow


def permeability(mesh, first, second):
    """Tensor K of the mean velocity K G for a mean pressure drop per length G."""
    lattice = np.array([first, second])
    gradients = np.linalg.solve(lattice, np.eye(2)).T
    means = np.array([mean_velocity(mesh, first, second, drops)[0] for drops in np.eye(2)])
    return np.linalg.solve(gradients, means).T


def ellipse(angle):
    return 0.15 / np.sqrt(1.0 - 0.75 * np.cos(angle - 0.5) ** 2)


def circle(fraction, cell):
    """Regular or not, the polygon has the area of the circle."""

    def outline(angle):
        turn = np.diff(np.append(angle, angle[0])) % (2.0 * np.pi)
        return np.full(len(angle), np.sqrt(fraction * cell * 2.0 / np.sin(turn).sum()))

    return outline


@pytest.mark.parametrize(("fraction", "drag"), [(0.1, 25.132025), (0.3, 96.793381), (0.5, 382.222710)])
def test_a_hexagonal_array_in_a_parallelogram(fraction, drag):
    # Drag of a cylinder in the hexagonal array, by multipoles; its permeability is the same in every direction.
    mesh = lattice_cell(*HEXAGONAL, circle(fraction, np.sqrt(0.75)), 24, 14)
    found = permeability(mesh, *HEXAGONAL) * drag / np.sqrt(0.75)
    np.testing.assert_allclose(found, np.eye(2), atol=2e-3)


def test_the_permeability_of_a_skew_array_is_symmetric_and_positive():
    cell = (1.0, 0.0), (0.3, 0.9)
    found = [permeability(lattice_cell(*cell, ellipse, 6 * k, 4 * k), *cell) for k in (1, 2)]
    assert np.linalg.eigvalsh(found[1]).min() > 0.0
    assert found[1][0, 1] > 0.2 * found[1][0, 0]
    skew = [abs(k[0, 1] - k[1, 0]) / k[0, 1] for k in found]
    assert skew[1] < 0.01
    assert skew[1] < 0.5 * skew[0]


def test_drops_in_both_directions_add_up():
    mesh = lattice_cell(*SQUARE, ellipse, 9, 6)
    one, _ = mean_velocity(mesh, *SQUARE, (1.0, 0.0))
    two, _ = mean_velocity(mesh, *SQUARE, (0.0, 1.0))
    both, flow = mean_velocity(mesh, *SQUARE, (2.0, -0.7))
    np.testing.assert_allclose(both, 2.0 * one - 0.7 * two, atol=1e-14)
    # The mean flow crosses the sides, but for the second-order difference of a mean over cells and one over faces.
    assert flow.flow_rate("right") == pytest.approx(both[0], rel=5e-3)
    assert flow.flow_rate("top") == pytest.approx(both[1], rel=5e-3)
    assert flow.flow_rate("left") == pytest.approx(-flow.flow_rate("right"), rel=1e-13)


def test_a_body_force_does_what_a_pressure_drop_does():
    mesh = lattice_cell(*HEXAGONAL, ellipse, 8, 5)
    _, flow = mean_velocity(mesh, *HEXAGONAL, (0.8, 0.3))
    gradient = np.linalg.solve(np.array(HEXAGONAL), (0.8, 0.3))
    pushed = solve_stokes(mesh, {"left": Periodic("right"), "bottom": Periodic("top")}, force=gradient)
    np.testing.assert_allclose(pushed.velocity, flow.velocity, atol=1e-14)
    there = pushed.pressure - mesh.centroids @ gradient
    there += np.sum(mesh.areas * (flow.pressure - there)) / np.sum(mesh.areas)
    np.testing.assert_allclose(there, flow.pressure, atol=1e-12)


def cross():
    """Crossing of two channels of width 1 and 0.6; the upper end belongs to two sides."""
    outer = [
        (1, 0),
        (1.6, 0),
        (1.6, 1),
        (3, 1),
        (3, 2),
        (1.6, 2),
        (1.6, 3),
        (1.3, 3),
        (1, 3),
        (1, 2),
        (0, 2),
        (0, 1),
        (1, 1),
    ]
    names = {"lower": 0, "east": 3, "upper right": 6, "upper left": 7, "west": 10}
    return generate_mesh(Domain(outer, [], names), 0.14)


def test_several_inlets_and_outlets_conserve_the_flow():
    mesh = cross()
    flow = solve_stokes(mesh, {
        "west": Velocity.parabolic(2.0), "lower": Velocity.parabolic(peak=-1.5), "upper left": Pressure(1.0),
        "upper right": Pressure(1.0), "east": Pressure(0.0),
    })  # fmt: skip
    rates = {name: flow.flow_rate(name) for name in mesh.side_names}
    assert rates["west"] == pytest.approx(-2.0, rel=1e-13)
    assert rates["lower"] == pytest.approx(0.6, rel=1e-13)
    assert rates["wall"] == 0.0
    assert sum(rates.values()) == pytest.approx(0.0, abs=1e-12)
    assert rates["upper left"] * rates["upper right"] != 0.0


def test_a_side_in_two_pieces_has_a_parabola_in_each():
    outer = [(0, 0), (2, 0), (2, 1), (0, 1), (0, 0.75), (0, 0.25)]
    mesh = generate_mesh(Domain(outer, [], {"in": [3, 5], "out": 1}), 0.1)
    flow = solve_stokes(mesh, {"in": Velocity.parabolic(4.0), "out": Velocity.parabolic(-2.0)})
    assert flow.flow_rate("in") == pytest.approx(-2.0, rel=1e-12)
    assert flow.flow_rate("out") == pytest.approx(2.0, rel=1e-12)
    middle = mesh.points[mesh.boundary_edges[mesh.edge_of("wall")]].mean(axis=1)
    assert ((middle[:, 0] == 0.0) & (middle[:, 1] > 0.25) & (middle[:, 1] < 0.75)).any()


def two_pillars():
    angle = 2.0 * np.pi * np.arange(24) / 24
    circle = 0.25 * np.column_stack([np.cos(angle), np.sin(angle)])
    pillars = [circle + np.array([x, 0.5]) for x in (0.8, 2.2)]
    return generate_mesh(Domain.rectangle(3.0, 1.0, pillars), 0.12)


def test_single_pillars_have_conditions_of_their_own():
    mesh = two_pillars()
    flow = solve_stokes(mesh, {"pillar 1": Wall.turning(1.0, (2.2, 0.5))})
    fast = [np.abs(flow.wall_shear[flow.wall_pillar == k]).max() for k in (0, 1)]
    assert fast[1] > 10.0 * fast[0] > 0.0
    source = solve_stokes(mesh, {
        "pillar 0": Velocity(lambda x, y: (x - 0.8, y - 0.5)), "pillars": Slip(), "right": Pressure(0.0),
    })  # fmt: skip
    # Twice the area of the pillar flows out of it; the other one is no wall.
    assert source.flow_rate("right") == pytest.approx(24 * 0.25**2 * np.sin(2 * np.pi / 24), rel=1e-10)
    assert set(source.wall_pillar) == {0, -1}


def test_all_pillars_named_one_by_one_are_the_pillars():
    mesh = two_pillars()
    ends = {"left": Pressure(1.0), "right": Pressure(0.0)}
    named = solve_stokes(mesh, ends | {"pillar 1": Slip(), "pillar 0": Slip(), "pillars": Wall()})
    np.testing.assert_array_equal(named.velocity, solve_stokes(mesh, ends | {"pillars": Slip()}).velocity)
    assert (named.wall_pillar == -1).all()


def test_periodic_sides_of_a_turned_mesh():
    mesh = rectangle(2.0, 1.0, 6, seed=2, turn=0.4)
    flow = solve_stokes(mesh, {"left": Periodic("right", 2.0)})
    assert flow.flow_rate("right") == pytest.approx(1.0 / 12.0, abs=1e-12)
