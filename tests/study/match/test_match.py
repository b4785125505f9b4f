"""The fit to a picture: search, table of evaluations, going on, what cannot be fitted, a whole fit."""

import dataclasses
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import vasculo as vc
from vasculo.measure.distance import SCALES
from vasculo.study.match import fit
from vasculo.study.match import search as searching
from vasculo.study.match.evaluation import Evaluation, read_evaluations, write_evaluations
from vasculo.study.match.painting import paint
from vasculo.study.match.result import ranges_of
from vasculo.study.match.sample import WIDTHS, Wanted, grow_samples
from vasculo.study.match.search import DESIGN, LEAST_BUDGET, Evaluator, first_design, search
from vasculo.study.match.settings import SEARCHED, vasculogenesis_of
from vasculo.study.match.target import target_of

CENTRE = np.array([0.7, 0.3, 0.5, 0.2, 0.8, 0.4])
CAPILLARIES = Path(__file__).parents[3] / "examples" / "images" / "capillaries.png"
WANTED = Wanted(30.0, 1.0, 0.43, 0.08)
PARENT = """
import os, time
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from vasculo.study.match.worker import begin_worker

if __name__ == "__main__":
    pool = ProcessPoolExecutor(1, get_context("spawn"), begin_worker)
    pid = pool.submit(os.getpid).result()
    pool.submit(time.sleep, 600.0)
    print(pid, flush=True)
    time.sleep(600.0)
"""


@pytest.fixture(scope="module")
def known():
    """A plexus with known settings, and its settings."""
    settings = dataclasses.replace(vc.Vasculogenesis.preset("uniform"), stop_void_fraction=0.3)
    return grow_samples(settings, WANTED, [1])[0], settings


def bowl(calls):
    """Stands in for growth: the distance grows away from a centre, with noise that the seeds give."""

    def evaluate(number, places, seeds, *_):
        calls.append(number)
        noise = 0.05 * np.random.default_rng(seeds[0]).standard_normal()
        far = float(np.hypot(0.5, 3.0 * np.linalg.norm(np.array(places) - CENTRE)) + noise)
        return Evaluation(number, places, seeds, far, 0.05, dict.fromkeys(SCALES, far), 1000, 8.0, 0.5, 0.1)

    return evaluate


def evaluator(known=(), tell=lambda _: None):
    return Evaluator(WANTED, None, seeds=2, seed=3, workers=1, known=known, tell=tell)


def test_values_and_places_belong_together():
    for each in SEARCHED:
        for place in (0.0, 0.3, 1.0):
            value = each.value(place)
            assert value == 0.0 or each.low * 0.999 <= value <= each.high * 1.001
            if value > 0.0:
                assert each.place(value) == pytest.approx(place, abs=1e-3)
    assert vasculogenesis_of([0.0] * len(SEARCHED)).threshold_correlation == 0.0


def test_the_design_begins_with_the_defaults_and_covers_every_range():
    design = np.array(first_design(4))
    assert design.shape == (1 + DESIGN, len(SEARCHED))
    usual = vc.Vasculogenesis()
    for name, value in dataclasses.asdict(vasculogenesis_of(design[0])).items():
        assert value == pytest.approx(getattr(usual, name), rel=1e-3) if isinstance(value, float) else True
    for column in design[1:].T:  # a Latin hypercube: one in each of so many parts of a range
        assert sorted(np.floor(column * DESIGN)) == list(range(DESIGN))


def test_the_search_finds_the_settings_in_spite_of_the_noise(monkeypatch):
    monkeypatch.setattr(searching, "evaluate", bowl([]))
    with evaluator() as done:
        why = search(done, 240, 5)
        best = min(done.found, key=lambda each: each.distance)
    assert "differed by less than the noise" in why
    assert len(done.found) < 240
    assert np.abs(np.array(best.places) - CENTRE).max() < 0.15


def test_ranges_are_those_of_the_evaluations_as_near_as_the_best():
    rng = np.random.default_rng(2)
    tried = []
    for number, places in enumerate(rng.random((400, len(SEARCHED)))):  # the first setting does not matter
        far = float(np.hypot(1.0, 3.0 * np.linalg.norm(places[1:] - CENTRE[1:])))
        tried.append(Evaluation(number, tuple(places.tolist()), (0,), far))
    best = min(tried, key=lambda each: each.distance)
    level = float(np.hypot(1.0, 3.0 * 0.3))
    free, *known = ranges_of(best, level, tried)
    assert not free.identified
    for each, setting, centre in zip(known, SEARCHED[1:], CENTRE[1:], strict=True):
        assert each.low <= each.best <= each.high
        assert each.share <= 0.6
        assert setting.place(each.high) <= centre + 0.301
        assert each.low == 0.0 or setting.place(each.low) >= centre - 0.301
    alone = ranges_of(best, best.distance, tried)
    assert all(each.low == each.best == each.high and each.identified for each in alone)


def test_workers_end_with_a_parent_that_is_killed(tmp_path):
    file = tmp_path / "parent.py"
    file.write_text(PARENT)
    with subprocess.Popen([sys.executable, file], stdout=subprocess.PIPE, text=True) as parent:
        worker = int(parent.stdout.readline())
        parent.kill()
    end = time.monotonic() + 20.0
    while time.monotonic() < end and Path(f"/proc/{worker}").exists():
        time.sleep(0.05)
    assert not Path(f"/proc/{worker}").exists()


def test_the_table_reads_back_and_a_fit_that_goes_on_repeats_nothing(monkeypatch, tmp_path):
    calls, path = [], tmp_path / "match.csv"
    monkeypatch.setattr(searching, "evaluate", bowl(calls))
    with evaluator(tell=lambda found: write_evaluations(path, found)) as whole:
        search(whole, 57, 5)
    part = read_evaluations(path)[:40]
    assert part == whole.found[:40]
    calls.clear()
    with evaluator(part) as rest:
        search(rest, 57, 5)
    assert rest.found == whole.found
    assert calls == list(range(40, len(whole.found)))


def test_settings_without_a_plexus_are_kept_with_their_line(monkeypatch, tmp_path):
    def broken(number, places, seeds, *_):
        return Evaluation(number, places, seeds, note="no voids, 3 of 9")

    monkeypatch.setattr(searching, "evaluate", broken)
    with evaluator() as done, pytest.raises(vc.ComputationError, match=r"none of 25 settings .*no voids, 3 of 9"):
        search(done, 100, 0)
    write_evaluations(tmp_path / "match.csv", done.found)
    back = read_evaluations(tmp_path / "match.csv")
    assert back[3].failed
    assert back[3].note == "no voids, 3 of 9"


def test_a_damaged_table_is_refused(tmp_path):
    (tmp_path / "match.csv").write_text("evaluation,distance\n0,1.0\n")
    with pytest.raises(vc.InputError, match="no table of a fit"):
        read_evaluations(tmp_path / "match.csv")


def test_samples_have_the_wanted_islands_and_vessels():
    for sample in grow_samples(vc.Vasculogenesis.preset("fine"), WANTED, [1, 2]):
        assert sample.table.islands == pytest.approx(30.0, rel=0.3)
        assert sample.table.vessel_fraction == pytest.approx(0.43, abs=0.03)
        assert sample.lumen_width > 0.1


def test_a_plexus_beside_a_picture_has_its_pixels():
    fine = vc.Vasculogenesis.preset("fine")
    reading = vc.ImageExtraction(vessels="bright", threshold=90.0, crop=(9, 9, 9, 9), inlet="top")
    (plain,) = grow_samples(fine, WANTED, [1])
    (read,) = grow_samples(fine, dataclasses.replace(WANTED, pixels=17.0, reading=reading), [1])
    assert plain.scale == 1.0
    assert read.table.spacing == pytest.approx(17.0, rel=0.1)
    assert read.table.islands == pytest.approx(30.0, rel=0.05)
    assert read.spacing == pytest.approx(plain.spacing, rel=0.1)
    assert vc.measure.distance(plain.table, read.table).value < 1.0


def test_a_painted_plexus_is_the_plexus(known):
    domain, window = known[0].domain, known[0].table.window
    mask = paint(domain, window, (300, 400))
    assert mask.shape == (300, 400)
    assert 1.0 - mask.mean() == pytest.approx(known[0].table.vessel_fraction, abs=0.02)
    x, y = domain.pillars[0].mean(axis=0)
    around = x - 0.01, y - 0.01, x + 0.02, y + 0.01
    assert paint(domain, around, (2, 3))[:, 0].all()


def test_thick_cords_stay_thick():
    """Where the cords alone take more than the wanted share, nothing is added to them."""
    (sample,) = grow_samples(dataclasses.replace(vc.Vasculogenesis(), stop_void_fraction=0.25), WANTED, [1])
    assert sample.lumen_width == WIDTHS[0]
    assert sample.table.vessel_fraction > 0.43


def test_a_plexus_of_the_same_settings_is_nearer_than_one_of_others(known):
    sample, settings = known
    (same,) = grow_samples(settings, WANTED, [2])
    (other,) = grow_samples(dataclasses.replace(settings, stop_void_fraction=0.42, tether=0.001), WANTED, [2])
    near = vc.measure.distance(sample.table, same.table).value
    far = vc.measure.distance(sample.table, other.table).value
    assert near < 2.2
    assert far > 1.5 * near


@pytest.mark.parametrize(
    ("picture", "words"),
    [
        (np.zeros((40, 40)), "one colour|no pillars|all .* pixels|no vessel"),
        (np.kron(np.eye(3) + 1.0, np.ones((9, 9))), "cannot be fitted|no pillar|one value|no vessel"),
    ],
)
def test_pictures_without_a_network(picture, words):
    with pytest.raises(vc.InputError, match=words):
        target_of(picture, vc.ImageExtraction(vessels="dark"))


def test_too_few_islands_are_counted():
    picture = np.zeros((90, 90))
    for row in range(4):
        for column in range(4):
            picture[5 + 22 * row : 20 + 22 * row, 5 + 22 * column : 20 + 22 * column] = 1.0
    with pytest.raises(vc.InputError, match="it has 16 whole islands and 0 cut ones, at least 20"):
        target_of(picture, vc.ImageExtraction(vessels="dark"))


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"budget": 10}, f"budget is 10, a fit needs a whole number from {LEAST_BUDGET} up"),
        ({"seeds": 1}, "seeds is 1, a fit needs a whole number from 2 up"),
        ({"workers": 0}, "workers is 0"),
        ({"pixel_size": -1.0}, "pixel size"),
        ({"resume": True, "out": "away"}, "away holds no fit to go on with"),
        ({"resume": True}, "name the folder of the fit to go on with"),
    ],
)
def test_wrong_options(known, options, words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(vc.InputError, match=words):
        fit.match(known[0].domain, **options)


def test_without_cma_the_line_says_how_to_get_it(known, monkeypatch, tmp_path):
    monkeypatch.setitem(sys.modules, "cma", None)
    with pytest.raises(vc.InputError, match=r"cma: pip install 'vasculo\[match\]'"):
        fit.match(known[0].domain, tmp_path / "fit")
    assert not (tmp_path / "fit").exists()


@pytest.mark.slow
def test_a_fit_comes_nearer_than_the_defaults(monkeypatch, tmp_path):
    reading = vc.ImageExtraction(vessels="dark", crop=(60, 60, 110, 110))
    for home, name, value in (
        (fit, "ISLANDS", 20.0),
        (fit, "FINALISTS", 1),
        (fit, "REPEATS", 2),
        (fit, "LEAST_BUDGET", 6),
        (searching, "DESIGN", 3),
        (searching, "GENERATION", 3),
    ):
        monkeypatch.setattr(home, name, value)
    found = fit.match(CAPILLARIES, tmp_path / "fit", reading, budget=6, replicates=2)
    assert found.single[0] < found.default[0]
    assert found.near >= 1
    for each in found.ranges:
        assert each.low <= each.best <= each.high
    for sample in found.samples:
        assert sample.table.islands == pytest.approx(found.target.table.islands, rel=0.1)
    assert {path.name for path in found.folder.iterdir()} >= {"match.toml", "match.csv", "match.json", "match.png"}
    with pytest.raises(vc.InputError, match="holds a fit already"):
        fit.match(CAPILLARIES, tmp_path / "fit", reading)
