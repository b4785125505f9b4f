"""What is shown of a record: all of a short one, a share of a long one that is told, and something of a broken one."""

import shutil

import numpy as np
import pytest

from vasculo.errors import InputError
from vasculo.store.read import open_run
from vasculo.store.record import Record
from vasculo.view import layers, legend, numbers, thin
from vasculo.view.layout import ABOUT, TIMELINE
from vasculo.view.replay import Replay
from vasculo.view.show import save_view
from vasculo.view.words import about, caption


def rows_of(path):
    """Entities of a saved view with the values of the timeline at which each was logged (None: static)."""
    from rerun.chunk import RrdReader

    found = {}
    for chunk in RrdReader(str(path)).stream().to_chunks():
        batch = chunk.to_record_batch()
        steps = batch.column(TIMELINE).to_pylist() if TIMELINE in batch.schema.names else [None] * batch.num_rows
        found.setdefault(str(chunk.entity_path).lstrip("/"), []).extend(steps)
    return found


def test_every_layer_comes_at_its_steps(tissue_run, tmp_path):
    path = tmp_path / "run.rrd"
    save_view(tissue_run, path)
    rows = rows_of(path)
    tissue = [frame.index for frame in tissue_run.frames if frame.stage == "vasculogenesis"]
    blood = [frame.index for frame in tissue_run.frames if frame.stage == "angiogenesis"]
    assert set(rows[layers.SPRINGS]) == {*tissue, blood[0]}  # the last one takes them away
    for layer in (layers.SPEEDS, layers.PRESSURES, layers.FILLS, layers.OUTLINES, layers.SHEARS):
        assert sorted(rows[layer]) == blood
    assert sorted(rows[ABOUT]) == sorted(rows[legend.CAPTION]) == [*tissue, *blood]
    finite = np.flatnonzero(np.isfinite(tissue_run.metrics["permeability"])).tolist()
    assert sorted(step for step in rows[numbers.entity("permeability")] if step is not None) == finite
    assert list(tmp_path.iterdir()) == [path]


def test_a_long_run_is_thinned_and_says_so(tissue_run):
    shown = Replay(tissue_run, most=4)
    recorded = tissue_run.steps("vasculogenesis")
    kept = [frame.step for frame in shown.steps if frame.stage == "vasculogenesis"]
    assert len(recorded) > 4 >= len(kept)
    assert kept[0] == recorded[0]
    assert kept[-1] == recorded[-1]
    assert "recorded step is shown" in shown.notes[0]
    assert Replay(tissue_run, most=len(recorded)).notes == []


@pytest.mark.parametrize("count", [1, 2, 3, 99, 100, 101, 250, 1000])
def test_thinning_keeps_the_ends_and_the_limit(count):
    places = thin.shown(count, thin.spacing(count, 100))
    assert places[0] == 0
    assert places[-1] == count - 1
    assert len(places) <= 100
    assert len(places) >= min(count, 50)
    assert sorted(thin.coarse_first(places)) == places


def test_what_stopped_early_is_shown_as_far_as_it_came(tissue_run, tmp_path):
    record = Record.create(tmp_path / "run.vtkhdf", tissue_run.settings_text, "0")
    state = tissue_run.network(0)
    record.add_springs({"step": 0, "time": 0.0}, state.points, state.velocities, state.springs, state.forces)
    record.close()
    shown = Replay(open_run(tmp_path))
    assert shown.notes == ["the run did not come to its end: this is what it recorded"]
    save_view(open_run(tmp_path), tmp_path / "run.rrd")
    assert rows_of(tmp_path / "run.rrd")[layers.SPRINGS] == [0]


def test_nothing_recorded_is_one_line(tissue_run, tmp_path):
    Record.create(tmp_path / "run.vtkhdf", tissue_run.settings_text, "0").close()
    with pytest.raises(InputError, match="has no recorded step to view"):
        Replay(open_run(tmp_path))


def test_fewer_than_two_steps_are_refused(tissue_run):
    with pytest.raises(InputError, match="1 steps of a stage cannot be shown"):
        Replay(tissue_run, most=1)


def test_a_file_that_cannot_be_written_is_one_line(tissue_run, tmp_path):
    with pytest.raises(InputError, match="name a file in a folder that is there"):
        save_view(tissue_run, tmp_path / "away" / "run.rrd")


def test_words_have_units_and_numbers(units):
    row = {"step": 3.0, "pillars": 2.0, "permeability": 2e-6, "mean_gap": float("nan")}
    text = about("a study", "angiogenesis", 40, row, units, ["every 3rd recorded step is shown"])
    assert "## Angiogenesis, step 3 of 40" in text
    assert "| permeability, µm² | 2 |" in text
    assert "gap" not in text
    assert "every 3rd" in text
    assert caption("angiogenesis", row) == "angiogenesis step 3: 2 pillars"


def test_a_study_without_tissue_and_a_copied_folder(tissue_run, tmp_path):
    shutil.copy(tissue_run.path, tmp_path / "run.vtkhdf")
    copied = Replay(open_run(tmp_path))
    assert copied.plane == Replay(tissue_run).plane
    assert copied.plane.size[0] > 1.0  # the plain strips before and behind the tissue are in it
