"""The watchers: what they stop, what they record, in which order."""

from types import SimpleNamespace

import numpy as np
import pytest

from vasculo.errors import ComputationError
from vasculo.store.read import open_run
from vasculo.store.record import Record
from vasculo.study.invariants import check_growth, check_remodelling
from vasculo.study.recorders import GrowthRecorder, Table
from vasculo.study.watch import growth_progress, in_turn
from vasculo.tissue.lattice import lattice


def growth(phase, step, points=None):
    network = lattice(60, 0)
    if points is not None:
        network.points = points
    return SimpleNamespace(
        phase=phase,
        step=step,
        steps_total=100,
        time=0.2 * step,
        void_fraction=0.1,
        voids=3,
        residual=0.5,
        network=network,
    )


def remodelled(**changes):
    flow = SimpleNamespace(velocity=np.ones((3, 2)), pressure=np.ones(3), wall_shear=np.ones(2), mass_imbalance=1e-12)
    for name, value in changes.items():
        if name != "areas":
            setattr(flow, name, value)
    domain = SimpleNamespace(pillar_areas=changes.get("areas", np.array([1.0, 2.0])))
    return SimpleNamespace(step=7, domain=domain, flow=flow)


def test_a_node_that_is_lost_stops_the_run():
    check_growth(growth("growth", 1))
    points = lattice(60, 0).points
    points[[4, 9]] = np.nan
    with pytest.raises(ComputationError, match=r"vasculogenesis step 12 .* 2 of 60 nodes .* the first is node 4"):
        check_growth(growth("growth", 12, points))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"areas": np.array([1.0, -0.5])}, "step 7: pillar 1 has area -0.5"),
        ({"pressure": np.array([1.0, np.inf, np.nan])}, "step 7: 2 of 3 values of the pressure are not finite"),
        ({"wall_shear": np.array([np.nan])}, "1 of 1 values of the wall_shear"),
        ({"mass_imbalance": 0.02}, "step 7: the mass balance of the flow is off by 0.02, above 1e-06"),
        ({"mass_imbalance": float("nan")}, "off by nan"),
    ],
)
def test_broken_invariants_stop_the_run(changes, message):
    check_remodelling(remodelled())
    with pytest.raises(ComputationError, match=message):
        check_remodelling(remodelled(**changes))


def test_first_and_last_of_each_phase_are_recorded(tmp_path):
    record = Record.create(tmp_path / "run.vtkhdf", '[study]\ntitle = "x"\n', "0")
    recorder = GrowthRecorder(record, Table(tmp_path / "metrics.csv"), every=3)
    phases = ["growth"] * 5 + ["rupture"] * 3 + ["tightening"] + ["settling"] * 6
    for step, phase in enumerate(phases):
        recorder(growth(phase, step))
    recorder.flush()
    recorder.flush()
    record.close()
    assert open_run(tmp_path).steps("vasculogenesis") == [0, 3, 4, 5, 7, 8, 9, 12, 14]
    assert len((tmp_path / "metrics.csv").read_text().splitlines()) == 10


def test_watchers_are_called_in_turn():
    seen = []
    in_turn(lambda step: seen.append(("a", step)), lambda step: seen.append(("b", step)))(5)
    assert seen == [("a", 5), ("b", 5)]


def test_progress_gets_words():
    told = []
    growth_progress(SimpleNamespace(advance=lambda *words: told.append(words)))(growth("rupture", 30))
    done, total, text = told[0]
    assert (done, total) == (30, 100)
    assert text.startswith("rupture: ")
    assert "voids 10% in 3" in text
