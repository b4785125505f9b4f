"""Controls: one switch at a time, and what must come of it."""

from __future__ import annotations

import numpy as np
import pytest
from tests.pillars.shapes import disk, disk_domain, record, shape

from vasculo.errors import InputError
from vasculo.flow.boundary import Pressure, Slip
from vasculo.flow.stokes import solve_stokes
from vasculo.geometry.domain import Domain
from vasculo.geometry.outline import centroid, signed_area
from vasculo.mesh.generate import generate_mesh
from vasculo.pillars.angiogenesis import Angiogenesis
from vasculo.pillars.responses import cell_response


def two_disks():
    """Pillars of unlike size beside each other, with room on all sides."""
    return Domain.rectangle(11, 8, [disk(50, 1.3, 4.0, 3.5, 1.1, 0.6), disk(35, 0.9, 7.2, 4.8)])


def ratio_of(final):
    return shape(final.pillars[0])[0]


def test_rolled_activation_has_the_same_values_elsewhere():
    here = record(two_disks(), Angiogenesis(steps=0))[1][0].activation
    rolled = record(two_disks(), Angiogenesis(steps=0, sensing="rolled", roll_seed=1))[1][0].activation
    for a, b in zip(here, rolled, strict=True):
        turns = [k for k in range(len(a)) if np.array_equal(np.roll(a, k), b)]
        assert len(turns) == 1
        assert turns[0] != 0


def test_rolled_activation_depends_on_its_seed_and_on_the_step():
    def values(seed):
        return [
            step.activation[0]
            for step in record(two_disks(), Angiogenesis(steps=2, sensing="rolled", roll_seed=seed))[1]
        ]

    first, again, other = values(1), values(1), values(2)
    for a, b in zip(first, again, strict=True):
        np.testing.assert_array_equal(a, b)
    assert not np.array_equal(first[0], other[0])
    assert np.argmax(first[0]) != np.argmax(first[1]) or np.argmax(first[1]) != np.argmax(first[2])


@pytest.mark.slow
def test_filaments_that_remember_hold_the_disk_back():
    def ratios(memory):
        _, steps = record(disk_domain(), Angiogenesis(steps=14, filament_memory=memory))
        return np.array([shape(step.domain.pillars[0])[0] for step in steps])

    plastic, between, elastic = ratios(0.0), ratios(0.7), ratios(1.0)
    assert plastic[-1] > 1.8
    assert 1.2 < between[-1] < plastic[-1] - 0.3
    assert elastic.max() < 1.15  # strain 0.08 at full activation can do no more
    assert abs(elastic[-1] - elastic[-5]) < 0.01


def test_another_inlet_turns_the_disk():
    outline = disk(35, 1.0, 4.0, 6.0)
    final, steps = record(Domain.rectangle(8, 12, [outline]), Angiogenesis(steps=4, inlet="bottom", outlet="top"))
    usual = record(disk_domain(), Angiogenesis(steps=4))[0]
    assert steps[-1].flow.flow_rate("top") > 0
    assert abs(shape(final.pillars[0])[1]) > 88
    assert ratio_of(final) == pytest.approx(ratio_of(usual), rel=0.01)


@pytest.mark.parametrize("changes", [{"filament_ratio": 0.0}, {"activation": 0.0}])
def test_without_filaments_or_activation_the_disk_keeps_its_shape(changes):
    final, _ = record(disk_domain(), Angiogenesis(steps=4, **changes))
    assert ratio_of(final) == pytest.approx(1.0, abs=0.01)


@pytest.mark.parametrize(
    "changes",
    [
        {"membrane_ratio": 0.0},
        {"bending": 0.0},
        {"area_stiffness": 0.0},
        {"matrix": "none"},
        {"matrix": "elastic"},
        {"response": "logarithm"},
        {"response": "sign"},
        {"smoothing": 0},
        {"border_joining": False},
        {"walls": "no-slip"},
    ],
    ids=lambda changes: next(iter(changes)) + "=" + str(next(iter(changes.values()))),
)
def test_the_disk_elongates_without_any_one_of_these(changes):
    final, _ = record(disk_domain(), Angiogenesis(steps=3, **changes))
    ratio, angle = shape(final.pillars[0])
    assert ratio > 1.1
    assert abs(angle) < 3.0


def test_pressure_pushes_a_hanging_disk_at_least_twice_as_far():
    shifts = []
    for part in ("friction", "full"):
        final, _ = record(disk_domain(), Angiogenesis.hanging(steps=12, traction_part=part))
        shifts.append(centroid(final.pillars[0]) - (6.0, 4.0))
    assert shifts[0][0] > 0.0
    assert abs(shifts[0][1]) < 0.05 * shifts[0][0]
    # Friction is half the drag of a lone disk; the pressure also bends the soft membrane.
    assert 1.8 < shifts[1][0] / shifts[0][0] < 3.0


def test_a_run_ends_when_its_strain_is_used_up():
    _, steps = record(disk_domain(), Angiogenesis(steps=9, strain_limit=0.2))
    assert steps[-1].time >= 0.2 > steps[-2].time
    assert steps[-1].is_last
    assert not steps[-2].is_last
    with pytest.raises(InputError, match="strain_limit"):
        Angiogenesis(strain_limit=-1.0)


def test_a_law_of_ones_own_moves_the_cell():
    @cell_response("test-only-stretch")
    def stretch(shear, _mean, _position):
        return -np.ones_like(shear)

    free, bound = (
        record(disk_domain(), Angiogenesis(steps=2, response="test-only-stretch", area_stiffness=k))[0]
        for k in (0.0, 300.0)
    )
    grown = [signed_area(final.pillars[0]) / signed_area(disk(35)) for final in (free, bound)]
    assert grown[0] > 1.02
    assert grown[1] < grown[0]
    assert ratio_of(free) == pytest.approx(1.0, abs=0.01)


def flow_around(outline):
    """Flow rate at a pressure drop of 1 in the box of the disk; squared shear, length and middle of the wall edges."""
    mesh = generate_mesh(Domain.rectangle(12, 8, [outline]), 0.5, 0.08)
    flow = solve_stokes(mesh, {"left": Pressure(1.0), "right": Pressure(0.0), "bottom": Slip(), "top": Slip()})
    ends = mesh.points[flow.wall_edges[flow.wall_pillar == 0]]
    length = np.hypot(*(ends[:, 1] - ends[:, 0]).T)
    return flow.flow_rate("right"), flow.wall_shear[flow.wall_pillar == 0] ** 2, length, ends.mean(axis=1)


def test_the_flow_rate_changes_with_a_wall_as_its_squared_shear_says():
    # Pironneau 1974: why even shear is the condition for the body of least drag of given area
    _, squared, length, places = flow_around(disk(240, 1.0, 6.0, 4.0))
    angle = np.arctan2(places[:, 1] - 4.0, places[:, 0] - 6.0)
    out = 0.02 * np.cos(2 * angle)
    plus, minus = (flow_around(disk(240, 1.0, 6.0, 4.0, 1.0 + sign * 0.02))[0] for sign in (1, -1))
    assert (plus - minus) / 2 == pytest.approx(-(squared * length) @ out, rel=0.04)


@pytest.mark.slow
def test_the_remodelled_disk_has_less_drag_than_its_ellipse(disk_run):
    area = signed_area(disk_run[0].domain.pillars[0])
    rates = [flow_around(disk(240, 1.0, 6.0, 4.0))[0]]
    for step in (10, 20):
        outline = disk_run[step].domain.pillars[0]
        middle, scale = centroid(outline), np.sqrt(area / signed_area(outline))
        rates.append(flow_around((outline - middle) * scale + (6.0, 4.0))[0])
    squeeze = np.sqrt(shape(disk_run[20].domain.pillars[0])[0])
    twin = flow_around(disk(240, np.sqrt(area / np.pi), 6.0, 4.0, squeeze))[0]
    assert rates[0] < rates[1] < rates[2]
    assert rates[2] > twin
