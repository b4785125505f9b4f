import numpy as np
import pytest

from vasculo import measure
from vasculo.errors import InputError
from vasculo.flow.boundary import Pressure, Slip
from vasculo.flow.stokes import solve_stokes
from vasculo.geometry.domain import Domain
from vasculo.mesh.generate import generate_mesh
from vasculo.plexus.voronoi import disk_domain, voronoi_plexus

MIRRORS = {"top": Slip(), "bottom": Slip()}


def ellipse(degrees, centre, long=1.2, short=0.6, nodes=40):
    t = 2.0 * np.pi * np.arange(nodes) / nodes
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    flat = np.stack([long * np.cos(t), short * np.sin(t)], axis=1)
    return flat @ np.array([[c, s], [-s, c]]) + centre


def solved(domain, high=2.0, low=0.0, viscosity=1.0, spacing=0.5, **sides):
    mesh = generate_mesh(domain, spacing, 0.5 * spacing)
    conditions = {"left": Pressure(high), "right": Pressure(low)} | (sides or MIRRORS)
    return solve_stokes(mesh, conditions, viscosity)


@pytest.fixture(scope="module")
def disk():
    domain = disk_domain()
    return domain, solved(domain, viscosity=3.0)


@pytest.fixture(scope="module")
def block():
    domain = voronoi_plexus(9, channel=0.7, pad=1.0, seed=3)
    return domain, solved(domain, spacing=0.4)


def test_permeability_of_an_empty_channel():
    domain = Domain.rectangle(4.0, 1.0)
    mesh = generate_mesh(domain, 0.08)
    flow = solve_stokes(mesh, {"left": Pressure(5.0), "right": Pressure(1.0)}, 2.0)
    assert measure.permeability(domain, flow) == pytest.approx(1.0 / 12.0, rel=0.02)


def test_permeability_is_that_of_the_prescribed_drop(disk):
    domain, flow = disk
    expected = flow.flow_rate("right") * 3.0 * 12.0 / (8.0 * 2.0)
    assert measure.permeability(domain, flow) == pytest.approx(expected, rel=3e-3)


def test_permeability_knows_no_units_of_the_flow(block):
    domain, flow = block
    other = solved(domain, high=-1.0, low=6.0, viscosity=5.0, spacing=0.4)
    assert measure.permeability(domain, other) == pytest.approx(measure.permeability(domain, flow), rel=1e-6)
    assert measure.shear_ratio(other) == pytest.approx(measure.shear_ratio(flow), rel=1e-6)
    assert measure.alignment(domain, other) == pytest.approx(measure.alignment(domain, flow), abs=1e-6)
    assert measure.mean_wall_shear(other) == pytest.approx(3.5 * measure.mean_wall_shear(flow), rel=1e-6)


def test_drag_balances_the_pressure(disk, block):
    for domain, flow in (disk, block):
        height = domain.bounds[3]
        total = measure.pillar_drag(domain, flow).sum(axis=0)
        assert total[0] == pytest.approx(2.0 * height, rel=0.01)  # mirror walls carry no shear
        assert abs(total[1]) < 0.1 * total[0]


def test_alignment_is_against_the_drag_and_not_x():
    # one pillar in a channel along y
    outer = [(0, 0), (4, 0), (4, 8), (0, 8)]
    for degrees, expected in ((90.0, 1.0), (0.0, -1.0)):
        domain = Domain(outer, [ellipse(degrees, (2.0, 4.0))], ("low", "right", "high", "left"))
        mesh = generate_mesh(domain, 0.35, 0.15)
        conditions = {"low": Pressure(1.0), "high": Pressure(0.0), "left": Slip(), "right": Slip()}
        flow = solve_stokes(mesh, conditions)
        assert measure.alignment(domain, flow) == pytest.approx(expected, abs=0.02)
        assert measure.order(domain) == pytest.approx(-expected, abs=1e-6)
        assert measure.permeability(domain, flow, "low", "high") > 0.0


def test_shear_of_one_and_of_unlike_pillars(disk):
    _, flow = disk
    assert measure.shear_ratio(flow) == 1.0
    uneven = Domain.rectangle(10.0, 6.0, [ellipse(0.0, (3.0, 1.1), 0.8, 0.6), ellipse(0.0, (7.0, 3.4), 1.5, 1.5)])
    assert measure.shear_ratio(solved(uneven)) > 1.05


def test_nothing_to_measure():
    empty = Domain.rectangle(3.0, 1.0)
    flow = solve_stokes(generate_mesh(empty, 0.3), {"left": Pressure(1.0), "right": Pressure(0.0)})
    for function in (measure.mean_wall_shear, measure.shear_ratio):
        with pytest.raises(InputError, match="no pillar has a wall"):
            function(flow)
    with pytest.raises(InputError, match="none of 0"):
        measure.alignment(empty, flow)
    with pytest.raises(InputError, match="no pressure drop"):
        measure.permeability(empty, flow, "left", "left")
