import numpy as np
import pytest
from tests.pillars.shapes import disk, record, shape

from vasculo.errors import ComputationError, InputError
from vasculo.geometry.domain import Domain
from vasculo.geometry.neighbours import pillar_gaps
from vasculo.geometry.outline import centroid, signed_area
from vasculo.pillars import angiogenesis
from vasculo.pillars.angiogenesis import Angiogenesis, RemodelState
from vasculo.plexus.voronoi import voronoi_plexus


def order(domain):
    return np.mean([np.cos(2 * np.radians(shape(p)[1])) for p in domain.pillars])


def areas(domain):
    return np.array([signed_area(p) for p in domain.pillars])


def block(channel=0.4):
    return voronoi_plexus(16, seed=0, channel=channel)


def four_in_two_rows():
    """Two pairs of pillars with a slow gap between the partners, which soon merge."""
    pillars = [disk(40, 1.0, x, y, 1.3) for y in (1.3, 3.8) for x in (3.0, 5.77)]
    return Domain.rectangle(8.8, 5.1, pillars)


@pytest.mark.slow
def test_sixteen_pillars_align_and_merge_into_chains_along_the_flow():
    start = block()
    final, steps = record(start, Angiogenesis(steps=40))
    merges = [merge for step in steps for merge in step.merges]
    assert len(final.pillars) <= 10
    assert len(merges) == 16 - len(final.pillars) == steps[-1].merges_total
    assert order(final) >= 0.75
    assert np.mean(np.cos(2 * np.radians([merge.angle for merge in merges]))) >= 0.8
    assert np.mean([shape(p)[0] for p in final.pillars]) > 1.5 * np.mean([shape(p)[0] for p in start.pillars])
    assert steps[-1].flow.flow_rate("right") > 2.5 * steps[0].flow.flow_rate("right")
    assert areas(final).sum() == pytest.approx(areas(start).sum(), rel=0.02)  # the latest merges filled notches
    assert max(len(group) for group in steps[-1].lineage) >= 3


@pytest.mark.slow
def test_activation_without_information_makes_no_chains():
    start = block()
    final, steps = record(start, Angiogenesis(steps=20, sensing="rolled", roll_seed=5))
    assert len(final.pillars) == 16
    assert abs(order(final) - order(start)) < 0.3
    change = np.mean([shape(p)[0] for p in final.pillars]) - np.mean([shape(p)[0] for p in start.pillars])
    assert abs(change) < 0.2
    assert steps[-1].flow.flow_rate("right") < 1.2 * steps[0].flow.flow_rate("right")


@pytest.mark.slow
def test_hanging_pillars_are_only_pushed_aside():
    start = block(channel=0.5)
    final, steps = record(start, Angiogenesis.hanging(steps=20))
    assert len(final.pillars) == 16
    shift = np.array([centroid(b) - centroid(a) for a, b in zip(start.pillars, final.pillars, strict=True)])
    assert shift[:, 0].min() > 0.0
    assert 0.05 < shift[:, 0].mean() < 0.4
    assert abs(shift[:, 1].mean()) < 0.1 * shift[:, 0].mean()
    gaps = pillar_gaps(final.pillars) / pillar_gaps(start.pillars)
    assert abs(gaps.mean() - 1) < 0.05
    ratios = np.array([[shape(p)[0] for p in domain.pillars] for domain in (start, final)])
    assert ratios[1].mean() == pytest.approx(ratios[0].mean(), rel=0.05)  # "somewhat changing shape"
    assert abs(order(final) - order(start)) < 0.25
    assert steps[-1].displacement < 0.3 * steps[1].displacement  # it settles
    assert all((a == 0.0).all() for a in steps[-1].activation)
    assert abs(steps[-1].flow.flow_rate("right") / steps[0].flow.flow_rate("right") - 1) < 0.05


def test_partners_in_a_row_merge_and_the_record_is_whole():
    final, steps = record(four_in_two_rows(), Angiogenesis(steps=8))
    assert len(final.pillars) == 2
    assert steps[-1].lineage == ((0, 1), (2, 3))
    merges = [merge for step in steps for merge in step.merges]
    assert sorted(merge.pillars for merge in merges) == [((0,), (1,)), ((2,), (3,))]
    assert max(abs(merge.angle) for merge in merges) < 10.0
    for step in steps:
        assert sorted(i for group in step.lineage for i in group) == [0, 1, 2, 3]
        assert step.merges_total == 4 - len(step.domain.pillars)
        assert (pillar_gaps(step.domain.pillars) >= 0.5 * 0.18 - 1e-9).all()
        assert all(merge.step == step.step for merge in step.merges)
        assert step.shear_ratio >= 1.0
        assert step.seconds == pytest.approx(sum(step.seconds_by_part.values()))
    np.testing.assert_allclose(steps[-1].state.rest_areas, 2 * steps[0].state.rest_areas[[0, 2]])


@pytest.mark.parametrize(
    "parameters",
    [
        Angiogenesis(steps=6),
        Angiogenesis.hanging(steps=6),
        Angiogenesis(steps=6, filament_memory=0.5, matrix="elastic", sensing="rolled", roll_seed=3),
    ],
)
def test_going_on_from_a_state_gives_the_same_bits(parameters):
    whole, steps = record(four_in_two_rows(), parameters)
    arrays = {name: value.copy() for name, value in steps[3].state.arrays().items()}
    rest, later = record(four_in_two_rows(), parameters, RemodelState.from_arrays(arrays))
    assert [step.step for step in later] == [4, 5, 6]
    for a, b in zip(whole.pillars, rest.pillars, strict=True):
        np.testing.assert_array_equal(a, b)
    for a, b in zip(steps[4:], later, strict=True):
        assert a.time == b.time
        assert a.merges == b.merges
        np.testing.assert_array_equal(a.flow.wall_shear, b.flow.wall_shear)
        for name, value in a.state.arrays().items():
            np.testing.assert_array_equal(b.state.arrays()[name], value)


def test_a_finished_state_is_given_back():
    _, steps = record(four_in_two_rows(), Angiogenesis(steps=1))
    final, later = record(four_in_two_rows(), Angiogenesis(steps=1), steps[-1].state)
    assert later == []
    for a, b in zip(final.pillars, steps[-1].domain.pillars, strict=True):
        np.testing.assert_array_equal(a, b)


def test_pillars_at_a_wall_stay_inside():
    pillars = [disk(40, 1.0, x, 1.06) for x in (3.0, 6.0)]
    final, steps = record(Domain.rectangle(9, 4, pillars), Angiogenesis(steps=5, activation=-0.08))
    assert min(p[:, 1].min() for p in final.pillars) > 0.2 * 0.18
    assert len(steps) == 6


def test_no_slip_walls_slow_the_flow():
    free = record(four_in_two_rows(), Angiogenesis(steps=0))[1][0].flow.flow_rate("right")
    held = record(four_in_two_rows(), Angiogenesis(steps=0, walls="no-slip"))[1][0].flow.flow_rate("right")
    assert 0 < held < free


def test_a_box_without_inlet_is_refused():
    domain = Domain([(0, 0), (8, 0), (8, 5), (0, 5)], [disk(30, 1.0, 4, 2.5)], ("a", "b", "c", "d"))
    with pytest.raises(InputError, match="inlet = 'left' is no side of the domain: it has a, b, c, d"):
        record(domain, Angiogenesis(steps=1))


def test_a_step_that_fails_names_itself_after_the_steps_before_it(monkeypatch):
    move = angiogenesis.move

    def fails_in_step_two(domain, state, activation, loads, parameters):
        if state.step == 1:
            loads = np.full_like(loads, np.inf)
        return move(domain, state, activation, loads, parameters)

    monkeypatch.setattr(angiogenesis, "move", fails_in_step_two)
    seen = []
    with pytest.raises(ComputationError, match=r"remodelling step 2: .* not finite .* pillar 0"):
        angiogenesis.remodel(four_in_two_rows(), Angiogenesis(steps=3), seen.append)
    assert [step.step for step in seen] == [0, 1]


def test_a_flow_that_fails_in_a_later_step_names_the_step(monkeypatch):
    sense = angiogenesis.sense

    def fails_in_step_one(domain, state, parameters, *tools):
        if state.step == 1:
            raise InputError("no mesh")
        return sense(domain, state, parameters, *tools)

    monkeypatch.setattr(angiogenesis, "sense", fails_in_step_one)
    with pytest.raises(ComputationError, match=r"^remodelling step 1: no mesh$"):
        angiogenesis.remodel(four_in_two_rows(), Angiogenesis(steps=2))
