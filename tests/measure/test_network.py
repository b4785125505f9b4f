import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad
from tests.measure.arrays import MIRRORS, disk, plexus, square_array

from vasculo import measure
from vasculo.errors import ComputationError, InputError
from vasculo.geometry.domain import Domain
from vasculo.measure.network import poiseuille_network
from vasculo.measure.outline_pieces import LONGEST, facing_widths, facing_widths_plain
from vasculo.measure.passage_legs import link_legs, walk_pressures
from vasculo.measure.passage_legs_plain import link_legs_plain, walk_pressures_plain
from vasculo.measure.tubules import tubule_flow
from vasculo.plexus.voronoi import voronoi_plexus

DRAG = {0.3: 102.881304, 0.5: 532.54812, 0.7: 13519.152}
"""Drag over viscosity and mean speed of square arrays, by multipole series."""


@pytest.mark.parametrize(("gap", "error"), [(0.1, 0.04), (0.03, 0.012), (0.01, 0.004)])
def test_two_disks_in_lubrication(gap, error):
    # dp = 9 pi / 2 viscosity q sqrt(radius) gap^-5/2 (paraboloids in place of circles: leading order in the gap)
    pillars = [disk(6.0, 6.0 + side * (1.0 + 0.5 * gap), nodes=2000) for side in (-1, 1)]
    found = poiseuille_network(Domain.rectangle(12.0, 12.0, pillars), viscosity=2.0)
    (row,) = np.flatnonzero(found.between_walls & (found.bodies[:, 1] >= 0))
    assert found.resistance[row] == pytest.approx(2.0 * 4.5 * np.pi * gap**-2.5, rel=error)


def test_a_straight_channel_is_exact():
    # one pillar far down a channel of width 1: on the way to it the pressure falls by 12 q / w^3 a length
    found = poiseuille_network(Domain.rectangle(12.0, 1.0, [disk(6.0, 0.5, 0.2)]), {"left": 3.0, "right": 1.0})
    assert found.outflow["right"] == pytest.approx(-found.outflow["left"], rel=1e-14)
    for (x, _), pressure in zip(found.junctions.place, found.pressure, strict=True):
        left = x < 6.0
        way = x if left else 12.0 - x
        lost = (3.0 - pressure) if left else (pressure - 1.0)
        assert lost == pytest.approx(12.0 * found.outflow["right"] * way, rel=0.02)


@pytest.mark.parametrize(("fraction", "error"), [(0.3, 0.058), (0.5, 0.034), (0.7, 0.011)])
def test_square_arrays(fraction, error):
    found = poiseuille_network(square_array(fraction, 4, 2, 512), mirrors=MIRRORS)
    # along the line between two rows, circles of this radius touch both: 2 (sqrt(x^2 + 1/4) - radius) is the width
    radius = np.sqrt(fraction / np.pi)
    lost, _ = quad(lambda x: 12.0 * (2.0 * (np.hypot(x, 0.5) - radius)) ** -3, -0.5, 0.5, points=[0.0])
    assert 4.0 / 2.0 * lost * found.outflow["right"] == pytest.approx(1.0, abs=2e-3)
    assert 4.0 / 2.0 * DRAG[fraction] * found.outflow["right"] == pytest.approx(1.0, abs=error)


def test_cutting_outlines_finer_changes_little():
    rates = [poiseuille_network(square_array(0.5, 3, 2, n), mirrors=MIRRORS).outflow["right"] for n in (128, 512)]
    assert rates[0] == pytest.approx(rates[1], rel=3e-3)


def test_a_mirror_line_halves_a_domain():
    whole = Domain.rectangle(8.0, 6.0, [disk(x, y) for x in (2.0, 6.0) for y in (1.5, 4.5)])
    half = Domain.rectangle(8.0, 3.0, [disk(x, 1.5) for x in (2.0, 6.0)])
    both, one = poiseuille_network(whole), poiseuille_network(half, mirrors=["top"])
    assert one.outflow["right"] == pytest.approx(0.5 * both.outflow["right"], rel=1e-3)
    top = one.bodies[:, 1] == -1 - one.sides.index("top")
    pairs = (both.bodies == [0, 1]).all(axis=1) | (both.bodies == [2, 3]).all(axis=1)
    np.testing.assert_allclose(np.abs(one.flux[top]), 0.5 * np.abs(both.flux[pairs]), rtol=1e-3)


def test_against_the_solved_flow():
    domain, flow = plexus()
    resolved, found = tubule_flow(domain, flow), poiseuille_network(domain, mirrors=MIRRORS)
    np.testing.assert_array_equal(found.bodies, resolved.bodies)
    np.testing.assert_array_equal(found.junctions.bodies, resolved.junctions.bodies)
    walls = resolved.between_walls
    assert np.corrcoef(found.flux[walls], resolved.flux[walls])[0, 1] > 0.999
    assert found.permeability(domain) == pytest.approx(measure.permeability(domain, flow), rel=0.08)
    bare = poiseuille_network(domain, mirrors=MIRRORS, junction_resistance=False)
    assert found.outflow["right"] < flow.flow_rate("right") < bare.outflow["right"]
    assert np.nansum(np.abs(found.flux - resolved.flux)) < 0.08 * np.nansum(np.abs(resolved.flux))
    lined = walls & np.isfinite(resolved.wall_shear)
    ratio = found.wall_shear[lined] / resolved.wall_shear[lined]
    assert np.median(ratio) == pytest.approx(1.0, abs=0.12)
    np.testing.assert_array_equal(found.columns()["resistance"], found.resistance)


def test_pressures_fit_the_openings():
    domain, _ = plexus()
    found = poiseuille_network(domain, mirrors=MIRRORS)
    assert ((found.pressure > 0.0) & (found.pressure < 1.0)).all()
    # power in is power lost
    lost = np.nansum(np.unique(found.resistance * found.flux**2))
    assert 0.5 < lost / found.outflow["right"] <= 1.0 + 1e-12


def test_linear_in_pressure_and_fluidity():
    domain, _ = plexus()
    one = poiseuille_network(domain, {"left": 1.0, "right": 0.0}, mirrors=MIRRORS)
    two = poiseuille_network(domain, {"left": -4.0, "right": 2.0}, 3.0, mirrors=MIRRORS)
    scale = np.nanmax(np.abs(one.flux))
    np.testing.assert_allclose(two.flux, -2.0 * one.flux, atol=1e-12 * scale)
    np.testing.assert_allclose(two.pressure, 2.0 - 6.0 * one.pressure, atol=1e-10)
    np.testing.assert_allclose(two.wall_shear, 6.0 * one.wall_shear, rtol=1e-9)
    assert two.permeability(domain) == pytest.approx(one.permeability(domain), rel=1e-12)


@settings(max_examples=8, deadline=None)
@given(
    seed=st.integers(0, 1000),
    scale=st.floats(0.01, 100.0),
    turn=st.sampled_from([0, 1, 2, 3]),
    flip=st.booleans(),
)
def test_turned_mirrored_and_scaled(seed, scale, turn, flip):
    domain = voronoi_plexus(9, seed=seed)
    matrix = scale * np.linalg.matrix_power(np.array([[0.0, -1.0], [1.0, 0.0]]), turn)
    if flip:
        matrix = matrix @ np.diag([1.0, -1.0])
    moved = Domain(domain.outer @ matrix.T, [p @ matrix.T for p in domain.pillars], domain.sides)
    one, two = (poiseuille_network(d, mirrors=MIRRORS) for d in (domain, moved))
    # the flow per depth is dp w^3 / (12 viscosity length): it grows with the square of lengths
    assert two.outflow["right"] == pytest.approx(scale**2 * one.outflow["right"], rel=1e-6)
    assert two.gini == pytest.approx(one.gini, rel=1e-5)


def test_three_openings_and_two_that_meet():
    pillars = [disk(x, y, 0.8) for x in (2.0, 4.5, 7.0) for y in (1.5, 4.0)]
    domain = Domain.rectangle(9.0, 5.5, pillars)
    # the left side and the bottom meet at a corner: one opening, one pressure
    found = poiseuille_network(domain, {"left": 2.0, "bottom": 2.0})
    assert list(found.outflow) == ["bottom+left"]
    assert found.outflow["bottom+left"] == pytest.approx(0.0, abs=1e-12)
    with pytest.raises(InputError, match="openings of pressure 0 and 2 meet: put a wall between them"):
        poiseuille_network(domain, {"left": 2.0, "bottom": 0.0})
    # three openings parted by walls: what comes in goes out, more on the straighter way
    outer = np.array([(0, 0), (9, 0), (9, 1), (9, 1.5), (9, 4), (9, 5.5), (0, 5.5), (0, 2), (0, 1)])
    fork = Domain(outer, pillars, {"in": 7, "low": 1, "high": 3})
    found = poiseuille_network(fork, {"in": 1.0, "low": 0.0, "high": 0.0})
    assert sum(found.outflow.values()) == pytest.approx(0.0, abs=1e-14)
    assert found.outflow["low"] > 0.0
    assert found.outflow["high"] > 0.0


def test_the_kernels_and_their_twins():
    domain, _ = plexus()
    found = poiseuille_network(domain, mirrors=MIRRORS)
    graph, pieces = found.graph, found.graph.pieces
    slip = np.isin(graph.segment_side, [graph.sides.index(name) for name in MIRRORS])
    legs = (
        pieces.points, pieces.before, pieces.after, pieces.triangles, pieces.body, graph.segment_body, slip, graph.links
    )  # fmt: skip
    for one, two in zip(link_legs(*legs), link_legs_plain(*legs), strict=True):
        np.testing.assert_allclose(one, two, rtol=1e-9, atol=1e-12)
    widths = (*legs[:6], graph.closed)
    one, two = facing_widths(*widths), facing_widths_plain(*widths)
    np.testing.assert_allclose(one, two, rtol=1e-12)
    length = np.hypot(*(pieces.points[pieces.after] - pieces.points).T)
    assert (length <= LONGEST * one).all()


def test_the_walk_of_pressures_and_its_twin():
    domain = voronoi_plexus(3, seed=1, spacing=0.5)
    found = poiseuille_network(domain, mirrors=MIRRORS)
    graph, pieces = found.graph, found.graph.pieces
    slip = np.isin(graph.segment_side, [graph.sides.index(name) for name in MIRRORS])
    resistance, _, _ = link_legs(
        pieces.points, pieces.before, pieces.after, pieces.triangles, pieces.body, graph.segment_body, slip, graph.links
    )
    psi = np.where(graph.closed, 0.0, np.nan)
    joined = found.between_walls
    for _ in psi:  # from body 0 on, row by row
        for (one, two), flux in zip(graph.row_bodies[joined], found.flux[joined], strict=True):
            if two != 0:
                psi[two] = psi[one] + flux if one == 0 or psi[one] != 0.0 else psi[two]
    mouths = graph.links.sum(axis=1) == 1
    left = pieces.points[pieces.triangles].mean(axis=1)[:, 0] < 0.5 * domain.bounds[2]
    given_pressure = np.where(mouths, np.where(left, 1.0, 0.0), np.nan)
    arrays = pieces.triangles, pieces.neighbours, pieces.body, graph.links, resistance, psi, given_pressure
    one, two = walk_pressures(*arrays), walk_pressures_plain(*arrays)
    np.testing.assert_allclose(one, two, atol=1e-9)
    np.testing.assert_allclose(one[graph.junctions], found.pressure, atol=1e-12)


def test_bad_input():
    domain, _ = plexus()
    for pressures, message in (
        ({}, "at least one side"),
        ({"left": np.nan}, "pressure on 'left' is nan"),
        ({"lift": 1.0}, "no side is called 'lift'; the sides are bottom, left, right, top"),
    ):
        with pytest.raises(InputError, match=message):
            poiseuille_network(domain, pressures)
    with pytest.raises(InputError, match="viscosity is -1"):
        poiseuille_network(domain, viscosity=-1.0)
    with pytest.raises(InputError, match="'left' has a pressure"):
        poiseuille_network(domain, mirrors=["left"])
    with pytest.raises(InputError, match="no side is called 'up'"):
        poiseuille_network(domain, mirrors=["up"])
    with pytest.raises(InputError, match="at least one pillar"):
        poiseuille_network(Domain.rectangle(3.0, 1.0))
    with pytest.raises(InputError, match="nothing parts the openings of pressure 0 and 1"):
        poiseuille_network(Domain.rectangle(1.0, 9.0, [disk(0.5, 1.0, 0.2)]))
    found = poiseuille_network(domain, {"left": 1.0, "right": 1.0}, mirrors=MIRRORS)
    with pytest.raises(InputError, match="no pressure drop from left to right: both 1"):
        found.permeability(domain)
    with pytest.raises(InputError, match="'top' is no opening of its own; these are right, left"):
        found.permeability(domain, "top")


def test_mirror_lines_alone_hold_nothing_back():
    # a plain channel between mirror lines, and the only pillar in a blind arm of it
    outer = np.array([(0, 0), (8, 0), (8, 1), (4.5, 1), (4.5, 6), (3.5, 6), (3.5, 1), (0, 1)], dtype=float)
    names = ["floor", "right", "roof", "arm", "arm", "arm", "roof", "left"]
    domain = Domain(outer, [disk(4.0, 5.0, 0.2, 16)], names)
    with pytest.raises(ComputationError, match="nothing holds back the flow"):
        poiseuille_network(domain, mirrors=["floor", "roof", "arm"])
    assert poiseuille_network(domain, mirrors=["floor"]).outflow["right"] > 0.0
