import numpy as np
import pytest
from tests.measure.arrays import box, disk, plexus

import vasculo as vc
from vasculo import measure
from vasculo.errors import InputError
from vasculo.flow.boundary import Periodic, Pressure, Slip, Velocity
from vasculo.geometry.domain import Domain
from vasculo.measure.tubules import tubule_flow

DRIVEN = {"left": Pressure(1.0), "right": Pressure(0.0)}


def solved(domain, size=0.3, conditions=DRIVEN):
    return vc.solve_stokes(vc.generate_mesh(domain, size), conditions)


def test_the_rows_are_the_passages():
    domain, flow = plexus()
    found, passages = tubule_flow(domain, flow), measure.passages(domain)
    np.testing.assert_array_equal(found.bodies, passages.bodies)
    np.testing.assert_array_equal(found.width, passages.width)
    np.testing.assert_array_equal(found.place, passages.place)
    names = [found.sides[-1 - other] if other < 0 else "" for other in found.bodies[:, 1]]
    assert set(names) == {"", "left", "right", "bottom", "top"}
    np.testing.assert_array_equal(found.between_walls, ~np.isin(names, ["left", "right"]))
    assert found.columns()["flux"] is found.flux
    assert list(found.columns()["other"][np.array(names) == "left"]) == ["left"] * names.count("left")


def test_the_flux_is_what_crosses_the_line_between_the_bodies():
    domain = Domain.rectangle(14.0, 3.0, [box(3, 0.8, 11, 0.9), box(3, 1.9, 11, 2.0)])
    flow = solved(domain, 0.14)
    found = tubule_flow(domain, flow)
    rates = []
    for row in np.flatnonzero(found.between_walls & (found.width < 1.1)):  # not past the end of a plate
        low, high = sorted(found.facing[row][:, 1])
        x, y = flow.mesh.centroids.T
        inside = (np.abs(x - 7.0) < 1.0) & (y > low) & (y < high)
        parabola = (y[inside] - low) * (high - y[inside])
        rate = (flow.velocity[inside, 0] @ parabola) / (parabola @ parabola) * (high - low) ** 3 / 6.0
        # a flux is positive towards the right of the way from the first to the second body
        upward = np.sign(found.facing[row][1, 1] - found.facing[row][0, 1])
        assert found.flux[row] == pytest.approx(upward * rate, rel=1e-4)
        assert found.mean_speed[row] == pytest.approx(rate / found.width[row], rel=1e-4)
        if found.bodies[row, 1] >= 0:  # plane Poiseuille flow but for the ends
            assert found.wall_shear[row] == pytest.approx(6.0 * rate / found.width[row] ** 2, rel=0.05)
        rates.append(abs(found.flux[row]))
    assert len(rates) == 3
    assert sum(rates) == pytest.approx(flow.flow_rate("right"), rel=1e-12)


def test_flows_balance_at_every_junction():
    domain, flow = plexus()
    found = tubule_flow(domain, flow)
    junctions = found.junctions
    passing = flow.flow_rate("right")
    assert len(junctions) > 10
    assert np.abs(junctions.outflow.sum(axis=1)).max() < 1e-14 * passing
    assert (junctions.diverging ^ junctions.converging ^ junctions.dead).all()
    assert junctions.diverging.any()
    assert junctions.converging.any()
    inflows = (junctions.outflow < 0.0).sum(axis=1)
    np.testing.assert_array_equal(inflows[junctions.diverging], 1)
    np.testing.assert_array_equal(inflows[junctions.converging], 2)
    np.testing.assert_allclose(junctions.shares[~junctions.dead].sum(axis=1), 1.0, rtol=1e-12)
    # the arms are rows of the table
    for number, arm in np.argwhere(junctions.rows >= 0):
        row = junctions.rows[number, arm]
        pair = junctions.bodies[number, [arm, (arm + 1) % 3]]
        assert set(pair) == set(found.bodies[row])
        sign = 1.0 if found.bodies[row, 0] == pair[0] else -1.0
        assert junctions.outflow[number, arm] == sign * found.flux[row]
    columns = junctions.columns()
    assert {len(column) for column in columns.values()} == {len(junctions)}
    assert set(columns["kind"]) <= {"dead", "diverging", "converging"}


def test_a_junction_lies_between_its_bodies():
    # three disks around a point: the middle of the junction is as far from all of them
    angle = np.pi / 2 + 2.0 * np.pi * np.arange(3) / 3
    domain = Domain.rectangle(10.0, 10.0, [disk(5 + 1.3 * np.cos(a), 5 + 1.3 * np.sin(a), nodes=60) for a in angle])
    junctions = tubule_flow(domain, solved(domain)).junctions
    (inner,) = np.flatnonzero((junctions.bodies >= 0).all(axis=1))
    np.testing.assert_allclose(junctions.place[inner], 5.0, atol=1e-3)


def test_turned_pressures_turn_every_flow():
    domain, flow = plexus()
    back = vc.solve_stokes(flow.mesh, {"left": Pressure(0.0), "right": Pressure(1.0), "bottom": Slip(), "top": Slip()})
    one, two = tubule_flow(domain, flow), tubule_flow(domain, back)
    scale = np.nanmax(np.abs(one.flux))
    np.testing.assert_allclose(two.flux, -one.flux, atol=1e-9 * scale)
    np.testing.assert_array_equal(two.junctions.diverging, one.junctions.converging)


def test_a_name_on_two_stretches_has_a_row_for_each():
    domain = Domain(box(0, 0, 6, 4), [disk(3, 1.5)], {"left": 3, "right": 1})
    flow = solved(domain)
    found = tubule_flow(domain, flow)
    walls = np.flatnonzero(found.between_walls)
    assert [found.sides[-1 - other] for other in found.bodies[walls, 1]] == ["wall", "wall"]
    assert sorted(found.width[walls]) == pytest.approx([0.5, 1.5])
    assert np.abs(found.flux[walls]).sum() == pytest.approx(flow.flow_rate("right"), rel=1e-12)


@pytest.mark.parametrize(
    ("conditions", "openings"),
    [
        ({"left": Velocity(lambda x, y: 0 * x + y * (4 - y), 0.0), "right": Pressure(0.0)}, {"left", "right"}),
        ({"left": Periodic("right", 1.0)}, {"left", "right"}),
        ({"top": Velocity(1.0)}, set()),
    ],
)
def test_every_kind_of_drive(conditions, openings):
    domain = Domain.rectangle(6.0, 4.0, [disk(3.0, 1.7, nodes=40)])
    found = tubule_flow(domain, solved(domain, conditions=conditions))
    shut = [found.sides[-1 - other] not in openings for other in found.bodies[:, 1]]
    np.testing.assert_array_equal(found.between_walls, shut)
    if not openings:  # what the lid carries over the disk comes back below
        assert found.flux[shut] == pytest.approx(found.flux[shut][0], rel=1e-12)
        assert abs(found.flux[shut][0]) > 0.01


def test_how_uneven_the_flow_is():
    domain, flow = plexus()
    found = tubule_flow(domain, flow)
    size = np.abs(found.flux[found.between_walls])
    apart = np.abs(size[:, None] - size).mean()
    assert found.gini == pytest.approx(apart / (2.0 * size.mean()), rel=1e-12)
    assert found.top_share(1.0) == pytest.approx(1.0)
    assert found.top_share(1e-9) == pytest.approx(size.max() / size.sum())
    assert 0.1 < found.top_share() < 1.0


def test_bad_input():
    domain, flow = plexus()
    with pytest.raises(InputError, match=r"solved around 12 pillars .*; this domain has 1"):
        tubule_flow(Domain.rectangle(9.0, 9.0, [disk(4, 4)]), flow)
    moved = Domain(domain.outer + 0.01, [pillar + 0.01 for pillar in domain.pillars], domain.sides)
    with pytest.raises(InputError, match="not that of this domain"):
        tubule_flow(moved, flow)
    one = Domain.rectangle(6.0, 4.0, [disk(3.0, 2.0, nodes=40)])
    with pytest.raises(InputError, match="pillar 0 is open"):
        tubule_flow(one, solved(one, conditions={"left": Pressure(1.0), "pillars": Pressure(0.0)}))
    with pytest.raises(InputError, match="at least one pillar"):
        tubule_flow(Domain.rectangle(6.0, 4.0), solved(Domain.rectangle(6.0, 4.0)))
    with pytest.raises(InputError, match="above 0 and at most 1, not 0"):
        tubule_flow(domain, flow).top_share(0.0)
    still = tubule_flow(one, solved(one, conditions={}))
    with pytest.raises(InputError, match="nothing flows through any of the 4 tubules"):
        _ = still.gini
    assert still.junctions.dead.all()
    assert np.isnan(still.junctions.shares).all()
